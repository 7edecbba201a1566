"""Table 6.12: what happened to each parameter's comparisons while the missions ran.

A row for each parameter that was compared with. ``Locations`` are the places in the source at which
it was, ``Comparisons`` the evaluations, ``Frequency`` those per second of all missions together,
``Runtime %`` the share of the missions' seconds in which there was one, ``Flops`` the changes of
the predicate, ``True %`` and ``False %`` its outcomes.

Where the policy ``edges`` kept summaries, comparisons and flops are exact too. A summary has the
outcome of all its evaluations where none of them flopped; where some did, they count as spread
evenly over its time. It counts for all seconds from its begin to its end.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from pytpc.base.columns import Floats, Int64s
from pytpc.base.wording import many
from pytpc.diagnosis.scores.summary_scores import covered
from pytpc.diagnosis.scores.summary_truth import true_in
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries
from pytpc.static.parameters import base_key, parameter_name
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.tables import Column, Table, statistics

SUMMARY = {
    "mean": "mean",
    "median": "median",
    "std": "std",
    "min": "minimum",
    "max": "maximum",
    "sum": "sum",
}
"""The thesis's names of the last rows."""

_COLUMNS = (
    Column("Locations", 0),
    Column("Comparisons", 0),
    Column("Frequency", 2, name="frequency per s"),
    Column("Runtime %", 1),
    Column("Flops", 0),
    Column("True %", 2),
    Column("False %", 2),
)


@dataclass(frozen=True, slots=True)
class RuntimeRow:
    """One parameter; None where the missions took no time. Percentages are 0 to 100."""

    parameter: str
    locations: int
    comparisons: int
    frequency: float | None
    runtime: float
    flops: int
    true: float
    false: float


@dataclass(frozen=True, slots=True)
class RuntimeStatistics:
    """The rows sorted by parameter, and what they are out of.

    ``seconds`` is how long all missions took. ``locations`` and ``parameters`` are how many the
    analysis found, ``seen`` how many of the locations were evaluated.
    """

    rows: tuple[RuntimeRow, ...]
    missions: int
    seconds: float
    locations: int
    seen: int
    parameters: int


def runtime_statistics(
    recordings: Sequence[Recording], static_info: StaticInfo
) -> RuntimeStatistics:
    """The rows of table 6.12 over all ``recordings`` together."""
    keys = _Keys.of(static_info, recordings)
    counts = [_Counts.none(keys), *(_counts(recording, keys) for recording in recordings)]
    total = _Counts(
        *(np.sum([getattr(c, field.name) for c in counts], axis=0) for field in fields(_Counts))
    )
    seconds = sum(recording.seconds for recording in recordings)
    bins = sum(_bins(recording) for recording in recordings)
    seen = total.by_key > 0
    rows = []
    for number, name in enumerate(keys.names):
        comparisons = int(total.by_key[keys.parameter == number].sum())
        if not comparisons:
            continue
        true = 100.0 * float(total.true[number]) / comparisons
        rows.append(
            RuntimeRow(
                parameter=name,
                locations=np.unique(keys.place[seen & (keys.parameter == number)]).size,
                comparisons=comparisons,
                frequency=comparisons / seconds if seconds > 0 else None,
                runtime=100.0 * int(total.seconds[number]) / bins,
                flops=int(total.flops[number]),
                true=true,
                false=100.0 - true,
            )
        )
    return RuntimeStatistics(
        rows=tuple(rows),
        missions=len(recordings),
        seconds=seconds,
        locations=np.unique(keys.place).size,
        seen=np.unique(keys.place[seen]).size,
        parameters=len(keys.names),
    )


def runtime_table(found: RuntimeStatistics) -> Table:
    """Table 6.12 with the thesis's last rows."""
    rows = tuple(
        (
            row.parameter,
            (
                row.locations,
                row.comparisons,
                row.frequency,
                row.runtime,
                row.flops,
                row.true,
                row.false,
            ),
        )
        for row in found.rows
    )
    columns = [statistics([cells[n] for _, cells in rows]) for n in range(len(_COLUMNS))]
    summary = tuple(
        (shown, tuple(column[name] for column in columns)) for name, shown in SUMMARY.items()
    )
    return Table(
        "runtime",
        "Runtime parameter statistics",
        _COLUMNS,
        rows,
        summary if rows else (),
        first="Parameter",
        statistic_digits=2,
        notes=_notes(found),
    )


