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
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from pytpc.base.columns import Bools, Floats
from pytpc.diagnosis.ranking.mark_evidence import SHARE, Marked, Wait, any_time, caused, marked
from pytpc.diagnosis.ranking.posterior import Posterior, diagnose_log, softmax, type_odds
from pytpc.diagnosis.ranking.result_streams import ResultStream, ResultStreams
from pytpc.diagnosis.ranking.summarised import with_summarised
from pytpc.diagnosis.results.differences import RunDifferences
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.thresholds.inverse import kept_as
from pytpc.diagnosis.thresholds.threshold_sets import outcomes
from pytpc.diagnosis.thresholds.units import NoUnitError, is_text, read_type, tree_of
from pytpc.recording.events import Events
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.static.arithmetic import evaluate
from pytpc.static.parameters import ByParameter
from pytpc.static.static_info import StaticInfo

MOMENT_S = 2.0
"""A turn of this length weighs half of one that lasts."""

LEAST = 0.001
"""The least weight of a turn."""

SLOPE_S = 2.0
"""How long a value's slope is measured, to extrapolate it."""

ACQUITTED = -4.0
"""The log odds of a parameter whose other value would have turned nothing before the marks."""

UNCHANGED = -12.0
"""The log odds of a parameter that kept the value with which the robot went right. Not less, as the
record may be wrong, and the robot may be at another place. The size of a change does not count:
what is a large change differs from one parameter to the next."""

ALONE = 0.2
"""Weight of the log alone beside the replay, which uses the same marks."""

REPLAYED = 1.0
"""Weight of the replay. Both weights, and ``NOBODY``, maximise the likelihood of the true cause on
the tuning half of the study, whose missions have eight large harmless changes each."""

NOBODY = -0.4
"""The score of "none of them" if it is known what differs. The likeliest value is lower; with -0.4
no clean mission and no fault in the code of the tuning half is blamed on a parameter."""

FAULTS = 2 / 3
"""The share of faults in the code among the missions of the tuning half in which no parameter is to
blame: six of nine."""

HIDDEN = 0.2
"""The share of faults that a good run of the same code does not show, as other input or another
order of events brings them about. Of the faults of three open-source systems 72 to 87 % did not
depend on anything around the program (Chandra and Chen, Whither generic recovery from application
faults?, DSN 2000)."""

CANDIDATES = 6
"""How many parameters could be the cause in a mission of the study, with which ``NOBODY`` was
chosen: 2 to 6 that differ turn decisions shortly before the marks, and 2 to 5 that differ are
reported by no comparison. (Six is the mean of seven missions of one robot.)"""


def nobody(differences: RunDifferences | None) -> float:
    """The score of "none of them", by what is known to be as it was in a good run.

    - With the code of the good run, most faults in the code would have shown there.
    - If the values of all parameters are known as well, the cause is one that differs, or something
      around the robot. One of them is to blame, so the fewer could be, the likelier is each. Those
      could be with which decisions shortly before the marks would have come out otherwise.

    Args:
        differences: what differs from good runs; None if there is none.
    """
    if differences is None or differences.code is None or not differences.code.is_same:
        return NOBODY
    score = NOBODY + math.log(1.0 - FAULTS * (1.0 - HIDDEN))
    candidates = sum(one.turned_near > 0 for one in differences.found)
    if not candidates or not differences.is_complete or differences.unreported:
        return score
    return score + min(0.0, math.log(candidates / CANDIDATES))


def diagnose_beside(
    recording: Recording,
    static_info: StaticInfo,
    *,
    references: Sequence[Recording] = (),
    changes: Sequence[Change] = (),
    differences: RunDifferences | None = None,
) -> Posterior:
    """Judge all parameters by all marks, and by what the other values would have changed.

    Args:
        recording: the mission with its marks, of any types or none.
        static_info: what the analysis found.
        references: good runs, the last one last; their thresholds count.
        changes: what was changed since the robot worked, newest last; empty if not known. Their
            order does not count, but the oldest change of a parameter has the value that worked.
            With references, too, a parameter is unlikely if either says that it did not change; if
            the references say nothing of it, the changes count. Old values come from the changes
            first.
        differences: what differs from the references, for ``nobody``.
    """
    tpcs = Tpcs.of(static_info)
    priors, others = [], {}
    if references:
        here, good = with_summarised(recording), [with_summarised(run) for run in references]
        priors.append(of_references(tpcs, here, good))
        for there in good:
            others.update(of_good_run(tpcs, here, there))
    if changes:
        priors.append(of_changes(tpcs.names, changes))
        # The last value for a parameter counts.
        oldest_last = [(one.parameter, one.old) for one in reversed(changes)]
        others.update(before_changes(static_info, oldest_last))
    if not priors:
        return diagnose_log(recording, static_info)
    prior = np.fmin.reduce(priors)
    prior[np.isnan(prior)] = UNCHANGED / 2
    return diagnose_replayed(recording, static_info, prior, others, nobody(differences))


def diagnose_replayed(
    recording: Recording,
    static_info: StaticInfo,
    prior: Floats,
    others: Mapping[str, float],
    none_score: float = NOBODY,
) -> Posterior:
    """The diagnosis of `pytpc.diagnosis.ranking.posterior` with what the replay says.

    Args:
        recording: the mission with its marks.
        static_info: what the analysis found.
        prior: float64[p], see `pytpc.diagnosis.ranking.other_values`.
        others: the other thresholds that are known, by the key of the comparison.
        none_score: that of "none of them".
    """
    alone = diagnose_log(recording, static_info)
    if not np.isfinite(alone.scores).any():
        return alone
    found = replayed(recording, static_info, others)
    charges = np.array([found.get(name, 0.0) for name in alone.names])
    scores = ALONE * alone.scores + REPLAYED * charges + prior
    posterior, none = softmax(scores, none_score)
    return replace(alone, scores=scores, posterior=posterior, none=none)


