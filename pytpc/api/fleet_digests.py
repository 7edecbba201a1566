"""What a fleet's data set keeps of one mission: its tables."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from pytpc.api.comparing import RecordedRun
from pytpc.base.columns import Floats, Int64s
from pytpc.diagnosis.behaviour import behaviours
from pytpc.diagnosis.results.behaviour import Behaviour
from pytpc.fleet.tables import COMPARISONS, MARKS, VALUES
from pytpc.recording.graph_file import GRAPH_FILE
from pytpc.recording.marks import Mark
from pytpc.recording.mission import MARKS_FILE, RUN_FILE, Recording, marks_json
from pytpc.recording.summaries import Summaries
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import PARAMS_FILE, origins_file, read_origins
from pytpc.values.recording import params_file

_LARGEST_FILE = 16 << 20
_DIGEST = 12


def comparisons_of(recording: Recording, named: StaticInfo) -> pa.Table:
    """A row for each comparison and node that evaluated it.

    Args:
        recording: the mission; marks are not needed.
        named: the static information with the names of this mission.
    """
    rows = [_comparison(one, recording) for one in behaviours(recording, named)]
    return pa.Table.from_pylist(rows, schema=COMPARISONS)


def _comparison(one: Behaviour, recording: Recording) -> dict[str, Any]:
    events, summaries = recording.events, recording.summaries
    rows, own = events.rows_in(one.key, one.node), summaries.rows_in(one.key, one.node)
    times = events.time_ns[rows]
    turned = times[events.flop[rows]]
    ends = summaries.end_ns[own]
    # The last summary has the last evaluation, unless it is in a row of its own.
    latest = int(ends.argmax()) if own.size else -1
    in_row = rows.size > 0 and (latest < 0 or int(times[-1]) >= int(ends[latest]))
    last = int(rows[-1]) if in_row else int(own[latest])
    table = events if in_row else summaries
    first_row = rows.size > 0 and (
        not own.size or int(times[0]) <= int(summaries.begin_ns[own].min())
    )
    first = int(rows[0]) if first_row else int(own[0])
    begin = events if first_row else summaries
    thresholds = np.concatenate([events.thresh[rows], summaries.thresh[own]])
    low, high = _extremes(
        np.concatenate([
            events.cmp[rows],
            summaries.cmp[own],
            *_compared(summaries, own),
        ])
    )  # fmt: skip
    margins = one.margins
    return {
        "key": one.key,
        "node": one.node,
        "parameter": one.parameter,
        "file": one.comparison.file,
        "lineno": one.comparison.lineno,
        "relation": one.comparison.relation,
        "kind": one.comparison.type,
        "unit": one.unit,
        "evaluations": one.evaluations,
        "seconds": one.seconds,
        "first_ns": min(_ends(times[:1], summaries.begin_ns[own])),
        "last_ns": max(_ends(times[-1:], ends)),
        "true_share": one.true_share,
        "turns": one.turns,
        "first_turn_ns": int(turned[0]) if turned.size else None,
        "result_first": bool(begin.result[first]),
        "result_last": bool(table.result[last]),
        "thresh_first": float(begin.thresh[first]),
        "thresh_last": float(table.thresh[last]),
        "thresholds": int(np.unique(thresholds[np.isfinite(thresholds)]).size),
        "value_low": low,
        "value_high": high,
        "reach": one.reach,
        "least": None if margins is None else margins.least,
        "low": None if margins is None else margins.low,
        "median": None if margins is None else margins.median,
        "high": None if margins is None else margins.high,
        "near_misses": one.near_misses,
        "undecided": one.undecided,
        "drift_per_minute": None if one.drift is None else one.drift.per_minute,
    }


def _ends(rows: Int64s, summaries: Int64s) -> list[int]:
    return [*rows.tolist(), *summaries.tolist()]


def _compared(summaries: Summaries, rows: Int64s) -> tuple[Floats, Floats]:
    """At least and at most so much was compared, as if the threshold had been the last one.

    If it was another one, they are at most the extremes of all that stood on both sides.
    """
    with np.errstate(all="ignore"):
        low = summaries.thresh[rows] + summaries.diff_min[rows]
        high = summaries.thresh[rows] + summaries.diff_max[rows]
        return (
            np.clip(low, summaries.low[rows], summaries.high[rows]),
            np.clip(high, summaries.low[rows], summaries.high[rows]),
        )


def _extremes(values: Floats) -> tuple[float, float]:
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if finite.size else (math.nan, math.nan)


def values_of(run: RecordedRun) -> pa.Table:
    """The values of the parameters at the beginning, and those that were set later.

    Raises:
        InputError: params.yaml or origins.json is broken.
    """
    origins = {} if run.source is None else read_origins(run.source)
    rows = list(_values(run.values.values or {}, run.recording, origins))
    return pa.Table.from_pylist(rows, schema=VALUES)


def _values(
    values: Mapping[str, object], recording: Recording, origins: Mapping[str, Any]
) -> Iterator[dict[str, Any]]:
    for name, value in sorted(values.items()):
        origin = origins.get(name)
        words = "" if origin is None else origin.words()
        digest = "" if origin is None else _digest([f"{origin.kind} {words} {origin.text}"])
        yield _value(name, None, value, words, digest)
    for one in recording.values:
        yield _value(one.name, one.time_ns, one.value, "", "")


def _value(
    name: str, time_ns: int | None, value: object, words: str, digest: str
) -> dict[str, Any]:
    is_number = isinstance(value, int | float)
    try:
        number = float(value) if is_number else None  # type: ignore[arg-type]
    except OverflowError:
        number = None
    return {
        "name": name,
        "time_ns": time_ns,
        "value": json.dumps(value, sort_keys=True, default=str),
        "number": number,
        "origin": words,
        "origin_digest": digest,
    }


def marks_of(marks: Iterable[Mark]) -> pa.Table:
    """The marks, by time."""
    rows = [
        {"time_ns": one.time_ns, "type": one.type, "observer": one.observer, "note": one.note}
        for one in marks
    ]
    return pa.Table.from_pylist(rows, schema=MARKS)


def files_of(recording: Recording, source: Path) -> dict[str, bytes]:
    """The small files of a mission, with which it becomes a folder again."""
    folder = source if source.is_dir() else source.parent
    params = params_file(source)
    places = {
        PARAMS_FILE: params,
        origins_file(source).name: origins_file(source),
        GRAPH_FILE: folder / GRAPH_FILE,
        RUN_FILE: folder / RUN_FILE if source.is_dir() else None,
    }
    files = {
        name: path.read_bytes()
        for name, path in places.items()
        if path is not None and path.is_file() and path.stat().st_size <= _LARGEST_FILE
    }
    rows = len(recording.events), len(recording.summaries)
    return {MARKS_FILE: marks_json(recording, *rows), **files}


def mission_id(name: str, comparisons: pa.Table) -> str:
    """The name of a mission with a digest of what it did, the same however much of it is kept.

    >>> mission_id("today", COMPARISONS.empty_table())
    'today-e3b0c44298fc'
    """
    columns = ("key", "node", "evaluations", "first_ns", "last_ns")
    told = (" ".join(map(str, row.values())) for row in comparisons.select(columns).to_pylist())
    return f"{name}-{_digest(sorted(told))}"


def _digest(texts: Iterable[str]) -> str:
    found = hashlib.sha256("\n".join(texts).encode("utf-8", "backslashreplace"))
    return found.hexdigest()[:_DIGEST]
