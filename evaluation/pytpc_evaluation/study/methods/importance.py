"""Predicate-based statistical debugging (Liblit et al., Scalable Statistical Bug Isolation, 2005).

There a program is run many times, and some runs fail. Here windows of one mission are the runs: the
12 s before a mark failed, and the rest of the mission, cut into windows of the same length, passed.
(Windows of a mission that nobody marked would all pass; it has no ranking.) The predicates of a
comparison are that it was true, that it was false, and that its result changed; each was observed
in a window in which the comparison was evaluated. `pytpc.diagnosis.importance` has the formula.
"""

from __future__ import annotations

import numpy as np

from pytpc.base.columns import Bools, Int64s
from pytpc.diagnosis.importance import importance_of
from pytpc.diagnosis.question import WINDOW_S
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc_evaluation.study.case import Case, Verdict

_DIGITS = 12


def importance(case: Case) -> Verdict:
    """The parameters by the largest Importance of the predicates of their comparisons."""
    tpcs = Tpcs.of(case.static_info)
    recording = case.recording
    begins, ends, failed = windows(
        np.array([mark.time_ns for mark in recording.marks], dtype=np.int64),
        recording.start_ns,
        recording.end_ns,
        round(WINDOW_S * 1e9),
    )
    events = recording.events.with_keys(tpcs.keys)
    best = dict.fromkeys(tpcs.names, 0.0)
    for code, name in enumerate(tpcs.parameters):
        rows = events.by_key.rows(code)
        times = events.time_ns[rows]
        observed = _within(times, begins, ends)
        for held in (events.result[rows], ~events.result[rows], events.flop[rows]):
            value = importance_of(_within(times[held], begins, ends), observed, failed)
            best[name] = max(best[name], value)
    found = {name: round(value, _DIGITS) for name, value in best.items() if value > 0}
    order = sorted(found, key=lambda name: (-found[name], name))
    return Verdict(tuple(order), scores=tuple(found[name] for name in order))


def windows(
    marks_ns: Int64s, start_ns: int, end_ns: int, length_ns: int
) -> tuple[Int64s, Int64s, Bools]:
    """Begins, ends and whether they failed: one before each mark, and the gaps between them cut up.

    What is left of a gap after the last whole window is a window, too, if it has half the length.
    """
    marks = np.unique(marks_ns)
    begins, ends = [marks - length_ns], [marks]
    at = start_ns
    for mark in [*marks.tolist(), end_ns + length_ns]:
        gap_end = min(mark - length_ns, end_ns)
        cuts = np.arange(at, gap_end - length_ns // 2 + 1, length_ns, dtype=np.int64)
        begins.append(cuts)
        ends.append(np.minimum(cuts + length_ns, gap_end) - 1)
        at = max(at, mark + 1)
    failed = np.zeros(sum(part.size for part in begins), np.bool_)
    failed[: marks.size] = True
    return np.concatenate(begins), np.concatenate(ends), failed


def _within(times: Int64s, begins: Int64s, ends: Int64s) -> Bools:
    """bool[windows]: whether one of the sorted times lies in each closed window."""
    first = np.searchsorted(times, begins, side="left")
    return np.asarray(first < np.searchsorted(times, ends, side="right"))
