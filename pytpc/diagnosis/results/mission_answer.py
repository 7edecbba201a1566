"""The whole answer about a mission: all marks together, and the evidence at each."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.results.advice import Advice, BlamedAdvice, RankCurves
from pytpc.diagnosis.results.behaviour import Behaviour
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.differences import RunDifferences
from pytpc.diagnosis.results.suspects import Accused, MarkRanking
from pytpc.diagnosis.results.turn_groups import TurnGroup
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark

Spans = tuple[tuple[float, float], ...]
"""Thresholds from (low) to (high); an open end is infinite."""


@dataclass(frozen=True, slots=True)
class SuspectAnswer:
    """All evidence about one of the first suspects at a mark.

    ``why`` says what its comparison did before the mark. ``others`` is the advice by the other
    comparisons of its parameter. ``suggested`` is the threshold that the smallest change gives;
    None if it is not a number. ``feasible`` are the thresholds that would do.
    """

    advice: Advice
    why: str
    others: tuple[Advice, ...]
    suggested: float | None
    feasible: Spans


@dataclass(frozen=True, slots=True)
class MarkAnswer:
    """One mark: ``first`` are the first suspects, ``rest`` is the advice for the others."""

    ranking: MarkRanking
    first: tuple[SuspectAnswer, ...]
    rest: tuple[Advice, ...]


@dataclass(frozen=True, slots=True)
class LeadAnswer:
    """The evidence for the first suspect of the diagnosis, at the mark where it has most of it.

    ``number`` counts the marks from 1. ``accused`` has the comparison and the type of error that
    the value to try is about. ``why``, ``suggested`` and ``feasible`` are as in `SuspectAnswer`,
    but ``suggested`` is for the value to try.
    """

    advised: BlamedAdvice
    accused: Accused
    mark: Mark
    number: int
    why: str
    suggested: float | None
    feasible: Spans
    declared: Declared | None


@dataclass(frozen=True, eq=False)
class MissionAnswer:
    """The whole diagnosis of one mission, as the report page shows it.

    The ``top`` of its ``question`` is how many suspects of a mark have all evidence. ``diagnosis``
    is None without marks, ``curves`` if no mark has a suspect, ``lead`` if the diagnosis shows
    none, or first one that no comparison reports. ``warnings`` say what is wrong with the
    recording. ``behaviours`` are what the comparisons did over the mission, the nearest to turning
    first, and ``groups`` those that turn as one.
    """

    question: Question
    marks: tuple[MarkAnswer, ...]
    diagnosis: Diagnosis | None
    curves: RankCurves | None
    warnings: tuple[str, ...]
    lead: LeadAnswer | None = None
    behaviours: tuple[Behaviour, ...] = ()
    groups: tuple[TurnGroup, ...] = ()

    @property
    def differences(self) -> RunDifferences | None:
        """The parameters that differ from good runs; None if none was given."""
        return self.question.differences
