"""Chains of suggestions for the missions of the study, and the shares that come of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pytpc.advice.known import Source
from pytpc.advice.remedy import EVERY_SOURCE

SUSPECTS = "suspects"
VARIANTS: Mapping[str, frozenset[Source] | None] = {
    "smallest": None,
    "lasting": frozenset(),
    "with-default": frozenset({"default", "declared"}),
    "with-reference": EVERY_SOURCE,
    SUSPECTS: frozenset(),
}
"""The known values that each may take; None for the smallest change."""
MOST_TRIES = {"lasting": 3, SUSPECTS: 3}


@dataclass(frozen=True)
class Try:
    """A value that was asked for, and what came of it.

    ``gone`` and ``new_error`` are None until it is flown, ``reason`` are the errors that were seen
    then. Where nothing was suggested ``value`` is None, and ``reason`` says why.
    """

    parameter: str
    node: str | None
    value: float | None
    basis: str | None
    gone: bool | None = None
    new_error: bool | None = None
    reason: str = ""

    @property
    def is_open(self) -> bool:
        """Whether it is to be flown."""
        return self.value is not None and self.new_error is None


@dataclass
class Chain:
    """The tries of one variant for one mission.

    ``old`` and ``new`` are values of the changed parameter; ``order`` are the first suspects, empty
    of variants that are told the changed one.
    """

    system: str
    treatment: str
    type: str
    half: str
    seed: int
    variant: str
    old: float
    new: float
    order: tuple[str, ...] = ()
    tries: list[Try] = field(default_factory=list)

    @property
    def mission(self) -> str:
        """Its folder below ``missions`` and ``suggested``."""
        return f"{self.system}/{self.treatment}/seed-{self.seed}"

    @property
    def is_over(self) -> bool:
        """Whether it has what it wants, or has tried often enough."""
        if not self.tries:
            return False
        last = self.tries[-1]
        if last.is_open:
            return False
        if len(self.tries) >= MOST_TRIES.get(self.variant, 1):
            return True
        if last.value is None:
            # The next suspect may have a value.
            return self.variant != SUSPECTS or not last.parameter
        return last.gone is not False

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Chain:
        """The chain of an object in ``CHAINS_FILE``."""
        tries = [Try(**one) for one in document["tries"]]
        return cls(**{**document, "order": tuple(document["order"]), "tries": tries})


@dataclass(frozen=True, slots=True)
class Share:
    """Of how many treatments of a variant the error was gone within so many tries, and a new one.

    ``gone`` and ``new_error`` are shares of ``treatments``: means over them of the means over their
    seeds, None of no treatment. A new error counts where the last of these tries has one. ``open``
    chains are left out.
    """

    variant: str
    tries: int
    treatments: int
    gone: float | None
    new_error: float | None
    open: int


def shares(chains: Sequence[Chain]) -> list[Share]:
    """What came of each variant, by the number of tries; where no error was seen there is none."""
    found = []
    for variant in VARIANTS:
        for most in range(1, MOST_TRIES.get(variant, 1) + 1):
            rows: dict[tuple[str, str], list[tuple[bool, bool]]] = {}
            waiting = 0
            for chain in (one for one in chains if one.variant == variant):
                tries = chain.tries[:most]
                if any(one.is_open for one in tries) or not (chain.is_over or len(tries) == most):
                    waiting += 1
                elif any(one.gone is not None or one.value is None for one in tries):
                    came = (tries[-1].gone is True, tries[-1].new_error is True)
                    rows.setdefault((chain.system, chain.treatment), []).append(came)
            if rows or waiting:
                means = [np.mean(one, axis=0) for one in rows.values()]
                gone, new = np.mean(means, axis=0).tolist() if rows else (None, None)
                found.append(Share(variant, most, len(rows), gone, new, waiting))
    return found
