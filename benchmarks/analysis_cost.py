"""What the passes cost a build: CPU time of image_capture with them and without, in one run.

Without them the same clang, level and full link-time optimisation are used. Each command that
compiles or links is run in turn with and without, so that a machine that is slower for a while is
slower for both, and the sums of the commands' medians are compared.
"""

from __future__ import annotations

import os
import re
import resource
import shlex
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from figures import figure

from pytpc.base.paths import cmake_file
from pytpc_evaluation.demo.demo_examples import IMAGE_CAPTURE, SHARED_PACKAGE

ROUNDS = 3
PLAIN = (
    "-DCMAKE_C_COMPILER=clang-19",
    "-DCMAKE_CXX_COMPILER=clang++-19",
    "-DCMAKE_AR=/usr/bin/llvm-ar-19",
    "-DCMAKE_RANLIB=/usr/bin/llvm-ranlib-19",
    "-DCMAKE_CXX_FLAGS=-g -flto=full",
    "-DCMAKE_EXE_LINKER_FLAGS=-flto=full -fuse-ld=lld-19",
    "-DCMAKE_SHARED_LINKER_FLAGS=-flto=full -fuse-ld=lld-19",
)
ENVIRONMENT = {**os.environ, "PATH": "/usr/bin:/bin"}


def build(package: Path, folder: Path, options: Sequence[str], *targets: str) -> list[str]:
    """Builds a package; ninja's command for its folder."""
    configure = ["cmake", "-S", str(package), "-B", str(folder), "-G", "Ninja"]
    configure += ["-DCMAKE_BUILD_TYPE=RelWithDebInfo", "-DPYTHON_EXECUTABLE=/usr/bin/python3"]
    ninja = ["ninja", "-C", str(folder)]
    subprocess.run([*configure, *options], env=ENVIRONMENT, check=True, capture_output=True)
    subprocess.run([*ninja, *targets], env=ENVIRONMENT, check=True, capture_output=True)
    return ninja


def installed(folder: Path) -> Path:
    """Installs what the robots share, which is headers for a build."""
    prefix = folder / "install"
    build(SHARED_PACKAGE, folder, (f"-DCMAKE_INSTALL_PREFIX={prefix}",), "install")
    return prefix


def built(folder: Path, options: Sequence[str]) -> dict[str, str]:
    """Builds the robot; the commands that compiled and linked it, by what they wrote."""
    ninja = build(IMAGE_CAPTURE.folder, folder, options)
    listed = subprocess.run(
        [*ninja, "-t", "commands"], env=ENVIRONMENT, check=True, capture_output=True, text=True
    )
    commands = {}
    for line in listed.stdout.splitlines():
        output = re.search(r" -o (\S+)", line)
        if output and "clang" in line:
            name = shlex.split(output[1])[0].replace(str(folder), "")
            commands[name] = line
    return commands


def cpu_seconds(command: str, folder: Path) -> float:
    """What one command of the build costs, with all its processes."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        command, shell=True, cwd=folder, env=ENVIRONMENT, check=True, capture_output=True
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def medians(ways: dict[Path, dict[str, str]]) -> list[float]:
    """The sum of the commands' medians, for each way of building; the ways take turns."""
    (first, *others) = ways.values()
    if any(other.keys() != first.keys() for other in others):
        sys.exit("the two builds do not consist of the same commands")
    sums = [0.0] * len(ways)
    for name in first:
        seconds: list[list[float]] = [[] for _ in ways]
        for _ in range(ROUNDS):
            for own, (folder, commands) in zip(seconds, ways.items(), strict=True):
                own.append(cpu_seconds(commands[name], folder))
        sums = [total + statistics.median(own) for total, own in zip(sums, seconds, strict=True)]
    return sums


def main() -> None:
    """Prints the ratio."""
    with tempfile.TemporaryDirectory() as scratch:
        folders = Path(scratch) / "with", Path(scratch) / "without"
        shared = f"-DCMAKE_PREFIX_PATH={installed(Path(scratch) / 'shared')}"
        options = (shared, f"-DCMAKE_TOOLCHAIN_FILE={cmake_file()}"), (shared, *PLAIN)
        with_passes, without = medians(
            {folder: built(folder, own) for folder, own in zip(folders, options, strict=True)}
        )
    ratio = with_passes / without
    figure(
        "analysis-cost",
        "build_cpu_with_over_without",
        ratio,
        unit="ratio",
        target="<=1.05",
        hit=ratio <= 1.05,
    )


if __name__ == "__main__":
    main()
