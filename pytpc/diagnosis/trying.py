"""What tries of values say about the suspects, and which change to try next.

A person, or a simulator, flies one changed value after the other and says what came of it. Each
such verdict is evidence about the parameter: its probability is multiplied by how much likelier the
verdict is if that parameter is to blame, and all are made to sum to 1 again with "none of them".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeVar, get_args

from pytpc.base.wording import Number, percent, show, tidy
from pytpc.diagnosis.results.advice import Basis
from pytpc.diagnosis.results.suspects import SURE, WORTH
from pytpc.diagnosis.suggestion.wanted_value import between
from pytpc.diagnosis.thresholds.intervals import Interval
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark

Verdict = Literal["better", "same", "worse", "other", "fixed"]
"""What came of a try: the error is seldomer; as before; worse; gone, but another one came; gone."""

VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
STILL_THERE: frozenset[Verdict] = frozenset(("better", "same", "worse"))
"""The verdicts after which the error is still there, so that the mission's marks are about it."""

TAKEN_BACK: frozenset[Verdict] = frozenset(("same", "worse", "other"))
"""The verdicts after which the old value is set again."""

KNOWN_GOOD: frozenset[Basis] = frozenset(("reference", "before", "default", "declared"))
"""Whose values have worked, or were meant to: of a good run, from before a change, and defaults."""

SAME = 0.25
"""The log alone finds a value that is enough for about three of four wrong parameters (the tuning
half and the held-back half of the study), so an error that stays as it was is a fourth as likely if
it is this parameter."""

SAME_WITH_A_GOOD_VALUE = 0.02
"""The robot worked with that value. A small rest: another parameter may have to change with it."""

BETTER = 3.0
"""Another value of a wrong parameter helps; of any other it does so only by chance, as runs differ.
A person who says "better" has seen the difference, so that is a third as likely."""

OTHER = 4.0
"""The error is gone: more than better. It is no proof, as the new error may have hidden it."""

WORSE = 0.5
"""The parameter acts on the error, but in this direction it is not to be cured: one of two is left
of the ways in which it may be wrong."""

UNSEEN = 1e-3
"""The probability of a parameter in a mission that did not compare it, or that gave it less: the
error was there all the same, but one mission is not to rule a parameter out for good."""

REACH = 10.0
"""Within this factor of a known value a person would try a value without asking, as
`pytpc.diagnosis.suggestion.plausible` has it. Values that were tried are not known to be good:
several steps must not lead further than one."""

FEWER = 0.5
"""A mission with fewer than this share of the marks is better; chance alone seldom halves them."""

CERTAIN = 6
"""So many marks of two missions in all, of one type before and of the other after it, are about
another error. People confuse the types, as often as a coin does those of type II (thesis, table
6.13): with five marks one of 16 would be so by chance, with six one of 32."""

MOST_TRIES = 3
"""Tries of a conversation, unless a person wants more: as many as the study's chains have."""

Item = TypeVar("Item")
_ROUNDING = 1e-9
_ACTS: frozenset[Verdict | None] = frozenset(("better", "other"))


@dataclass(frozen=True, slots=True)
class Try:
    """A value of a parameter that was tried in place of ``old``; without a verdict it is open.

    ``parameter`` is what the suspect is called, ``basis`` the evidence for the value.
    """

    parameter: str
    old: Number
    new: Number
    basis: Basis | None
    verdict: Verdict | None = None

    @property
    def factor(self) -> float:
        """How much likelier the verdict is if the parameter is to blame."""
        if self.verdict == "same":
            return SAME_WITH_A_GOOD_VALUE if self.basis in KNOWN_GOOD else SAME
        return {"better": BETTER, "other": OTHER, "worse": WORSE}.get(self.verdict or "", 1.0)


class Odds(NamedTuple):
    """The probability of each suspect, and that it is none of them; together they are 1."""

    suspects: Mapping[str, float]
    none: float

    @property
    def ordered(self) -> list[tuple[str, float]]:
        """The suspects, the likeliest first; those that are as likely keep their order."""
        return sorted(self.suspects.items(), key=lambda one: -one[1])


def mean_of(missions: Sequence[Odds]) -> Odds:
    """What several missions with the same error say together: the mean of the log probabilities.

    They are about one robot, so they are not independent, and a product would be too sure. The
    suspects are those of the first mission, of which the question is.
    """
    first, *others = missions
    if not others:
        return first
    suspects = {
        name: _geometric([one.suspects.get(name, 0.0) for one in missions])
        for name in first.suspects
    }
    return _summing_to_1(suspects, _geometric([one.none for one in missions]))


def after_tries(odds: Odds, tries: Sequence[Try]) -> Odds:
    """The probabilities after tries of some suspects."""
    suspects = dict(odds.suspects)
    for one in tries:
        if one.parameter in suspects:
            suspects[one.parameter] *= one.factor
    return _summing_to_1(suspects, odds.none)


def why_over(odds: Odds, tries: Sequence[Try], most: int, *, go_on: bool = False) -> str:
    """Why nothing more is to be tried; empty while there is something.

    As sure as an accusation has to be, it is none of them; but a value that acted on the error is
    followed up, however likely that is.

    Args:
        odds: after the tries.
        tries: those with a verdict.
        most: how many there may be.
        go_on: also if it is likely none of them.
    """
    if not tries:
        return ""
    if odds.none >= SURE and tries[-1].verdict not in _ACTS and not go_on:
        return f"it is now likely that it is none of the parameters ({percent(odds.none)})"
    if len(tries) >= most:
        return f"{most} {'try is' if most == 1 else 'tries are'} used up"
    return ""


