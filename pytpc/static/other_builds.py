"""Which comparison of this build is one of another build, whose keys may differ.

A key has the line and the column in it, so a line that is added above a comparison changes it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import NamedTuple

from pytpc.static.link_unit import Comparison, LinkUnit
from pytpc.static.parameters import base_key
from pytpc.static.static_info import StaticInfo


class _Placed(NamedTuple):
    unit: LinkUnit
    found: Comparison


def keys_in(here: StaticInfo, there: StaticInfo) -> dict[str, str]:
    """The key in this build of each comparison of another build that has another one here.

    Two are the same if they compare the same parameter in the same way in the same function. If a
    function has several of these, they are told apart by their order, or, if their number differs,
    by their source line. What is still not clear is left out. A key has the line in it, so the same
    key may be another comparison there; it is the same one if its source line is, too. One
    whose key is here that of another one gets a key that nothing here has.

    Args:
        here: this build.
        there: the other one.
    """
    same = {
        key
        for key, found in there.comparisons.items()
        if key in here.comparisons and here.comparisons[key].source_code == found.source_code
    }
    new, old = _without(here, same), _without(there, same)
    found: dict[str, str] = {}
    taken: set[str] = set()
    for place in (_in_function, _in_file):
        free = _grouped([one for one in new if one.found.key not in taken], place)
        for alike, left in _grouped([o for o in old if o.found.key not in found], place).items():
            paired = _paired(left, free.get(alike, []))
            found |= paired
            taken |= set(paired.values())
    lost = taken & there.comparisons.keys() - same - found.keys()
    found |= {key: f"{key}-of-another-build" for key in lost}
    return {key: other for key, other in found.items() if key != other}


def _without(static: StaticInfo, skipped: Collection[str]) -> list[_Placed]:
    return [
        _Placed(unit, one)
        for unit in static.units
        for one in unit.comparisons
        if one.key not in skipped
    ]


def _grouped(
    every: Iterable[_Placed], place: Callable[[_Placed], tuple[object, ...]]
) -> Mapping[tuple[object, ...], list[_Placed]]:
    groups = defaultdict(list)
    for one in sorted(every, key=lambda one: (one.found.lineno, one.found.column, one.found.key)):
        groups[place(one)].append(one)
    return groups


def _in_function(one: _Placed) -> tuple[object, ...]:
    return (*_in_file(one), one.found.function)


def _in_file(one: _Placed) -> tuple[object, ...]:
    unit, found = one
    own = found.source or found.name
    return unit.package, unit.link_unit, found.file, own, found.relation, found.type


def _paired(old: list[_Placed], new: list[_Placed]) -> dict[str, str]:
    if len(old) == len(new):
        return {o.found.key: n.found.key for o, n in zip(old, new, strict=True)}
    by_line: dict[str | None, list[_Placed]] = defaultdict(list)
    for one in new:
        by_line[one.found.source_code].append(one)
    lines = [one.found.source_code for one in old]
    return {
        one.found.key: by_line[line][0].found.key
        for one, line in zip(old, lines, strict=True)
        if line is not None and lines.count(line) == 1 and len(by_line[line]) == 1
    }


def renamed(key: str, names: Mapping[str, str]) -> str:
    """The key in this build; that of an instance keeps its number.

    >>> [renamed(key, {"a": "x", "b": "y"}) for key in ("a", "b#2", "c")]
    ['x', 'y#2', 'c']
    """
    base = base_key(key)
    return names.get(base, base) + key[len(base) :]
