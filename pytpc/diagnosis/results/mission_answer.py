"""The whole diagnosis of one mission, as the report page shows it."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.base.columns import Floats, Int64s
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.results.advice import Advice, BlamedAdvice
from pytpc.diagnosis.results.suspects import Blame, MarkRanking


@dataclass(frozen=True, eq=False)
class RankCurves:
    """Scores and ranks of p parameters at t times.

    ``times_ns`` int64[t]; ``parameters`` the p names, sorted; ``score1``, ``score2`` float64[t, p]
    (`pytpc.diagnosis.scores.scores.NONE` where none), ``rank1``, ``rank2`` and ``combined``
    float64[t, p] in [0, 1], 1 the most suspicious.
    """

    times_ns: Int64s
    parameters: tuple[str, ...]
    score1: Floats
    score2: Floats
    rank1: Floats
    rank2: Floats
    combined: Floats


@dataclass(frozen=True, slots=True)
class SuspectAnswer:
    """All that is known of one of the first suspects at a mark.

    ``why`` says what its comparison did before the mark. ``others`` is the advice by the other
    comparisons of its parameter. ``suggested`` is the threshold that the value to try gives, None
    where there is no number. ``feasible`` are the thresholds that would do, as (low, high).
    """

    advice: Advice
    why: str
    others: tuple[Advice, ...]
    suggested: float | None
    feasible: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class MarkAnswer:
    """One mark: ``first`` are the first suspects, ``rest`` is the advice for the others."""

    ranking: MarkRanking
    first: tuple[SuspectAnswer, ...]
    rest: tuple[Advice, ...]


@dataclass(frozen=True, eq=False)
class MissionAnswer:
    """All that is found out about one mission.

    ``question`` is what was asked; its ``top`` is how many suspects of a mark were looked at
    closely. ``blame`` and ``first`` are the verdict of all marks together and the advice for its
    first suspect; None without marks, or without a suspect. ``curves`` is None where no mark has a
    suspect. ``warnings`` say what is wrong with the recording.
    """

    question: Question
    marks: tuple[MarkAnswer, ...]
    blame: Blame | None
    first: BlamedAdvice | None
    curves: RankCurves | None
    warnings: tuple[str, ...]
