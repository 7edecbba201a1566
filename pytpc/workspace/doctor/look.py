"""Looking at the machine, for ``doctor.machine``: runs programs, reads files, changes nothing."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from pytpc.base.paths import (
    BUILD_TOOLS,
    ROS_PREFIXES,
    SYSTEM_PATH,
    how_to_install,
    is_checkout,
    prefix,
    ros_places,
    search_path,
    sourced_prefixes,
)
from pytpc.workspace.doctor.machine import COLCON_EXTENSIONS, MODULES, Machine, Program

_PARTS = (
    "lib/tpc/TpcPasses.so",
    "lib/tpc/TpcDefer.so",
    "lib/libtpc_log.so",
    "share/tpc/cmake/tpc.cmake",
    "share/tpc/flags",
    "share/tpc/rules/ros1.json",
    "bin/tpc-clang++",
)
_PATIENCE_S = 60
# What /usr/bin/python3 is asked: a dictionary with "modules" and "colcon".
_QUESTION = """
import importlib, importlib.metadata as metadata, json, sys
modules, extensions = {}, []
for name in json.loads(sys.argv[1]):
    try:
        modules[name] = str(getattr(importlib.import_module(name), "__version__", ""))
    except Exception:
        pass
for name in json.loads(sys.argv[2]):
    try:
        metadata.distribution(name)
        extensions.append(name)
    except Exception:
        pass
print(json.dumps({"modules": modules, "colcon": extensions}))
"""


def look_at_machine(folder: Path) -> Machine:
    """See what this machine has.

    Args:
        folder: the free space of its disk is checked; it need not exist.
    """
    programs = {
        name: Program(Path(path), version_of(output_of([path, "--version"])))
        for name in BUILD_TOOLS
        if (path := shutil.which(name, path=search_path())) is not None
    }
    python = shutil.which("python3")
    modules, extensions = _ask_python()
    missing = tuple(part for part in _PARTS if not (prefix() / part).exists())
    told = sourced_prefixes()
    disk = folder.absolute()
    while not disk.exists():
        disk = disk.parent
    return Machine(
        programs=programs,
        python=None if python is None else Path(python),
        modules=modules,
        extensions=extensions,
        prefix=prefix(),
        missing_parts=missing,
        trial=None if missing or "clang++-19" not in programs else _try_build(),
        ros=ros_places([*told, *ROS_PREFIXES]),
        environment=dict(os.environ),
        folders=frozenset(path for path in told if path.is_dir()),
        disk_folder=disk,
        disk_free=shutil.disk_usage(disk).free,
        memory_free=_free_memory(Path("/proc/meminfo")),
        setup="make setup" if is_checkout() else how_to_install(),
        ccache=ccache_settings(output_of(["ccache", "--show-config"])),
    )


def version_of(said: str) -> tuple[int, ...]:
    """The first dotted number in the output of ``--version``; empty if there is none."""
    found = re.search(r"\b(\d+(?:\.\d+)+)", said)
    return tuple(map(int, found[1].split("."))) if found else ()


def ccache_settings(said: str) -> dict[str, str]:
    """The settings that ``ccache --show-config`` tells, each line as ``(origin) name = value``."""
    lines = re.findall(r"^\([^)]*\) (\w+) = (.*)$", said, re.MULTILINE)
    return dict(lines)


def _ask_python() -> tuple[Mapping[str, str], frozenset[str]]:
    names = [json.dumps(list(MODULES)), json.dumps(COLCON_EXTENSIONS)]
    said = output_of(["/usr/bin/python3", "-c", _QUESTION, *names])
    try:
        answer = json.loads(said)
    except ValueError:
        return {}, frozenset()
    return answer["modules"], frozenset(answer["colcon"])


def _try_build() -> str | None:
    """Build a program with the wrapper, so that each installed part has to load."""
    with tempfile.TemporaryDirectory(prefix="tpc-doctor-") as name:
        source = Path(name) / "trial.cpp"
        source.write_text("int main() { return 0; }\n", encoding="utf-8")
        command = [str(prefix() / "bin/tpc-clang++"), source.name, "-o", "trial"]
        ran = _run(command, cwd=name)
        if ran is None:
            return "the compiler cannot be started or does not finish"
        if ran.returncode != 0:
            return next((line for line in ran.stderr.splitlines() if line), "it says nothing")
        if not (Path(name) / "tpc/trial.json").is_file():
            return "the passes were not run"
        return None


def _free_memory(file: Path) -> int:
    try:
        found = re.search(r"^MemAvailable:\s+(\d+) kB", file.read_text("ascii"), re.MULTILINE)
    except OSError:
        found = None
    return int(found[1]) * 1024 if found else 1 << 40


def output_of(command: Sequence[str]) -> str:
    """The output of a program; empty if it is not installed or takes too long."""
    ran = _run(command)
    return "" if ran is None else ran.stdout


def _run(command: Sequence[str], cwd: str | None = None) -> subprocess.CompletedProcess[str] | None:
    own = {"PYTHONHOME", "PYTHONPATH", "VIRTUAL_ENV"}
    kept = {
        name: value
        for name, value in os.environ.items()
        if name not in own and not name.startswith("TPC_")
    }
    try:
        return subprocess.run(
            list(command),
            cwd=cwd,
            env={**kept, "PATH": search_path() or SYSTEM_PATH},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_PATIENCE_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
