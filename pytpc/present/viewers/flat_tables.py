"""Writes a mission as flat tables, CSV or Parquet: what people load into pandas.

Every table repeats the names, so that each can be used alone. Text in CSV that a spreadsheet would
take for a formula gets an apostrophe before it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pa_csv

from pytpc.base.atomic import replacing
from pytpc.base.columns import table_writer
from pytpc.base.wording import utf8_text
from pytpc.diagnosis.results.exported import ExportedRows, MissionExport, Progress

_PART = 1 << 16
_FORMULA = r"^[=+\-@\t\r]"
_NUMERAL = r"^[+-]?[0-9.]+([eE][+-]?[0-9]+)?$"
_OURS = ("relation",)
_EVALUATIONS, _RANKS = "evaluations", "ranks"

Write = Callable[[pa.Table], None]
_TEXT, _NUMBER, _TIME = pa.string(), pa.float64(), pa.int64()
_WHEN = [("time_ns", _TIME), ("seconds", _NUMBER)]
_SCHEMAS = {
    _EVALUATIONS: [
        *_WHEN,
        ("node", _TEXT),
        ("parameter", _TEXT),
        ("place", _TEXT),
        ("relation", _TEXT),
        ("value", _NUMBER),
        ("threshold", _NUMBER),
        ("margin", _NUMBER),
        ("margin_unit", _TEXT),
        ("result", pa.bool_()),
        ("holds", pa.bool_()),
        ("flop", pa.bool_()),
        ("evaluations", pa.int64()),
        ("key", _TEXT),
    ],
    "comparisons": [
        (name, _TEXT)
        for name in (
            *("topic", "node", "parameter", "place", "relation", "margin_unit"),
            *("source_code", "key"),
        )
    ],
    "parameters": [
        *_WHEN,
        ("node", _TEXT),
        ("parameter", _TEXT),
        ("value", _NUMBER),
        ("text", _TEXT),
    ],
    "marks": [*_WHEN, ("type", _TEXT), ("observer", _TEXT), ("note", _TEXT)],
    "suspects": [
        *_WHEN,
        ("mark", pa.int64()),
        ("position", pa.int64()),
        ("parameter", _TEXT),
        ("probability", _NUMBER),
        ("type", _TEXT),
        ("place", _TEXT),
        ("value_to_try", _TEXT),
        ("none", _NUMBER),
    ],
    _RANKS: [
        *_WHEN,
        ("parameter", _TEXT),
        ("rank1", _NUMBER),
        ("rank2", _NUMBER),
        ("combined", _NUMBER),
    ],
}
TABLES: Sequence[str] = tuple(_SCHEMAS)
"""The names of the files, without their endings."""


def write_tables(
    found: MissionExport, folder: Path, kind: str, on_progress: Progress | None = None
) -> None:
    """Write one file for each of ``TABLES``, each atomically.

    Args:
        found: the mission.
        folder: is made if it does not exist.
        kind: ``csv`` or ``parquet``.
        on_progress: called with (evaluations and ranks written, all of them).

    Raises:
        TpcError: a file cannot be written.
    """
    tell = found.counting(on_progress)
    large = {_EVALUATIONS: _write_evaluations, _RANKS: _write_ranks}
    for name, columns in _SCHEMAS.items():
        schema = pa.schema(columns)
        path = folder / f"{name}.{kind}"
        opened = _csv_writer(path, schema) if kind == "csv" else table_writer(path, schema)
        with opened as write:
            if name in large:
                large[name](found, schema, write, tell)
                continue
            for rows in _ROWS[name](found):
                write(pa.Table.from_pylist(rows, schema))


def _write_evaluations(
    found: MissionExport, schema: pa.Schema, write: Write, tell: Callable[[int], None]
) -> None:
    about = {
        name: pa.array([utf8_text(getattr(one, field)) for one in found.series], _TEXT)
        for name, field in (
            ("node", "node"),
            ("parameter", "parameter"),
            ("place", "place"),
            ("relation", "relation"),
            ("margin_unit", "unit"),
            ("key", "key"),
        )
    }
    for rows in found.rows(_PART):
        write(_evaluations(rows, about, found.start_ns, schema))
        tell(rows.time_ns.size)


def _evaluations(
    rows: ExportedRows, about: dict[str, pa.Array], start_ns: int, schema: pa.Schema
) -> pa.Table:
    series = pa.array(rows.series)
    columns: dict[str, Any] = {name: text.take(series) for name, text in about.items()}
    columns |= rows._asdict()
    columns["seconds"] = (rows.time_ns - start_ns) / 1e9
    return pa.table([pa.array(columns[name]) for name in schema.names], schema=schema)


def _when(found: MissionExport, time_ns: int) -> dict[str, Any]:
    return {"time_ns": time_ns, "seconds": (time_ns - found.start_ns) / 1e9}


def _comparisons(found: MissionExport) -> Iterator[list[dict[str, Any]]]:
    yield [
        {
            "topic": utf8_text(one.topic),
            "node": utf8_text(one.node),
            "parameter": utf8_text(one.parameter),
            "place": utf8_text(one.place),
            "relation": one.relation,
            "margin_unit": one.unit,
            "source_code": utf8_text(one.source_code),
            "key": utf8_text(one.key),
        }
        for one in found.series
    ]


def _parameters(found: MissionExport) -> Iterator[list[dict[str, Any]]]:
    yield [
        {
            **_when(found, one.time_ns),
            "node": utf8_text(one.node),
            "parameter": utf8_text(one.parameter),
            "value": one.number,
            "text": utf8_text(one.text),
        }
        for one in found.values
    ]


def _marks(found: MissionExport) -> Iterator[list[dict[str, Any]]]:
    yield [
        {
            **_when(found, one.time_ns),
            "type": one.type or "",
            "observer": utf8_text(one.observer),
            "note": utf8_text(one.note),
        }
        for one in found.marks
    ]


def _suspects(found: MissionExport) -> Iterator[list[dict[str, Any]]]:
    yield [
        {
            **_when(found, at.time_ns),
            "mark": at.mark,
            "position": one.position,
            "parameter": utf8_text(one.parameter),
            "probability": one.probability,
            "type": one.type,
            "place": utf8_text(one.place),
            "value_to_try": one.to_try,
            "none": at.none,
        }
        for at in found.suspects
        for one in at.suspects
    ]


def _write_ranks(
    found: MissionExport, schema: pa.Schema, write: Write, tell: Callable[[int], None]
) -> None:
    """A row for each time and parameter: of a day, millions."""
    ranks = found.ranks
    names = pa.array([utf8_text(name) for name in ranks.parameters], _TEXT)
    size = max(1, _PART // max(1, len(names)))
    for begin in range(0, ranks.times_ns.size, size):
        part = slice(begin, begin + size)
        times = ranks.times_ns[part]
        each = np.repeat(times, len(names))
        columns: dict[str, Any] = {
            "time_ns": each,
            "seconds": (each - found.start_ns) / 1e9,
            "parameter": names.take(pa.array(np.tile(np.arange(len(names)), times.size))),
            "rank1": ranks.rank1[part].ravel(),
            "rank2": ranks.rank2[part].ravel(),
            "combined": ranks.combined[part].ravel(),
        }
        write(pa.table([pa.array(columns[name]) for name in schema.names], schema=schema))
        tell(each.size)


_ROWS: dict[str, Callable[[MissionExport], Iterator[list[dict[str, Any]]]]] = {
    "comparisons": _comparisons,
    "parameters": _parameters,
    "marks": _marks,
    "suspects": _suspects,
}


@contextmanager
def _csv_writer(path: Path, schema: pa.Schema) -> Iterator[Write]:
    """Write a CSV file atomically, table by table."""
    with replacing(path) as staged, pa_csv.CSVWriter(str(staged), schema) as writer:
        yield lambda table: writer.write_table(_without_formulas(table))


def _without_formulas(table: pa.Table) -> pa.Table:
    """The table with an apostrophe before each text that a spreadsheet would work out."""
    for number, field in enumerate(table.schema):
        if field.type != _TEXT or field.name in _OURS:
            continue
        texts = table.column(number)
        unsafe = pc.and_(
            pc.match_substring_regex(texts, _FORMULA),
            pc.invert(pc.match_substring_regex(texts, _NUMERAL)),
        )
        quoted = pc.binary_join_element_wise("'", texts, "")
        table = table.set_column(number, field, pc.if_else(unsafe, quoted, texts))
    return table
