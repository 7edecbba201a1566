"""The comparisons of a recording as series: their names, and their evaluations in order of time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import PurePosixPath

import numpy as np

from pytpc.base.columns import Bools, Floats, Int32s, Int64s
from pytpc.base.legal_names import LegalNames, legal_part
from pytpc.diagnosis.results.exported import ComparisonSeries, ExportedRows
from pytpc.diagnosis.scores.summary_scores import FLOP_SLACK_NS, covered
from pytpc.diagnosis.thresholds.margins import MarginRules
from pytpc.recording.events import Events
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import parameter_name
from pytpc.static.static_info import StaticInfo

_LONGEST_CODE = 200

SeriesKey = tuple[str, str]
"""Key and node."""


@dataclass(frozen=True, eq=False)
class ExportSeries:
    """The series of a recording, without comparisons that the static information does not have.

    ``numbers`` are their numbers. ``of_events`` and ``of_summaries`` int32[keys, nodes] say which
    one each pair of codes of the tables is, -1 for none. ``count`` rows of both tables have one.
    ``in_summary`` bool[events] are those that a summary has, too; ``has_untold`` bool[summaries]
    are those with flops that are no events.
    """

    series: tuple[ComparisonSeries, ...]
    numbers: dict[SeriesKey, int]
    rules: MarginRules
    of_events: Int32s
    of_summaries: Int32s
    count: int
    in_summary: Bools
    has_untold: Bools

    @classmethod
    def of(cls, recording: Recording, static_info: StaticInfo, names: LegalNames) -> ExportSeries:
        """Find and name them, sorted by node and parameter."""
        known = static_info.comparisons
        pairs = {
            (key, node)
            for key, nodes in recording.nodes_of.items()
            if key in known
            for node in nodes
        }
        order = sorted(
            pairs,
            key=lambda one: (
                one[1],
                parameter_name(known[one[0]]),
                known[one[0]].file,
                known[one[0]].lineno,
                one[0],
            ),
        )
        comparisons = [known[key] for key, _ in order]
        rules = MarginRules.of(comparisons)
        series = [
            series_of(key, node, one, names, is_in_parameters=is_in_parameters)
            for (key, node), one, is_in_parameters in zip(
                order, comparisons, rules.in_parameters, strict=True
            )
        ]
        numbers = {pair: number for number, pair in enumerate(order)}
        events, summaries = recording.events, recording.summaries
        of_events, of_summaries = _numbers_of(events, numbers), _numbers_of(summaries, numbers)
        count = np.count_nonzero(of_events[events.key, events.node] >= 0)
        count += np.count_nonzero(of_summaries[summaries.key, summaries.node] >= 0)
        return cls(
            tuple(series),
            numbers,
            rules,
            of_events,
            of_summaries,
            int(count),
            _in_summary(recording),
            _has_untold(recording),
        )

    def of_key(self, key: str | None) -> tuple[int, ...]:
        """The series of a comparison, in all nodes."""
        return tuple(number for pair, number in self.numbers.items() if pair[0] == key)


def series_of(
    key: str, node: str, comparison: Comparison, names: LegalNames, *, is_in_parameters: bool
) -> ComparisonSeries:
    """Name a comparison in a node; ``is_in_parameters`` is the unit of its margin."""
    parameter = _parameter_part(comparison, node)
    return ComparisonSeries(
        topic=names.take("tpc", node, parameter, _place_part(comparison)),
        node=node,
        parameter=parameter_name(comparison),
        key=key,
        place=f"{comparison.file}:{comparison.lineno}",
        relation=comparison.relation,
        source_code=(comparison.source_code or "")[:_LONGEST_CODE],
        is_in_parameters=is_in_parameters,
    )


def _numbers_of(table: Events | Summaries, numbers: dict[SeriesKey, int]) -> Int32s:
    """int32[keys, nodes]: the series of each pair of codes."""
    found = np.full((len(table.keys), len(table.nodes)), -1, np.int32)
    for row, key in enumerate(table.keys):
        for column, node in enumerate(table.nodes):
            found[row, column] = numbers.get((key, node), -1)
    return found


def _in_summary(recording: Recording) -> Bools:
    """bool[events]: under ``edges`` and ``light``, an event is an evaluation of a summary, too."""
    events, summaries = recording.events, recording.summaries
    found = np.zeros(len(events), np.bool_)
    for key in summaries.keys:
        rows, own = events.rows_of(key), summaries.rows_of(key)
        if rows.size and own.size:
            found[rows] = covered(events, rows, summaries, own)
    return found


def _has_untold(recording: Recording) -> Bools:
    """bool[summaries]: more flops than there are events of flops in its time."""
    events, summaries = recording.events, recording.summaries
    found = summaries.flops > 0
    for key in summaries.keys:
        for node in summaries.nodes:
            own = summaries.rows_in(key, node)
            own = own[summaries.flops[own] > 0]
            if not own.size:
                continue
            rows = events.rows_in(key, node)
            times = events.time_ns[rows[events.flop[rows]]]
            begin, end = summaries.begin_ns[own] - FLOP_SLACK_NS, summaries.end_ns[own]
            last = np.searchsorted(times, end + FLOP_SLACK_NS, side="right")
            told = last - np.searchsorted(times, begin)
            found[own] = summaries.flops[own] > told
    return found


def _parameter_part(comparison: Comparison, node: str) -> str:
    """A parameter's name as it follows its node's."""
    if comparison.source is None:
        return f"constants/{legal_part(comparison.name or '')}"
    return parameter_name(comparison).removeprefix(f"{node}/")


def _place_part(comparison: Comparison) -> str:
    return legal_part(f"{PurePosixPath(comparison.file).name}_{comparison.lineno}")


def rows_of(recording: Recording, found: ExportSeries, size: int) -> Iterator[ExportedRows]:
    """The evaluations and summaries in order of time, in parts of at most twice ``size``."""
    events, summaries = recording.events, recording.summaries
    order = np.argsort(summaries.end_ns, kind="stable")
    ends = summaries.end_ns[order]
    first, second = 0, 0
    while first < len(events) or second < len(summaries):
        last = min(first + size, len(events))
        # What comes before the first event of the next part.
        until = len(ends) if last == len(events) else np.searchsorted(ends, events.time_ns[last])
        until = max(second, int(until))
        if until > second + size:
            until = second + size
            last = int(np.searchsorted(events.time_ns, ends[until - 1], side="right"))
            last = min(max(first, last), first + size)
        rows = order[second:until]
        part = _joined(events, slice(first, last), found), _summarised(summaries, rows, found)
        yield _in_order(*part)
        first, second = last, until


def _joined(events: Events, rows: slice, found: ExportSeries) -> ExportedRows:
    series = found.of_events[events.key[rows], events.node[rows]]
    cmp, thresh = events.cmp[rows], events.thresh[rows]
    return ExportedRows(
        events.time_ns[rows],
        series,
        cmp,
        thresh,
        _margins(found, series, cmp, thresh),
        events.result[rows],
        events.res[rows],
        events.flop[rows],
        np.where(found.in_summary[rows], 0, 1),
    )


def _summarised(table: Summaries, rows: Int64s, found: ExportSeries) -> ExportedRows:
    series = found.of_summaries[table.key[rows], table.node[rows]]
    cmp, thresh = table.cmp[rows], table.thresh[rows]
    return ExportedRows(
        table.end_ns[rows],
        series,
        cmp,
        thresh,
        _margins(found, series, cmp, thresh),
        table.result[rows],
        table.res[rows],
        found.has_untold[rows],
        table.count[rows],
    )


def _margins(found: ExportSeries, series: Int32s, cmp: Floats, thresh: Floats) -> Floats:
    if not found.series:
        return np.full(series.shape, np.nan)
    return found.rules.margins(np.maximum(series, 0), cmp, thresh)


def _in_order(one: ExportedRows, other: ExportedRows) -> ExportedRows:
    """Both parts by time, without the rows of no series."""
    order = np.argsort(np.concatenate([one.time_ns, other.time_ns]), kind="stable")
    order = order[np.concatenate([one.series, other.series])[order] >= 0]
    return ExportedRows(
        *(np.concatenate([mine, theirs])[order] for mine, theirs in zip(one, other, strict=True))
    )
