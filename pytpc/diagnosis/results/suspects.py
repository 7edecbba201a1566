"""The parameters that a diagnosis suspects.

`MarkRanking` and `Suspect` are the thesis's ranking at one mark, by scores. `Blame` and `Accused`
are the judgement of all marks together, with probabilities.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeAlias, TypeVar

from pytpc.base.wording import listed, percent
from pytpc.diagnosis.results.differences import CodeComparison, Difference
from pytpc.diagnosis.results.turn_groups import NAMED, SuspectGroup, group_of
from pytpc.recording.marks import Mark, MarkType
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import ByParameter, same_parameter

Named = TypeVar("Named", "Suspect", "Suspected")


class Evaluation(NamedTuple):
    """One reported evaluation, or the last one of a summary."""

    time_ns: int
    result: bool
    cmp: float
    thresh: float
    res: bool
    node: str


class _Compared:
    """What is compared somewhere."""

    __slots__ = ()
    comparison: Comparison

    @property
    def place(self) -> str:
        """Where it is compared: ``file:line``."""
        return f"{self.comparison.file}:{self.comparison.lineno}"

    @property
    def condition(self) -> str:
        """The source code there; empty if it is not known."""
        return (self.comparison.source_code or "").strip()


@dataclass(frozen=True, slots=True)
class Suspect(_Compared):
    """A parameter at a mark.

    ``position`` counts from 1; ``tied`` parameters share one. ``key`` and ``comparison`` are its
    most suspicious TPC, ``score`` is that TPC's score by the formula of ``type``. Suspects are
    ordered by ``rank``: the parameter's rank among all parameters, or a combination of both ranks
    if the type is not believed. ``keys`` are all TPCs of the parameter in the log. ``last`` is the
    TPC's last evaluation up to the mark. ``rank1`` and ``rank2`` are the parameter's ranks by type
    I and by type II; 0 without such a score.
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

    ``parameters`` is the number of parameters that were ranked. If there is not ``enough`` evidence
    for the order, or for any suspect, ``reason`` says why.
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

    def only(self, parameter: str) -> MarkRanking:
        """The same with the one suspect, at its position; with none where it is not suspected."""
        return replace(self, suspects=_meant(self.suspects, parameter))

    def with_first(self, parameters: Collection[str]) -> MarkRanking:
        """The same with what these names can mean before all others, each counted anew."""
        named = ByParameter(self.suspects, lambda one: one.parameter)
        first = {one.parameter for name in parameters for one in named.meant(name)}
        groups: tuple[list[Suspect], list[Suspect]] = ([], [])
        for one in self.suspects:
            groups[one.parameter not in first].append(one)
        ordered: list[Suspect] = []
        for group in groups:
            before, alike = len(ordered), Counter(one.position for one in group)
            for place, one in enumerate(group):
                same = place > 0 and group[place - 1].position == one.position
                position = ordered[-1].position if same else before + place + 1
                ordered.append(replace(one, position=position, tied=alike[one.position] > 1))
        return replace(self, suspects=tuple(ordered))

    def suspect_of(self, parameter: str) -> Suspect | None:
        """The most suspicious of what ``parameter`` can mean, see `same_parameter`."""
        same = (s for s in self.suspects if same_parameter(parameter, s.parameter))
        return next(same, None)


def _meant(suspects: tuple[Named, ...], parameter: str) -> tuple[Named, ...]:
    """Those of exactly this name, else all that it can mean."""
    exact = tuple(one for one in suspects if one.parameter == parameter)
    return exact or tuple(one for one in suspects if same_parameter(parameter, one.parameter))


SURE = 0.8
"""A parameter of at least this probability is accused. From 0.5 on it is likelier than all others
together, but then one accusation in seven of the study's tuning half was wrong."""


WORTH = 0.01
"""Suspects that are less likely are counted in one line of a table for people."""


@dataclass(frozen=True, slots=True)
class Followed:
    """Comparisons of other nodes that turned after a suspect's, as messages lead to them.

    ``text`` is the path over the nodes. The suspect's comparison turned ``turned_s`` after the log
    began, and the last one on the path ``after_s`` later.
    """

    text: str
    turned_s: float
    after_s: float

    @property
    def sentence(self) -> str:
        """The evidence in one line."""
        return f"turned at {self.turned_s:.1f} s, and {self.after_s:.1f} s later: {self.text}"


