"""The study's conclusion in a few sentences, from its own tables; nothing is worked out here."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from pytpc_evaluation.study.report.judged import HELD_BACK
from pytpc_evaluation.study.report.parts import SECOND_ROUND, THIRD_ROUND
from pytpc_evaluation.study.report.ranked import (
    BASELINE,
    BESIDE_CLEAN,
    CHANCE,
    CHANCE_OF_DIFFERENT,
    OURS,
    TURNED,
)
from pytpc_evaluation.tables import Table

_LABELS = "confused"
"""What a user has: types as people say them."""


def conclusion(tables: Mapping[str, Table]) -> str:
    """A few sentences; empty where a number that they need is missing."""
    try:
        one = _observer(tables, HELD_BACK)
        four = _shares(tables, HELD_BACK, "all users")
        last = next(
            part for part in (THIRD_ROUND, SECOND_ROUND) if f"observer-{part.name}" in tables
        )
        unseen = _observer(tables, last.name)
        return "\n".join(
            (
                "One person who watches the robot and marks its errors gets the changed parameter"
                f" among the first three in {one('tpc')} % of the held-back treatments that they"
                f" mark, from the log of that mission alone, in {one('tpc+2-runs')} % with two good"
                f" runs of other settings, and in {one(BESIDE_CLEAN)} % with a good run that is"
                " its twin.",
                f"The thesis's ranking has {one(BASELINE)} %; without the defaults in the code it"
                f" is {one('tpc-log')} % from the log alone.",
                f"With four people's marks it is {four(OURS)} % from the log alone; chance finds"
                f" {four(CHANCE)} % among all parameters and {four(CHANCE_OF_DIFFERENT)} % among"
                " those that differ from the good run, and counting which of these would have"
                f" turned most recorded decisions {four(TURNED)} %.",
                f"Of the treatments of the {last.title}, which nobody had seen ranked before, one"
                f" person gets {unseen('tpc')} % from the log alone and {unseen('tpc+2-runs')} %"
                f" with two good runs; the thesis's ranking has {unseen(BASELINE)} %.",
            )
        )
    except (KeyError, StopIteration):
        return ""


def _observer(tables: Mapping[str, Table], part: str) -> Callable[[str], str]:
    """The share of a method in the top 3 by one observer, of the missions that they marked.

    Raises:
        KeyError: there is no such part; and, when called, no such method.
    """
    table = tables[f"observer-{part}"]
    place = [column.heading for column in table.columns].index("Top 3 %")
    shares = {name: str(row[place]) for name, row in table.rows}

    def share(method: str) -> str:
        if shares[method] == "-":
            raise KeyError(method)
        return shares[method].split(" ")[0]

    return share


def _shares(tables: Mapping[str, Table], part: str, users: str) -> Callable[[str], str]:
    """The share of a method in the top 3, from confused marks of so many users.

    Raises:
        KeyError: there is no such part or number of users; and, when called, no such method.
    """
    table = tables[f"users-{part}"]
    cells = {(name, row[0]): row for name, row in table.rows}[users, _LABELS]
    shares = dict(zip((column.heading for column in table.columns), cells, strict=True))

    def share(method: str) -> str:
        if shares[method] == "-":
            raise KeyError(method)
        return str(shares[method]).split(" ")[0]

    return share
