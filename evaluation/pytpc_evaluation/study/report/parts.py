"""Parts of the study whose treatments are judged together."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Part:
    """The treatments of one half, from a round on; ``name`` for files, ``title`` for people."""

    name: str
    title: str
    half: str
    since: int = 1

    def has(self, half: str, number: int) -> bool:
        """Whether a treatment of this half and this round is in it."""
        return half == self.half and number >= self.since


SECOND_ROUND = Part("second-round", "second round alone", "held-back", 2)


def parts_of(halves: Sequence[str], rounds: Iterable[tuple[str, int]]) -> list[Part]:
    """The halves that are shown; behind the one that is held back its second round.

    Args:
        halves: by name.
        rounds: half and round of what was flown; without a second round there is no part of it.
    """
    found: list[Part] = []
    has_second = any(SECOND_ROUND.has(*one) for one in rounds)
    for half in halves:
        found.append(Part(half, f"{half} half", half))
        if half == SECOND_ROUND.half and has_second:
            found.append(SECOND_ROUND)
    return found
