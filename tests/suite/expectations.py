"""The lists of threshold predicate comparisons that a reader finds in each node of the suite.

A list stands beside the node's source and was written by hand, before any analysis ran. ``judge``
compares it with what the analysis found; it knows nothing of files and processes.

An expectation says ``file``, ``line``, ``parameter``, ``type``, ``relation`` and, where they are
plain, ``distance`` and ``transform``. Under ``constants`` stand hard-coded constants, which are
judged where the node has that key; under ``limits`` what the analysis may or may not find. In a
node that is ``imprecise`` both answers are right.

Lists of Python nodes (examples/python_nodes) say ``column``, too, where a comparison begins; one
that is found at another column is another one. ``params`` must be set before the node starts. What
a ``timed`` node publishes depends on when things happen, too.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pytpc.static.link_unit import Comparison

PACKAGE = Path(__file__).parents[2] / "examples/threshold_nodes"
PYTHON_PACKAGE = PACKAGE.with_name("python_nodes")
RCLPY_PACKAGE = PACKAGE.with_name("rclpy_nodes")
RCLCPP_PACKAGE = PACKAGE.with_name("rclcpp_nodes")
# The lists say which operator stands in the source; static information has six relations.
_EQUALITIES = {"is": "==", "is not": "!=", "in": "==", "not in": "!="}


@dataclass(frozen=True, slots=True)
class Entry:
    """One comparison as the reader wrote it down. ``absent`` entries have a place alone.

    One that is absent and ``decides`` can be seen from outside, but compares no parameter's value.
    """

    file: str
    line: int
    text: str
    parameter: str | None
    type: str | None
    relation: str | None
    distance: int | None
    transform: dict[str, float] | str | None
    why: str
    column: int | None = None
    decides: bool = False

    def __str__(self) -> str:
        """One line for a person."""
        return (
            f"{self.file}:{self.line} {self.type} '{self.parameter}' {self.relation} ({self.text})"
        )


@dataclass(frozen=True, slots=True)
class Expectation:
    """The list of one node."""

    node: str
    expect: tuple[Entry, ...]
    constants: tuple[Entry, ...] | None
    limits: tuple[Entry, ...]
    absent: tuple[Entry, ...]
    imprecise: bool
    nan: bool
    params: Mapping[str, Any] = field(default_factory=dict)
    timed: bool = False

    @property
    def entries(self) -> tuple[Entry, ...]:
        """All that has a place."""
        return (*self.expect, *(self.constants or ()), *self.limits, *self.absent)


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of one node's list.

    ``missing`` and ``false`` say what and where; a comparison that is found with another type,
    relation, distance or transform than expected is one of each. ``limits_found`` counts those of
    ``limits``; for an ``imprecise`` node ``missing`` and ``false`` are no errors.
    """

    node: str
    expected: int
    found: int
    missing: tuple[str, ...]
    false: tuple[str, ...]
    limits: int
    limits_found: int
    imprecise: bool

    @property
    def is_right(self) -> bool:
        """Nothing missing, nothing false, or both answers allowed."""
        return self.imprecise or not (self.missing or self.false)


def nodes(package: Path = PACKAGE) -> list[str]:
    """The names of all nodes that have a list."""
    return sorted(path.stem for path in (package / "nodes").glob("*.json"))


def load(node: str, package: Path = PACKAGE) -> Expectation:
    """Read one node's list."""
    data = json.loads((package / "nodes" / f"{node}.json").read_text("utf-8"))
    return Expectation(
        node=node,
        expect=_entries(data["expect"]),
        constants=_entries(data["constants"]) if "constants" in data else None,
        limits=_entries(data.get("limits", [])),
        absent=_entries(data.get("absent", [])),
        imprecise=bool(data.get("imprecise", False)),
        nan=bool(data.get("nan", False)),
        params=data.get("params", {}),
        timed=bool(data.get("timed", False)),
    )


