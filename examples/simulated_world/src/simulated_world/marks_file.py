"""Causes as JSON and marks as a table (Parquet): what the observers hand on."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from simulated_world.atomic_file import replacing
from simulated_world.crowd import CrowdMark
from simulated_world.rules import Cause

MARKS = pa.schema(
    [
        pa.field("time_ns", pa.int64(), nullable=False),
        pa.field("observer", pa.string(), nullable=False),
        pa.field("cause", pa.int32(), nullable=False),
        pa.field("right", pa.string(), nullable=False),
        pa.field("said", pa.string(), nullable=False),
    ]
)


def save_causes(causes: Sequence[Cause], path: Path) -> None:
    """Write a list of objects with ``kind``, ``start``, ``end`` and ``reason``."""
    text = json.dumps([asdict(cause) for cause in causes], indent=1, ensure_ascii=False)
    with replacing(path) as written:
        written.write_text(text + "\n", encoding="utf-8")


def save_marks(marks: Sequence[CrowdMark], path: Path) -> None:
    """Write the table; it may have no row."""
    columns = {name: [getattr(mark, name) for mark in marks] for name in MARKS.names}
    with replacing(path) as written:
        pq.write_table(pa.table(columns, schema=MARKS), written)
