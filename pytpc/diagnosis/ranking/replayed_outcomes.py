"""What the robot would have decided with values from before a change, or from a good run.

An engineer who knows which parameters have changed asks: with which of the old values would the
robot have decided otherwise before the marks, when, and for how long? The logged comparisons of a
parameter are evaluated again with its other threshold. A turn is a span in which the outcome
differs; it ends where the outcome is the same again. If the comparison is left alone before that,
its value is extrapolated as it last rose or fell. So a decision that comes a moment sooner or later
weighs little, however much the value was changed. For each comparison

    acted  = log( sum of u fit / (sum of u + c) ) - log( mean of fit )
    u      = d^2 / (d^2 + MOMENT_S^2), LEAST at least
    waited = log( (turned in the wait + s)^2 / (turned elsewhere + s) )

with the duration d of each turn, and shares of the time; ``fit`` and the wait are those of
`pytpc.diagnosis.ranking.mark_evidence`. Type I uses ``acted`` of the turns that begin before the
last of the observers' first marks. Type II uses ``waited`` or, with half the weight each,
``acted``: a change that cannot be undone. Both are weighted by the odds of the types. A parameter
whose other value turns nothing before the marks is acquitted.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

import numpy as np

from pytpc.base.columns import Bools, Floats
from pytpc.diagnosis.ranking.known_good import Other, other_thresholds
from pytpc.diagnosis.ranking.mark_evidence import SHARE, Marked, Wait, any_time, caused, marked
from pytpc.diagnosis.ranking.posterior import type_odds
from pytpc.diagnosis.ranking.result_streams import ResultStream, ResultStreams
from pytpc.diagnosis.ranking.summarised import with_summarised
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.thresholds.threshold_sets import outcomes
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

MOMENT_S = 2.0
"""A turn of this length weighs half of one that lasts."""

LEAST = 0.001
"""The least weight of a turn."""

SLOPE_S = 2.0
"""How long a value's slope is measured, to extrapolate it."""

ACQUITTED = -5.0
"""The charge of a comparison whose other threshold would have turned nothing before the marks, and
the least of all. Not less: a parameter may act as a number beside its comparisons, as a padding
does that is compared with its own old value only. Between -3 and -8 nothing changes in the study,
whose parameters act in comparisons."""


UNKNOWN_CHARGE = -1.7
"""That of a comparison whose other threshold is not known. In the study's tuning half, 939
parameters that differ from two good runs and are not to blame have, in the mean, as much evidence
against them as this charge is."""


def replayed(
    recording: Recording,
    static_info: StaticInfo,
    others: Mapping[str, Other],
    same: Collection[str] = (),
) -> dict[str, float]:
    """What speaks against the parameters whose comparisons are replayed, in log odds.

    Args:
        recording: with its marks, at least one.
        static_info: what the analysis found.
        others: the other threshold of each comparison to replay.
        same: comparisons that are known to have had the same threshold.

    Returns:
        By the parameter's name, for those with such a threshold; the worst of the comparisons
        counts.
    """
    tpcs = Tpcs.of(static_info)
    streams = ResultStreams.of(with_summarised(recording), tpcs)
    marks = marked(recording.marks, streams)
    odds = type_odds(recording.marks)
    wait = Wait.before(marks, streams.seconds)
    found: dict[str, float] = {}
    asked = {name for key, name in zip(tpcs.keys, tpcs.parameters, strict=True) if key in others}
    unknown: set[str] = set()
    for stream in streams.streams:
        key, name = tpcs.keys[stream.code], tpcs.names[stream.column]
        if key not in others:
            if key not in same:
                unknown.add(name)
            continue
        other = other_thresholds(stream.thresh, others[key])
        if np.isnan(other).all():
            unknown.add(name)
            continue
        turned = is_other(static_info.thresholds[key].relation, stream, other)
        charge = ACQUITTED
        if np.any(turned & (stream.times <= marks.times.max())):
            charge = max(charge, _charge(stream, turned, other, (marks, wait), odds))
        found[name] = max(charge, found.get(name, ACQUITTED))
    # Another one of its comparisons may have done it.
    for name in unknown & asked:
        found[name] = max(found.get(name, ACQUITTED), UNKNOWN_CHARGE)
    return found


