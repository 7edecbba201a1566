"""The thesis's own tables, 6.12 to 6.16, of each system, and short forms of them side by side.

The full tables are those of `pytpc stats`, of missions with the marks as they were said. The short
ones stand on the page beside the thesis's numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean, median

from pytpc.diagnosis.scores.scores import NONE
from pytpc.recording.marks import MarkType
from pytpc_evaluation.stats.delays import DelaysOfTrial, delays_of, delays_table
from pytpc_evaluation.stats.found import FoundAtMark, FoundInTrial, found_in, found_table
from pytpc_evaluation.stats.marked import MarksOfTrial, confusion_table, marks_table
from pytpc_evaluation.stats.missions import Trial, in_order, users_of
from pytpc_evaluation.stats.runtime import RuntimeStatistics, runtime_statistics, runtime_table
from pytpc_evaluation.study.report import thesis_figures as thesis
from pytpc_evaluation.study.report.folder import FlownSystem
from pytpc_evaluation.tables import Cell, Column, Table
from pytpc_evaluation.treatment import TreatmentType

TOP_ROWS = 8
_RIGHT: dict[str, MarkType] = {"type1": "I", "type2": "II"}
_KINDS: tuple[TreatmentType, ...] = ("type1", "type2", "fault", "clean")
KIND_NAMES = {"type1": "type I", "type2": "type II", "fault": "fault in the source",
              "clean": "clean"}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Original:
    """What the thesis's tables of one system are made from."""

    name: str
    runtime: RuntimeStatistics
    trials: tuple[Trial, ...]
    marks: tuple[MarksOfTrial, ...]
    delays: tuple[DelaysOfTrial, ...]
    found: tuple[FoundInTrial, ...]
    users: tuple[str, ...]

    @classmethod
    def of(cls, system: FlownSystem, halves: Sequence[str]) -> Original:
        """Count and rank; ranks are taken in the treatments of ``halves`` alone."""
        missions = [flight.as_said() for flight in system.flights]
        half = {flight.treatment.name: flight.half for flight in system.flights}
        trials = tuple(in_order(missions))
        shown = [
            trial
            for trial in trials
            if trial.mission.treatment and half[trial.mission.treatment.name] in halves
        ]
        static_info = system.static_info
        delays = (delays_of(trial, static_info) for trial in trials)
        found = (found_in(trial, static_info) for trial in shown)
        return cls(
            system.name,
            runtime_statistics([mission.recording for mission in missions], static_info),
            trials,
            tuple(MarksOfTrial.of(trial) for trial in trials),
            tuple(one for one in delays if one is not None),
            tuple(one for one in found if one is not None),
            tuple(users_of(missions)),
        )

    def tables(self) -> list[Table]:
        """Tables 6.12 to 6.16 in full."""
        return [
            runtime_table(self.runtime),
            confusion_table(self.marks),
            delays_table(self.delays, self.users),
            marks_table(self.marks, self.users),
            found_table(self.found),
        ]

    def of_kind(self, kind: TreatmentType) -> list[Trial]:
        """The trials of one type of treatment."""
        return [trial for trial in self.trials if trial.mission.kind == kind]

    def delays_on(self, kind: TreatmentType) -> list[float]:
        """Seconds to the first mark, of all users in all trials of a type of treatment."""
        labels = {trial.label for trial in self.of_kind(kind)}
        return [d for one in self.delays if one.label in labels for d in one.delays.values()]

    def marks_on(self, kind: TreatmentType, mark: MarkType) -> int:
        """How many marks of a type were set in the trials of a type of treatment."""
        return sum(one.number(mark) for one in self.marks if one.kind == kind)


def runtime_short(found: RuntimeStatistics) -> Table:
    """Table 6.12: the parameters that are compared most often, and the last rows."""
    whole = runtime_table(found)
    rows = sorted(whole.rows, key=lambda row: (-_number(row[1][1]), row[0]))[:TOP_ROWS]
    return Table(
        whole.label, whole.title, whole.columns, tuple(rows), whole.summary, whole.first,
        whole.statistic_digits,
    )  # fmt: skip


def runtime_compared(originals: Sequence[Original]) -> Table:
    """What table 6.12 gives of docs/reference/thesis-figures.md, beside the thesis's figures."""
    columns = [Column(one.name, 2) for one in originals]
    columns += [Column("thesis: image capture", 2), Column("thesis: three systems", 2)]
    values = [runtime_figures(one.runtime) for one in originals]
    names = list(runtime_figures(runtime_statistics_of_nothing()))
    rows = tuple(
        (
            name,
            (
                *(each[name] for each in values),
                thesis.IMAGE_CAPTURE.get(name),
                thesis.RANGES.get(name),
            ),
        )
        for name in names
    )
    return Table("runtime-compared", "While the robots run", tuple(columns), rows, (), "What")


def runtime_figures(found: RuntimeStatistics) -> dict[str, float | None]:
    """What is compared with the thesis, by name."""
    comparisons = sum(row.comparisons for row in found.rows)
    flops = sum(row.flops for row in found.rows)
    unseen = found.locations - found.seen
    return {
        "places in the source": float(found.locations),
        "places in the source never evaluated, %": _share(unseen, found.locations),
        "parameters never compared, %": _share(
            found.parameters - len(found.rows), found.parameters
        ),
        "comparisons per second": comparisons / found.seconds if found.seconds > 0 else None,
        "flops, % of the comparisons": _share(flops, comparisons),
        "seconds flown": found.seconds,
    }


def runtime_statistics_of_nothing() -> RuntimeStatistics:
    """Of no mission of no system."""
    return RuntimeStatistics((), 0, 0.0, 0, 0, 0)


