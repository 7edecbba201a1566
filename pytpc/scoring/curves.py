"""Scores and ranks of all parameters over a grid of times: the curves of figures 6.15 to 6.18."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.columns import Floats, Int64s
from pytpc.ingest.recording import Recording
from pytpc.scoring.scores import WINDOW_S
from pytpc.static_info import StaticInfo

STEP_S = 0.1
"""10 Hz."""


@dataclass(frozen=True, eq=False)
class RankCurves:
    """Scores and ranks of p parameters at t times.

    ``times_ns`` int64[t]; ``parameters`` the p names, sorted; ``score1``, ``score2`` float64[t, p]
    (`pytpc.scoring.scores.NONE` where none), ``rank1``, ``rank2`` and ``combined`` float64[t, p] in
    [0, 1], 1 the most suspicious.
    """

    times_ns: Int64s
    parameters: tuple[str, ...]
    score1: Floats
    score2: Floats
    rank1: Floats
    rank2: Floats
    combined: Floats


def rank_curves(
    recording: Recording,
    static_info: StaticInfo,
    *,
    step_s: float = STEP_S,
    window_s: float = WINDOW_S,
) -> RankCurves:
    """The curves of a mission, from its begin to its end every ``step_s`` seconds."""
    raise NotImplementedError
