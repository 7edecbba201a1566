"""Suggestions of SPEC 8: raise or lower a parameter, and to which value.

Type I: the smallest change of the threshold with which the last flop up to the mark would not have
happened: the evaluation that flopped and the one before it would both have had the earlier outcome.
Type II: the smallest change with which at least one evaluation in the window before the mark would
have gone the other way. Both are half-lines of thresholds, ended by compared values that the log
has, so that nothing is searched for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pytpc.advice.thresholds import (
    Affine,
    HalfLine,
    Unit,
    nearest,
    outcomes,
    readable,
    thresholds_for,
)
from pytpc.arithmetic import Expression
from pytpc.events import Bools, Events, Floats, Int64s
from pytpc.marks import MarkType
from pytpc.parameters import parameter_name
from pytpc.scoring.scores import WINDOW_S
from pytpc.static_info import Comparison, LinkUnit
from pytpc.summaries import Summaries
from pytpc.words import Number, exact, show

_WHOLE_TYPES = frozenset(
    f"{sign}{name}"
    for sign in ("", "unsigned ", "signed ")
    for name in ("char", "short", "int", "long", "long long")
)
_FLOAT_TYPES = frozenset({"float", "double", "long double"})


@dataclass(frozen=True, slots=True)
class Suggestion:
    """What to do with one parameter.

    ``current`` and ``value`` are in the parameter's unit: a bool for a switch, an int for a
    whole-number parameter. ``boundary`` ends the values that would do, and is one of them where
    ``inclusive``. ``text`` is the sentence to show. Where nothing can be suggested ``direction``,
    ``value`` and ``boundary`` are None and ``reason`` says why.
    """

    parameter: str
    current: Number | None
    direction: Literal["raise", "lower", "switch"] | None
    value: Number | None
    boundary: float | None
    inclusive: bool
    text: str
    reason: str | None


@dataclass(frozen=True, slots=True)
class _Case:
    """What a suggestion is worked out from: the evaluations up to the mark, and the unit."""

    comparison: Comparison
    how: Unit
    whole: bool
    threshold: float
    cmp: Floats
    thresh: Floats

    @property
    def current(self) -> Number:
        return _number(self.how.back(self.threshold), self.whole)


@dataclass(frozen=True, slots=True)
class _Kept:
    """What summaries say of the evaluations in a window: those at the ends of what each encloses.

    The outermost values are all that type II asks for. ``threshold`` is the last one up to the
    mark, in the summary that ends at ``last_ns``. A summary that straddles an end of the window is
    taken where none lies within it, for its evaluations need not.
    """

    cmp: Floats
    thresh: Floats
    threshold: float
    last_ns: int

    @classmethod
    def of(
        cls, summaries: Summaries | None, key: str, mark_ns: int, window_s: float
    ) -> _Kept | None:
        """None where there are none of ``key`` before the mark."""
        if summaries is None or key not in summaries.keys:
            return None
        begins = mark_ns - round(window_s * 1e9)
        own = summaries.take(summaries.key == summaries.keys.index(key))
        own = own.take(own.begin_ns <= mark_ns)
        if not len(own):
            return None
        last = int(np.argmax(own.end_ns))
        threshold, last_ns = float(own.thresh[last]), int(own.end_ns[last])
        within = own.take((own.begin_ns >= begins) & (own.end_ns <= mark_ns))
        if not len(within):
            within = own.take(own.end_ns >= begins)
        ends = [within.thresh + within.diff_min, within.thresh + within.diff_max]
        return cls(
            np.concatenate([*ends, within.cmp]), np.tile(within.thresh, 3), threshold, last_ns
        )


class _NoneBecause(Exception):
    """Why there is no suggestion."""


def suggest(
    events: Events,
    comparison: Comparison,
    mark_ns: int,
    kind: MarkType,
    *,
    unit: LinkUnit | None = None,
    window_s: float = WINDOW_S,
    summaries: Summaries | None = None,
) -> Suggestion:
    """The suggestion for the parameter of one TPC at a mark.

    Args:
        events: the evaluations of the mission.
        comparison: the TPC; its ``key`` is looked up in ``events``.
        mark_ns: the time of the mark in nanoseconds.
        kind: the type of error.
        unit: the TPC's link unit, for the C++ type of the parameter.
        window_s: the window of type II in seconds.
        summaries: what the policy ``edges`` kept of the evaluations that are no events.
    """
    current: Number | None = None
    try:
        _refuse(comparison, unit)
        rows = _rows_up_to(events, comparison.key, mark_ns)
        kept = _Kept.of(summaries, comparison.key, mark_ns, window_s)
        threshold = float(events.thresh[rows[-1]])
        if kept is not None and kept.last_ns >= events.time_ns[rows[-1]]:
            threshold = kept.threshold
        if not math.isfinite(threshold):
            raise _NoneBecause("the threshold is not a finite number")
        how = _unit_of(comparison, threshold)
        seen = events.thresh[rows]
        if isinstance(how, Affine):
            seen = (seen - how.offset) / how.scale
        else:
            seen = np.array([how.back(threshold)])
        whole = is_whole(comparison, unit, seen)
        pair, window = _evaluations(events, rows, mark_ns, kind, window_s)
        used = window if kind == "II" else pair
        cmp, thresh = events.cmp[used], events.thresh[used]
        if kind == "II" and kept is not None:
            cmp, thresh = np.append(kept.cmp, cmp), np.append(kept.thresh, thresh)
        if kind == "II" and not cmp.size:
            raise _NoneBecause("it was not evaluated in the window before the mark")
        case = _Case(comparison, how, whole, threshold, cmp, thresh)
        current = _shown_current(case)
        if comparison.relation == "flag":
            return _switch(case, kind)
        if comparison.relation in {"==", "!="}:
            if kept is not None and not isinstance(comparison.default, bool):
                raise _NoneBecause("summaries do not tell which values came near to the threshold")
            return _equality(case, kind)
        return _suggestion(case, _first_type(case) if kind == "I" else _second_type(case))
    except _NoneBecause as why:
        reason = str(why)
        name = parameter_name(comparison)
        return Suggestion(name, current, None, None, None, False, reason, reason)


def is_whole(comparison: Comparison, unit: LinkUnit | None, values: Floats) -> bool:
    """Whether a parameter takes whole numbers only.

    The C++ type of the read decides; where that is not known, a default that is an int together
    with ``values`` (float64[n], seen of the parameter) that are all whole but for rounding.
    """
    read_type = _read_type(comparison, unit)
    if read_type in _WHOLE_TYPES:
        return True
    if read_type in _FLOAT_TYPES:
        return False
    finite = values[np.isfinite(values)]
    return type(comparison.default) is int and bool(
        np.allclose(finite, np.round(finite), rtol=1e-9, atol=1e-9)
    )


def _read_type(comparison: Comparison, unit: LinkUnit | None) -> str | None:
    """The C++ type of the read, where the link unit is known."""
    place = comparison.read_at
    for read in unit.parameters if unit is not None else ():
        if read.name == comparison.source and (
            place is not None and (read.file, read.lineno) == (place.file, place.lineno)
        ):
            return read.type
    return None


def _refuse(comparison: Comparison, unit: LinkUnit | None) -> None:
    if comparison.type == "constant":
        raise _NoneBecause("the threshold is a constant in the source, not a parameter")
    read_type = _read_type(comparison, unit) or ""
    if isinstance(comparison.default, str) or read_type.startswith("std::"):
        raise _NoneBecause("the parameter is text")


def _unit_of(comparison: Comparison, threshold: float) -> Unit:
    transform = comparison.transform
    if transform is None:
        return Affine()
    if transform.tree is not None:
        default = comparison.default
        anchor = None if default is None or isinstance(default, str) else float(default)
        found = Expression(transform.tree, threshold, anchor)
        if found.current is None:
            raise _NoneBecause(f"no value of the parameter gives the threshold {transform.text}")
        return found
    if transform.kind != "affine" or transform.scale is None or transform.offset is None:
        raise _NoneBecause(f"the threshold is computed from the parameter: {transform.text}")
    if transform.scale == 0:
        raise _NoneBecause("the parameter is multiplied by 0")
    return Affine(float(transform.scale), float(transform.offset))


def _rows_up_to(events: Events, key: str, mark_ns: int) -> Int64s:
    if key in events.keys:
        rows = events.by_key.rows(events.keys.index(key))
        last = int(np.searchsorted(events.time_ns[rows], mark_ns, side="right"))
        if last:
            return rows[:last]
    raise _NoneBecause("it was not evaluated before the mark")


def _evaluations(
    events: Events, rows: Int64s, mark_ns: int, kind: MarkType, window_s: float
) -> tuple[Int64s, Int64s]:
    """The rows of the last flop's two evaluations (earlier first), and those of the window."""
    if kind == "II":
        begin = mark_ns - round(window_s * 1e9)
        window = rows[int(np.searchsorted(events.time_ns[rows], begin, side="left")) :]
        return window[:0], window
    flops = rows[events.flop[rows]]
    if not flops.size:
        raise _NoneBecause("its result did not change before the mark")
    return np.array([events.previous[flops[-1]], flops[-1]], dtype=np.int64), rows[:0]


