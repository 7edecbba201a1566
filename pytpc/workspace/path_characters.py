"""Refuses paths with characters that make, the shell or CMake take for something else."""

from __future__ import annotations

from pathlib import Path

from pytpc.base.errors import WorkspaceError

_NAMES = {
    "$": "a dollar sign",
    '"': "a quotation mark",
    ";": "a semicolon",
    "\\": "a backslash",
    "`": "a backtick",
    "\n": "a line break",
}
"""A variable of make and the shell, ends of strings, the separator of CMake's lists, an escape."""


def refuse_characters(path: Path) -> None:
    """Check that a workspace or package can be built where it is; nothing is written.

    With a dollar sign in a path, make writes files elsewhere and the build seems to succeed.
    Spaces, single quotes, ``#``, ``%``, a hyphen in front and letters of all languages do no harm.

    Raises:
        WorkspaceError: its path has a character that make, the shell or CMake changes.
    """
    for character in str(path.absolute()):
        name = _NAMES.get(character)
        if name is None and (ord(character) < 0x20 or ord(character) == 0x7F):
            name = "a control character"
        if name is not None:
            raise WorkspaceError(
                f"{name} in the path, which make and CMake do not take; rename or move the folder",
                path,
            )
