"""The value of a parameter to try by one comparison: what lasts, as far as a person would go."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pytpc.diagnosis.results.advice import Basis, KnownValue
from pytpc.diagnosis.suggestion.choice import choose
from pytpc.diagnosis.suggestion.lasting import Lasting
from pytpc.diagnosis.suggestion.plausible import NO_DOUBT, NOBODY, Doubt, ParameterKind
from pytpc.diagnosis.suggestion.suggestion_case import SuggestionCase
from pytpc.diagnosis.thresholds.intervals import Interval, Intervals, holds
from pytpc.diagnosis.thresholds.replay import Track


@dataclass(frozen=True, slots=True)
class Wanted:
    """A comparison, the values of the parameter that would last, and those that do the least."""

    track: Track
    case: SuggestionCase
    found: Lasting
    lasting: Intervals
    least: Intervals
    kind: ParameterKind

    @property
    def rises(self) -> bool:
        """Whether the nearest value that would do is above the present one."""
        ends = [
            part.first() if part.first() > self.case.present else part.last() for part in self.least
        ]
        return min(ends, key=lambda end: abs(end - self.case.present)) > self.case.present


def value_to_try(
    wanted: Wanted,
    known: Sequence[KnownValue],
    within: Interval,
    stops: Callable[[float], bool],
) -> tuple[float | None, Basis, Doubt]:
    """The value inside ``within`` with the best evidence, if there is one, and which evidence.

    A known value that would stop everything comes after a lasting one that would not.
    """
    enough = wanted.least if wanted.found.ground == "growth" else wanted.lasting
    fits = [one for one in known if within.holds(one.value) and holds(enough, one.value)]
    first = next((one for one in fits if not stops(one.value)), None)
    if first is not None:
        return first.value, first.source, NO_DOUBT
    found = _by_evaluations(wanted, within)
    if fits and (found[0] is None or stops(found[0])):
        return fits[0].value, fits[0].source, NO_DOUBT
    return found


def _by_evaluations(wanted: Wanted, within: Interval) -> tuple[float | None, Basis, Doubt]:
    """The same by the log alone."""
    case, found, lasts, least = wanted.case, wanted.found, wanted.lasting, wanted.least
    possible = case.possible
    basis: Basis = "growth" if found.ground == "growth" else "lasting"
    chosen = choose(lasts, case.present, possible, wanted.kind, up_first=found.up)
    if isinstance(chosen, str):
        # Nothing that lasts is in the parameter's range: take the end of the range, if that helps.
        ends = (possible.interval.high, possible.interval.low)
        beyond = [end for end in ends if math.isfinite(end) and holds(least, end)]
        if not beyond:
            return None, "lasting", NO_DOUBT
        value = min(beyond, key=lambda end: abs(end - case.present))
        doubt = wanted.kind.doubt(value)
    else:
        value, doubt = chosen.value, chosen.doubt
    if doubt.grade == NOBODY or doubt.what == "zero" or (doubt.words and basis == "growth"):
        value, doubt = _nearer(wanted, value, doubt)
    if not within.holds(value):
        middle = between(within)
        value = float(round(middle)) if possible.whole else middle
        return (value if within.holds(value) else None), "between", NO_DOUBT
    return (None if doubt.grade == NOBODY else value), basis, doubt


def _nearer(wanted: Wanted, value: float, doubt: Doubt) -> tuple[float, Doubt]:
    """A value that lasts less surely, but that a person would try; else the same again.

    It is as far towards the ``value`` as is usual, if that would do at least once, else the
    smallest change.
    """
    kind, case = wanted.kind, wanted.case
    end = kind.furthest(up=wanted.rises)
    end = None if end is None else case.possible.toward(end, case.present)
    if end is not None and holds(wanted.least, end) and kind.doubt(end) == NO_DOUBT:
        return end, NO_DOUBT
    smallest = choose(wanted.least, case.present, case.possible, kind, up_first=wanted.found.up)
    if isinstance(smallest, str) or smallest.doubt.grade > doubt.grade:
        return value, doubt
    return smallest.value, smallest.doubt


def between(within: Interval) -> float:
    """The geometric mean of two values of one sign, else the arithmetic one; three digits."""
    low, high = within.low, within.high
    mean = (low + high) / 2
    if low * high > 0:
        mean = math.copysign(math.sqrt(low * high), low)
    short = float(f"{mean:.3g}")
    return short if within.holds(short) else mean