@dataclass(frozen=True, slots=True)
class Accused(_Compared):
    """A parameter and the probability that it is to blame, by all marks of a mission.

    ``position`` counts from 1; ``tied`` parameters share one. ``type`` is the likelier type of
    error if it is this parameter. ``key`` and ``comparison`` decided, ``last`` is their last
    evaluation up to the last mark. ``followed`` is what other nodes did after it turned.
    """

    position: int
    tied: bool
    parameter: str
    probability: float
    type: MarkType
    key: str
    comparison: Comparison
    last: Evaluation
    followed: tuple[Followed, ...] = ()


@dataclass(frozen=True, slots=True)
class Uncompared:
    """A parameter that no comparison of the mission reports, and that differs from good runs.

    ``position``, ``tied`` and ``probability`` are as in `Accused`; there is no type of error, no
    ``key`` and ``condition``, and nobody ``followed``.
    """

    position: int
    tied: bool
    probability: float
    difference: Difference
    type: None = None
    key: None = None
    followed: tuple[Followed, ...] = ()
    condition: str = ""

    @property
    def parameter(self) -> str:
        """What an answer calls it."""
        return self.difference.name

    @property
    def place(self) -> str:
        """What is known of where it acts, in words."""
        return self.difference.effect


Suspected: TypeAlias = "Accused | Uncompared"
"""A parameter that all marks of a mission suspect."""


@dataclass(frozen=True, slots=True)
class Blame:
    """The judgement of all marks of a mission: the suspects, the likeliest first.

    They are all compared parameters, and what differs from good runs and no comparison reports.
    ``none`` is the probability that it is none of them; ``parameters`` counts those that are
    compared anywhere in the code. ``notes`` say what keeps the judgement from being surer. ``code``
    compares the code with that of the good runs; None if it is not known. ``groups`` are the
    suspects that turn as one.
    """

    suspects: tuple[Suspected, ...]
    none: float
    parameters: int
    marks: tuple[Mark, ...]
    notes: tuple[str, ...]
    code: CodeComparison | None = None
    groups: tuple[SuspectGroup, ...] = ()

    @property
    def confidence(self) -> float:
        """The probability of the first suspect; 0 without a suspect."""
        return self.suspects[0].probability if self.suspects else 0.0

    @property
    def accused(self) -> str | None:
        """The parameter that is sure enough to be blamed, if there is one.

        Nobody is blamed of whom no comparison says what it did.
        """
        sure = self.confidence >= SURE and isinstance(self.suspects[0], Accused)
        return self.suspects[0].parameter if sure else None

    @property
    def blamed_group(self) -> SuspectGroup | None:
        """The group of the first suspect if it is sure enough that it is one of these."""
        if not self.suspects or self.accused is not None:
            return None
        group = group_of(self.groups, self.suspects[0].parameter)
        return group if group is not None and group.probability >= SURE else None

    @property
    def text(self) -> str:
        """The judgement in one line."""
        if not self.suspects:
            return "not enough evidence to suspect any parameter"
        first = self.suspects[0]
        name, sure = first.parameter, percent(first.probability)
        if self.accused is not None:
            return f"blame {name}: {sure}; none of the parameters: {percent(self.none)}"
        group = self.blamed_group
        if group is not None:
            members = listed(group.parameters, NAMED)
            return (
                f"blame one of {members}: {percent(group.probability)}, as they"
                f" {group.turning.text}; none of the parameters: {percent(self.none)}"
            )
        if self.none > first.probability:
            return (
                f"not sure: most likely none of the parameters ({percent(self.none)};"
                f" {self.else_cause}), then {name} ({sure})"
            )
        silent = ", and no comparison reports it" if isinstance(first, Uncompared) else ""
        return (
            f"not sure: {name} is likeliest ({sure}){silent}; none of the parameters:"
            f" {percent(self.none)}"
        )

    @property
    def else_cause(self) -> str:
        """What it may be if it is none of the parameters."""
        if self.code is None:
            return "perhaps a fault in the code"
        if self.code.is_same:
            return f"{self.code.line}, so perhaps something around the robot"
        return f"perhaps a fault in the code: {self.code.line}"

    def only(self, parameter: str) -> Blame:
        """The same with the one suspect, at its position; with none where it is not suspected."""
        return replace(self, suspects=_meant(self.suspects, parameter))

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