def thesis_runtime() -> Table:
    """The last rows of the thesis's table 6.12."""
    columns = runtime_table(runtime_statistics_of_nothing()).columns
    rows = tuple(thesis.RUNTIME_SUMMARY.items())
    return Table("thesis-runtime", "Table 6.12 of the thesis", columns, (), rows, "Parameter", 2)


def confusion_compared(originals: Sequence[Original]) -> Table:
    """Table 6.13 of all systems, and the thesis's."""
    columns = tuple(
        Column(heading, digits, group=group)
        for group in ("Treatment type I", "Treatment type II")
        for heading, digits in (("marks I", 0), ("marks II", 0), ("wrong %", 1))
    )
    rows: list[tuple[str, tuple[Cell, ...]]] = []
    for one in originals:
        cells: list[Cell] = []
        for kind, right in _RIGHT.items():
            first, second = (one.marks_on(_kind(kind), mark) for mark in ("I", "II"))
            wrong = second if right == "I" else first
            cells += [first, second, _share(wrong, first + second)]
        rows.append((one.name, tuple(cells)))
    own: list[Cell] = []
    for kind, right in _RIGHT.items():
        first, second = thesis.CONFUSION[kind]
        own += [first, second, _share(second if right == "I" else first, first + second)]
    rows.append(("thesis: image capture", tuple(own)))
    return Table("confusion-compared", "Confusion", columns, tuple(rows), (), "System")


def delays_compared(originals: Sequence[Original]) -> Table:
    """Table 6.14 in short: how many users marked, after how many seconds."""
    columns = tuple(
        Column(heading, digits, group=group)
        for group in ("Treatment type I", "Treatment type II")
        for heading, digits in (("marked", 0), ("of", 0), ("mean s", 2), ("median s", 2))
    )
    rows: list[tuple[str, tuple[Cell, ...]]] = []
    for one in originals:
        cells: list[Cell] = []
        for kind in _RIGHT:
            found = one.delays_on(_kind(kind))
            cells += [len(found), len(one.of_kind(_kind(kind))) * len(one.users)]
            cells += [fmean(found) if found else None, median(found) if found else None]
        rows.append((one.name, tuple(cells)))
    own: list[Cell] = []
    for trials in thesis.DELAYS.values():
        found = [delay for trial in trials for delay in trial]
        own += [len(found), len(trials) * thesis.USERS, fmean(found), median(found)]
    rows.append(("thesis: image capture", tuple(own)))
    return Table("delays-compared", "Delays", columns, tuple(rows), (), "System")


def marks_compared(originals: Sequence[Original]) -> Table:
    """Table 6.15 in short: marks of a user in a trial, by type of treatment."""
    columns = tuple(
        Column(f"marks {mark}", 2, group=KIND_NAMES[kind])
        for kind in _KINDS
        for mark in ("I", "II")
    )
    rows: list[tuple[str, tuple[Cell, ...]]] = []
    for one in originals:
        cells: list[Cell] = []
        for kind in _KINDS:
            chances = len(one.of_kind(kind)) * len(one.users)
            counts = (one.marks_on(kind, mark) for mark in ("I", "II"))
            cells += [count / chances if chances else None for count in counts]
        rows.append((one.name, tuple(cells)))
    own: list[Cell] = []
    for kind in _KINDS:
        trials = thesis.MARKS[kind]
        own += [sum(trial[n] for trial in trials) / len(trials) / thesis.USERS for n in (0, 1)]
    rows.append(("thesis: image capture", tuple(own)))
    return Table("marks-compared", "Marks", columns, tuple(rows), (), "System")


def found_compared(original: Original) -> Table:
    """Table 6.16: rank and score at the marks of the right and of the wrong type, by treatment."""
    columns = tuple(
        Column(heading, digits, group=group)
        for group in ("Rightly typed", "Wrongly typed")
        for heading, digits in (("marks", 0), ("rank", 2), ("score", 2))
    )
    trials = {trial.label: trial.mission for trial in original.trials}
    at_marks: dict[tuple[int, str], list[FoundAtMark]] = {}
    for one in original.found:
        treated = trials[one.label].treatment
        if treated is not None:
            at_marks.setdefault((_KINDS.index(treated.type), treated.name), []).extend(one.marks)
    rows = []
    for (kind, name), marks in at_marks.items():
        right = _RIGHT[_KINDS[kind]]
        rightly = [mark for mark in marks if mark.type == right]
        wrongly = [mark for mark in marks if mark.type != right]
        rows.append((name, (*_means(rightly), *_means(wrongly))))
    return Table("found-compared", "Found", columns, tuple(rows), (), "Treatment")


def thesis_found() -> Table:
    """The thesis's ranks of table 6.16 in the same form, trial by trial."""
    columns = (Column("rank rightly typed", 2), Column("rank wrongly typed", 2))
    rows = []
    for kind, right in _RIGHT.items():
        for trial, (first, second) in enumerate(thesis.FOUND[kind], start=1):
            cells = (first, second) if right == "I" else (second, first)
            rows.append((f"{KIND_NAMES[kind]} trial {trial}", cells))
    return Table("thesis-found", "Table 6.16 of the thesis", columns, tuple(rows), (), "Treatment")


def _means(marks: Sequence[FoundAtMark]) -> tuple[Cell, Cell, Cell]:
    """Number, mean rank and mean score; the score is over the marks that have one."""
    scores = [mark.score for mark in marks if mark.score != NONE]
    rank = fmean(mark.rank for mark in marks) if marks else None
    return len(marks), rank, fmean(scores) if scores else None


def _share(part: int, whole: int) -> float | None:
    return 100.0 * part / whole if whole else None


def _kind(name: str) -> TreatmentType:
    return next(kind for kind in _KINDS if kind == name)


def _number(cell: Cell) -> float:
    return float(cell) if isinstance(cell, int | float) else 0.0
