"""The suspects at each mark of a mission: parameters, most suspicious first.

``rank_marks`` is the entrance. TPCs whose threshold is a constant are no parameters and are left
out. A parameter is named as in the source; where no constant names it, its place does.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pytpc.events import Events, Floats, Int64s
from pytpc.ingest.recording import Recording
from pytpc.marks import Mark, MarkType
from pytpc.parameters import parameter_name, same_parameter
from pytpc.scoring.bounds import type2_bounds
from pytpc.scoring.scores import (
    NONE,
    WINDOW_S,
    ParameterScores,
    by_parameter,
    combined,
    ordering,
    ranks,
    type1,
)
from pytpc.static_info import Comparison, StaticInfo
from pytpc.summaries import Summaries


class Evaluation(NamedTuple):
    """One evaluation, as it was reported, or the last of a summary."""

    time_ns: int
    result: bool
    cmp: float
    thresh: float
    res: bool
    node: str


@dataclass(frozen=True, slots=True)
class Suspect:
    """A parameter at a mark.

    ``position`` counts from 1. ``key`` and ``comparison`` are its most suspicious TPC, ``score``
    that one's score by the formula of ``type`` (SPEC 7) and ``rank`` the parameter's rank among all
    parameters. ``keys`` are all TPCs of the parameter that the log has. ``last`` is the TPC's last
    evaluation up to the mark.
    """

    position: int
    parameter: str
    key: str
    comparison: Comparison
    type: MarkType
    score: float
    rank: float
    keys: tuple[str, ...]
    last: Evaluation


@dataclass(frozen=True, slots=True)
class MarkRanking:
    """The suspects at one mark, most suspicious first; parameters without a score are not here.

    ``parameters`` is the number of parameters among which they were ranked.
    """

    mark: Mark
    suspects: tuple[Suspect, ...]
    parameters: int

    def position_of(self, parameter: str) -> int | None:
        """The position of a parameter, None where it has no score at this mark."""
        found = self.suspect_of(parameter)
        return None if found is None else found.position

    def suspect_of(self, parameter: str) -> Suspect | None:
        """The most suspicious of what ``parameter`` can mean, see `same_parameter`."""
        same = (s for s in self.suspects if same_parameter(parameter, s.parameter))
        return next(same, None)


def rank_marks(
    recording: Recording,
    static_info: StaticInfo,
    *,
    untyped: bool = False,
    window_s: float = WINDOW_S,
) -> list[MarkRanking]:
    """Rank the parameters at every mark.

    Args:
        recording: the mission. Keys that the static information does not know are left out;
            ``unknown_keys`` counts them.
        static_info: what the analysis found. All its TPCs and parameters count in n of the rank,
            also those that were never evaluated.
        untyped: do not believe the observer's types: the combined ranking at every mark.
        window_s: the window of type II in seconds.

    Returns:
        One ranking for each mark, in the order of ``recording.marks``.
    """
    tpcs = _Tpcs.of(static_info)
    events = recording.events.with_keys(tpcs.keys)
    marks_ns = np.array([mark.time_ns for mark in recording.marks], dtype=np.int64)
    second = type2_bounds(
        events, recording.summaries, marks_ns, tpcs.distance, window_s=window_s
    ).value
    tables = _Tables(
        _by_parameter(tpcs, type1(events, marks_ns, tpcs.distance)),
        _by_parameter(tpcs, second),
    )
    rankings = []
    for row, mark in enumerate(recording.marks):
        order = _order(tables, row, None if untyped else mark.type)
        suspects = []
        for position, (number, kind, rank) in enumerate(order, start=1):
            table = tables.of(kind)
            key = tpcs.keys[int(table.best[row, number])]
            suspects.append(
                Suspect(
                    position=position,
                    parameter=table.names[number],
                    key=key,
                    comparison=static_info.comparisons[key],
                    type=kind,
                    score=float(table.scores[row, number]),
                    rank=rank,
                    keys=tpcs.seen(events, recording.summaries, table.names[number]),
                    last=_last(events, recording.summaries, key, mark.time_ns),
                )
            )
        rankings.append(MarkRanking(mark, tuple(suspects), len(tables.first.names)))
    return rankings


def unknown_keys(events: Events, static_info: StaticInfo) -> dict[str, int]:
    """Keys in the log that the static information does not know, with their number of reports.

    They come from a program that was built at another time than the static information.
    """
    counts = Counter(events.key.tolist())
    return {
        key: counts[code]
        for code, key in enumerate(events.keys)
        if counts[code] and key not in static_info.comparisons
    }


@dataclass(frozen=True, slots=True)
class _Tpcs:
    """The TPCs on parameters, sorted by key."""

    keys: tuple[str, ...]
    distance: Floats
    parameters: tuple[str, ...]

    @classmethod
    def of(cls, static_info: StaticInfo) -> _Tpcs:
        found = static_info.thresholds
        keys = tuple(sorted(found))
        return cls(
            keys,
            np.array([found[key].distance for key in keys], dtype=np.float64),
            tuple(parameter_name(found[key]) for key in keys),
        )

    def seen(self, events: Events, summaries: Summaries, parameter: str) -> tuple[str, ...]:
        """The keys of a parameter that have events or summaries."""
        return tuple(
            key
            for code, key in enumerate(self.keys)
            if self.parameters[code] == parameter
            and (events.by_key.rows(code).size or _rows_of(summaries, key).size)
        )


class _Table(NamedTuple):
    names: tuple[str, ...]
    scores: Floats
    best: Int64s
    distance: Floats
    ranks: Floats


class _Tables(NamedTuple):
    first: _Table
    second: _Table

    def of(self, kind: MarkType) -> _Table:
        return self.first if kind == "I" else self.second


def _by_parameter(tpcs: _Tpcs, scores: Floats) -> _Table:
    """Scores and ranks of the parameters; the distance of one is that of its best TPC."""
    found: ParameterScores = by_parameter(scores, tpcs.parameters, tpcs.distance, tpcs.keys)
    distance = np.append(tpcs.distance, np.inf)[found.best]
    table = np.empty_like(found.scores)
    for row in range(table.shape[0]):
        table[row] = ranks(found.scores[row : row + 1], distance[row], found.names)[0]
    return _Table(found.names, found.scores, found.best, distance, table)


def _order(tables: _Tables, row: int, kind: MarkType | None) -> list[tuple[int, MarkType, float]]:
    """Parameters with a score at one mark, in order: number, type of the score, rank."""
    first, second = tables
    if kind is not None:
        table = tables.of(kind)
        scores, distance = table.scores[row : row + 1], table.distance[row]
        order: Sequence[int] = ordering(scores, distance, table.names)[0].tolist()
        return [(n, kind, float(table.ranks[row, n])) for n in order if scores[0, n] != NONE]
    distance = np.minimum(first.distance[row], second.distance[row])
    ranks1, ranks2 = first.ranks[row : row + 1], second.ranks[row : row + 1]
    better, places = combined(ranks1, ranks2, distance, first.names)
    return [
        (n, "II" if ranks2[0, n] > ranks1[0, n] else "I", float(better[0, n]))
        for n in places[0].tolist()
        if better[0, n] > 0
    ]


def _last(events: Events, summaries: Summaries, key: str, mark_ns: int) -> Evaluation:
    """The last evaluation up to the mark that is known: a report, or the last of a summary.

    Where the mark is within the first period, it is the first of these.
    """
    rows = events.by_key.rows(events.keys.index(key))
    found = [_at(events, events.time_ns, rows, mark_ns)] if rows.size else []
    own = _rows_of(summaries, key)
    if own.size:
        own = own[np.argsort(summaries.end_ns[own], kind="stable")]
        found += [_at(summaries, summaries.end_ns, own, mark_ns)] if own.size else []
    before = [evaluation for evaluation in found if evaluation.time_ns <= mark_ns]
    return max(before) if before else min(found)


def _rows_of(summaries: Summaries, key: str) -> Int64s:
    """The rows of a key; a table may know a key and have none."""
    code = summaries.keys.index(key) if key in summaries.keys else -1
    return np.flatnonzero(summaries.key == code)


def _at(table: Events | Summaries, times: Int64s, rows: Int64s, mark_ns: int) -> Evaluation:
    """The last of ``rows`` up to the mark, else the first; they are in the order of ``times``."""
    place = int(np.searchsorted(times[rows], mark_ns, side="right")) - 1
    row = int(rows[max(0, place)])
    return Evaluation(
        int(times[row]),
        bool(table.result[row]),
        float(table.cmp[row]),
        float(table.thresh[row]),
        bool(table.res[row]),
        table.nodes[table.node[row]],
    )
