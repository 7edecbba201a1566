"""Where each method put the changed parameter: the judge's table, read."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import pyarrow as pa

from pytpc.base.columns import read_table
from pytpc.base.errors import InputError
from pytpc_evaluation.study.data import ALL
from pytpc_evaluation.study.judge import Judged
from pytpc_evaluation.study.metrics import within

_LATER = frozenset({"digest", "tied", "round", "none"})
"""Tables that were written before them do not have these columns."""


@dataclass(frozen=True, slots=True)
class Position(Judged):
    """One verdict: of a mission, by a ``method``, from the marks of ``who`` with ``labels``.

    ``position`` counts from 1, with ties at the mean of their places; None where no parameter was
    changed, or there was no mark.
    """

    @property
    def changed(self) -> bool:
        """Whether a parameter was changed, which a method could find."""
        return self.type in {"type1", "type2"}

    @property
    def users(self) -> int | None:
        """How many users marked it; None for all of them."""
        return None if self.who == ALL else self.who.count("+") + 1

    def within(self, k: int) -> float:
        """Whether the changed parameter is among the first k, a share where it is tied.

        Without a mark it is not.
        """
        if self.marks == 0 or self.position is None:
            return 0.0
        return within(k, self.position, self.tied)

    @property
    def place(self) -> float:
        """The position; the middle of all places where nothing is known."""
        known = self.marks > 0 and self.position is not None
        return float(self.position or 0) if known else (self.parameters + 1) / 2

    @property
    def rank(self) -> float:
        """1 for the first, and 1/n for the last of n (docs/reference/scores.md#rank)."""
        return 1.0 - (self.place - 1.0) / self.parameters if self.parameters else 0.0


def read_positions(path: Path) -> list[Position]:
    """Read the table, sorted.

    Raises:
        InputError: the file cannot be read, or a column is missing.
    """
    names = [field.name for field in fields(Position)]

    def rows(table: pa.Table) -> list[Position]:
        there = [name for name in names if name in table.column_names]
        missing = [name for name in names if name not in there and name not in _LATER]
        if missing:
            raise InputError(f"no column {missing[0]}")
        found = [Position(**_known(row)) for row in table.select(there).to_pylist()]
        return sorted(found, key=lambda p: (p.system, p.type, p.treatment, p.seed, p.who))

    return read_table(path, "positions", rows)


def by_treatment(rows: Iterable[Position]) -> dict[tuple[str, str], list[Position]]:
    """The rows of each treatment (system, name), sorted."""
    found: dict[tuple[str, str], list[Position]] = defaultdict(list)
    for row in rows:
        found[row.system, row.treatment].append(row)
    return dict(sorted(found.items()))


def with_absent(rows: Sequence[Position]) -> list[Position]:
    """``rows``, and a miss for each user in each mission that this user alone did not mark.

    A user of one mission was beside the robot in all of them, and only verdicts from marks are in
    the table.
    """
    users = sorted({row.who for row in rows if row.users == 1})
    known = {_verdict(row, row.who) for row in rows}
    absent = [
        replace(row, who=user, position=None, confidence=None, marks=0)
        for row in rows
        for user in users
        if row.who == ALL and _verdict(row, user) not in known
    ]
    return [*rows, *absent]


def _verdict(row: Position, who: str) -> tuple[object, ...]:
    return (row.system, row.treatment, row.seed, row.labels, row.method, who)


def ordered(names: Iterable[str], first: Sequence[str]) -> list[str]:
    """Each name once: those of ``first`` in that order, then others by name."""
    found = set(names)
    return [name for name in first if name in found] + sorted(found - set(first))


def _known(row: dict[str, Any]) -> dict[str, Any]:
    """NaN is how a table says that there is no number."""
    missing = [n for n, value in row.items() if isinstance(value, float) and math.isnan(value)]
    return {**row, **dict.fromkeys(missing)}
