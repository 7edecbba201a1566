"""Parts of the study whose treatments are judged together."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Part:
    """Treatments of one half, of all rounds or one; ``name`` for files, ``title`` for people."""

    name: str
    title: str
    half: str
    round: int | None = None

    def has(self, half: str, number: int) -> bool:
        """Whether a treatment of this half and this round is in it."""
        return half == self.half and self.round in {None, number}


SECOND_ROUND = Part("second-round", "second round alone", "held-back", 2)
THIRD_ROUND = Part("third-round", "third round alone", "held-back", 3)


def parts_of(halves: Sequence[str], rounds: Iterable[tuple[str, int]]) -> list[Part]:
    """The halves that are shown; behind the one that is held back its later rounds.

    Args:
        halves: by name.
        rounds: half and round of what was flown; without a later round there is no part of it.
    """
    known = list(rounds)
    found: list[Part] = []
    for half in halves:
        found.append(Part(half, f"{half} half", half))
        for later in (SECOND_ROUND, THIRD_ROUND):
            if half == later.half and any(later.has(*one) for one in known):
                found.append(later)
    return found
