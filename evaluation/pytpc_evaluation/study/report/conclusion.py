"""The study's conclusion in five sentences, from its own tables; nothing is worked out here."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from pytpc_evaluation.study.report.judged import HELD_BACK
from pytpc_evaluation.study.report.parts import SECOND_ROUND
from pytpc_evaluation.study.report.ranked import (
    BASELINE,
    BESIDE_CLEAN,
    CHANCE,
    CHANCE_OF_DIFFERENT,
    OURS,
    TARGETS,
    TURNED,
)
from pytpc_evaluation.tables import Table

_LABELS = "confused"
"""What a user has: types as people say them."""


def conclusion(tables: Mapping[str, Table]) -> str:
    """Five sentences; empty where a number that they need is missing."""
    try:
        one = _shares(tables, HELD_BACK, "1 user")
        four = _shares(tables, HELD_BACK, "all users")
        unseen = _shares(tables, SECOND_ROUND.name, "all users")
        target = 100 * TARGETS[_LABELS]
        return "\n".join(
            (
                "One person who watches the robot and marks its errors gets the changed parameter"
                f" among the first three in {one(OURS)} % of the held-back treatments from the log"
                f" of that mission alone, and in {one(BESIDE_CLEAN)} % with the log of one good"
                " run beside it.",
                f"With four people's marks it is {four(OURS)} % and {four(BESIDE_CLEAN)} %; the"
                f" thesis's ranking has {one(BASELINE)} % with one person and {four(BASELINE)} %"
                " with four.",
                f"Chance finds {four(CHANCE)} % among all parameters and"
                f" {four(CHANCE_OF_DIFFERENT)} % among those that differ from the good run;"
                " counting which of these would have turned most recorded decisions finds"
                f" {four(TURNED)} %, without looking at a mark.",
                "In the second round, whose treatments nobody had seen ranked before, four people's"
                f" marks give {unseen(OURS)} % from the log alone, {unseen(BESIDE_CLEAN)} % with a"
                f" good run, {unseen(BASELINE)} % by the thesis's ranking and {unseen(TURNED)} %"
                " by counting turned decisions.",
                f"So the target of {target:.0f} % is {_said(unseen(OURS), target)} from one log"
                f" alone and {_said(unseen(BESIDE_CLEAN), target)} with a good run: record one"
                " while the robot behaves.",
            )
        )
    except KeyError:
        return ""


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


def _said(share: str, target: float) -> str:
    return "reached" if float(share) >= target else "missed"