def next_proposals(odds: Odds, value_of: Callable[[str], Item | None]) -> Iterator[Item]:
    """What to try next, the likeliest suspect first; those without a value are passed over.

    A suspect below `WORTH` is not worth a mission. ``value_of`` is asked only as far as needed.
    """
    for name, probability in odds.ordered:
        found = value_of(name) if probability >= WORTH else None
        if found is not None:
            yield found


@dataclass(frozen=True, slots=True)
class Search:
    """Where the next value of a parameter may be, after tries of it.

    ``base`` is the value with which the error was seen, ``up`` the direction of the last try. The
    error was still there at ``near``, and at ``far``, if that is known, another one came.
    ``still`` are all values at which the error was still there, in their order. ``helped`` says
    that the last of them made it better.
    """

    base: float
    up: bool
    near: float
    far: float | None
    closed: frozenset[bool]
    tried: frozenset[float]
    still: tuple[float, ...]
    helped: bool

    def allows(self, value: Number) -> bool:
        """Whether a value is news: further than what did not help, nearer than what was too much.

        The other direction is tried only after this one has made the error worse.
        """
        number = float(value)
        up = number > self.base
        if number in self.tried or up in self.closed:
            return False
        if up != self.up:
            return self.up in self.closed
        low, high = sorted((self.near, self._far))
        return low < number < high

    @property
    def _far(self) -> float:
        if self.far is not None:
            return self.far
        return math.inf if self.up else -math.inf

    @property
    def goes_further(self) -> bool:
        """Whether the next value is beyond all that were tried in this direction."""
        return self.far is None and self.up not in self.closed

    def between(self, *, whole: bool) -> Number | None:
        """A value between the last that did not help and the first that was too much."""
        if self.far is None:
            return None
        low, high = sorted((self.near, self.far))
        return self._if_allowed(between(Interval(low, high)), whole)

    def onward(self, *, whole: bool) -> Number | None:
        """As far again as the step that helped; by its factor if no value is 0, as ``between``."""
        if not (self.helped and self.goes_further):
            return None
        step = self.near / self.base if self.near * self.base > 0 else 0.0
        value = self.near * step if step else 2 * self.near - self.base
        return self._if_allowed(float(f"{value:.3g}"), whole)

    def _if_allowed(self, value: float, whole: bool) -> Number | None:
        number: Number = round(value) if whole else float(tidy(value))
        return number if self.allows(number) else None


def search_of(tries: Sequence[Try]) -> Search | None:
    """Where the next value may be after these tries of one parameter; None for a switch.

    A switch has only two values. All tries have a verdict, and there is at least one.
    """
    if any(isinstance(one.old, bool) or isinstance(one.new, bool) for one in tries):
        return None
    base = float(tries[0].old)
    up = tries[-1].new > base
    side = [one for one in tries if (one.new > base) == up]
    far = [abs(float(one.new) - base) for one in side if one.verdict == "other"]
    limit = min(far, default=math.inf)
    helped_not = [float(one.new) for one in side if one.verdict in STILL_THERE]
    near = [abs(value - base) for value in helped_not if abs(value - base) < limit]
    sign = 1.0 if up else -1.0
    closed = frozenset(one.new > base for one in tries if one.verdict == "worse")
    still = (base, *(float(one.new) for one in tries if one.verdict in STILL_THERE))
    return Search(
        base,
        up,
        base + sign * max(near, default=0.0),
        base + sign * limit if far else None,
        closed,
        frozenset((base, *(float(one.new) for one in tries))),
        still,
        tries[-1].verdict == "better",
    )


def beyond(
    value: Number, known: Collection[float], declared: Declared | None, doubt: str = ""
) -> str:
    """Why a value leaves the known range, so that nobody tries it unasked; empty if it does not.

    Args:
        value: the one to try.
        known: the value with which the error was seen, and those that are known to be good.
        declared: the parameter's declaration, if there is one.
        doubt: what the suggestion itself says against it.
    """
    if isinstance(value, bool):
        return ""
    if declared is not None and not Interval.closed(declared.low, declared.high).holds(value):
        ends = (show(end) if end is not None else "" for end in (declared.low, declared.high))
        return f"outside of the declared range {'..'.join(ends)}"
    return "" if value in known else doubt or _too_far(value, known)


def _too_far(value: Number, known: Collection[float]) -> str:
    """Why a value is too far from those that are known; empty if it is not."""
    sizes = [abs(one) for one in known if one * value > 0 and math.isfinite(one)]
    if value and any(known) and not sizes:
        return "a value of another sign than all that are known"
    factor = min((max(abs(value) / one, one / abs(value)) for one in sizes), default=1.0)
    if factor > REACH * (1 + _ROUNDING):
        return f"a factor of {show(float(f'{factor:.3g}'))} from what is known"
    return ""


def judged(before: Sequence[Mark], after: Sequence[Mark]) -> Verdict:
    """What the marks of a mission say about a try, where nobody else does.

    Args:
        before: the marks of the mission before it; at least one.
        after: those of the mission with the tried value.
    """
    if not after:
        return "fixed"
    if len(after) < FEWER * len(before):
        return "better"
    one, other = (min(marks, key=Mark.order).where for marks in (before, after))
    types = [{mark.type for mark in marks} for marks in (before, after)]
    turned = types in ([{"I"}, {"II"}], [{"II"}, {"I"}]) and len(before) + len(after) >= CERTAIN
    return "other" if one != other or turned else "same"


def _geometric(values: Sequence[float]) -> float:
    return math.exp(sum(math.log(max(value, UNSEEN)) for value in values) / len(values))


def _summing_to_1(suspects: Mapping[str, float], none: float) -> Odds:
    whole = sum(suspects.values()) + none
    if not whole:
        return Odds(suspects, none)
    return Odds({name: value / whole for name, value in suspects.items()}, none / whole)