def is_other(relation: str, stream: ResultStream, other: Floats) -> Bools:
    """bool[n]: whether the outcome would differ with the other thresholds, float64[n].

    It would not where these are nan.
    """
    other = np.where(np.isnan(other), stream.thresh, other)
    if relation == "flag":
        return np.asarray((stream.thresh != 0) != (other != 0))
    now = outcomes(relation, stream.cmp, stream.thresh)
    return np.asarray(now != outcomes(relation, stream.cmp, other))


def _charge(
    stream: ResultStream, turned: Bools, other: Floats, evidence: tuple[Marked, Wait], odds: float
) -> float:
    marks, wait = evidence
    begins, lengths = turns(stream, turned, other)
    early = begins <= marks.firsts.max()
    acted = ACQUITTED
    if early.any():
        weights = np.maximum(1.0 - 1.0 / (1.0 + (lengths[early] / MOMENT_S) ** 2), LEAST)
        acted = caused(begins[early], weights, wait.seconds, marks) - any_time(wait.seconds, marks)
    inside = wait.holds(stream.times)
    share = min(1.0, float(stream.weight[turned & inside].sum()) / wait.length)
    rest = max(wait.seconds - wait.length, 1.0)
    elsewhere = min(1.0, float(stream.weight[turned & ~inside].sum()) / rest)
    waited = math.log((share + SHARE) / (elsewhere + SHARE)) + math.log(share + SHARE)
    latched = np.logaddexp(acted, waited) - math.log(2.0)
    return float(np.logaddexp(acted - np.logaddexp(0.0, odds), latched - np.logaddexp(0.0, -odds)))


def turns(stream: ResultStream, turned: Bools, other: Floats) -> tuple[Floats, Floats]:
    """The spans in which the outcome would differ.

    Args:
        stream: n evaluations.
        turned: bool[n].
        other: float64[n], the other thresholds.

    Returns:
        float64[turns] each: when they begin, and their lengths in s; infinite if the value was not
        on its way to the other threshold.
    """
    last = np.zeros(turned.size, np.bool_)
    last[np.searchsorted(stream.times, stream.stops, side="right") - 1] = True
    goes_on = np.concatenate([[False], turned[:-1] & ~last[:-1]])
    begins = np.flatnonzero(turned & ~goes_on)
    ends = np.flatnonzero(turned & (last | ~np.append(turned[1:], False)))
    lengths = [
        stream.times[end] + _until_alike(stream, end, float(other[end]))
        if last[end]
        else stream.times[end + 1]
        for end in ends.tolist()
    ]
    return stream.times[begins], np.array(lengths, np.float64) - stream.times[begins]


def _until_alike(stream: ResultStream, place: int, other: float) -> float:
    """The seconds until the value of an evaluation passes the other threshold, on a straight line.

    The line goes through the evaluations of the last ``SLOPE_S``, without those before the value
    last turned back, as a timer does when it is reset.
    """
    since = int(np.searchsorted(stream.times, stream.times[place] - SLOPE_S))
    way, last = other - float(stream.cmp[place]), float(stream.cmp[place])
    steps = np.diff(stream.cmp[since : place + 1]) * (1.0 if way >= 0.0 else -1.0)
    back = np.flatnonzero(~(steps >= 0.0))
    first = since + (int(back[-1]) + 1 if back.size else 0)
    rise = abs(last - float(stream.cmp[first]))
    if first == place or rise == 0.0:
        return math.inf
    span = float(stream.times[place] - stream.times[first])
    return abs(way) * span / rise + span / (place - first)
