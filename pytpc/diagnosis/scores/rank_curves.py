"""Scores and ranks of all parameters over a grid of times: the curves of figures 6.15 to 6.18."""

from __future__ import annotations

import numpy as np

from pytpc.base.errors import TpcError
from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.results.mission_answer import RankCurves
from pytpc.diagnosis.scores.score_tables import Tpcs, parameter_tables, tpc_scores
from pytpc.diagnosis.scores.summary_scores import LogTables
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

STEP_S = 0.1
"""10 Hz."""

# Some 2 GB in all five tables. A mission that seems to take decades has two clocks in it.
_MOST_NUMBERS = 50_000_000


def rank_curves(
    recording: Recording,
    static_info: StaticInfo,
    question: Question = PLAIN,
    *,
    step_s: float = STEP_S,
) -> RankCurves:
    """The curves of a mission, from its begin to its end every ``step_s`` seconds.

    Each value is what an observer would have got at that time: nothing later counts.

    Raises:
        ValueError: ``step_s`` is less than a nanosecond.
        TpcError: there are too many steps.
    """
    step_ns = round(step_s * 1e9)
    if step_ns < 1:
        raise ValueError("step_s is less than a nanosecond")
    tpcs = Tpcs.of(static_info)
    steps = (recording.end_ns - recording.start_ns) // step_ns + 1
    if steps * max(1, len(tpcs.keys)) > _MOST_NUMBERS:
        raise TpcError(
            f"{recording.name}: {recording.seconds:.0f} s in steps of {step_s:g} s are too many for"
            f" {len(tpcs.keys)} comparisons; take longer steps (or are there two clocks in it?)"
        )
    times = recording.start_ns + step_ns * np.arange(steps, dtype=np.int64)
    events = recording.events.with_keys(tpcs.keys)
    scores = tpc_scores(tpcs, LogTables(events, recording.summaries), times, question.window_s)
    tables = parameter_tables(tpcs, scores)
    return RankCurves(
        times_ns=times,
        parameters=tables.first.names,
        score1=tables.first.scores,
        score2=tables.second.scores,
        rank1=tables.first.ranks,
        rank2=tables.second.ranks,
        combined=tables.combined,
    )
