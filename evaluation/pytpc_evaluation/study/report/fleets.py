"""How often the wrong parameter is first, from flown fleets: a table for each shape of questions.

The unit is the treatment: the mean over its questions. Intervals are those of Clopper and Pearson.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from pytpc_evaluation.study.fleet_causes import CausesVerdict
from pytpc_evaluation.study.fleet_judge import FleetVerdict
from pytpc_evaluation.study.fleet_questions import SHAPES
from pytpc_evaluation.study.metrics import Estimate, exact_share
from pytpc_evaluation.study.report.positions import ordered
from pytpc_evaluation.study.report.ranked import percent
from pytpc_evaluation.tables import Cell, Column, Table

FLEET = "fleet"
METHODS = (
    FLEET,
    "fleet-importance",
    "fleet-differs",
    "tpc+2-runs",
    "tpc",
    "importance",
    "thesis",
)
TARGET = 0.9
_TITLES = {
    "mixed": "Bad missions of all three robots",
    "one-robot": "Bad missions of one robot, good ones of all three",
    "by-marks": "Bad missions of all three robots, and all that have a false alarm",
}
_PARTS: tuple[tuple[str, Callable[[FleetVerdict], bool]], ...] = (
    ("all", lambda _: True),
    ("tuning", lambda one: one.half == "tuning"),
    ("held-back", lambda one: one.half == "held-back"),
    ("type I", lambda one: one.type == "type1"),
    ("type II", lambda one: one.type == "type2"),
)


def fleet_tables(verdicts: Sequence[FleetVerdict]) -> list[Table]:
    """For each shape a row for each method, with its shares of the treatments in %."""
    return [
        _table(shape, own)
        for shape in SHAPES
        if (own := [one for one in verdicts if one.shape == shape])
    ]


def causes_table(verdicts: Sequence[CausesVerdict]) -> Table:
    """For each system, and all of them, the share of the wrong parameters that were named."""
    columns = (
        Column("Questions", 0),
        Column("Named %", 0),
        Column("All named, none false %", 0),
        Column("Named falsely", 0),
    )
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for system in (*sorted({one.system for one in verdicts}), "all"):
        own = [one for one in verdicts if system in {one.system, "all"}]
        named = exact_share(
            [float(is_named) for one in own for is_named in one.named],
            [(one.system, treatment) for one in own for treatment in one.treatments],
        )
        whole = sum(all(one.named) and not one.false for one in own) / len(own)
        false = sum(len(one.false) for one in own)
        lines.append((system, (len(own), percent(named), 100.0 * whole, false)))
    causes = sorted({len(one.named) for one in verdicts})
    notes = (f"Each question has {_span(causes)} wrong parameters, each in other missions.",)
    return Table("fleet-causes", "Several causes", columns, tuple(lines), (), "System", notes=notes)


def first_share(verdicts: Sequence[FleetVerdict]) -> Estimate:
    """The share of treatments with the wrong parameter first."""
    return exact_share([one.first for one in verdicts], _units(verdicts))


def _third_share(verdicts: Sequence[FleetVerdict]) -> Estimate:
    return exact_share([one.third for one in verdicts], _units(verdicts))


def _units(verdicts: Sequence[FleetVerdict]) -> list[tuple[str, str]]:
    return [(one.system, one.treatment) for one in verdicts]


def _table(shape: str, verdicts: Sequence[FleetVerdict]) -> Table:
    parts = [(name, has) for name, has in _PARTS if any(map(has, verdicts))]
    columns = (
        *(Column(name, 0, "First %") for name, _ in parts),
        Column("all", 0, "Among three %"),
    )
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for method in ordered((one.method for one in verdicts), METHODS):
        own = [one for one in verdicts if one.method == method]
        shares = [percent(first_share([one for one in own if has(one)])) for _, has in parts]
        lines.append((method, (*shares, percent(_third_share(own)))))
    counts = {name: len(set(_units([one for one in verdicts if has(one)]))) for name, has in parts}
    lines.append(("treatments", (*counts.values(), counts["all"])))
    bad, good = (sorted({getattr(one, name) for one in verdicts}) for name in ("bad", "good"))
    notes = (f"Each question has {_span(bad)} bad missions and {_span(good)} good ones.",)
    return Table(f"fleet-{shape}", _TITLES[shape], columns, tuple(lines), (), "Method", notes=notes)


def _span(counts: Sequence[int]) -> str:
    low, high = counts[0], counts[-1]
    return str(low) if low == high else f"{low} to {high}"
