"""The smallest change of a parameter (docs/reference/scores.md#the-smallest-change).

Type I: the smallest change of the threshold that prevents the last flop up to the mark. The
evaluation that flopped and the one before it would both have had the earlier outcome.
Type II: the smallest change with which at least one evaluation in the window before the mark would
have gone the other way. Both are sets of thresholds that end at compared values of the log. The
arithmetic of the comparison turns them into sets of values of the parameter, from which one is
chosen that the parameter can take.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pytpc.base.wording import Number, exact, show
from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.results.advice import Direction, Suggestion
from pytpc.diagnosis.suggestion.choice import WHOLE, Choice, choose
from pytpc.diagnosis.suggestion.kinds_by_name import is_check
from pytpc.diagnosis.suggestion.known_values import kind_of
from pytpc.diagnosis.suggestion.overruled import overruling
from pytpc.diagnosis.suggestion.plausible import NOBODY, ParameterKind
from pytpc.diagnosis.suggestion.suggestion_case import (
    EQUALITIES,
    NoneBecauseError,
    SuggestionCase,
    case_of,
    evidence_of,
    is_truth,
    refuse,
    shown_current,
    values_for,
)
from pytpc.diagnosis.thresholds.intervals import (
    Interval,
    Intervals,
    gaps,
    holds,
    intersection,
    union,
    words,
)
from pytpc.diagnosis.thresholds.threshold_sets import outcomes, thresholds_for, thresholds_for_one
from pytpc.diagnosis.thresholds.units import NoUnitError
from pytpc.recording.declaration import Declared
from pytpc.recording.events import Bools, Floats
from pytpc.recording.marks import MarkType
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import parameter_name
from pytpc.static.static_info import StaticInfo


class At(NamedTuple):
    """The time of a mark, and its assumed type of error."""

    time_ns: int
    kind: MarkType


def smallest_change(
    recording: Recording,
    static_info: StaticInfo,
    comparison: Comparison,
    at: At,
    question: Question = PLAIN,
) -> Suggestion:
    """The suggestion for the parameter of one TPC at a mark.

    Args:
        recording: the mission.
        static_info: what the analysis found.
        comparison: the TPC, one of ``static_info``.
        at: the mark.
        question: its ``window_s``, and its ``sources`` and ``reference`` for what is usual;
            ``declared`` has at most the one of this parameter.
    """
    unit, kind = static_info.unit_of(comparison.key), at.kind
    declared = question.declaration
    current: Number | None = None
    feasible: Intervals = ()
    try:
        refuse(comparison, unit)
        evidence = evidence_of(recording, comparison.key, at.time_ns, kind, question.window_s)
        case = case_of(comparison, unit, evidence, declared)
        current = shown_current(case)
        if comparison.relation == "flag":
            if kind == "II":
                _refuse_overruled(case, recording, static_info, at, question)
            return _switch(case, kind)
        if is_truth(case) and comparison.relation in EQUALITIES and kind == "II":
            return _switched(case, not case.threshold)
        feasible = values_for(case, _first_type(case) if kind == "I" else _second_type(case))
        usual = kind_of(case, recording, static_info, question)
        return replace(_chosen(case, feasible, kind, usual), feasible=feasible)
    except (NoneBecauseError, NoUnitError) as why:
        reason = str(why)
        name = parameter_name(comparison)
        return Suggestion(name, current, None, None, None, False, reason, reason, feasible)


def smallest_change_for_most(
    recording: Recording,
    static_info: StaticInfo,
    comparisons: Sequence[Comparison],
    marks: Sequence[At],
    question: Question = PLAIN,
) -> tuple[Suggestion, str]:
    """The suggestion that would do at the most marks, and the key of its comparison.

    Args:
        recording: the mission.
        static_info: what the analysis found.
        comparisons: those of one parameter, at least one.
        marks: at least one.
        question: as for ``smallest_change``.
    """
    found = [
        (smallest_change(recording, static_info, comparison, at, question), comparison.key)
        for comparison in comparisons
        for at in marks
    ]
    best, most = found[0], 0
    for one in found:
        value = one[0].value
        if value is None:
            continue
        count = sum(holds(other.feasible, float(value)) for other, _ in found)
        if count > most:
            best, most = one, count
    return best


def _first_type(case: SuggestionCase) -> Intervals:
    """The thresholds with which both evaluations of the flop have the outcome of the earlier."""
    evidence = case.evidence
    before, after = outcomes(case.relation, evidence.cmp, evidence.thresh).tolist()
    if before == after:
        raise NoneBecauseError("another comparison of the same condition changed, not this one")
    earlier, later = (thresholds_for(case.relation, cmp, before) for cmp in evidence.cmp.tolist())
    if not later:
        if math.isnan(evidence.cmp[1]):
            raise NoneBecauseError("the compared value was not a number")
        raise NoneBecauseError("no finite threshold would change the outcome")
    both = intersection(earlier, later)
    if holds(both, case.threshold):
        raise NoneBecauseError("the threshold has changed since; its present value would do")
    if not both and case.relation in EQUALITIES:
        raise NoneBecauseError("no value is equal to both compared values of the last change")
    return both


def _second_type(case: SuggestionCase) -> Intervals:
    """The thresholds with which one evaluation of the window has its other outcome."""
    went, cmps = _still(case)
    if case.evidence.summed and case.relation in EQUALITIES:
        raise NoneBecauseError("summaries do not tell which values came near to the threshold")
    return union(
        interval
        for outcome in (True, False)
        for interval in thresholds_for_one(
            case.relation, cmps[went == outcome], not outcome, case.threshold
        )
    )


def _still(case: SuggestionCase) -> tuple[Bools, Floats]:
    """Outcomes and compared values of the evaluations that the present threshold keeps."""
    evidence = case.evidence
    finite = np.isfinite(evidence.cmp)
    cmps = evidence.cmp[finite]
    if not cmps.size:
        raise NoneBecauseError("the compared value was not a finite number")
    went = outcomes(case.relation, cmps, evidence.thresh[finite])
    same = went == outcomes(case.relation, cmps, case.threshold)
    if not np.any(same):
        raise NoneBecauseError("the threshold has changed since; its present value would do")
    return went[same], cmps[same]


def _chosen(
    case: SuggestionCase, feasible: Intervals, kind: MarkType, usual: ParameterKind
) -> Suggestion:
    declared = case.possible.declared
    if declared is not None and declared.choices:
        return _choice_of(case, feasible, declared)
    if case.relation in EQUALITIES and _is_everything_else(feasible, case):
        others = " and ".join(part.words().removeprefix("exactly ") for part in gaps(feasible))
        raise NoneBecauseError(f"any value but {others} would do")
    up_first = True
    if kind == "II" and case.relation not in EQUALITIES:
        up_first = _turns_upwards(case)
    found = choose(feasible, case.present, case.possible, usual, up_first=up_first)
    if isinstance(found, str):
        raise NoneBecauseError(found)
    if found.doubt.grade == NOBODY:
        raise NoneBecauseError(f"{found.doubt.text}: {words((found.interval,))}")
    return _sentence(case, found)


def _is_everything_else(feasible: Intervals, case: SuggestionCase) -> bool:
    """Whether the values on both sides of the present one would do."""
    gaps = [math.nextafter(case.present, end) for end in (-math.inf, math.inf)]
    return all(holds(feasible, gap) for gap in gaps)


def _turns_upwards(case: SuggestionCase) -> bool:
    """Whether higher values of the parameter turn the last outcome of the window."""
    went, cmps = _still(case)
    last = thresholds_for(case.relation, float(cmps[-1]), not bool(went[-1]))
    values = case.how.parameters(last)
    return any(part.first() > case.present for part in values)


def _choice_of(case: SuggestionCase, feasible: Intervals, declared: Declared) -> Suggestion:
    """One of the values of an enumeration."""
    numbers = {
        value: name
        for name, value in declared.choices
        if not isinstance(value, str) and holds(feasible, float(value))
    }
    if not numbers:
        names = _names(declared, tuple(value for _, value in declared.choices))
        raise NoneBecauseError(f"none of the declared choices would do: {names}")
    if case.relation in EQUALITIES and len(numbers) > 1:
        raise NoneBecauseError(f"another choice would do: {_names(declared, tuple(numbers))}")
    value = min(numbers, key=lambda one: (abs(one - case.present), one))
    inside = next(part for part in feasible if part.holds(float(value)))
    up = float(value) > case.present
    boundary, inclusive = _boundary(inside, up)
    source = parameter_name(case.comparison)
    now, then = (_names(declared, (number,)) for number in (case.current, value))
    text = f"switch {source} from {now} to {then}"
    return Suggestion(
        source, case.current, "switch", value, boundary, inclusive, text, None,
        limited_by="declared choices",
    )  # fmt: skip


def _names(declared: Declared, values: tuple[Number | str, ...]) -> str:
    """``Drop (0), Hold (1)``."""
    names = {value: name for name, value in declared.choices}
    shown = [value if isinstance(value, str) else show(value) for value in values]
    return ", ".join(
        f"{names[value]} ({text})" if value in names else text
        for value, text in zip(values, shown, strict=True)
    )


def _switch(case: SuggestionCase, kind: MarkType) -> Suggestion:
    """A flag: the value before it changed (type I), or the other one (type II).

    A flag may be a number: in a condition by itself, or in a switch, where any two values may
    differ.
    """
    now, evidence = case.threshold, case.evidence
    if kind == "I":
        other = float(evidence.thresh[0])
        if other == evidence.thresh[1]:
            raise NoneBecauseError("another comparison of the same condition changed, not the flag")
        if other == now:
            raise NoneBecauseError("the flag has changed back since")
    elif case.comparison.type == "derived":
        raise NoneBecauseError(
            "the parameter chooses between cases, and the analysis does not know which is which"
        )
    else:
        other = 0.0 if now else 1.0
    if is_truth(case):
        return _switched(case, bool(other))
    values = case.how.parameters((Interval.point(other),))
    if not values:
        raise NoneBecauseError("no value of the parameter gives the threshold before the change")
    value = min((part.first() for part in values), key=lambda one: abs(one - case.present))
    return _switched(case, case.number(value))


def _refuse_overruled(
    case: SuggestionCase,
    recording: Recording,
    static_info: StaticInfo,
    at: At,
    question: Question,
) -> None:
    """Refuse to switch a flag that would not have decided its condition otherwise.

    Raises:
        NoneBecauseError: another comparison decided it.
    """
    span_ns = (at.time_ns - round(question.window_s * 1e9), at.time_ns)
    is_on = bool(case.threshold)
    other = overruling(recording, static_info, case.comparison, is_on, span_ns)
    if other is not None:
        said = "false" if is_on else "true"
        raise NoneBecauseError(
            f"switching it would have turned nothing: the comparison with {parameter_name(other)}"
            f" in the same condition was {said} before the mark"
        )


def _switched(case: SuggestionCase, value: Number) -> Suggestion:
    source, current = parameter_name(case.comparison), shown_current(case)
    text = f"switch {source} from {show(current)} to {show(value)}"
    if not value and not isinstance(value, bool):
        text += " (only 0 would have prevented it, which often switches a check off)"
    elif not value and is_check(source):
        text += " (only this would have prevented it; it switches the check off)"
    feasible = (Interval.point(float(value)),)
    return Suggestion(source, current, "switch", value, float(value), True, text, None, feasible)


def _boundary(inside: Interval, up: bool) -> tuple[float, bool]:
    """The end of the interval next to the present value, and whether it belongs to it."""
    return (inside.low, inside.low_inclusive) if up else (inside.high, inside.high_inclusive)


def _sentence(case: SuggestionCase, found: Choice) -> Suggestion:
    source, inside = parameter_name(case.comparison), found.interval
    up = found.value > case.present
    boundary, inclusive = _boundary(inside, up)
    direction: Direction = "raise" if up else "lower"
    value = case.number(found.value)
    text = f"{direction} {source} from {show(case.current)} to {exact(value)} ({words((inside,))})"
    if found.limited_by not in {"", WHOLE}:
        text = f"{text[:-1]}; {found.limited_by})"
    if found.doubt.text:
        text = f"{text[:-1]}; {found.doubt.text})"
    return Suggestion(
        source, case.current, direction, value, boundary, inclusive, text, None,
        limited_by=found.limited_by,
    )  # fmt: skip
