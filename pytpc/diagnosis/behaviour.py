"""How each comparison behaves over a mission and over missions: margins, near misses, drift.

All of it is about one comparison in one node. Shares and quantiles are of time: each evaluation
counts for as long as it was the last word (`ResultStream.weight`). Summaries are taken as
`with_summarised` does: their extremes are exact, how long a value was at which distance is not.

Near is a margin of up to ``NEAR`` of the range of all values and thresholds. A near miss is a time
in which it is near and that begins and ends on the same side; it ends when the margin is above
twice that, so that noise counts once. The drift is the trend of the median margin of ``PARTS``
equal parts of the time.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np

from pytpc.base.columns import Bools, Floats
from pytpc.diagnosis.ranking.result_streams import ResultStream, ResultStreams
from pytpc.diagnosis.ranking.summarised import with_summarised
from pytpc.diagnosis.results.behaviour import NEAR, Behaviour, Distribution, Drift, OverMissions
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.scores.summary_scores import covered
from pytpc.diagnosis.thresholds.margins import slope_of
from pytpc.diagnosis.thresholds.units import is_text
from pytpc.diagnosis.trend import trend_of
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import base_key
from pytpc.static.static_info import StaticInfo

PARTS = 10
"""The drift is that of the medians of so many parts of the time."""

FEWEST, SHORTEST_S = 30, 30.0
"""What was evaluated less often, or for a shorter time, has no drift: all that moves would."""

_QUANTILES = (0.05, 0.5, 0.95)


def behaviours(recording: Recording, static_info: StaticInfo) -> tuple[Behaviour, ...]:
    """What each comparison did in each node, by parameter, key and node.

    Args:
        recording: the mission; marks are not needed.
        static_info: what the analysis found, with the names of this mission.
    """
    tpcs = Tpcs.of(static_info)
    streams = ResultStreams.of(with_summarised(recording), tpcs)
    found = [_behaviour(one, tpcs, static_info, recording) for one in streams.streams]
    return tuple(sorted(found, key=_order))


def by_nearest(one: Behaviour) -> tuple[float, str]:
    """To sort by: those that came nearest to turning first, those without margins last."""
    return (math.inf if one.nearest is None else one.nearest, one.parameter)


def over_missions(missions: Sequence[Sequence[Behaviour]]) -> tuple[OverMissions, ...]:
    """The comparisons of several missions, in their order.

    A comparison is the same in all of them if its key, its node and the parameter's name are. The
    number of an instance does not count: only of several with one name, the first is the first.
    """
    places: dict[tuple[str, str, str, int], list[Behaviour | None]] = {}
    for number, mission in enumerate(missions):
        alike: Counter[tuple[str, str, str]] = Counter()
        for one in mission:
            same = base_key(one.key), one.node, one.parameter
            row = places.setdefault((*same, alike[same]), [])
            alike[same] += 1
            row += [None] * (number + 1 - len(row))
            row[number] = one
    count = len(missions)
    made = [_over((*row, *[None] * (count - len(row)))) for row in places.values()]
    return tuple(sorted(made, key=lambda one: (one.parameter, one.key, one.node)))


def _over(row: tuple[Behaviour | None, ...]) -> OverMissions:
    seen = [(place, one) for place, one in enumerate(row) if one is not None]
    known = [(place, one.margins.median) for place, one in seen if one.margins is not None]
    places, medians = np.array(known, np.float64).reshape(-1, 2).T
    found = trend_of(places, medians)
    step = found.slope if found is not None and found.is_clear else None
    last = seen[-1][1]
    zero_in = float(-medians[-1] / step) if step is not None and step < 0 else None
    return OverMissions(last.key, last.node, last.parameter, last.comparison, row, step, zero_in)


def _order(one: Behaviour) -> tuple[str, str, str]:
    return one.parameter, one.key, one.node


def _counted(recording: Recording, key: str, node: str) -> tuple[int, int]:
    """How many evaluations there were of a comparison in a node, and how many turns.

    Summaries count the evaluations that are in the events as well, and turns beyond a cap.
    """
    events, summaries = recording.events, recording.summaries
    rows, own = events.rows_in(key, node), summaries.rows_in(key, node)
    turned = int(events.flop[rows].sum())
    if not own.size:
        return rows.size, turned
    alone = rows[~covered(events, rows, summaries, own)]
    in_both = int(summaries.flops[own].sum()) + int(events.flop[alone].sum())
    return int(summaries.count[own].sum()) + alone.size, max(turned, in_both)


def _behaviour(
    stream: ResultStream, tpcs: Tpcs, static_info: StaticInfo, recording: Recording
) -> Behaviour:
    key = tpcs.keys[stream.code]
    evaluations, turns = _counted(recording, key, stream.node)
    comparison = static_info.comparisons[key]
    seconds = float(stream.weight.sum())
    slope = slope_of(comparison)
    scale = 1.0 if slope is None else abs(slope)
    measured = _measured(stream, comparison, static_info)
    margin = stream.margin / scale
    reach = stream.spread / scale
    near = margin <= NEAR * reach
    return Behaviour(
        key=key,
        node=stream.node,
        parameter=tpcs.parameters[stream.code],
        comparison=comparison,
        evaluations=evaluations,
        seconds=seconds,
        margins=_distribution(margin, stream.weight) if measured else None,
        unit="value" if slope is None else "parameter",
        reach=reach,
        true_share=_share(stream.res, stream.weight),
        turns=turns,
        near_misses=_near_misses(margin, stream.res, NEAR * reach) if measured else 0,
        undecided=_share(near, stream.weight) if measured else None,
        drift=_drift(stream, margin) if measured else None,
    )


def _measured(stream: ResultStream, comparison: Comparison, static_info: StaticInfo) -> bool:
    """Whether the values say how near it was: not of flags, text, and what has one value only."""
    if comparison.relation == "flag" or stream.spread <= 0 or np.isnan(stream.margin).all():
        return False
    return not is_text(comparison, static_info.unit_of(base_key(comparison.key)))


def _share(which: Bools, weight: Floats) -> float:
    """The share of the time; of the evaluations if all were at one time."""
    total = float(weight.sum())
    if total <= 0:
        return float(which.mean())
    return float(weight[which].sum()) / total


def _distribution(margin: Floats, weight: Floats) -> Distribution:
    known = np.isfinite(margin)
    margin, weight = margin[known], weight[known]
    order = np.argsort(margin, kind="stable")
    below = np.cumsum(weight[order])
    if below[-1] <= 0:
        below = np.arange(1, margin.size + 1, dtype=np.float64)
    places = np.searchsorted(below, np.array(_QUANTILES) * below[-1], side="left")
    low, median, high = margin[order][places].tolist()
    return Distribution(float(margin[order][0]), low, median, high)


def _near_misses(margin: Floats, res: Bools, near: float) -> int:
    """How often the margin was near without a turn; see the module's docstring."""
    found, inside, turned = 0, False, False
    # Between two evaluations that a turn lies between, nothing was missed.
    changes = np.diff(res, prepend=res[0])
    for value, change in zip(margin.tolist(), changes.tolist(), strict=True):
        if change and inside:
            turned = True
        if not inside and value <= near:
            inside, turned = True, bool(change)
        elif inside and not value <= 2 * near:
            found += not turned
            inside = False
    return found + (inside and not turned)


def _drift(stream: ResultStream, margin: Floats) -> Drift | None:
    known = np.isfinite(margin)
    # Pauses do not count: what happened in them is not known.
    clock = np.cumsum(stream.weight) - stream.weight
    clock, margin = clock[known], margin[known]
    if clock.size < FEWEST or clock[-1] < SHORTEST_S:
        return None
    parts = np.minimum((PARTS * clock / clock[-1]).astype(np.int64), PARTS - 1)
    begins = np.flatnonzero(np.diff(parts, prepend=-1))
    ends = np.append(begins[1:], parts.size)
    # The upper and lower middle of each part; the clock rises already.
    middles = np.array([(begins + ends - 1) // 2, (begins + ends) // 2])
    medians = margin[np.lexsort((margin, parts))][middles].mean(axis=0)
    found = trend_of(clock[middles].mean(axis=0), medians)
    if found is None or not found.is_clear:
        return None
    left = float(medians[-1]) / -found.slope if found.slope < 0 else None
    return Drift(60.0 * found.slope, left)