def _first_type(case: _Case) -> HalfLine:
    """The thresholds with which both evaluations of the flop have the outcome of the earlier."""
    before, after = outcomes(case.comparison.relation, case.cmp, case.thresh).tolist()
    if before == after:
        raise _NoneBecause("another comparison of the same condition changed, not this one")
    lines = [
        thresholds_for(case.comparison.relation, float(cmp), before)
        for cmp in case.cmp
        if not math.isnan(cmp)
    ]
    if math.isnan(case.cmp[1]):
        raise _NoneBecause("the compared value was not a number")
    furthest = max if lines[0].up else min
    line = furthest(lines, key=lambda one: one.bound)
    if line.holds(case.threshold):
        raise _NoneBecause("the threshold has changed since, and would do as it is now")
    return line


def _second_type(case: _Case) -> HalfLine:
    """The nearest thresholds with which one evaluation of the window has its other outcome."""
    name = case.comparison.relation
    went, cmps = _still(case)
    lines = []
    for outcome in (True, False):
        some = cmps[went == outcome]
        if some.size:
            up = thresholds_for(name, 0.0, not outcome).up
            lines.append(thresholds_for(name, float(some.min() if up else some.max()), not outcome))
    lines.sort(key=lambda line: _change(case, line))
    if len(lines) == 2 and _change(case, lines[0]) == _change(case, lines[1]):
        last = bool(went[-1])
        return next(line for line in lines if line.up == thresholds_for(name, 0.0, not last).up)
    return lines[0]


