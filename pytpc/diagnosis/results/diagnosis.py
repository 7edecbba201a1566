"""The answer about a mission: which parameter, which way, and to which value.

Every output shows this one object: the page, ``rank``, ``suggest``, ``watch``, the library.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from pytpc.base.wording import listed, many, percent
from pytpc.diagnosis.results.advice import BlamedAdvice
from pytpc.diagnosis.results.differences import Difference, RunDifferences
from pytpc.diagnosis.results.suspects import WORTH, Blame, Suspected
from pytpc.diagnosis.results.turn_groups import NAMED, SuspectGroup, group_of

_NAMED = 3


@dataclass(frozen=True)
class Diagnosis:
    """What all marks of a mission say together, and what to do.

    ``blame`` has all suspects with their probabilities. ``advice`` is the value to try of each of
    the first ones. ``differences`` are the parameters that differ from good runs; None if no good
    run was given.
    """

    blame: Blame
    advice: tuple[BlamedAdvice, ...]
    differences: RunDifferences | None = None

    @property
    def accused(self) -> str | None:
        """The parameter to blame; None where it is not sure (a probability below one half).

        Nor is a parameter accused of which the log only says that another value would stop all
        that it decides: that answers any complaint about an action.
        """
        return None if self._only_stops else self.blame.accused

    @property
    def _only_stops(self) -> bool:
        if not self.advice or self.blame.accused is None:
            return False
        return _only_stops(self.advice[0])

    def _all_only_stop(self, group: SuspectGroup) -> bool:
        """The same of all members of a group that have an advice."""
        members = [one for one in self.advice if one.accused.parameter in group.parameters]
        return bool(members) and all(map(_only_stops, members))

    @property
    def confidence(self) -> float:
        """The probability of the first suspect."""
        return self.blame.confidence

    @property
    def is_none_likeliest(self) -> bool:
        """Whether "none of the parameters" is likelier than each, and no group is blamed."""
        found = self.blame
        return found.none > found.confidence and found.blamed_group is None

    @cached_property
    def shown(self) -> tuple[BlamedAdvice, ...]:
        """The first suspects that are likely enough to be listed.

        Without good runs there is always one. With them, what kept its value is not listed: then
        none of the parameters is the likeliest.
        """
        likely = tuple(one for one in self.advice if one.accused.probability >= WORTH)
        if likely or (self.differences is not None and self.is_none_likeliest):
            return likely
        return self.advice[:1]

    @cached_property
    def groups(self) -> tuple[SuspectGroup, ...]:
        """The groups of which at least two members are listed."""
        names = {one.accused.parameter for one in self.shown}
        return tuple(one for one in self.blame.groups if len(names & {*one.parameters}) > 1)

    @cached_property
    def by_group(self) -> tuple[tuple[BlamedAdvice, ...], ...]:
        """What is listed: each suspect with those that turn as one with it, the likeliest first."""
        found: dict[str, list[BlamedAdvice]] = {}
        for one in self.shown:
            group = group_of(self.groups, one.accused.parameter)
            first = one.accused.parameter if group is None else group.parameters[0]
            found.setdefault(first, []).append(one)
        return tuple(map(tuple, found.values()))

    @property
    def folded(self) -> tuple[Suspected, ...]:
        """The suspects that are only counted."""
        listed_here = {one.accused.parameter for one in self.shown}
        return tuple(one for one in self.blame.suspects if one.parameter not in listed_here)

    @property
    def to_try(self) -> BlamedAdvice | None:
        """What to try first; None where "none of the parameters" is likelier than any of them."""
        if self.is_none_likeliest or not self.shown:
            return None
        return self.shown[0]

    @property
    def next_suspects(self) -> tuple[BlamedAdvice, ...]:
        """The suspects behind the first one."""
        return self.shown[1:]

    @property
    def unreported(self) -> tuple[Difference, ...]:
        """The parameters that differ from good runs and that no comparison reports."""
        return () if self.differences is None else self.differences.unreported

    @cached_property
    def headline(self) -> str:
        """The verdict in one sentence, without a full stop."""
        found = self.blame
        if self.accused is not None:
            return found.text
        if self._only_stops:
            first = found.suspects[0]
            return (
                f"not sure: {first.parameter} is likeliest ({percent(first.probability)}), but the"
                " log only shows that another value would stop all that it decides"
            )
        group = found.blamed_group
        if group is not None and self._all_only_stop(group):
            return (
                f"not sure: {listed(group.parameters, NAMED)} are likeliest"
                f" ({percent(group.probability)} together), but the log only shows that another"
                " value would stop all that they decide"
            )
        if not found.suspects and self.unreported:
            return f"not sure: {self._silent}"
        return found.text

    @property
    def _silent(self) -> str:
        """What differs and is not reported, as a clause."""
        silent = listed([one.change for one in self.unreported], _NAMED)
        verb = "differs" if len(self.unreported) == 1 else "differ"
        return (
            f"{silent} {verb} from the good run, and no comparison reports {_it(self.unreported)}"
        )

    @property
    def action(self) -> str:
        """What to try, in one sentence without a full stop; empty if nothing is suggested."""
        first = self.to_try
        return "" if first is None or first.remedy.value is None else first.remedy.text

    @property
    def folded_text(self) -> str:
        """``12 more parameters, 9 of them below 1 %``; empty if none is."""
        if not self.folded:
            return ""
        unlikely = sum(one.probability < WORTH for one in self.folded)
        every = many(len(self.folded), "more parameter" if self.shown else "compared parameter")
        if not unlikely:
            return every
        of = "" if unlikely == len(self.folded) else f", {unlikely:,} of them"
        return f"{every}{of} below {percent(WORTH)}"


def _it(found: tuple[Difference, ...]) -> str:
    return "it" if len(found) == 1 else "them"


def _only_stops(one: BlamedAdvice) -> bool:
    return one.stops and one.remedy.basis not in {"reference", "before"}
