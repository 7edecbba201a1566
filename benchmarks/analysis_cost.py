"""What the passes cost a build: CPU time with them and without, in one run.

Two packages: our robot image_capture, and ``heavy_robot`` beside this file, a node of the size and
manner of real ones: containers, boost, tf2, actions, dynamic_reconfigure, virtual functions.
For a link the same comparison says what the slowest unit pays; there the passes also do what the
compiler does without them.

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
HEAVY_ROBOT = Path(__file__).resolve().parent / "heavy_robot"
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


def built(package: Path, folder: Path, options: Sequence[str]) -> dict[str, str]:
    """Builds a robot; the commands that compiled and linked it, by what they wrote."""
    ninja = build(package, folder, options)
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


def medians(ways: dict[Path, dict[str, str]]) -> dict[str, list[float]]:
    """The median of each command, for each way of building; the ways take turns."""
    (first, *others) = ways.values()
    if any(other.keys() != first.keys() for other in others):
        sys.exit("the two builds do not consist of the same commands")
    found = {}
    for name in first:
        seconds: list[list[float]] = [[] for _ in ways]
        for _ in range(ROUNDS):
            for own, (folder, commands) in zip(seconds, ways.items(), strict=True):
                own.append(cpu_seconds(commands[name], folder))
        found[name] = [statistics.median(own) for own in seconds]
    return found


def cost(package: Path, name: str, shared: str) -> None:
    """Prints the ratio of a package, and that of its slowest link."""
    with tempfile.TemporaryDirectory() as scratch:
        folders = Path(scratch) / "with", Path(scratch) / "without"
        options = (shared, f"-DCMAKE_TOOLCHAIN_FILE={cmake_file()}"), (shared, *PLAIN)
        commands = medians(
            {
                folder: built(package, folder, own)
                for folder, own in zip(folders, options, strict=True)
            }
        )
    with_passes, without = (sum(column) for column in zip(*commands.values(), strict=True))
    links = [own for output, own in commands.items() if not output.endswith(".o")]
    for figure_name, ratio, most in (
        (f"build_cpu_with_over_without_{name}", with_passes / without, 1.1),
        (f"slowest_link_with_over_without_{name}", max(one / other for one, other in links), 2),
    ):
        target = f"<={most:g}"
        figure("analysis-cost", figure_name, ratio, unit="ratio", target=target, hit=ratio <= most)


def main() -> None:
    """Prints the ratios."""
    with tempfile.TemporaryDirectory() as scratch:
        shared = f"-DCMAKE_PREFIX_PATH={installed(Path(scratch) / 'shared')}"
        cost(IMAGE_CAPTURE.folder, "image_capture", shared)
        cost(HEAVY_ROBOT, "heavy_robot", shared)


if __name__ == "__main__":
    main()
