"""Names that every viewer takes, made of names that may hold anything.

A legal name is a topic of ROS 1 and ROS 2 and a path of Rerun: parts of letters, digits and single
underscores, each beginning with a letter, with slashes between them.
"""

from __future__ import annotations

import re

_LONGEST_PART = 60
_LONGEST = 200
_OTHER = re.compile(r"[^A-Za-z0-9]+")
_NOT_IN_FILES = re.compile(r"[^A-Za-z0-9_.-]+")


def legal_part(text: str) -> str:
    """One part of a name; other characters become underscores.

    >>> legal_part("~min face-width"), legal_part("2d"), legal_part("\u0301")
    ('min_face_width', 'x2d', 'x')
    """
    part = _OTHER.sub("_", text).strip("_")[:_LONGEST_PART].rstrip("_")
    return part if part[:1].isalpha() else f"x{part}"


def file_part(text: str, otherwise: str) -> str:
    """A part of a file's name, as like the text as may be; ``otherwise`` where nothing is left.

    >>> file_part("monday (2)", "run"), file_part("...", "run")
    ('monday-2', 'run')
    """
    return _NOT_IN_FILES.sub("-", text).strip(".-")[:_LONGEST_PART] or otherwise


def legal_name(text: str) -> str:
    """A name of several parts without a slash before it; empty parts are left out.

    >>> legal_name("/arm//left.joint"), legal_name("~limit")
    ('arm/left_joint', 'limit')
    """
    return "/".join(legal_part(part) for part in text.split("/") if part)


class LegalNames:
    """Gives out legal names, each once."""

    def __init__(self) -> None:
        """No name is given out yet."""
        self._used: set[str] = set()

    def take(self, *parts: str) -> str:
        """The name of these parts, each of which may have slashes; if it is taken, with a number.

        >>> names = LegalNames()
        >>> names.take("tpc", "/arm", "a.b"), names.take("tpc", "/arm", "a b")
        ('/tpc/arm/a_b', '/tpc/arm/a_b_2')
        """
        joined = "/".join(name for name in map(legal_name, parts) if name)
        wanted = "/" + joined[:_LONGEST].rstrip("/_")
        found, number = wanted, 1
        while found in self._used:
            number += 1
            found = f"{wanted}_{number}"
        self._used.add(found)
        return found