def before_changes(
    static_info: StaticInfo, changes: Iterable[tuple[str, float]]
) -> dict[str, float]:
    """The threshold that each comparison, by its key, has with the old values of (parameter, old).

    Comparisons of text, and those with an unknown way from parameter to threshold, are left out.
    """
    found = {}
    named = [(key, one) for key, one in static_info.thresholds.items() if one.source is not None]
    every = ByParameter(named, lambda item: item[1].source or "")
    for parameter, old in changes:
        for key, comparison in every.meant(parameter):
            unit = static_info.unit_of(key)
            if is_text(comparison, unit):
                continue
            try:
                tree = kept_as(tree_of(comparison), read_type(comparison, unit))
            except NoUnitError:
                continue
            threshold = evaluate(tree, old)
            if not math.isnan(threshold):
                found[key] = threshold
    return found


def of_good_run(tpcs: Tpcs, events: Events, reference: Events) -> dict[str, float]:
    """The thresholds in a good run that differ, by the key of the comparison."""
    here, there = thresholds_of(events, tpcs), thresholds_of(reference, tpcs)
    differs = (here != there) & ~np.isnan(here) & ~np.isnan(there)
    return {tpcs.keys[code]: float(there[code]) for code in np.flatnonzero(differs)}


def replayed(
    recording: Recording, static_info: StaticInfo, others: Mapping[str, float]
) -> dict[str, float]:
    """What speaks against the parameters whose comparisons are replayed, in log odds.

    Args:
        recording: with its marks, at least one.
        static_info: what the analysis found.
        others: the other threshold of each comparison to replay.

    Returns:
        By the parameter's name; the worst of its comparisons counts.
    """
    tpcs = Tpcs.of(static_info)
    streams = ResultStreams.of(with_summarised(recording), tpcs)
    times = np.array([mark.time_ns for mark in recording.marks], np.int64)
    marks = marked(times, tuple(mark.observer for mark in recording.marks), streams)
    odds = type_odds(recording.marks)
    wait = Wait.before(marks, streams.seconds)
    found: dict[str, float] = {}
    for stream in streams.streams:
        key, name = tpcs.keys[stream.code], tpcs.names[stream.column]
        if key not in others:
            continue
        other = others[key]
        turned = is_other(static_info.thresholds[key].relation, stream, other)
        charge = ACQUITTED
        if np.any(turned & (stream.times <= marks.times.max())):
            charge = max(charge, _charge(stream, turned, other, (marks, wait), odds))
        found[name] = max(charge, found.get(name, ACQUITTED))
    return found


def is_other(relation: str, stream: ResultStream, other: float) -> Bools:
    """bool[n]: whether the outcome would differ with the other threshold."""
    if relation == "flag":
        return np.asarray((stream.thresh != 0) != (other != 0))
    now = outcomes(relation, stream.cmp, stream.thresh)
    return np.asarray(now != outcomes(relation, stream.cmp, other))


def _charge(
    stream: ResultStream, turned: Bools, other: float, evidence: tuple[Marked, Wait], odds: float
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


def turns(stream: ResultStream, turned: Bools, other: float) -> tuple[Floats, Floats]:
    """The spans in which the outcome would differ.

    Args:
        stream: n evaluations.
        turned: bool[n].
        other: the other threshold.

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
        stream.times[end] + _until_alike(stream, end, other) if last[end] else stream.times[end + 1]
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


def of_changes(names: Sequence[str], changes: Iterable[Change]) -> Floats:
    """float64[p], the log odds of each name, by which of them were changed."""
    prior = np.full(len(names), UNCHANGED)
    columns = ByParameter(range(len(names)), lambda column: names[column])
    for change in changes:
        for column in columns.meant(change.parameter):
            prior[column] = max(prior[column], of_change(change.old, change.new))
    return prior


def of_references(tpcs: Tpcs, events: Events, references: Sequence[Events]) -> Floats:
    """float64[p], the log odds of each parameter, by the thresholds of good runs.

    A parameter kept its value if one of the runs had it. Nothing is known of one that changed
    during a run, or was not compared in the mission and in a good run: nan. Without other knowledge
    it gets half of ``UNCHANGED``.
    """
    here = thresholds_of(events, tpcs)
    prior: dict[str, float] = {}
    there = [thresholds_of(one, tpcs) for one in references]
    for code, name in enumerate(tpcs.parameters):
        known = [float(one[code]) for one in there if not np.isnan(one[code])]
        if np.isnan(here[code]) or not known:
            continue
        kept = min(of_change(then, float(here[code])) for then in known)
        prior[name] = max(prior.get(name, UNCHANGED), kept)
    return np.array([prior.get(name, np.nan) for name in tpcs.names])


def of_change(old: float, new: float) -> float:
    """The log odds of a parameter that was ``old`` and is ``new``."""
    return UNCHANGED if old == new else 0.0


def thresholds_of(events: Events, tpcs: Tpcs) -> Floats:
    """float64[n]: the threshold of each comparison; nan if it had none or several."""
    own = events.with_keys(tpcs.keys)
    found = np.full(len(tpcs.keys), np.nan)
    for code in range(len(tpcs.keys)):
        values = own.thresh[own.by_key.rows(code)]
        if values.size and np.isfinite(values[0]) and bool(np.all(values == values[0])):
            found[code] = values[0]
    return found
