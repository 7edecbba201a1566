"""Which names are most likely meant by parameters that differ and that no node reads."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

from pytpc.base.closest import closest
from pytpc.diagnosis.results.differences import Difference
from pytpc.static.parameters import DYNAMIC

_MISSPELT = 20
"""If nobody reads more of the parameters, they belong to a node that was not analysed."""


def with_alike(
    found: Sequence[Difference], values: Collection[str], read: Iterable[str]
) -> list[Difference]:
    """The differences; those that nobody reads have the names that are most likely meant.

    Such a name is read and has the default of the code, as nobody set it beside the misspelt one.

    Args:
        found: the differences.
        values: the names of the parameters that were set in the mission.
        read: the names in the source of those that nodes read.
    """
    unread = {one.parameter for one in found if one.state is None and one.bad.value is not None}
    if not unread or len(unread) > _MISSPELT:
        return list(found)
    names = sorted({name for name in read if DYNAMIC not in name})

    def alike(parameter: str) -> tuple[str, ...]:
        folder = parameter.rpartition("/")[0]
        beside = {_end(name) for name in values if name.rpartition("/")[0] == folder}
        return tuple(closest(parameter, [name for name in names if _end(name) not in beside]))

    return [
        replace(one, alike=alike(one.parameter)) if one.parameter in unread else one
        for one in found
    ]


def _end(name: str) -> str:
    return name.rpartition("/")[2].lstrip("~")
