"""The names that a user most likely meant by one that does not exist."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from itertools import islice
from pathlib import Path

from pytpc.base.wording import plain

_MOST = 3
_ENOUGH = 0.6
_NEAR = 0.15
"""A name that is this much less alike than the best one is not offered beside it."""
_MOST_FILES = 2000
_LONGEST = 200
"""What is longer is no name, and comparing it takes long."""


def closest(name: str, known: Iterable[str], most: int = _MOST) -> list[str]:
    """The known names that are most like ``name``, the likest first.

    A parameter's namespace and ``~`` may be left out, in either name; upper and lower case are the
    same.
    """
    if not name or len(name) > _LONGEST:
        return []
    from difflib import SequenceMatcher  # noqa: PLC0415

    matcher = SequenceMatcher(autojunk=False)

    def alike(ours: str, theirs: str) -> float:
        if _most_alike(ours, letters, theirs) < _ENOUGH:
            return 0.0
        matcher.set_seqs(ours, theirs)
        return matcher.ratio()

    bare, last = _forms(name)
    letters = {letter: last.count(letter) for letter in last}
    found: dict[str, float] = {}
    for one in dict.fromkeys(known):
        its_bare, its_last = _forms(one)
        # Names of one node begin alike, which says nothing about the parameter.
        parts = alike(last, its_last)
        if parts >= _ENOUGH:
            matcher.set_seqs(bare, its_bare)
            whole = matcher.ratio() if matcher.quick_ratio() >= _ENOUGH else 0.0
            found[one] = (parts + whole) / 2
    ordered = sorted(found, key=lambda one: (-found[one], one))
    return [one for one in ordered if found[one] >= found[ordered[0]] - _NEAR][:most]


def _most_alike(ours: str, letters: Mapping[str, int], theirs: str) -> float:
    """What the ratio of two names is at most: by their lengths, then by their letters.

    Args:
        ours, theirs: the names.
        letters: how often ours has each letter.
    """
    both = len(ours) + len(theirs)
    most = 2 * min(len(ours), len(theirs)) / both if both else 1.0
    if most < _ENOUGH:
        return most
    shared = sum(min(theirs.count(letter), times) for letter, times in letters.items())
    return 2 * shared / both if both else 1.0


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """``; did you mean rank?``, or nothing if no name is like it.

    >>> did_you_mean("rnk", ["rank", "mark"]), did_you_mean("~spd", ["/arm/speed"])
    ('; did you mean rank?', '; did you mean /arm/speed?')
    >>> did_you_mean("zzz", ["rank"])
    ''
    """
    close = [plain(one) for one in closest(name, known)]
    if not close:
        return ""
    *others, last = close
    return f"; did you mean {', '.join(others)} or {last}?" if others else f"; did you mean {last}?"


def _forms(name: str) -> tuple[str, str]:
    """A name without what says where it is, and its last part."""
    bare = name.lower().lstrip("~/")
    return bare, re.split("[~/]", bare)[-1] or bare


def path_hint(path: Path) -> str:
    """``; did you mean today.bag?``: what lies beside the place of a path that does not exist.

    Of a folder on the way that does not exist, that is said.
    """
    gone = path
    while gone.parent != gone and not gone.parent.exists():
        gone = gone.parent
    try:
        with os.scandir(gone.parent) as entries:
            beside = [entry.name for entry in islice(entries, _MOST_FILES)]
    except OSError:
        return ""
    if gone != path:
        return f"; there is no folder {plain(str(gone))}"
    # The end of a name says what a file is, and is alike for all of a kind.
    near = [name for name in beside if name.lower() == path.name.lower()]
    return did_you_mean(path.name, near or [n for n in beside if not n.startswith(".")])


def no_folder(path: Path) -> str:
    """What is wrong with a path that is no folder."""
    return "not a folder" if path.exists() else f"no such folder{path_hint(path)}"