def _notes(found: RuntimeStatistics) -> tuple[str, ...]:
    comparisons = sum(row.comparisons for row in found.rows)
    flops = sum(row.flops for row in found.rows)
    share = f" ({100 * found.seen / found.locations:.1f} %)" if found.locations else ""
    notes = [
        f"{found.seen} of {many(found.locations, 'location')}{share} and {len(found.rows)} of"
        f" {many(found.parameters, 'parameter')} found in the source were compared in"
        f" {many(found.missions, 'mission')} of {found.seconds:.1f} s together."
    ]
    if comparisons and found.seconds > 0:
        notes.append(
            f"{many(comparisons, 'comparison')}, {comparisons / found.seconds:.1f} a second;"
            f" {100 * flops / comparisons:.2f} % of them are flops."
        )
    return tuple(notes)


@dataclass(frozen=True, eq=False)
class _Keys:
    """The TPCs on parameters, sorted by key; ``parameter`` and ``place`` int64[keys] number what
    ``names`` has, and the locations in the source. Each object that evaluates one has a key."""

    keys: tuple[str, ...]
    parameter: Int64s
    place: Int64s
    names: tuple[str, ...]

    @classmethod
    def of(cls, static_info: StaticInfo, recordings: Sequence[Recording]) -> _Keys:
        found = static_info.thresholds
        seen = {
            key
            for recording in recordings
            for table in (recording.events, recording.summaries)
            for key in table.keys
        }
        known = {key: base_key(key) for key in seen if base_key(key) in found}
        known |= {key: key for key in found}
        keys = tuple(sorted(known))
        of_key = {key: parameter_name(found[known[key]]) for key in keys}
        names = tuple(sorted(set(of_key.values())))
        number = {name: index for index, name in enumerate(names)}
        places = {k.key: index for index, tpc in enumerate(static_info.tpcs) for k in tpc.keys}
        return cls(
            keys,
            np.array([number[of_key[key]] for key in keys], dtype=np.int64),
            np.array([places[known[key]] for key in keys], dtype=np.int64),
            names,
        )


@dataclass(frozen=True, eq=False)
class _Counts:
    """Of one mission: ``by_key`` int64[keys] evaluations; by parameter ``true`` float64, ``flops``
    and the ``seconds`` in which it occurs, int64."""

    by_key: Int64s
    true: Floats
    flops: Int64s
    seconds: Int64s

    @classmethod
    def none(cls, keys: _Keys) -> _Counts:
        """Of no mission."""
        parameters = np.zeros(len(keys.names), np.int64)
        by_key = np.zeros(len(keys.keys), np.int64)
        return cls(by_key, parameters.astype(np.float64), parameters, parameters)


def _counts(recording: Recording, keys: _Keys) -> _Counts:
    events = recording.events.with_keys(keys.keys)
    summaries = recording.summaries
    kept = np.ones(len(events), np.bool_)
    by_key = np.zeros(len(keys.keys))
    true = np.zeros(len(keys.names))
    spans = []
    for code, key in enumerate(keys.keys) if len(summaries) else ():
        rows = _rows_of(summaries, key)
        if rows.size:
            own = events.by_key.rows(code)
            kept[own[covered(events, own, summaries, rows)]] = False
            by_key[code] += summaries.count[rows].sum()
            true[keys.parameter[code]] += true_in(events, own, summaries, rows)
            ends = np.stack([summaries.begin_ns[rows], summaries.end_ns[rows]])
            spans.append((keys.parameter[code], ends.min(axis=0), ends.max(axis=0)))
    of_parameter = keys.parameter[events.key]
    size = len(keys.names)
    by_key += np.bincount(events.key[kept], minlength=by_key.size)
    true += np.bincount(of_parameter[kept & events.result], minlength=size)
    flops = np.bincount(of_parameter[events.flop], minlength=size)
    return _Counts(
        by_key.astype(np.int64),
        true,
        flops.astype(np.int64),
        _seconds(recording, of_parameter, events.time_ns, spans, size),
    )


def _seconds(
    recording: Recording,
    of_parameter: Int64s,
    times: Int64s,
    spans: Sequence[tuple[int, Int64s, Int64s]],
    size: int,
) -> Int64s:
    """int64[parameters]: in how many seconds of the mission each occurs."""
    bins = _bins(recording)

    def second(time_ns: Int64s) -> Int64s:
        return np.clip((time_ns - recording.start_ns) // 10**9, 0, bins - 1)

    parts = [of_parameter * bins + second(times)]
    for parameter, begin, end in spans:
        first, last = second(begin), second(end)
        length = last - first + 1
        start = np.repeat(first - (np.cumsum(length) - length), length)
        parts.append(parameter * bins + start + np.arange(start.size))
    return np.bincount(np.unique(np.concatenate(parts)) // bins, minlength=size).astype(np.int64)


def _bins(recording: Recording) -> int:
    """The seconds of a mission, a begun one counted as one."""
    return max(1, math.ceil((recording.end_ns - recording.start_ns) / 10**9))


def _rows_of(summaries: Summaries, key: str) -> Int64s:
    code = summaries.keys.index(key) if key in summaries.keys else -1
    return np.flatnonzero(summaries.key == code)
