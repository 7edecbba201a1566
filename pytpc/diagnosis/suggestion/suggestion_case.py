"""One parameter at one of its comparisons: the data from which suggestions are computed.

Turns sets of thresholds that would do into sets of values of the parameter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pytpc.base.columns import Floats, Int64s
from pytpc.base.wording import Number, show, tidy
from pytpc.diagnosis.suggestion.choice import Possible
from pytpc.diagnosis.thresholds.intervals import Interval, Intervals, holds, intersection
from pytpc.diagnosis.thresholds.units import (
    ParameterUnit,
    is_text,
    is_unsigned,
    is_whole,
    unit_of,
)
from pytpc.recording.declaration import Declared
from pytpc.recording.events import Events
from pytpc.recording.marks import MarkType
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries
from pytpc.static.link_unit import Comparison, LinkUnit

_CLOSE, _TINY = 1e-9, 1e-12
EQUALITIES = frozenset({"==", "!="})


class NoneBecauseError(Exception):
    """Why there is no suggestion."""


@dataclass(frozen=True, slots=True)
class SuggestionEvidence:
    """Evaluations of one comparison up to a mark, those that count for a type of error.

    ``cmp`` and ``thresh`` are float64[n]: for type I the two of the last flop, the earlier first;
    for type II those of the window. ``threshold`` is the last one up to the mark, ``seen``
    float64[m] are all up to it. ``summed`` says whether summaries are among them, which have only
    the extreme values.
    """

    cmp: Floats
    thresh: Floats
    threshold: float
    seen: Floats
    summed: bool


@dataclass(frozen=True, slots=True)
class SuggestionCase:
    """The data for a suggestion: the evaluations up to the mark, and the parameter."""

    comparison: Comparison
    how: ParameterUnit
    possible: Possible
    evidence: SuggestionEvidence

    @property
    def relation(self) -> str:
        """The comparison's relation, with the threshold on the right-hand side."""
        return self.comparison.relation

    @property
    def threshold(self) -> float:
        """The last threshold up to the mark."""
        return self.evidence.threshold

    @property
    def present(self) -> float:
        """The parameter's value as a double."""
        found = self.how.current
        return math.nan if found is None else found

    @property
    def current(self) -> Number:
        """The parameter's value as a user wrote it."""
        return tidy(self.number(self.present))

    def number(self, value: float) -> Number:
        """The value, as an int if the parameter takes whole numbers only."""
        return round(value) if self.possible.whole and math.isfinite(value) else value


def refuse(comparison: Comparison, unit: LinkUnit | None) -> None:
    """Refuse a comparison that no suggestion can be made about.

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
        # The program may round differently; that must not lead to "leave it".
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


@dataclass(frozen=True, slots=True)
class _KeptEnds:
    """The extreme evaluations of the summaries in a window, which is all that type II needs.

    ``threshold`` is the last one up to the mark, in the summary that ends at ``last_ns``. A summary
    that straddles an end of the window counts only if no summary is inside it.
    """

    cmp: Floats
    thresh: Floats
    threshold: float
    last_ns: int

    @classmethod
    def of(
        cls, summaries: Summaries | None, key: str, mark_ns: int, window_s: float
    ) -> _KeptEnds | None:
        """None where there are none of ``key`` before the mark."""
        if summaries is None or not summaries.rows_of(key).size:
            return None
        begins = mark_ns - round(window_s * 1e9)
        own = summaries.take(summaries.rows_of(key))
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


def evidence_of(
    recording: Recording, key: str, mark_ns: int, kind: MarkType, window_s: float
) -> SuggestionEvidence:
    """What the log has of ``key`` up to a mark.

    Raises:
        NoneBecauseError: there is nothing.
    """
    events = recording.events
    kept = _KeptEnds.of(recording.summaries, key, mark_ns, window_s)
    rows = events.rows_of(key)
    rows = rows[: int(np.searchsorted(events.time_ns[rows], mark_ns, side="right"))]
    if kept is None and not rows.size:
        raise NoneBecauseError("it was not evaluated before the mark")
    seen = events.thresh[rows]
    if kept is not None and (not rows.size or kept.last_ns >= events.time_ns[rows[-1]]):
        threshold = kept.threshold
        seen = np.append(seen, threshold)
    else:
        threshold = float(seen[-1])
    if kind == "I":
        pair = last_flop(events, rows)
        return SuggestionEvidence(events.cmp[pair], events.thresh[pair], threshold, seen, False)
    begin = mark_ns - round(window_s * 1e9)
    window = rows[int(np.searchsorted(events.time_ns[rows], begin, side="left")) :]
    cmp, thresh = events.cmp[window], events.thresh[window]
    if kept is not None:
        cmp, thresh = np.append(kept.cmp, cmp), np.append(kept.thresh, thresh)
    if not cmp.size:
        raise NoneBecauseError("it was not evaluated in the window before the mark")
    return SuggestionEvidence(cmp, thresh, threshold, seen, kept is not None)


def last_flop(events: Events, rows: Int64s) -> Int64s:
    """The rows of the two evaluations of the last flop among ``rows``, the earlier first.

    Raises:
        NoneBecauseError: there is none.
    """
    flops = rows[events.flop[rows]]
    if not flops.size:
        raise NoneBecauseError("its result did not change before the mark")
    return np.array([events.previous[flops[-1]], flops[-1]], dtype=np.int64)
