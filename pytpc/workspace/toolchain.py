"""The commands that build with TPC by the tool that a user already has.

Nothing is run here: ``steps`` has the commands, ``shown`` writes them for a shell. Each build gets
its own folder, because a build folder keeps the compiler that it was made with.
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.paths import clang_release, home

_GAP = "@TPC_CMAKE_FILE@"


class Way(Enum):
    """The tools; the value is the name on the command line."""

    CATKIN_MAKE = "catkin_make"
    CATKIN_TOOLS = "catkin_tools"
    CMAKE = "cmake"
    COLCON = "colcon"
    CC = "cc"


HEADINGS = {
    Way.CATKIN_MAKE: "catkin_make, in the workspace",
    Way.CATKIN_TOOLS: "catkin build (catkin_tools), in the workspace",
    Way.CMAKE: "plain CMake, in the package",
    Way.COLCON: "colcon, in the workspace",
    Way.CC: "make, Autoconf, Meson and others, before the sources are configured",
}


@dataclass(frozen=True, slots=True)
class Choices:
    """The user's settings of TPC: own rules, a profile, comparisons with constants."""

    rules: Path | None = None
    profile: str | None = None
    constants: bool = False

    def variables(self) -> dict[str, str]:
        """The variables of tpc.cmake and the compiler wrappers; only those that were chosen."""
        chosen = {
            "TPC_RULES": None if self.rules is None else str(self.rules.absolute()),
            "TPC_PROFILE": self.profile,
            "TPC_CONSTANTS": "ON" if self.constants else None,
        }
        return {name: value for name, value in chosen.items() if value is not None}


@dataclass(frozen=True, slots=True)
class Step:
    """One command: its words, and what it is for; ``once`` where it need not be repeated."""

    command: tuple[str, ...]
    purpose: str
    once: bool = False


def steps(way: Way, prefix: Path, choices: Choices) -> list[Step]:
    """The commands of one way, in order.

    Args:
        way: the tool.
        prefix: where the C++ half of TPC is installed; absolute.
        choices: carried along in the tool's own form.
    """
    arguments = _cmake_arguments(prefix, choices)
    match way:
        case Way.CATKIN_MAKE:
            command = ("catkin_make", "--build", "build_tpc", *arguments)
            return [
                Step((*command, "-DCATKIN_DEVEL_PREFIX=devel_tpc"), "builds all packages together"),
                Step(("pytpc", "collect", "build_tpc"), "what the analysis found"),
            ]
        case Way.CATKIN_TOOLS:
            return _catkin_tools(arguments)
        case Way.CMAKE:
            return [
                Step(("cmake", "-S", ".", "-B", "build_tpc", *arguments), "configures"),
                Step(("cmake", "--build", "build_tpc"), "builds"),
                Step(("pytpc", "collect", "build_tpc"), "what the analysis found"),
            ]
        case Way.COLCON:
            return _colcon(prefix, choices)
        case Way.CC:
            return _compilers(prefix, choices)


def shown(way: Way, found: Sequence[Step]) -> str:
    """The steps as text that can be pasted into a shell; purposes are comments."""
    lines = [f"# {HEADINGS[way]}"]
    purpose = ""
    for step in found:
        if step.purpose != purpose:
            lines.append(f"# {step.purpose}{' (once)' if step.once else ''}:")
            purpose = step.purpose
        lines.append(shell_line(step.command))
    return "\n".join(lines) + "\n"


def shell_line(command: Sequence[str]) -> str:
    """A command for a POSIX shell; of an assignment only the value is quoted."""
    words = []
    for word in command:
        name, equals, value = word.partition("=")
        is_assignment = equals and name.isidentifier()
        words.append(f"{name}={shlex.quote(value)}" if is_assignment else shlex.quote(word))
    return " ".join(words)


def _cmake_arguments(prefix: Path, choices: Choices) -> tuple[str, ...]:
    return (
        f"-DCMAKE_TOOLCHAIN_FILE={prefix / 'share/tpc/cmake/tpc.cmake'}",
        # Catkin's generators need the Python that Debian's ROS is installed for.
        "-DPYTHON_EXECUTABLE=/usr/bin/python3",
        *(f"-D{name}={value}" for name, value in choices.variables().items()),
    )


def _catkin_tools(arguments: tuple[str, ...]) -> list[Step]:
    profile = "a profile with spaces of its own"
    return [
        Step(("catkin", "profile", "add", "tpc"), profile, once=True),
        Step(("catkin", "config", "--profile", "tpc", "-x", "_tpc"), profile, once=True),
        # All words behind --cmake-args are for CMake.
        Step(
            ("catkin", "config", "--profile", "tpc", "--cmake-args", *arguments),
            profile,
            once=True,
        ),
        Step(("catkin", "build", "--profile", "tpc"), "builds"),
        Step(("pytpc", "collect", "build_tpc"), "what the analysis found"),
    ]


def _colcon(prefix: Path, choices: Choices) -> list[Step]:
    index = mixin_index(prefix).as_uri()
    mixin = "the mixin, which needs the PyPI package colcon-mixin"
    further = [f"-D{name}={value}" for name, value in choices.variables().items()]
    build = ("colcon", "build", "--mixin", "tpc", *(["--cmake-args", *further] if further else []))
    return [
        Step(("colcon", "mixin", "add", "tpc", index), mixin, once=True),
        Step(("colcon", "mixin", "update", "tpc"), mixin, once=True),
        Step(build, "builds; further mixins may stand behind tpc"),
        Step(("pytpc", "collect", "build_tpc"), "what the analysis found"),
    ]


def mixin_index(prefix: Path) -> Path:
    """The index of the mixin for colcon.

    A wheel cannot know where it is installed, and the mixin of one has a gap for that. It is filled
    in in a copy, in ``$XDG_DATA_HOME/tpc`` (``~/.local/share/tpc``).
    """
    index = prefix / "share/tpc/colcon/index.yaml"
    mixin = index.with_name("tpc.mixin")
    text = mixin.read_text("utf-8") if mixin.is_file() else ""
    if _GAP not in text:
        return index
    data = os.environ.get("XDG_DATA_HOME") or home() / ".local/share"
    folder = Path(data) / "tpc/colcon" / prefix.name
    folder.mkdir(parents=True, exist_ok=True)
    filled = text.replace(_GAP, str(prefix / "share/tpc/cmake/tpc.cmake"))
    write_atomic(folder / mixin.name, filled.encode())
    write_atomic(folder / index.name, index.read_bytes())
    return folder / index.name


def _compilers(prefix: Path, choices: Choices) -> list[Step]:
    tools = {
        "CC": "tpc-clang",
        "CXX": "tpc-clang++",
        "AR": "tpc-ar",
        "RANLIB": "tpc-ranlib",
        "NM": "tpc-nm",
    }
    variables = {name: str(prefix / "bin" / tool) for name, tool in tools.items()}
    return [
        *(
            Step(("export", f"{name}={value}"), "compilers and archiver")
            for name, value in variables.items()
        ),
        # A build that calls the linker itself needs one that knows bitcode.
        Step(("export", f"LD=ld.lld-{clang_release()}"), "compilers and archiver"),
        *(
            Step(("export", f"{name}={value}"), "what to analyse")
            for name, value in choices.variables().items()
        ),
        Step(
            ("export", f"CCACHE_EXTRAFILES={prefix / 'lib/tpc/TpcDefer.so'}"),
            "for CC='ccache tpc-clang': another plugin makes other objects",
        ),
    ]
