"""The comparisons in inner loops: where a report of every evaluation would cost most."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.static.places import Tpc
from pytpc.static.static_info import StaticInfo


@dataclass(frozen=True, slots=True)
class InLoop:
    """A comparison in ``depth`` loops, at least one."""

    tpc: Tpc
    depth: int


def loop_depth(static: StaticInfo, tpc: Tpc) -> int | None:
    """In how many loops a comparison is, in the unit where it is in most; None if none says."""
    found = (static.comparisons[each.key].loop_depth for each in tpc.keys)
    return max((depth for depth in found if depth is not None), default=None)


def inner_loops(static: StaticInfo) -> tuple[InLoop, ...]:
    """The comparisons with parameters that are in inner loops: the deepest first, then by place."""
    found = [
        InLoop(tpc, depth)
        for tpc in static.tpcs
        if tpc.type != "constant" and (depth := loop_depth(static, tpc))
    ]
    return tuple(sorted(found, key=lambda each: -each.depth))
