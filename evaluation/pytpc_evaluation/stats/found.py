"""Table 6.16: mean rank and score of the changed parameter on the marks.

The columns of a type are means over the marks of that type: so the thesis's numbers come about (a
score of 8181.87 over 22 marks is 18 times 9999.9 and four times 0.75). A parameter without a score
at a mark counts with score 9999.9 and rank 0. Where there are no marks of a type there is no mean;
the thesis prints rank 0.00 and score 9999.00.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pytpc.diagnosis.full_names import with_full_names
from pytpc.diagnosis.question import WINDOW_S, Question
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.diagnosis.scores.scores import NONE
from pytpc.recording.marks import MARK_TYPES, MarkType
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.stats.missions import Trial
from pytpc_evaluation.tables import Cell, Column, Table, statistics


@dataclass(frozen=True, slots=True)
class FoundAtMark:
    """The changed parameter at one mark: its rank, 0 to 1, and its score by the mark's type."""

    type: MarkType | None
    rank: float
    score: float


@dataclass(frozen=True, slots=True)
class FoundInTrial:
    """The changed parameter at all marks of a trial."""

    label: str
    marks: tuple[FoundAtMark, ...]

    def mean(self, kind: MarkType | None, what: str) -> float | None:
        """The mean of ``rank`` or ``score`` over the marks of a type."""
        return statistics([getattr(m, what) for m in self.marks if m.type == kind])["mean"]

    def number(self, kind: MarkType | None) -> int:
        """How many marks of a type there are."""
        return sum(1 for mark in self.marks if mark.type == kind)


def found_in(
    trial: Trial, static_info: StaticInfo, window_s: float = WINDOW_S
) -> FoundInTrial | None:
    """Rank the changed parameter at each mark; None where the treatment changed none.

    A mark without a type has the combined rank, and the score of the type by which it has it.
    """
    treatment = trial.mission.treatment
    if treatment is None or treatment.parameter is None:
        return None
    marks = []
    recording = trial.mission.recording
    named = with_full_names(static_info, recording, {})
    for ranking in rank_marks(recording, named, Question(window_s=window_s)):
        suspect = ranking.suspect_of(treatment.parameter)
        rank, score = (0.0, NONE) if suspect is None else (suspect.rank, suspect.score)
        marks.append(FoundAtMark(ranking.mark.type, rank, score))
    return FoundInTrial(trial.label, tuple(marks))


def found_table(trials: Sequence[FoundInTrial]) -> Table:
    """Table 6.16, with the number of marks that each mean is over."""
    columns = []
    for kind in MARK_TYPES:
        columns += [
            Column(f"Type {kind} Marks", 0),
            Column(f"Type {kind} Rank", 2),
            Column(f"Type {kind} Score", 2),
        ]
    untyped = any(trial.number(None) for trial in trials)
    if untyped:
        columns += [Column("No type Marks", 0), Column("No type Rank", 2)]
    rows: list[tuple[str, tuple[Cell, ...]]] = []
    for trial in trials:
        cells: list[Cell] = []
        for kind in MARK_TYPES:
            cells += [trial.number(kind), trial.mean(kind, "rank"), trial.mean(kind, "score")]
        if untyped:
            cells += [trial.number(None), trial.mean(None, "rank")]
        rows.append((trial.label, tuple(cells)))
    return Table(
        "found",
        "Average score and rank of the changed parameter on the marks",
        tuple(columns),
        tuple(rows),
        (),
        first="Trial",
        notes=("Rank 1 is the most suspicious; a score of 9999.9 is none.",) if rows else (),
    )
