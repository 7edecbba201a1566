"""Builds the suite once with the passes, and links the same objects once more without them.

Both programs come from the same compiler, flags, objects and linker with the same optimisation at
link time; the one is what the author wrote, the other is instrumented.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from pytpc.build import BuildResult, build_environment, build_workspace
from suite.expectations import PACKAGE

_OWN_LINK_FLAG = re.compile(r"-Wl,(--load-pass-plugin=|-mllvm,-tpc-|-mllvm,-load=)")


@dataclass(frozen=True, slots=True)
class Suite:
    """The suite, built."""

    result: BuildResult
    folder: Path

    @property
    def build(self) -> Path:
        """CMake's build folder of the package."""
        return self.result.bases.build / PACKAGE.name


def build_suite(
    folder: Path, build_type: str = "RelWithDebInfo", cmake_args: tuple[str, ...] = ()
) -> Suite:
    """Build the package with the passes in a workspace of its own.

    Raises:
        BuildError: it does not build.
    """
    (folder / "src").mkdir(parents=True)
    (folder / "src" / PACKAGE.name).symlink_to(PACKAGE)
    result = build_workspace(folder, build_type=build_type, cmake_args=cmake_args)
    return Suite(result, folder)


def link_commands(suite: Suite) -> dict[str, list[str]]:
    """How each node was linked."""
    return {
        path.parent.name.removesuffix(".dir"): shlex.split(path.read_text("utf-8"))
        for path in sorted(suite.build.glob("CMakeFiles/*.dir/link.txt"))
    }


def instrumented(suite: Suite) -> dict[str, Path]:
    """The programs that the build made."""
    return {node: suite.build / _output(command) for node, command in link_commands(suite).items()}


def link_plain(suite: Suite) -> dict[str, Path]:
    """Link the nodes without the passes.

    Raises:
        CalledProcessError: one does not link.
    """
    into = suite.folder / "plain"
    into.mkdir()
    commands = {}
    for node, command in link_commands(suite).items():
        plain = [word for word in command if not _OWN_LINK_FLAG.match(word)]
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


def remove(suite: Suite) -> None:
    """Delete what was built: a hundred programs with debug information are large."""
    shutil.rmtree(suite.folder)
