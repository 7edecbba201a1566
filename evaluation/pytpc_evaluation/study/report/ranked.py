"""How high each method ranks the changed parameter: the main tables.

A share is that of a treatment's missions, its mean that of the treatments; the interval is the
bootstrap's over treatments (`metrics`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from pytpc_evaluation.study.data import ALL, LABELS
from pytpc_evaluation.study.metrics import Estimate, estimate, share
from pytpc_evaluation.study.report.folder import UNKNOWN, FlownSystem
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.positions import Position, by_treatment, ordered, with_absent
from pytpc_evaluation.study.report.systems import language_of, nearness, one_of_each
from pytpc_evaluation.tables import Cell, Column, Table

OURS = "tpc"
BESIDE_CLEAN = "tpc+reference"
"""Ours where there is a good run."""
BASELINE = "thesis"
CHANCE = "random"
CHANCE_OF_DIFFERENT = "differs-at-random"
TURNED = "turned-decisions"
SAY_NONE = (
    "tpc-log",
    "tpc-other-defaults",
    "tpc+where",
    "tpc+1-run",
    "tpc+2-runs",
    "tpc+4-runs",
    "tpc+2-runs+where",
    BESIDE_CLEAN,
)
"""With ours, the methods of which one observer's table has how likely it is none of them."""
METHODS = (
    OURS,
    *SAY_NONE,
    "tpc+changes",
    BASELINE,
    "thesis-doubt",
    "importance",
    TURNED,
    "largest-change",
    "recent-change",
    CHANCE_OF_DIFFERENT,
    CHANCE,
)
TARGETS: Mapping[str, float] = {"typed": 0.90, "untyped": 0.80, "confused": 0.80}
"""The share of treatments with the changed parameter in the top 3 that was aimed at."""
TARGET_PLACES = 3
OPEN = "interval holds the target"
"""What is said of a verdict that other treatments might have turned."""

Group = Callable[[Position], str]


def changed_rows(rows: Iterable[Position], part: Part | None = None) -> list[Position]:
    """The verdicts about missions with a changed parameter, of one part, by all users' marks."""
    own = (row for row in rows if row.changed and row.who == ALL)
    return [row for row in own if part is None or part.has(row.half, row.round)]


def top(rows: Iterable[Position], k: int) -> Estimate:
    """The share of treatments with the changed parameter among the first ``k``."""
    found = list(rows)
    return share([row.within(k) for row in found], _units(found))


def mean_of(rows: Iterable[Position], of: Callable[[Position], float]) -> float | None:
    """The mean over treatments of something."""
    own = list(rows)
    found = estimate([of(row) for row in own], _units(own))
    return found.value if found.treatments else None


def percent(found: Estimate) -> str:
    """``83 [67, 100]``, a dash where nothing is known."""
    if not found.treatments:
        return "-"
    return f"{100 * found.value:.0f} [{100 * found.low:.0f}, {100 * found.high:.0f}]"


def result_table(rows: Sequence[Position], part: Part) -> Table:
    """The result: ours without and with a good run beside the thesis's ranking and chance."""
    methods = (BASELINE, OURS, BESIDE_CLEAN, CHANCE, CHANCE_OF_DIFFERENT)
    judged = (OURS, BESIDE_CLEAN)
    verdicts = (f"Verdict on {method}" for method in judged)
    headings = ("Among the first", "Target", *methods, *verdicts)
    own = changed_rows(rows, part)
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for labels in ordered((row.labels for row in own), LABELS):
        for k in (1, 3):
            shares = {
                method: top([r for r in own if (r.method, r.labels) == (method, labels)], k)
                for method in methods
            }
            aimed = TARGETS.get(labels) if k == TARGET_PLACES else None
            told = [percent(shares[method]) for method in methods]
            target = None if aimed is None else f">= {100 * aimed:.0f}"
            hits = [verdict_of(shares[method], aimed) for method in judged]
            lines.append((labels, (k, target, *told, *hits)))
    columns = tuple(Column(heading, 0) for heading in headings)
    title = f"The result, the {part.title}"
    return Table(f"result-{part.name}", title, columns, tuple(lines), (), "Marks")


def verdict_of(found: Estimate, aimed: float | None) -> str | None:
    """Whether a share is as it should be, by itself; and whether its interval leaves that open."""
    if aimed is None or not found.treatments:
        return None
    word = "hit" if found.value >= aimed else "miss"
    return f"{word}, {OPEN}" if holds_target(found, aimed) else word


def holds_target(found: Estimate, aimed: float) -> bool:
    """Whether the interval has values on both sides of the target."""
    return found.low < aimed <= found.high


def main_table(rows: Sequence[Position], part: Part) -> Table:
    """Method by labels, of one part."""
    columns = (
        Column("Labels", 0),
        Column("Treatments", 0),
        Column("Top 1 %", 0),
        Column("Top 3 %", 0),
        Column("Mean position", 1),
        Column("of", 0),
        Column("Mean rank", 2),
        Column("Target", 0),
        Column("Verdict", 0),
    )
    own = changed_rows(rows, part)
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for labels in ordered((row.labels for row in own), LABELS):
        for method in _methods(own):
            found = [row for row in own if (row.method, row.labels) == (method, labels)]
            if not found:
                continue
            three = top(found, TARGET_PLACES)
            aimed = TARGETS.get(labels)
            cells: tuple[Cell, ...] = (
                labels,
                three.treatments,
                percent(top(found, 1)),
                percent(three),
                mean_of(found, lambda row: row.place),
                mean_of(found, lambda row: float(row.parameters)),
                mean_of(found, lambda row: row.rank),
                None if aimed is None else f">= {100 * aimed:.0f}",
                verdict_of(three, aimed),
            )
            lines.append((method, cells))
    return Table(f"main-{part.name}", f"The {part.title}", columns, tuple(lines), (), "Method")


