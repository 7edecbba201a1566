"""The suspects that the log cannot tell apart by when they turned."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from pytpc.base.columns import Floats
from pytpc.diagnosis.ranking.mark_evidence import Marked, marked
from pytpc.diagnosis.ranking.result_streams import ResultStreams
from pytpc.diagnosis.results.suspects import WORTH, Accused, Suspected
from pytpc.diagnosis.results.turn_groups import SuspectGroup, TurnGroup
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.turn_groups import part_of, width_of
from pytpc.recording.marks import Mark

RECENT_S = 60.0
"""A turn that is so long before a mark, or before the begin that its observer tells, is not why a
comparison is suspected: nobody takes so long to see what it did, nor waits so long."""

MOST_MARKS = 0.5
"""Two suspects must have turned as one before this share of the observers' first marks."""

_Turned = Mapping[tuple[str, str], Floats]


def suspect_groups(
    suspects: Sequence[Suspected],
    groups: Iterable[TurnGroup],
    streams: ResultStreams,
    tpcs: Tpcs,
    marks: Sequence[Mark],
) -> tuple[SuspectGroup, ...]:
    """The groups of suspects whose deciding comparisons turn as one, the likeliest first.

    They must have done so before the marks, too: one that turned shortly before them and one that
    did not are told apart, however often they turned together in the rest of the log. So are those
    that last turned long before, like all that only turned while the robot was started.

    Args:
        suspects: the likeliest first.
        groups: of the comparisons in the log.
        streams: of the log.
        tpcs: the comparisons.
        marks: at least one.
    """
    observed = marked(marks, streams)
    turned = {(tpcs.keys[one.code], one.node): one.changes for one in streams.streams}
    found = []
    for group in groups:
        after = {(one.key, one.node): one.after_s for one in group.members}
        likely = [
            one
            for one in suspects
            if isinstance(one, Accused) and one.probability >= WORTH and _decider(one) in after
        ]
        if len(likely) < 2:
            continue
        first = _decider(likely[0])
        members = [
            one
            for one in likely
            if one is likely[0]
            or _met(
                (turned[first], turned[_decider(one)]),
                after[_decider(one)] - after[first],
                observed,
            )
        ]
        if len(members) > 1:
            total = sum(one.probability for one in members)
            names = tuple(one.parameter for one in members)
            turning = part_of(group, {_decider(one) for one in members})
            found.append(SuspectGroup(names, total, turning))
    return tuple(sorted(found, key=lambda one: -one.probability))


def _decider(one: Accused) -> tuple[str, str]:
    return one.key, one.last.node


def _met(both: tuple[Floats, Floats], distance: float, observed: Marked) -> bool:
    """Whether the last turns before most first marks are one, and not long before.

    Args:
        both: the turns of two comparisons, each at least one.
        distance: how long the second usually turns after the first, in s.
        observed: the marks.
    """
    marks, told = observed.firsts, observed.begins[:, 0]
    since = np.minimum(marks, np.where(np.isnan(told), marks, told)) - RECENT_S
    last = []
    for times in both:
        place = np.searchsorted(times, marks, side="right") - 1
        last.append(np.where(place >= 0, times[np.maximum(place, 0)], -np.inf))
    known = (last[0] >= since) & (last[1] >= since)
    one, other = (np.where(known, times, 0.0) for times in last)
    met = known & (np.abs(other - one - distance) <= 2.0 * width_of(distance))
    return bool(met.mean() >= MOST_MARKS)
