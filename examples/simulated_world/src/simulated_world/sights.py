"""Sights as a table (Parquet): one column for each field of a sight."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from itertools import pairwise
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from simulated_world.atomic_file import replacing
from simulated_world.errors import ObserverError
from simulated_world.rules import SightT

# A field's type is its text where the module has postponed annotations.
COLUMN_TYPES = {"float": pa.float64(), "int": pa.int64(), "bool": pa.bool_()}


def schema_of(sight: type[SightT]) -> pa.Schema:
    """The columns of a table of such sights.

    Raises:
        TypeError: a field is no float, int or bool.
    """
    columns = []
    for field in fields(sight):
        name = field.type if isinstance(field.type, str) else field.type.__name__
        if name not in COLUMN_TYPES:
            raise TypeError(f"{sight.__name__}.{field.name} is no float, int or bool: {name}")
        columns.append(pa.field(field.name, COLUMN_TYPES[name], nullable=False))
    return pa.schema(columns)


def save_sights(sights: Sequence[SightT], sight: type[SightT], path: Path) -> None:
    """Write the table; it may have no row."""
    schema = schema_of(sight)
    columns = {name: [getattr(row, name) for row in sights] for name in schema.names}
    with replacing(path) as written:
        pq.write_table(pa.table(columns, schema=schema), written)


def load_sights(path: Path, sight: type[SightT]) -> list[SightT]:
    """Read the table.

    Raises:
        ObserverError: the file is no table of such sights, or their time does not run forwards.
        OSError: it cannot be read.
    """
    try:
        with path.open("rb") as stream:
            # A thread of Arrow that still holds the stream aborts a Python that ends
            # (apache/arrow#34314): none is asked.
            table = pq.ParquetFile(stream, pre_buffer=False).read(use_threads=False)
    except pa.ArrowException as error:
        raise ObserverError(f"{path}: no readable Parquet file") from error
    wanted = schema_of(sight)
    found = {field.name: field.type for field in table.schema}
    for field in wanted:
        if found.get(field.name) != field.type:
            there = found.get(field.name, "missing")
            raise ObserverError(f"{path}: column {field.name} is {there}, not {field.type}")
        if table[field.name].null_count:
            raise ObserverError(f"{path}: column {field.name} has gaps")
    columns = [table[name].to_pylist() for name in wanted.names]
    sights = [sight(*row) for row in zip(*columns, strict=True)]
    check_order(sights, path)
    return sights


def check_order(sights: Sequence[SightT], path: Path) -> None:
    """The time of sights must run forwards.

    Raises:
        ObserverError: it does not.
    """
    for number, (before, after) in enumerate(pairwise(sights), 1):
        if not before.time <= after.time:
            raise ObserverError(
                f"{path}: the time runs back from {before.time:.3f} s to {after.time:.3f} s"
                f" at sight {number}"
            )