def _entries(items: Iterable[dict[str, Any]]) -> tuple[Entry, ...]:
    return tuple(
        Entry(
            item["file"],
            item["line"],
            item["text"],
            item.get("parameter"),
            item.get("type"),
            item.get("relation"),
            item.get("distance"),
            item.get("transform"),
            item.get("why", ""),
            item.get("column"),
            bool(item.get("decides", False)),
        )
        for item in items
    )


def judge(expectation: Expectation, found: Iterable[Comparison]) -> Verdict:
    """Compare a node's list with the comparisons that were found in its link unit."""
    wanted = [*expectation.expect, *(expectation.constants or ())]
    left = [
        comparison
        for comparison in found
        if comparison.type != "constant" or expectation.constants is not None
    ]
    unmet: list[Entry] = []
    for entry in wanted:
        same = next((one for one in left if not differences(entry, one)), None)
        if same is None:
            unmet.append(entry)
        else:
            left.remove(same)
    total_found = len(wanted) - len(unmet)
    limits_found = 0
    for entry in expectation.limits:
        near = next((one for one in left if _is_at(entry, one)), None)
        if near is not None:
            left.remove(near)
            limits_found += 1
    return Verdict(
        node=expectation.node,
        expected=len(wanted),
        found=total_found,
        missing=tuple(_of_missing(entry, left) for entry in unmet),
        false=tuple(_of_false(comparison, expectation) for comparison in left),
        limits=len(expectation.limits),
        limits_found=limits_found,
        imprecise=expectation.imprecise,
    )


def differences(entry: Entry, found: Comparison) -> list[str]:
    """In what a comparison is not the one that was expected; empty where it is the one."""
    wrong = []
    if _place(found) != (entry.file, entry.line):
        wrong.append(f"at {found.file}:{found.lineno}")
    elif entry.column not in (None, found.column):
        wrong.append(f"column {found.column}")
    if entry.type != "constant" and found.source != entry.parameter:
        wrong.append(f"parameter '{found.source}'")
    if found.type != entry.type:
        wrong.append(f"type {found.type}")
    if found.relation != _EQUALITIES.get(entry.relation or "", entry.relation):
        wrong.append(f"relation {found.relation}")
    if entry.distance is not None and found.distance != entry.distance:
        wrong.append(f"distance {found.distance}")
    if entry.transform is not None and not _same_transform(entry.transform, found):
        wrong.append(f"transform {found.transform}")
    return wrong


def _place(found: Comparison) -> tuple[str, int]:
    return found.file, found.lineno


def _is_at(entry: Entry, found: Comparison) -> bool:
    return _place(found) == (entry.file, entry.line) and entry.column in (None, found.column)


def _same_transform(wanted: dict[str, float] | str, found: Comparison) -> bool:
    how = found.transform
    if how is None:
        return False
    if isinstance(wanted, str):
        return how.text.replace(" ", "") == wanted.replace(" ", "")
    return (
        how.kind == "affine"
        and _near(how.scale, wanted["scale"])
        and _near(how.offset, wanted["offset"])
    )


def _near(found: float | None, wanted: float) -> bool:
    """Equal up to the digits with which a person writes a number down."""
    return found is not None and abs(found - wanted) <= 1e-6 * max(1.0, abs(wanted))


def _of_missing(entry: Entry, left: Iterable[Comparison]) -> str:
    wrongs = [differences(entry, one) for one in left if _place(one) == (entry.file, entry.line)]
    if not wrongs:
        return str(entry)
    return f"{entry}, but found with {', '.join(min(wrongs, key=len))}"


def _of_false(found: Comparison, expectation: Expectation) -> str:
    reasons = [entry.why for entry in expectation.absent if _is_at(entry, found)]
    text = f"{found.file}:{found.lineno} {found.type} '{found.source}' {found.relation}"
    return f"{text} ({reasons[0]})" if reasons else text
