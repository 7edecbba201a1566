"""Where a person who looks on says that a robot goes wrong: a place of the robot's graph.

A robot's ``study.json`` has ``places``: the name of each place with the errors that are seen there,
in the words of the observer's rules. What moves the robot has no list: it is the place of all other
errors. A person knows what the robot does wrong, and not which node is to blame.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc_evaluation.demo.demo_examples import EXAMPLES, Example

_PLACES = "places"


@cache
def places_of(example: Example) -> Mapping[str | None, str]:
    """The place of each error, by its words; None is for all others. Empty without a file.

    Raises:
        InputError: the file has no such list.
    """
    path = example.study
    if not path.exists():
        return {}
    document = parse_json(path)
    given = document.get(_PLACES, {}) if isinstance(document, dict) else None
    if not isinstance(given, dict):
        raise InputError(f"{_PLACES} is not an object", path)
    found: dict[str | None, str] = {}
    for place, listed in given.items():
        reasons = [None] if listed is None else listed
        if not isinstance(reasons, list) or any(one in found for one in reasons):
            raise InputError(f"{_PLACES}, {place}: a list of errors, each in one list only", path)
        found |= dict.fromkeys(reasons, place)
    return found


def place_of(system: str, reason: str) -> str:
    """The place of an error of a robot; empty if nobody can say it."""
    for example in EXAMPLES:
        if example.name == system:
            known = places_of(example)
            return known.get(reason) or known.get(None, "")
    return ""