def _still(case: _Case) -> tuple[Bools, Floats]:
    """Outcomes and compared values of those that the present threshold would let go as they did."""
    finite = np.isfinite(case.cmp)
    cmps = case.cmp[finite]
    if not cmps.size:
        raise _NoneBecause("the compared value was not a finite number")
    went = outcomes(case.comparison.relation, cmps, case.thresh[finite])
    now = outcomes(case.comparison.relation, cmps, np.full_like(cmps, case.threshold))
    if not np.any(went == now):
        raise _NoneBecause("the threshold has changed since, and would do as it is now")
    return went[went == now], cmps[went == now]


def _change(case: _Case, line: HalfLine) -> float:
    value = nearest(line, case.how, case.whole)
    return math.inf if value is None else abs(value - case.how.back(case.threshold))


def _suggestion(case: _Case, line: HalfLine) -> Suggestion:
    first = nearest(line, case.how, case.whole)
    if first is None:
        if isinstance(case.how, Affine):
            raise _NoneBecause("no finite threshold would change the outcome")
        raise _NoneBecause("no value of the parameter near this one gives such a threshold")
    mine = case.how.parameters(line)
    assert mine is not None, "there is a nearest one"
    current = case.how.back(case.threshold)
    value = first if case.whole else readable(line, case.how, first, current)
    direction: Literal["raise", "lower"] = "raise" if mine.up else "lower"
    return _sentence(case, direction, _number(value, case.whole), mine)


def _equality(case: _Case, kind: MarkType) -> Suggestion:
    """``==`` and ``!=`` have a nearest value only where a window never met the threshold."""
    if kind == "I":
        raise _NoneBecause("the comparison is for equality, which no direction leads away from")
    if isinstance(case.comparison.default, bool) and case.comparison.type == "parameter":
        return _switched(case, not case.threshold)
    went, cmps = _still(case)
    if np.any(went == (case.comparison.relation == "==")):
        raise _NoneBecause(f"any value but {show(case.current)} would do")
    met = float(cmps[np.argmin(np.abs(cmps - case.threshold))])
    value = case.how.back(met)
    if case.how.forward(value) != met or (case.whole and value != round(value)):
        raise _NoneBecause("no value of the parameter gives the compared value exactly")
    up = value > case.how.back(case.threshold)
    line = HalfLine(value, True, up)
    return _sentence(case, "raise" if up else "lower", _number(value, case.whole), line, "exactly")


def _switch(case: _Case, kind: MarkType) -> Suggestion:
    """A flag: the value before it changed (type I), or the other one (type II).

    A number is one in a condition of its own, or in a switch, of which any two values may differ.
    """
    truth = _is_truth(case)
    now = case.threshold
    if kind == "I":
        other = float(case.thresh[0])
        if other == case.thresh[1]:
            raise _NoneBecause("another comparison of the same condition changed, not the flag")
        if other == now:
            raise _NoneBecause("the flag has changed back since")
    elif case.comparison.type == "derived":
        raise _NoneBecause("the parameter chooses between cases, of which nothing more is known")
    else:
        other = 0.0 if now else 1.0
    return _switched(case, bool(other) if truth else _number(case.how.back(other), case.whole))


def _switched(case: _Case, value: Number) -> Suggestion:
    source, current = parameter_name(case.comparison), _shown_current(case)
    text = f"switch {source} from {show(current)} to {show(value)}"
    return Suggestion(source, current, "switch", value, float(value), True, text, None)


def _is_truth(case: _Case) -> bool:
    found = case.comparison
    unknown = found.type == "flag" and found.default is None
    return unknown or isinstance(found.default, bool)


def _shown_current(case: _Case) -> Number:
    return bool(case.threshold) if _is_truth(case) else case.current


def _sentence(
    case: _Case,
    direction: Literal["raise", "lower"],
    value: Number,
    line: HalfLine,
    bound: str | None = None,
) -> Suggestion:
    source = parameter_name(case.comparison)
    limit = f"{bound} {line.bound:.6g}" if bound else line.words()
    text = f"{direction} {source} from {show(case.current)} to {exact(value)} ({limit})"
    return Suggestion(
        source, case.current, direction, value, line.bound, line.inclusive, text, None
    )


def _number(value: float, whole: bool) -> Number:
    return round(value) if whole else value
