"""One parameter at one of its comparisons: the data from which suggestions are computed.

Turns sets of thresholds that would do into sets of values of the parameter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pytpc.base.wording import Number, show
from pytpc.diagnosis.suggestion.choice import Possible
from pytpc.diagnosis.suggestion.suggestion_evidence import NoneBecauseError, SuggestionEvidence
from pytpc.diagnosis.thresholds.intervals import Interval, Intervals, holds, intersection
from pytpc.diagnosis.thresholds.units import (
    ParameterUnit,
    is_text,
    is_unsigned,
    is_whole,
    unit_of,
)
from pytpc.recording.declaration import Declared
from pytpc.static.link_unit import Comparison, LinkUnit

_CLOSE, _TINY = 1e-9, 1e-12
EQUALITIES = frozenset({"==", "!="})


@dataclass(frozen=True, slots=True)
class SuggestionCase:
    """What a suggestion is worked out from: the evaluations up to the mark, and the parameter."""

    comparison: Comparison
    how: ParameterUnit
    possible: Possible
    evidence: SuggestionEvidence

    @property
    def relation(self) -> str:
        """That of the comparison, the threshold on the right-hand side."""
        return self.comparison.relation

    @property
    def threshold(self) -> float:
        """The last one up to the mark."""
        return self.evidence.threshold

    @property
    def present(self) -> float:
        """The parameter's value as a double."""
        found = self.how.current
        return math.nan if found is None else found

    @property
    def current(self) -> Number:
        """The parameter's value as it is shown."""
        return self.number(self.present)

    def number(self, value: float) -> Number:
        """An int of a parameter that takes whole numbers only."""
        return round(value) if self.possible.whole and math.isfinite(value) else value


def refuse(comparison: Comparison, unit: LinkUnit | None) -> None:
    """Let pass what suggestions can be made about.

    Raises:
        NoneBecauseError: the threshold is a constant, or text.
    """
    if comparison.type == "constant":
        raise NoneBecauseError("the threshold is a constant in the source, not a parameter")
    if is_text(comparison, unit):
        raise NoneBecauseError("the parameter is text")


def case_of(
    comparison: Comparison,
    unit: LinkUnit | None,
    evidence: SuggestionEvidence,
    declared: Declared | None,
) -> SuggestionCase:
    """The case of a comparison that ``refuse`` lets pass.

    Raises:
        NoneBecauseError: the threshold is not finite, or no value of the parameter gives it.
        NoUnitError: the file does not say how the parameter gives it.
    """
    if not math.isfinite(evidence.threshold):
        raise NoneBecauseError("the threshold is not a finite number")
    how = unit_of(comparison, unit, evidence.threshold)
    if how.current is None:
        text = comparison.transform.text if comparison.transform is not None else ""
        what = text or show(evidence.threshold)
        raise NoneBecauseError(f"no value of the parameter gives the threshold {what}")
    seen = evidence.seen if how.tree == "x" else np.array([how.current])
    whole = is_whole(comparison, unit, seen)
    if declared is not None and declared.type in {"int", "double"}:
        whole = declared.type == "int"
    return SuggestionCase(
        comparison, how, Possible(whole, is_unsigned(comparison, unit), declared), evidence
    )


def values_for(case: SuggestionCase, thresholds: Intervals) -> Intervals:
    """The values of the parameter that give one of ``thresholds``, none of them the present one.

    Raises:
        NoneBecauseError: there are none.
    """
    found = case.how.parameters(thresholds)
    if holds(found, case.present):
        # What the program rounds otherwise than we do must not come out as "leave it".
        slack = max(abs(case.present) * _CLOSE, _TINY)
        beside = [Interval.below(case.present - slack), Interval.above(case.present + slack)]
        found = intersection(found, beside)
    if found:
        return found
    if case.relation in EQUALITIES:
        raise NoneBecauseError("no value of the parameter gives the compared value exactly")
    if case.comparison.transform is None or case.comparison.transform.kind == "affine":
        raise NoneBecauseError("no finite threshold would change the outcome")
    raise NoneBecauseError("no value of the parameter gives such a threshold")


def is_truth(case: SuggestionCase) -> bool:
    """Whether the parameter is true or false."""
    found, declared = case.comparison, case.possible.declared
    if declared is not None:
        return declared.type == "bool"
    unknown = found.type == "flag" and found.default is None
    plain = found.type != "derived"
    return unknown or (isinstance(found.default, bool) and plain)


def shown_current(case: SuggestionCase) -> Number:
    """The parameter's present value in its own type."""
    return bool(case.threshold) if is_truth(case) else case.current
