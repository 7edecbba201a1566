"""Why a package did not build, in one line, from what CMake, the compilers and make wrote."""

from __future__ import annotations

import re
from collections.abc import Iterable

# Messages that name something missing on this machine; the group is its name.
_MISSING = tuple(
    re.compile(pattern)
    for pattern in (
        r'^\s*Could not find a package configuration file provided by "(?P<name>[^"]+)"',
        r"^\s*Could not find a package configuration file provided by (?P<name>\w[\w.+-]*)",
        r"^\s*Could NOT find (?P<name>\w[\w.+-]*)",
        r"^.*: fatal error: '(?P<name>[^']+)' file not found",
        r"^.*: fatal error: (?P<name>\S+): No such file or directory",
        r"^\s*(?:--\s+)?No package '(?P<name>[^']+)' found",
        r"^.*\bunable to find library -l(?P<name>\S+)",
        r"^.*\bcannot find -l(?P<name>[^\s:]+)",
        r"^ModuleNotFoundError: No module named '(?P<name>[^']+)'",
        r"^ImportError: No module named '?(?P<name>[\w.]+)'?",
    )
)
_CMAKE_ERROR = re.compile(r"^CMake Error(?: at (?P<place>[^\s:]+:\d+))?")
_ERRORS = tuple(
    re.compile(pattern)
    for pattern in (
        r"^\S.*:\d+(?::\d+)?: (?:fatal )?error: .*",
        r"^(?:\S*ld\.lld\S*|ld): error: .*",
        r"^(?:\S*/)?ld(?:\.\S+)?: .*(?:undefined|cannot|multiple).*",
        r"^clang\S*: error: .*",
        r"^\w*(?:Error|Exception)\b: .*",
        r"^.*\berror: .*",
        r"^g?make(?:\[\d+\])?: \*\*\* .*",
    )
)
_WARNING = ": warning: "
_LONGEST = 300


def missing_names(output: str) -> tuple[str, ...]:
    """What the output says is missing on this machine, each once, in the order of the output.

    CMake also names optional things it did not find: without an error nothing is reported.
    """
    lines = output.splitlines()
    names: dict[str, None] = {}
    optional = False
    for line in lines:
        if line.startswith("CMake Warning"):
            optional = True
        elif line and not line[0].isspace():
            optional = line.startswith("-- Could NOT find")
        for pattern in _MISSING:
            match = pattern.match(line)
            if match is not None and not optional:
                names.setdefault(match["name"])
                break
    return tuple(names)


def first_error(output: str) -> str:
    """The first error in the output as one line; without one, the last line."""
    lines = [line.rstrip() for line in output.splitlines()]
    for at, line in enumerate(lines):
        cmake = _CMAKE_ERROR.match(line)
        if cmake is not None:
            said = _indented(lines[at + 1 :])
            where = f"{cmake['place']}: " if cmake["place"] else ""
            return _shortened(f"CMake: {where}{said or line}")
        if _WARNING not in line and any(pattern.match(line) for pattern in _ERRORS[:-1]):
            return _shortened(line)
    for line in lines:
        if _ERRORS[-1].match(line):
            return _shortened(line)
    return _shortened(next((line for line in reversed(lines) if line), "it says nothing"))


def _indented(lines: Iterable[str]) -> str:
    """The first paragraph of a message of CMake's, which is indented by two."""
    said: list[str] = []
    for line in lines:
        if line.startswith("  "):
            said.append(line.strip())
        elif line or said:
            break
    return " ".join(said)


def _shortened(text: str) -> str:
    one = " ".join(text.split())
    return one if len(one) <= _LONGEST else f"{one[: _LONGEST - 4]} ..."
