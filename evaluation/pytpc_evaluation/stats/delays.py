"""Table 6.14: how long after the beginning of an error each user set the first mark.

The beginning of the error is taken from the evaluations of the changed parameter's TPCs in the
node whose parameter it is. Type I (the robot did what it should not): the first flop. Type II (it
does not do what it should): the first time that one should have flopped and did not, which is the
first evaluation that with the old value would have had another outcome than the evaluation before
(or would have been the first), and another than it had.

Where the policy ``edges`` kept summaries, a type II begins with the summary within which it began:
at most one period early.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pytpc.base.columns import Int64s
from pytpc.diagnosis.full_names import with_full_names
from pytpc.diagnosis.thresholds.threshold_sets import outcomes
from pytpc.recording.events import Bools, Events, Floats
from pytpc.recording.faults import CLOCKS_APART_NS
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries
from pytpc.static.arithmetic import evaluate
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import parameter_name, same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.stats.missions import StudyMission, Trial, user_of
from pytpc_evaluation.tables import Cell, Column, Table, statistics
from pytpc_evaluation.treatment import Treatment


@dataclass(frozen=True, slots=True)
class DelaysOfTrial:
    """One trial: when the error began, in seconds of the mission, and the delay of each user.

    ``start`` is None where it never began; a user who did not mark after it has no delay.
    """

    label: str
    start: float | None
    delays: Mapping[str, float]


def delays_of(trial: Trial, static_info: StaticInfo) -> DelaysOfTrial | None:
    """The delays of a trial; None where its treatment changed no parameter."""
    mission = trial.mission
    if mission.treatment is None or mission.treatment.mark_type is None:
        return None
    start_ns = error_start(mission, static_info)
    if start_ns is None:
        return DelaysOfTrial(trial.label, None, {})
    delays: dict[str, float] = {}
    for mark in sorted(mission.recording.marks, key=lambda mark: mark.time_ns):
        # What is more than a day later was set on another clock.
        if start_ns <= mark.time_ns <= start_ns + CLOCKS_APART_NS:
            delays.setdefault(user_of(mark), (mark.time_ns - start_ns) / 1e9)
    start = (start_ns - mission.recording.start_ns) / 1e9
    return DelaysOfTrial(trial.label, start, delays)


def delays_table(trials: Sequence[DelaysOfTrial], users: Sequence[str]) -> Table:
    """Table 6.14: a column for each user, and the mean of those who marked."""
    columns = [Column("Error began", 2, name="error began at s")]
    columns += [Column(user, 2, name=f"{user} delay s") for user in users]
    columns.append(Column("Mean", 2, name="mean delay s"))
    rows: list[tuple[str, tuple[Cell, ...]]] = []
    for trial in trials:
        own = [trial.delays.get(user) for user in users]
        rows.append((trial.label, (trial.start, *own, statistics(own)["mean"])))
    return Table(
        "delays",
        "Delays from error to the first mark by the users, in seconds",
        tuple(columns),
        tuple(rows),
        (),
        first="Trial",
    )


def error_start(mission: StudyMission, static_info: StaticInfo) -> int | None:
    """When the error of a treated mission began, in nanoseconds; None where it did not."""
    treatment = mission.treatment
    if treatment is None or treatment.parameter is None:
        return None
    named = with_full_names(static_info, mission.recording, {})
    found = {
        key: comparison
        for key, comparison in named.thresholds.items()
        if same_parameter(treatment.parameter, parameter_name(comparison))
    }
    events = _of_node(mission.recording, treatment, sorted(found))
    if treatment.mark_type == "I":
        flops = events.time_ns[events.flop]
        return int(flops[0]) if flops.size else None
    starts = []
    for code, key in enumerate(events.keys):
        other = threshold_for(found[key], treatment.old)
        rows = events.by_key.rows(code)
        summaries = _summaries_of(mission.recording.summaries, key, treatment)
        if len(summaries):
            starts.append(_first_kept(summaries, found[key], other))
        elif rows.size:
            starts.append(_first_missed(events, rows, found[key], other))
    known = [start for start in starts if start is not None]
    return min(known) if known else None


def threshold_for(comparison: Comparison, value: float | None) -> float | None:
    """The threshold that a value of the parameter gives; None where that is not known."""
    how = comparison.transform
    if value is None or how is None:
        return value
    if how.tree is not None:
        return evaluate(how.tree, value)
    if how.scale is None or how.offset is None:
        return None
    return how.scale * value + how.offset


def _first_missed(
    events: Events, rows: Int64s, comparison: Comparison, other: float | None
) -> int | None:
    """The first evaluation of a key that should have flopped and did not."""
    if other is None:
        return None
    cmp, thresh, node = events.cmp[rows], events.thresh[rows], events.node[rows]
    had = _outcomes(comparison, cmp, thresh)
    would = _outcomes(comparison, cmp, np.full(cmp.shape, other))
    flopped = np.ones(rows.size, np.bool_)
    for code in np.unique(node):
        own = np.flatnonzero(node == code)
        flopped[own[1:]] = would[own[1:]] != would[own[:-1]]
    missed = np.flatnonzero(flopped & (would != had))
    return int(events.time_ns[rows[missed[0]]]) if missed.size else None


def _first_kept(summaries: Summaries, comparison: Comparison, other: float | None) -> int | None:
    """The begin of the first summary within which one should have flopped and did not.

    Of a summary the extremes and the last of the compared values are known, so that it is known
    which outcomes there would have been, and which was the last.
    """
    if other is None:
        return None
    old = np.full(len(summaries), other)
    one = _outcomes(comparison, summaries.thresh + summaries.diff_min, old)
    two = _outcomes(comparison, summaries.thresh + summaries.diff_max, old)
    last = _outcomes(comparison, summaries.cmp, old)
    had = _outcomes(comparison, summaries.cmp, summaries.thresh)
    other_way = (one != had) | (two != had) | (last != had)
    same_way = (one == had) | (two == had) | (last == had)
    before: dict[int, bool] = {}
    for row in range(len(summaries)):
        node = int(summaries.node[row])
        came_from = before.get(node)
        before[node] = bool(last[row])
        if not other_way[row]:
            continue
        turned = came_from is None or came_from == had[row]
        if turned or (same_way[row] and last[row] != had[row]):
            return int(min(summaries.begin_ns[row], summaries.end_ns[row]))
    return None


def _outcomes(comparison: Comparison, cmp: Floats, thresh: Floats) -> Bools:
    if comparison.relation == "flag":
        return np.asarray(thresh != 0, dtype=np.bool_)
    return outcomes(comparison.relation, cmp, thresh)


def _of_node(recording: Recording, treatment: Treatment, keys: Sequence[str]) -> Events:
    """The evaluations of ``keys``; those in the parameter's node, if it has any."""
    events = recording.events.with_keys(keys)
    if treatment.node in events.nodes:
        own = events.node == events.nodes.index(treatment.node)
        if own.any():
            return events.take(own)
    return events


def _summaries_of(summaries: Summaries, key: str, treatment: Treatment) -> Summaries:
    code = summaries.keys.index(key) if key in summaries.keys else -1
    own = summaries.key == code
    if treatment.node in summaries.nodes:
        here = own & (summaries.node == summaries.nodes.index(treatment.node))
        own = here if here.any() else own
    return summaries.take(own)
