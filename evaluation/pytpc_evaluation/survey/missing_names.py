"""What a package did not find on this machine, from what CMake, the compilers and make wrote."""

from __future__ import annotations

import re

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
