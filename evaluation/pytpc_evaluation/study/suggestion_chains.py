"""Chains of suggestions for the missions of the study, and the shares that come of them.

They are kept in ``results/suggestion-chains.json``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from pytpc.diagnosis.question import EVERY_SOURCE, Source
from pytpc_evaluation.study.listed import read_list
from pytpc_evaluation.study.plan import Half, Setting, setting_label

CHAINS_FILE = Path("results") / "suggestion-chains.json"
HEADLINE = "lasting"
"""What is shown of the tool: nothing in it knows the value before the treatment."""
SUSPECTS = "suspects"
RANKED = "ranked"
RANKED_REFERENCE = "ranked-reference"
FIX_RUNS: Mapping[str, int] = {"fix": 0, "fix-2-runs": 2}
"""Variants that are conversations of ``pytpc fix``, and beside how many good runs each asks."""
VARIANTS: Mapping[str, frozenset[Source] | None] = {
    "smallest": None,
    "lasting": frozenset(),
    "with-default": frozenset({"default", "declared"}),
    "with-reference": EVERY_SOURCE,
    RANKED: frozenset(),
    RANKED_REFERENCE: EVERY_SOURCE,
    SUSPECTS: frozenset(),
    **dict.fromkeys(FIX_RUNS, EVERY_SOURCE),
}
"""The known values that each may take; None for the smallest change."""
MOST_TRIES = {"lasting": 3, SUSPECTS: 3, **dict.fromkeys(FIX_RUNS, 3)}


@dataclass(frozen=True)
class Try:
    """A value that was asked for, and its result.

    ``gone`` and ``new_error`` are None until it is flown, ``reason`` are the errors that were seen
    then. Where nothing was suggested ``value`` is None, and ``reason`` says why. Where the flight
    ``failed`` too often nothing is known of a new error, and the one of before counts as not gone.
    ``fix`` is the try of a conversation (`FixTry.to_json`).
    """

    parameter: str
    node: str | None
    value: float | None
    basis: str | None
    gone: bool | None = None
    new_error: bool | None = None
    reason: str = ""
    failed: bool = False
    fix: Mapping[str, Any] | None = None

    @property
    def is_open(self) -> bool:
        """Whether it is to be flown."""
        return self.value is not None and self.new_error is None and not self.failed

    @property
    def is_flown(self) -> bool:
        """Whether it is known what came of it."""
        return self.value is not None and self.new_error is not None

    @property
    def setting(self) -> Setting:
        """What it sets; it has a value."""
        assert self.value is not None, "what is flown has a value"
        return Setting(self.parameter, self.node or "", self.value)

    @property
    def verdict(self) -> str | None:
        """What the observer of a conversation said of it."""
        return None if self.fix is None else self.fix["verdict"]


@dataclass
class Chain:
    """The tries of one variant for one mission.

    ``old`` and ``new`` are values of the changed parameter; ``order`` are the first suspects, empty
    of variants that are told the changed one. ``digest`` is that of the mission from which the
    values are (`Done.digest`). ``observer`` is whose marks a conversation is about.
    """

    system: str
    treatment: str
    type: str
    half: Half
    seed: int
    variant: str
    old: float
    new: float
    order: tuple[str, ...] = ()
    tries: list[Try] = field(default_factory=list)
    digest: str = ""
    observer: str = ""

    @property
    def mission(self) -> str:
        """Its folder below ``missions`` and ``suggested``."""
        return f"{self.system}/{self.treatment}/seed-{self.seed}"

    def settings(self, place: int = -1) -> tuple[Setting, ...]:
        """What is set in the flight of a try: its own value last, before it what stays set."""
        own = self.tries[place].setting
        stay = (one.setting for one in self.tries[:place] if one.verdict == "better")
        kept = {one.parameter: one for one in stay if one.parameter != own.parameter}
        return (*kept.values(), own)

    def flown(self, place: int = -1) -> str:
        """The folder of the flight of a try."""
        return f"suggested/{self.mission}/{setting_label(self.settings(place))}"

    @property
    def is_over(self) -> bool:
        """Whether it has what it wants, or has tried often enough."""
        if not self.tries or self.tries[-1].is_open:
            return False
        last = self.tries[-1]
        if len(self.tries) >= MOST_TRIES.get(self.variant, 1):
            return True
        if last.value is None or last.failed:
            # There is no log from which to go on; the next suspect does not need it.
            return self.variant != SUSPECTS or not last.parameter
        # What the observer of a conversation saw, right or not, ends it.
        return last.gone is not False if last.fix is None else last.verdict == "fixed"

    def is_done(self, most: int) -> bool:
        """Whether nothing of its first ``most`` tries is still to be flown."""
        tries = self.tries[:most]
        return not any(one.is_open for one in tries) and (self.is_over or len(tries) == most)

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Chain:
        """The chain of an object in ``CHAINS_FILE``."""
        tries = [Try(**one) for one in document["tries"]]
        return cls(**{**document, "order": tuple(document["order"]), "tries": tries})


def load_chains(path: Path) -> list[Chain]:
    """All chains; none where there is no such file.

    Raises:
        InputError: the file cannot be read, or is not of chains.
    """
    return read_list(path, Chain.from_json, "not chains of suggestions")


class Outcome(NamedTuple):
    """What came of a chain within so many tries; a new error counts if it is of the last one.

    Only a conversation may go on after the error was gone, since its observer marked something.
    """

    unit: tuple[str, str]
    gone: bool
    new_error: bool


def outcomes(chains: Iterable[Chain], variant: str, most: int) -> tuple[list[Outcome], int]:
    """What came of a variant within ``most`` tries, and how many of its chains wait for flights.

    Where no error was seen in the treated mission, nothing could come of it.
    """
    found, waiting = [], 0
    for chain in (one for one in chains if one.variant == variant):
        tries = chain.tries[:most]
        if not chain.is_done(most):
            waiting += 1
        elif any(one.gone is not None or one.value is None for one in tries):
            unit = (chain.system, chain.treatment)
            gone = any(one.gone is True for one in tries)
            found.append(Outcome(unit, gone, tries[-1].new_error is True))
    return found, waiting


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
            came, waiting = outcomes(chains, variant, most)
            for one in came:
                rows.setdefault(one.unit, []).append((one.gone, one.new_error))
            if rows or waiting:
                means = [np.mean(one, axis=0) for one in rows.values()]
                gone, new = np.mean(means, axis=0).tolist() if rows else (None, None)
                found.append(Share(variant, most, len(rows), gone, new, waiting))
    return found
