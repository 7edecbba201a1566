"""The parameters that a diagnosis suspects: at one mark, and by all marks together."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

from pytpc.base.wording import percent
from pytpc.recording.marks import Mark, MarkType
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import same_parameter


class Evaluation(NamedTuple):
    """One evaluation, as it was reported, or the last of a summary."""

    time_ns: int
    result: bool
    cmp: float
    thresh: float
    res: bool
    node: str


@dataclass(frozen=True, slots=True)
class Suspect:
    """A parameter at a mark.

    ``position`` counts from 1; parameters between which nothing decides are ``tied`` and have the
    same one. ``key`` and ``comparison`` are its most suspicious TPC, ``score`` that one's score by
    the formula of ``type``. ``rank`` is what they are ordered by: the parameter's rank
    among all parameters, or what is made of both where the type is not believed. ``keys`` are all
    TPCs of the parameter that the log has. ``last`` is the TPC's last evaluation up to the mark.
    ``rank1`` and ``rank2`` are the parameter's ranks by type I and by type II, 0 where it has no
    such score.
    """

    position: int
    parameter: str
    key: str
    comparison: Comparison
    type: MarkType
    score: float
    rank: float
    keys: tuple[str, ...]
    last: Evaluation
    tied: bool = False
    rank1: float = 0.0
    rank2: float = 0.0


@dataclass(frozen=True, slots=True)
class MarkRanking:
    """The suspects at one mark, most suspicious first; parameters without a score are not here.

    ``parameters`` is the number of parameters among which they were ranked. Where there is not
    ``enough`` evidence to go by the order, or for any at all, ``reason`` says why; else it is
    empty.
    """

    mark: Mark
    suspects: tuple[Suspect, ...]
    parameters: int
    enough: bool = True
    reason: str = ""

    def position_of(self, parameter: str) -> int | None:
        """The position of a parameter, None where it has no score at this mark."""
        found = self.suspect_of(parameter)
        return None if found is None else found.position

    def suspect_of(self, parameter: str) -> Suspect | None:
        """The most suspicious of what ``parameter`` can mean, see `same_parameter`."""
        same = (s for s in self.suspects if same_parameter(parameter, s.parameter))
        return next(same, None)


SURE = 0.5
"""A parameter with at least this probability is accused: all others together are less likely."""


@dataclass(frozen=True, slots=True)
class Accused:
    """A parameter and the probability that it is to blame.

    ``position`` counts from 1; ``tied`` parameters have the same one. ``type`` is the likelier kind
    of error if it is this parameter: I, the robot did what it should not, or II, it does not do
    what it should. ``key`` and ``comparison`` are those that decide, ``last`` its last evaluation
    up to the last mark.
    """

    position: int
    tied: bool
    parameter: str
    probability: float
    type: MarkType
    key: str
    comparison: Comparison
    last: Evaluation


@dataclass(frozen=True, slots=True)
class Blame:
    """All parameters that were compared, the likeliest first.

    ``none`` is the probability that it is none of the parameters, ``parameters`` how many there
    are, ``marks`` from which it was worked out. ``notes`` say what keeps it from being surer.
    """

    suspects: tuple[Accused, ...]
    none: float
    parameters: int
    marks: tuple[Mark, ...]
    notes: tuple[str, ...]

    @property
    def confidence(self) -> float:
        """The probability of the first suspect; 0 without a suspect."""
        return self.suspects[0].probability if self.suspects else 0.0

    @property
    def accused(self) -> str | None:
        """The parameter that is likelier than all others together; None if there is none."""
        return self.suspects[0].parameter if self.confidence >= SURE else None

    @property
    def text(self) -> str:
        """The verdict in one line."""
        if not self.suspects:
            return "not enough evidence to suspect anybody"
        first = self.suspects[0]
        name, sure = first.parameter, percent(first.probability)
        if self.accused is not None:
            return f"blame {name}: {sure}; none of the parameters: {percent(self.none)}"
        if self.none > first.probability:
            return (
                f"not sure: none of the parameters is likeliest ({percent(self.none)}; a fault in "
                f"the code is none of them), then {name} ({sure})"
            )
        return (
            f"not sure: {name} is likeliest ({sure}); none of the parameters: {percent(self.none)}"
        )

    def only(self, parameter: str) -> Blame:
        """The same with the one suspect, at its position; with none where it is not suspected."""
        exact = [one for one in self.suspects if one.parameter == parameter]
        same = [one for one in self.suspects if same_parameter(parameter, one.parameter)]
        return replace(self, suspects=tuple(exact or same))

    @property
    def title(self) -> str:
        """Which marks they are: ``All 5 marks together: 1 of type I, 4 of type II``."""
        count = len(self.marks)
        observers = len({mark.observer for mark in self.marks})
        by = f" of {observers} observers" if observers > 1 else ""
        which = f"All {count} marks{by} together" if count > 1 else "The one mark"
        kinds = [mark.type for mark in self.marks]
        named: tuple[tuple[MarkType | None, str], ...]
        named = (("I", "of type I"), ("II", "of type II"), (None, "without a type"))
        said = [f"{kinds.count(kind)} {words}" for kind, words in named if kind in kinds]
        return f"{which}: {', '.join(said)}"
