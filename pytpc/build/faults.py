"""Finds the reason why a package did not build in what CMake, the compilers and make wrote."""

from __future__ import annotations

import re
from collections.abc import Iterable

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
