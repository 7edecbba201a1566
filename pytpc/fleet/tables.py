"""The tables of a fleet's data set (docs/reference/formats.md#data-set-of-a-fleet).

Robot, day and mission are in the path of a file alone: tools that read partitioned data sets make
columns of them.
"""

from __future__ import annotations

from typing import Literal, get_args

import pyarrow as pa

from pytpc.recording.events import Events
from pytpc.recording.summaries import Summaries

SCHEMA = 1
Table = Literal["missions", "reports", "summaries", "comparisons", "values", "marks"]
TABLES: tuple[Table, ...] = get_args(Table)
COMMIT: Table = "missions"
"""Written last and removed first: a mission without a row here does not exist."""

WORD = pa.dictionary(pa.int32(), pa.string())


def _all(kind: pa.DataType, *names: str, nullable: bool = False) -> list[pa.Field]:
    return [pa.field(name, kind, nullable=nullable) for name in names]


MISSIONS = pa.schema(
    [
        *_all(pa.string(), "name", "source", "stamp", "build", "verdict", "keep", "tpc"),
        *_all(pa.int64(), "start_ns", "end_ns", "reports", "rows"),
        *_all(pa.int32(), "marks"),
        *_all(pa.float64(), "seconds"),
        pa.field("notes", pa.list_(pa.string()), nullable=False),
        pa.field("files", pa.map_(pa.string(), pa.binary()), nullable=False),
    ]
)
COMPARISONS = pa.schema(
    [
        *_all(WORD, "key", "node", "parameter", "file", "relation", "kind", "unit"),
        *_all(pa.int32(), "lineno", "thresholds"),
        *_all(pa.int64(), "evaluations", "first_ns", "last_ns", "turns", "near_misses"),
        *_all(pa.int64(), "first_turn_ns", nullable=True),
        *_all(pa.bool_(), "result_first", "result_last"),
        *_all(pa.float64(), "seconds", "true_share", "thresh_first", "thresh_last"),
        *_all(pa.float64(), "value_low", "value_high", "reach"),
        *_all(pa.float64(), "least", "low", "median", "high", nullable=True),
        *_all(pa.float64(), "undecided", "drift_per_minute", nullable=True),
    ]
)
VALUES = pa.schema(
    [
        *_all(WORD, "name", "origin", "origin_digest"),
        *_all(pa.int64(), "time_ns", nullable=True),
        *_all(pa.string(), "value"),
        *_all(pa.float64(), "number", nullable=True),
    ]
)
MARKS = pa.schema(
    [
        *_all(pa.int64(), "time_ns"),
        *_all(pa.string(), "type", nullable=True),
        *_all(pa.string(), "observer", "note"),
    ]
)
SCHEMAS: dict[Table, pa.Schema] = {
    "missions": MISSIONS,
    "reports": Events.schema,
    "summaries": Summaries.schema,
    "comparisons": COMPARISONS,
    "values": VALUES,
    "marks": MARKS,
}
