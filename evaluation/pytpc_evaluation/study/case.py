"""What a method is given of a mission, and what it answers: all methods of the study have this API.

Everything that may be seen is in a ``Case``; the treatment is not.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.static.static_info import StaticInfo


@dataclass(frozen=True)
class Case:
    """A mission and what is known beside it.

    ``recording`` has the marks, with types or without. ``reference`` is a good run, None where
    there is none. ``changes`` are in the order in which they were made, empty where unknown.
    ``good`` are good runs with other settings. ``placed`` are the marks with what the observers say
    of where it was wrong.
    """

    recording: Recording
    static_info: StaticInfo
    reference: Recording | None = None
    changes: tuple[Change, ...] = ()
    good: tuple[Recording, ...] = ()
    placed: tuple[Mark, ...] = ()

    @property
    def with_places(self) -> Recording:
        """The mission with marks that say where."""
        return replace(self.recording, marks=self.placed)

    @property
    def references(self) -> tuple[Recording, ...]:
        """The good run, if there is one."""
        return () if self.reference is None else (self.reference,)


@dataclass(frozen=True)
class Verdict:
    """Whom a method suspects.

    ``order`` are parameters (names as in `pytpc.diagnosis.scores.score_tables.Tpcs.names`), the
    most suspicious first; all others are tied behind them. ``confidence`` is the probability that
    the first one is to blame, and ``none`` that it is none of them; nan where a method has none.
    ``scores`` are those by which the order was made: equal ones are tied; empty where no two are.
    """

    order: tuple[str, ...]
    confidence: float = math.nan
    scores: tuple[float, ...] = ()
    none: float = math.nan

    def __post_init__(self) -> None:
        """Check that there is a score for each or for none.

        Raises:
            ValueError: there is not.
        """
        if self.scores and len(self.scores) != len(self.order):
            raise ValueError(f"{len(self.scores)} scores for {len(self.order)} parameters")


Method = Callable[[Case], Verdict]
