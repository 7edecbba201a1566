"""Builds the suite once with the passes, and links the same objects once more without them.

Both programs come from the same compiler, flags, objects and linker; the one is what the author
wrote, with the optimisation of the link alone, the other is analysed, instrumented and optimised.
"""

from __future__ import annotations

import os
import shlex
import subprocess
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from pytpc.build.build import BuildResult, build_workspace
from pytpc.workspace.colcon import BuildOptions, build_environment
from suite.expectations import PACKAGE

_XLINKER = "-Xlinker"


@dataclass(frozen=True, slots=True)
class Suite:
    """The suite, built."""

    result: BuildResult
    folder: Path
    package: Path = PACKAGE

    @property
    def build(self) -> Path:
        """CMake's build folder of the package."""
        return self.result.bases.build / self.package.name


def build_suite(
    folder: Path,
    build_type: str = "RelWithDebInfo",
    cmake_args: tuple[str, ...] = (),
    package: Path = PACKAGE,
) -> Suite:
    """Build the package with the passes in a workspace of its own.

    Raises:
        BuildError: it does not build.
    """
    (folder / "src").mkdir(parents=True)
    (folder / "src" / package.name).symlink_to(package)
    result = build_workspace(folder, BuildOptions(build_type=build_type, cmake_args=cmake_args))
    return Suite(result, folder, package)


def link_commands(suite: Suite) -> dict[str, list[str]]:
    """How each node was linked."""
    return {
        path.parent.name.removesuffix(".dir"): shlex.split(path.read_text("utf-8"))
        for path in sorted(suite.build.glob("CMakeFiles/*.dir/link.txt"))
    }


def instrumented(suite: Suite) -> dict[str, Path]:
    """The programs that the build made."""
    return {node: suite.build / _output(command) for node, command in link_commands(suite).items()}


def without_passes(command: list[str]) -> list[str]:
    """A link command without the plugin and its options."""
    kept, rest = [], command
    while rest:
        if rest[0] == _XLINKER and rest[1].startswith("--load-pass-plugin="):
            rest = rest[2:]
        elif rest[:3] == [_XLINKER, "-mllvm", _XLINKER] and rest[3].startswith(("-load=", "-tpc-")):
            rest = rest[4:]
        else:
            kept.append(rest[0])
            rest = rest[1:]
    return kept


def link_plain(suite: Suite) -> dict[str, Path]:
    """Link the nodes without the passes.

    Raises:
        CalledProcessError: one does not link.
    """
    into = suite.folder / "plain"
    into.mkdir()
    commands = {}
    for node, command in link_commands(suite).items():
        plain = without_passes(command)
        plain[plain.index("-o") + 1] = str(into / node)
        commands[node] = plain
    environment = build_environment()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for ran in [
            pool.submit(subprocess.run, command, cwd=suite.build, env=environment, check=True)
            for command in commands.values()
        ]:
            ran.result()
    return {node: into / node for node in commands}


def _output(command: list[str]) -> str:
    return command[command.index("-o") + 1]
