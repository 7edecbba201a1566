"""Compares how each comparison came out in two runs, aligned at their starts.

Which parameters differ, and what that changed, is another question: `pytpc.diagnosis.differences`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pytpc.base.columns import Bools, Floats, Int64s
from pytpc.diagnosis.differences import RunValues
from pytpc.diagnosis.results.decisions import MOST, Decided, DecisionChange, RunDecisions
from pytpc.diagnosis.results.differences import SetValue
from pytpc.diagnosis.scores.summary_scores import covered
from pytpc.diagnosis.scores.summary_truth import true_in
from pytpc.recording.events import Events
from pytpc.recording.summaries import Summaries
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import parameter_name, same_parameter
from pytpc.static.static_info import StaticInfo


def decisions(old: RunValues, new: RunValues, static_info: StaticInfo) -> RunDecisions:
    """How the comparisons of two runs came out, the largest difference first.

    Args:
        old: the older run, with the keys of the newer one.
        new: the newer run.
        static_info: with the names of the newer run (`pytpc.diagnosis.full_names`).
    """
    before, after = _Run(old), _Run(new)
    found = []
    for key, comparison in static_info.thresholds.items():
        one, other = before.decided(key, comparison), after.decided(key, comparison)
        if one is None and other is None:
            continue
        found.append(
            DecisionChange(
                key,
                parameter_name(comparison),
                f"{comparison.file}:{comparison.lineno}",
                (comparison.source_code or "").strip(),
                comparison.relation,
                one,
                other,
            )
        )
    known = static_info.comparisons.keys() | static_info.set_aside
    return RunDecisions(
        old.name,
        new.name,
        (old.recording.seconds, new.recording.seconds),
        tuple(sorted(found, key=DecisionChange.order)),
        (len(before.keys - known), len(after.keys - known)),
    )


@dataclass(frozen=True)
class _Run:
    """A run, and how its comparisons came out."""

    values: RunValues

    @property
    def _events(self) -> Events:
        return self.values.recording.events

    @property
    def _summaries(self) -> Summaries:
        return self.values.recording.summaries

    @cached_property
    def keys(self) -> set[str]:
        """The keys of what was evaluated."""
        return set(self.values.recording.nodes_of)

    def decided(self, key: str, comparison: Comparison) -> Decided | None:
        """How a comparison came out; None if it was not evaluated."""
        if key not in self.keys:
            return None
        events, summaries = self._events, self._summaries
        own, kept = events.rows_of(key), summaries.rows_of(key)
        alone = own[~covered(events, own, summaries, kept)] if kept.size else own
        evaluations = int(alone.size + summaries.count[kept].sum())
        true = float(events.result[alone].sum()) + true_in(events, own, summaries, kept)
        turned = events.time_ns[own[events.flop[own]]]
        flops = max(int(turned.size), int(summaries.flops[kept].sum()))
        low, middle, high = _margins(events, alone, summaries, kept)
        thresholds = _thresholds(events, own, summaries, kept)
        start = self.values.recording.start_ns
        return Decided(
            evaluations,
            min(1.0, true / evaluations) if evaluations else 0.0,
            flops,
            float(turned[0] - start) / 1e9 if turned.size else None,
            low,
            middle,
            high,
            thresholds[:MOST],
            max(0, len(thresholds) - MOST),
            self._value(key, comparison),
        )

    def _value(self, key: str, comparison: Comparison) -> SetValue:
        """The parameter's value on the robot; none if it is not known, or if there are several."""
        source, values = comparison.source or "", self.values.values or {}
        nodes = self.values.recording.nodes_of[key]
        names = [name for name in values if same_parameter(name, source)]
        mine = [n for n in names if any(n.startswith(f"{node}/") for node in nodes)] or names
        return self.values.set_value(mine[0]) if len(mine) == 1 else SetValue(None)


def _margins(
    events: Events, alone: Int64s, summaries: Summaries, kept: Int64s
) -> tuple[float | None, float | None, float | None]:
    """The smallest, the median and the largest of compared value minus threshold."""
    with np.errstate(invalid="ignore", over="ignore"):
        single = events.cmp[alone] - events.thresh[alone]
    count = (summaries.count - summaries.odd)[kept]
    low, high = summaries.diff_min[kept], summaries.diff_max[kept]
    single = single[np.isfinite(single)]
    known = np.isfinite(low) & np.isfinite(high) & (count > 0)
    ends = np.concatenate([single, low[known], high[known]])
    if not ends.size:
        return None, None, None
    values = np.concatenate([single, summaries.diff_mean[kept][known]])
    weights = np.concatenate([np.ones(single.size, np.int64), count[known]])
    return float(ends.min()), _median(values, weights), float(ends.max())


def _median(values: Floats, weights: Int64s) -> float:
    """The value below and above which half of the weights are; the mean of two in the middle."""
    order = np.argsort(values, kind="stable")
    values, reached = values[order], np.cumsum(weights[order])
    half = reached[-1] / 2
    place = int(np.searchsorted(reached, half))
    if reached[place] == half and place + 1 < values.size:
        return float((values[place] + values[place + 1]) / 2)
    return float(values[place])


def _thresholds(
    events: Events, own: Int64s, summaries: Summaries, kept: Int64s
) -> tuple[float, ...]:
    """The different finite thresholds, sorted."""
    every = np.concatenate([events.thresh[own], summaries.thresh[kept]])
    finite: Bools = np.isfinite(every)
    different: Iterable[float] = np.unique(every[finite]).tolist()
    return tuple(different)
