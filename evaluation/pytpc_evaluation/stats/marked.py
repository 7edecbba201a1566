"""Tables 6.13 and 6.15: which marks the users set, by treatment, and by trial and user."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pytpc.base.wording import many
from pytpc.recording.marks import MARK_TYPES, MarkType
from pytpc_evaluation.stats.missions import Trial, user_of
from pytpc_evaluation.stats.runtime import SUMMARY
from pytpc_evaluation.tables import Cell, Column, Table, statistics
from pytpc_evaluation.treatment import TreatmentType

NO_TYPE = "No type"
_KINDS: Sequence[MarkType | None] = (*MARK_TYPES, None)
_TREATMENTS: Mapping[TreatmentType, tuple[str, MarkType]] = {
    "type1": ("Treatment Type I", "I"),
    "type2": ("Treatment Type II", "II"),
}
_OTHERS: Sequence[tuple[TreatmentType | None, str]] = (
    ("fault", "with a fault in the source"),
    ("clean", "with nothing changed"),
    (None, "whose treatment is not known"),
)


@dataclass(frozen=True, slots=True)
class MarksOfTrial:
    """How many marks of each type each user set in one trial; a user may be missing for none."""

    label: str
    kind: TreatmentType | None
    counts: Mapping[str, Mapping[MarkType | None, int]]

    @classmethod
    def of(cls, trial: Trial) -> MarksOfTrial:
        """Count the marks of a mission."""
        counts: dict[str, Counter[MarkType | None]] = {}
        for mark in trial.mission.recording.marks:
            counts.setdefault(user_of(mark), Counter())[mark.type] += 1
        return cls(trial.label, trial.mission.kind, counts)

    def number(self, kind: MarkType | None, user: str | None = None) -> int:
        """The marks of a type, by one user or by all."""
        found = self.counts.values() if user is None else [self.counts.get(user, {})]
        return sum(counts.get(kind, 0) for counts in found)


def confusion_table(trials: Sequence[MarksOfTrial]) -> Table:
    """Table 6.13: treatments with a changed parameter against the types of the marks."""
    kinds = _kinds_in(trials)
    rows: list[tuple[str, tuple[Cell, ...]]] = []
    wrong = typed = 0
    for treatment, (name, right) in _TREATMENTS.items():
        own = [trial for trial in trials if trial.kind == treatment]
        if own:
            rows.append((name, tuple(sum(t.number(kind) for t in own) for kind in kinds)))
            wrong += sum(t.number(kind) for t in own for kind in MARK_TYPES if kind != right)
            typed += sum(t.number(kind) for t in own for kind in MARK_TYPES)
    notes = [f"{wrong} of {many(typed, 'mark')} are of the wrong type."] if rows else []
    for treatment_or_none, what in _OTHERS:
        own = [trial for trial in trials if trial.kind == treatment_or_none]
        marks = sum(trial.number(kind) for trial in own for kind in _KINDS)
        if marks:
            notes.append(f"{many(marks, 'mark')} in {many(len(own), 'trial')} {what}.")
    return Table(
        "confusion",
        "Confusion matrix for marks of type I and type II and treatments",
        tuple(Column(_mark_heading(kind), 0) for kind in kinds),
        tuple(rows),
        (),
        first="Treatment",
        notes=tuple(notes),
    )


def marks_table(trials: Sequence[MarksOfTrial], users: Sequence[str]) -> Table:
    """Table 6.15: marks of each user in each trial, and their totals.

    A user who set none in a trial has 0 there: whether somebody was present and saw nothing wrong,
    or was absent, nothing tells.
    """
    kinds = _kinds_in(trials)
    columns = [Column(_heading(kind), 0, group=user) for user in users for kind in kinds]
    columns += [Column(_heading(kind), 0, group="Total") for kind in kinds]
    rows: list[tuple[str, tuple[Cell, ...]]] = []
    for trial in trials:
        own = [trial.number(kind, user) for user in users for kind in kinds]
        rows.append((trial.label, (*own, *(trial.number(kind) for kind in kinds))))
    figures = [statistics([cells[n] for _, cells in rows]) for n in range(len(columns))]
    summary = tuple(
        (shown, tuple(figure[name] for figure in figures)) for name, shown in SUMMARY.items()
    )
    return Table(
        "marks",
        "User marks during the trials",
        tuple(columns),
        tuple(rows),
        summary if rows else (),
        first="Trial",
        statistic_digits=2,
    )


def _kinds_in(trials: Sequence[MarksOfTrial]) -> Sequence[MarkType | None]:
    """Both types; marks without a type where there are any."""
    untyped = any(trial.number(None) for trial in trials)
    return _KINDS if untyped else MARK_TYPES


def _heading(kind: MarkType | None) -> str:
    return NO_TYPE if kind is None else f"Type {kind}"


def _mark_heading(kind: MarkType | None) -> str:
    return f"{_heading(kind)} Marks"
