"""Evaluations of a running robot as the rows that viewers show, with bounded numbers of them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from pytpc.api.export_series import SeriesKey, series_of
from pytpc.base.legal_names import LegalNames
from pytpc.diagnosis.results.exported import FIXED_TOPICS, ComparisonSeries, ExportedRows
from pytpc.diagnosis.results.live import Seen
from pytpc.diagnosis.thresholds.margins import MarginRules, slope_of
from pytpc.recording.summaries import Summary
from pytpc.static.link_unit import Comparison

MOST_ROWS = 50
"""So many evaluations of a comparison are passed on at a time; of more, its changes and some."""
MOST_SERIES = 5000


class _Row(NamedTuple):
    time_ns: int
    value: float
    threshold: float
    result: bool
    holds: bool
    flop: bool
    evaluations: int


class LiveSeries:
    """The comparisons that have reported so far; ``left_out`` counts what was too much."""

    def __init__(self) -> None:
        """Nothing has come."""
        self.names = LegalNames()
        for topic in FIXED_TOPICS:
            self.names.take(topic)
        self.series: list[ComparisonSeries] = []
        self.left_out = 0
        self._comparisons: list[Comparison] = []
        self._numbers: dict[SeriesKey, int] = {}
        self._last: dict[int, bool] = {}
        self._rules = MarginRules.of(())
        self._topics: dict[tuple[str, str], str] = {}

    def topic(self, kind: str, parameter: str) -> str:
        """The topic of a kind (``ranks``, ``probabilities``) for a parameter."""
        if (kind, parameter) not in self._topics:
            self._topics[kind, parameter] = self.names.take("tpc", kind, parameter)
        return self._topics[kind, parameter]

    def of_key(self, key: str | None) -> tuple[int, ...]:
        """The numbers of a comparison's series, in all nodes."""
        return tuple(number for pair, number in self._numbers.items() if pair[0] == key)

    def rows(
        self, items: Iterable[object], known: Mapping[str, Comparison]
    ) -> tuple[ExportedRows, list[ComparisonSeries]]:
        """The evaluations and summaries among what came, and the comparisons that are new.

        Those of comparisons that the static information does not have are left out.
        """
        before = len(self.series)
        found: defaultdict[int, list[_Row]] = defaultdict(list)
        for item in items:
            if not isinstance(item, Seen | Summary) or item.key not in known:
                continue
            number = self._number(item.key, item.node, known[item.key])
            if number is None:
                self.left_out += 1
                continue
            found[number].append(self._row(number, item))
        if len(self.series) != before:
            self._rules = MarginRules.of(self._comparisons)
        return self._joined(found), self.series[before:]

    def _number(self, key: str, node: str, comparison: Comparison) -> int | None:
        number = self._numbers.get((key, node))
        if number is None:
            if len(self.series) >= MOST_SERIES:
                return None
            number = self._numbers[key, node] = len(self.series)
            is_in_parameters = slope_of(comparison) is not None
            self.series.append(
                series_of(key, node, comparison, self.names, is_in_parameters=is_in_parameters)
            )
            self._comparisons.append(comparison)
        return number

    def _row(self, number: int, item: Seen | Summary) -> _Row:
        flop = self._last.get(number, item.result) != item.result
        self._last[number] = item.result
        if isinstance(item, Seen):
            time_ns, evaluations = item.time_ns, 1
        else:
            time_ns, evaluations, flop = item.end_ns, item.count, flop or item.flops > 0
        return _Row(time_ns, item.cmp, item.thresh, item.result, item.res, flop, evaluations)

    def _joined(self, found: Mapping[int, list[_Row]]) -> ExportedRows:
        pairs: list[tuple[_Row, int]] = []
        for number, own in found.items():
            kept = _thinned(own)
            self.left_out += len(own) - len(kept)
            pairs += [(row, number) for row in kept]
        pairs.sort(key=lambda one: one[0].time_ns)
        rows = [row for row, _ in pairs]
        series = np.array([number for _, number in pairs], np.int32)
        value = np.array([row.value for row in rows], np.float64)
        threshold = np.array([row.threshold for row in rows], np.float64)
        return ExportedRows(
            np.array([row.time_ns for row in rows], np.int64),
            series,
            value,
            threshold,
            self._rules.margins(series, value, threshold) if rows else value,
            np.array([row.result for row in rows], bool),
            np.array([row.holds for row in rows], bool),
            np.array([row.flop for row in rows], bool),
            np.array([row.evaluations for row in rows], np.int64),
        )


def _thinned(rows: list[_Row]) -> list[_Row]:
    """At most ``MOST_ROWS``: the newest changes first of all, and evenly spread others."""
    if len(rows) <= MOST_ROWS:
        return rows
    turned = [number for number, one in enumerate(rows) if one.flop][-MOST_ROWS // 2 :]
    room = MOST_ROWS - len(turned)
    others = np.linspace(0, len(rows) - 1, room).round().astype(int).tolist()
    return [rows[number] for number in sorted({*turned, *others})]
