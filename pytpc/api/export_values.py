"""The values of a mission's compared parameters over time."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np

from pytpc.api.export_series import ExportSeries
from pytpc.base.columns import Floats, Int64s
from pytpc.base.legal_names import LegalNames
from pytpc.base.wording import shown_value, tidy
from pytpc.diagnosis.results.exported import ComparisonSeries, ExportedValue
from pytpc.diagnosis.thresholds.units import NoUnitError, unit_of
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_values import ParameterValues
from pytpc.static.parameters import resolved
from pytpc.static.static_info import StaticInfo

_MOST_THRESHOLDS = 500


def values_over_time(
    recording: Recording, static_info: StaticInfo, found: ExportSeries, names: LegalNames
) -> Iterator[ExportedValue]:
    """The values of each compared parameter over time, as recorded or as its thresholds say."""
    recorded = ParameterValues(recording.values)
    known = set(recorded.names())
    by_parameter: defaultdict[tuple[str, str], list[int]] = defaultdict(list)
    for number, one in enumerate(found.series):
        if static_info.comparisons[one.key].source is not None:
            by_parameter[one.node, one.parameter].append(number)
    for (node, parameter), numbers in by_parameter.items():
        part = parameter.removeprefix(f"{node}/")
        topic = names.take("tpc", node, part, "parameter")
        full = next((name for name in (parameter, resolved(parameter, node)) if name in known), "")
        history = (
            recorded.history(full)
            if full
            else _from_thresholds(
                recording, static_info, [found.series[number] for number in numbers]
            )
        )
        for time_ns, value in history:
            text = shown_value(value)
            yield ExportedValue(time_ns, topic, node, parameter, _number(value), text)


def _number(value: object) -> float:
    """A value as a float; NaN if it is no number, or a whole number that no float holds.

    >>> _number(True), _number("3"), _number(10**400)
    (1.0, nan, nan)
    """
    try:
        return float(value) if isinstance(value, bool | int | float) else math.nan
    except OverflowError:
        return math.nan


def _from_thresholds(
    recording: Recording, static_info: StaticInfo, series: Sequence[ComparisonSeries]
) -> list[tuple[int, object]]:
    """The values that give the thresholds of the first comparison that says so."""
    for one in series:
        comparison = static_info.comparisons[one.key]
        unit = static_info.unit_of(one.key)
        times, thresholds = _thresholds(recording, one.key, one.node)
        changed = np.flatnonzero(np.diff(thresholds, prepend=np.nan) != 0)
        distinct = np.unique(thresholds[changed])
        if not changed.size or distinct.size > _MOST_THRESHOLDS:
            continue
        try:
            values = {t: unit_of(comparison, unit, t).current for t in distinct.tolist()}
        except NoUnitError:
            continue
        history: list[tuple[int, object]] = []
        for time_ns, threshold in zip(
            times[changed].tolist(), thresholds[changed].tolist(), strict=True
        ):
            value = values.get(threshold)
            if value is not None and (not history or history[-1][1] != tidy(value)):
                history.append((time_ns, tidy(value)))
        return history
    return []


def _thresholds(recording: Recording, key: str, node: str) -> tuple[Int64s, Floats]:
    """The thresholds of a comparison in a node by time, those of summaries at their ends."""
    events, summaries = recording.events, recording.summaries
    rows, others = events.rows_in(key, node), summaries.rows_in(key, node)
    times = np.concatenate([events.time_ns[rows], summaries.end_ns[others]])
    thresholds = np.concatenate([events.thresh[rows], summaries.thresh[others]])
    order = np.argsort(times, kind="stable")
    return times[order], thresholds[order]
