"""Which comparisons are nearest to turning, and which have not turned for long.

This ranks comparisons, not suspects: it says what the robot decides now. The margin is that of
the score of type II (D in docs/reference/scores.md), of the last evaluation alone.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Hashable, Mapping, Sequence
from typing import TypeVar

from pytpc.diagnosis.question import WINDOW_S
from pytpc.diagnosis.ranking.watching import Watching
from pytpc.diagnosis.results.turning import Compared, NearRow, TurningLook
from pytpc.diagnosis.thresholds.units import NoUnitError, is_text, unit_of
from pytpc.static.link_unit import Comparison, LinkUnit
from pytpc.static.static_info import StaticInfo

RECENT_S = 20.0
"""A comparison that was reported within this time is shown: one about which nothing is new may send
no summary for 16 s (docs/reference/runtime.md#light)."""

_Key = TypeVar("_Key", bound=Hashable)
_NEARER = 0.8
_NEARER_BY = 0.001
"""A row moves up only past one that is so much farther, so that rows do not jump."""

_ORDERED = 4
"""So many times as many rows are ordered as are shown."""


_Place = tuple[str, str]
"""A comparison in a node: its key, and the node."""


class Turning:
    """Follows the comparisons of a mission.

    Args:
        window_s: a result is held if it has been the same for so long, in seconds.
    """

    def __init__(self, window_s: float = WINDOW_S) -> None:
        """Nothing is known."""
        self._window_ns = round(window_s * 1e9)
        self._near: list[_Place] = []
        self._held: list[_Place] = []
        self._margins: dict[_Place, tuple[float, float, tuple[float, bool]]] = {}

    def look(self, watching: Watching, now_ns: int, most: int) -> TurningLook:
        """The first ``most`` of each list at an instant."""
        static = watching.static_info
        compared = watching.compared(now_ns, RECENT_S)
        found = {(one.last.key, one.last.node): one for one in compared}
        shares = {place: share_of(one, static.unit_of(place[0])) for place, one in found.items()}
        near = {key: share for key, share in shares.items() if share is not None}
        self._near = steady_order(self._near, _lowest(near, most))
        # What has no margin is last: the nearest to its exposing statement first.
        held = {
            key: 1.0 + one.comparison.distance
            if shares[key] is None
            else min(1.0, shares[key] or 0)
            for key, one in found.items()
            if now_ns - one.since_ns >= self._window_ns
        }
        self._held = steady_order(self._held, _lowest(held, most))

        def rows(keys: Sequence[_Place]) -> list[NearRow]:
            return [self._row(found[key], shares[key], static) for key in keys[:most]]

        turns = tuple(watching.turns)[::-1][:most]
        return TurningLook(rows(self._near), rows(self._held), turns)

    def _row(self, one: Compared, share: float | None, static: StaticInfo) -> NearRow:
        if share is None:
            return NearRow(one, None, None, False)
        cmp, thresh = one.last.cmp, one.last.thresh
        place = one.last.key, one.last.node
        kept = self._margins.get(place)
        if kept is None or kept[:2] != (cmp, thresh):
            margin = margin_of(one.comparison, static.unit_of(one.last.key), cmp, thresh)
            kept = self._margins[place] = (cmp, thresh, margin)
        return NearRow(one, share, *kept[2])


def _lowest(values: Mapping[_Place, float], most: int) -> dict[_Place, float]:
    """Those that may be among the first ``most`` rows: to order thousands takes too long."""
    if len(values) <= _ORDERED * most:
        return dict(values)
    found = heapq.nsmallest(_ORDERED * most, values, key=lambda place: (values[place], place))
    return {place: values[place] for place in found}


def share_of(one: Compared, unit: LinkUnit) -> float | None:
    """The margin of the last evaluation over the range so far; None where there is none."""
    if one.comparison.type == "flag" or is_text(one.comparison, unit):
        return None
    margin = abs(one.last.cmp - one.last.thresh)
    return margin / one.spread if math.isfinite(margin) and one.spread > 0 else None


def margin_of(
    comparison: Comparison, unit: LinkUnit, cmp: float, thresh: float
) -> tuple[float, bool]:
    """By how much the parameter would have to change, and whether that is in its own unit.

    If the arithmetic is not known, it is the distance of the compared values.
    """
    plain = abs(cmp - thresh)
    if comparison.transform is None:
        return plain, True
    try:
        now = unit_of(comparison, unit, thresh).current
        then = unit_of(comparison, unit, cmp).current
    except NoUnitError:
        return plain, False
    if now is None or then is None or not math.isfinite(then - now):
        return plain, False
    return abs(then - now), True


def steady_order(before: Sequence[_Key], values: Mapping[_Key, float]) -> list[_Key]:
    """The keys by ascending values, but as before where the values hardly differ.

    A key is put before the first one that is clearly larger. So no key stands behind one that is
    clearly larger, and two that are nearly equal keep their order.

    >>> steady_order(["a", "b"], {"a": 0.50, "b": 0.45, "c": 0.1})
    ['c', 'a', 'b']
    """
    known = [key for key in before if key in values]
    here = set(known)
    unknown = (key for key in values if key not in here)
    new = sorted(unknown, key=lambda key: (values[key], str(key)))
    order: list[_Key] = []
    for key in [*known, *new]:
        limit = values[key]
        place = next(
            (n for n, one in enumerate(order) if limit < values[one] * _NEARER - _NEARER_BY),
            len(order),
        )
        order.insert(place, key)
    return order