def against_table(rows: Sequence[Position], part: Part) -> Table:
    """By how much each method is better than the baseline, mission by mission.

    A difference has a narrower interval than two shares: what is hard is hard for both.
    """
    own = changed_rows(rows, part)
    columns = (Column("Labels", 0), Column("Top 3, difference in %", 0), Column("Mean position", 1))
    base = {_mission(row): row for row in own if row.method == BASELINE}
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for labels in ordered((row.labels for row in own), LABELS):
        for method in _methods(own):
            found = [r for r in own if (r.method, r.labels) == (method, labels)]
            pairs = [(row, base[_mission(row)]) for row in found if _mission(row) in base]
            if method == BASELINE or not pairs:
                continue
            units = _units(row for row, _ in pairs)
            three = estimate([r.within(3) - b.within(3) for r, b in pairs], units)
            places = estimate([row.place - other.place for row, other in pairs], units)
            lines.append((method, (labels, percent(three), places.value)))
    title = f"Against {BASELINE}, the {part.title}"
    return Table(f"against-{part.name}", title, columns, tuple(lines), (), "Method")


def grouped_table(
    label: str, rows: Sequence[Position], part: Part, first: str, group: Group
) -> Table:
    """Top 3 by labels of each method, in groups of treatments."""
    own = changed_rows(rows, part)
    methods = _methods(own)
    columns = (Column("Labels", 0), Column("Treatments", 0), *(Column(m, 0) for m in methods))
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for name in sorted({group(row) for row in own}):
        for labels in ordered((row.labels for row in own), LABELS):
            here = [row for row in own if row.labels == labels and group(row) == name]
            shares = [top([row for row in here if row.method == m], 3) for m in methods]
            count = max((share.treatments for share in shares), default=0)
            lines.append((name, (labels, count, *map(percent, shares))))
    title = f"Top 3 in %, the {part.title}"
    return Table(label, title, columns, tuple(lines), (), first)


def groups_of(systems: Sequence[FlownSystem]) -> dict[str, Group]:
    """What treatments are grouped by: heading -> name of a verdict's group."""
    near, spoken = {}, {}
    for system in systems:
        for flight in one_of_each(system.flights):
            place = system.name, flight.treatment.name
            near[place] = nearness(flight.treatment) or UNKNOWN
            spoken[place] = language_of(system, flight.treatment)
    return {
        "System": lambda row: row.system,
        "Type": lambda row: row.type,
        "Tipping point": lambda row: near.get((row.system, row.treatment), UNKNOWN),
        "Language": lambda row: spoken.get((row.system, row.treatment), UNKNOWN),
    }


def users_table(rows: Sequence[Position], part: Part) -> Table:
    """Top 3 by how many users marked; of single users the mean over all of them."""
    own = [row for row in with_absent(rows) if row.changed and part.has(row.half, row.round)]
    methods = _methods(own)
    columns = (Column("Labels", 0), *(Column(method, 0) for method in methods))
    most = 1 + max((row.users or 0 for row in own), default=0)
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for users in sorted({row.users or most for row in own}):
        for labels in ordered((row.labels for row in own), LABELS):
            here = [r for r in own if r.labels == labels and (r.users or most) == users]
            shares = (top([row for row in here if row.method == m], 3) for m in methods)
            name = "all users" if users == most else f"{users} user{'s' if users > 1 else ''}"
            lines.append((name, (labels, *map(percent, shares))))
    return Table(f"users-{part.name}", "Top 3 in %", columns, tuple(lines), (), "Marks of")


def positions_table(rows: Sequence[Position], labels: str) -> Table:
    """The position by each method in every mission, by all users' marks."""
    own = [row for row in rows if row.changed and row.who == ALL and row.labels == labels]
    methods = _methods(own)
    columns = (
        Column("Treatment", 0),
        Column("Half", 0),
        Column("Seed", 0),
        Column("Marks", 0),
        Column("of", 0),
        *(Column(method, 1) for method in methods),
    )
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for (system, treatment), found in by_treatment(own).items():
        for seed in sorted({row.seed for row in found}):
            here = [row for row in found if row.seed == seed]
            of = {row.method: row.position if row.marks else None for row in here}
            first = here[0]
            marks = max(row.marks for row in here)
            cells = (treatment, first.half, seed, marks, first.parameters, *map(of.get, methods))
            lines.append((system, cells))
    title = f"Positions, {labels} marks"
    return Table(f"positions-{labels}", title, columns, tuple(lines), (), "System")


def _mission(row: Position) -> tuple[str, str, int, str]:
    return (row.system, row.treatment, row.seed, row.labels)


def _methods(rows: Iterable[Position]) -> list[str]:
    return ordered((row.method for row in rows), METHODS)


def _units(rows: Iterable[Position]) -> list[tuple[str, str]]:
    return [(row.system, row.treatment) for row in rows]
