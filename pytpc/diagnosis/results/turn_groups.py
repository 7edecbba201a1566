"""Comparisons that turn together or one after the other, and what such a group suspects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from pytpc.base.wording import listed, many, percent

GroupKind = Literal["together", "in order"]

NAMED = 4
"""So many members are named in a sentence."""


@dataclass(frozen=True, slots=True)
class GroupMember:
    """A comparison of a group.

    ``after_s`` is how long after the first member it turned, the median in s. ``turns`` counts how
    often it turned, ``joined`` how many of these were with the others.
    """

    key: str
    node: str
    parameter: str
    after_s: float
    turns: int
    joined: int


@dataclass(frozen=True, slots=True)
class TurnGroup:
    """Comparisons that turn at the same times, in the order in which they do.

    ``kind`` is ``together`` if nothing can be said of an order. From when they turn, the members
    cannot be told apart.
    """

    kind: GroupKind
    members: tuple[GroupMember, ...]

    @property
    def parameters(self) -> tuple[str, ...]:
        """The parameters that the members compare with, each once, in their order."""
        return tuple(dict.fromkeys(one.parameter for one in self.members))

    @property
    def turns(self) -> int:
        """How often all of them turned."""
        return min(one.joined for one in self.members)

    @property
    def text(self) -> str:
        """How they turn, as the end of a sentence: ``turned together, 14 times``."""
        times = "once" if self.turns == 1 else many(self.turns, "time")
        if self.kind == "together":
            return f"turned together, {times}"
        last = self.members[-1]
        return f"turned one after the other within {last.after_s:.1f} s, {times}"


@dataclass(frozen=True, slots=True)
class SuspectGroup:
    """The suspects whose deciding comparisons turn as one, the likeliest first.

    ``probability`` is that of one of them being the cause.
    """

    parameters: tuple[str, ...]
    probability: float
    turning: TurnGroup

    @property
    def sentence(self) -> str:
        """``a, b: 62 % that it is one of them; they turned together, 14 times``."""
        return (
            f"{listed(self.parameters, NAMED)}: {percent(self.probability)} that it is one of"
            f" them; they {self.turning.text}"
        )


def group_of(groups: Sequence[SuspectGroup], parameter: str) -> SuspectGroup | None:
    """The group of a suspect; None if it is in none."""
    return next((one for one in groups if parameter in one.parameters), None)
