"""The answers about a fleet as Arrow tables, for files that other tools read.

What is said of an answer as a whole is JSON in the metadata of its schema, under ``pytpc``.
docs/reference/fleet-answers.md has the columns.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import pyarrow as pa

from pytpc.base.wording import plain_json, utf8_text
from pytpc.diagnosis.results.fleet import FleetDrifts, FleetOutliers, FleetPlace, FleetRanking
from pytpc.present.as_json import Json
from pytpc.present.fleet_json import (
    drifts_json,
    found_json,
    judgement_json,
    outliers_json,
    ranking_json,
    tested_json,
)
from pytpc.present.fleet_texts import Found

METADATA = b"pytpc"


def _list_of(kind: pa.DataType) -> pa.DataType:
    return pa.list_(pa.field("item", kind, nullable=False))


_TEXTS = _list_of(pa.string())


def _fields(names: str, kind: pa.DataType, *, nullable: bool = False) -> list[pa.Field]:
    return [pa.field(name, kind, nullable=nullable) for name in names.split()]


_PLACE = _fields("key node place", pa.string(), nullable=True)
_VALUE = pa.struct(
    [
        *_fields("text", pa.string()),
        *_fields("number", pa.float64(), nullable=True),
        *_fields("bad good fresh", pa.int64()),
        *_fields("robots", _TEXTS),
    ]
)
RANKING = pa.schema(
    [
        *_fields("position", pa.int64()),
        *_fields("tied", pa.bool_()),
        *_fields("parameter", pa.string()),
        *_fields("probability prior diagnoses from_values behaviour", pa.float64()),
        *_fields("importance", pa.float64()),
        *_fields("importance_position", pa.int64(), nullable=True),
        *_fields("differs mean_position", pa.float64(), nullable=True),
        *_fields("values", _list_of(_VALUE)),
        *_fields("more_values", pa.int64()),
        *_fields("margin_bad margin_good", pa.float64(), nullable=True),
        *_fields("unit", pa.string()),
        *_PLACE,
        *_fields("robots", _TEXTS),
        *_fields("reason", pa.string()),
    ]
)
_DAY_MARGIN = pa.struct([*_fields("day", pa.string()), *_fields("margin", pa.float64())])
DRIFTS = pa.schema(
    [
        *_fields("robot", pa.string(), nullable=True),
        *_fields("parameter", pa.string()),
        *_PLACE,
        *_fields("measure since until", pa.string()),
        *_fields("days", pa.int64()),
        *_fields("threshold", pa.float64(), nullable=True),
        *_fields("now per_day", pa.float64(), nullable=True),
        *_fields("unit", pa.string()),
        *_fields("chance", pa.float64()),
        *_fields("clear", pa.bool_()),
        *_fields("turns_on earliest latest", pa.string(), nullable=True),
        *_fields("turned", pa.int64()),
        *_fields("margins", _list_of(_DAY_MARGIN)),
    ]
)
OUTLIERS = pa.schema(
    [
        *_fields("kind robot parameter", pa.string()),
        *_PLACE,
        *_fields("measure value", pa.string(), nullable=True),
        *_fields("own", pa.float64(), nullable=True),
        *_fields("usual_value", pa.string(), nullable=True),
        *_fields("usual", pa.float64(), nullable=True),
        *_fields("sisters", pa.int64()),
        *_fields("share score chance", pa.float64(), nullable=True),
        *_fields("set_otherwise", pa.bool_()),
    ]
)
_TURN = pa.struct(
    [
        *_fields("time_ns", pa.int64()),
        *_fields("key node parameter place", pa.string()),
        *_fields("result", pa.bool_()),
        *_fields("value threshold margin", pa.float64(), nullable=True),
    ]
)
FOUND = pa.schema(
    [
        *_fields("robot day mission", pa.string()),
        *_fields("start_ns", pa.int64()),
        *_fields("bad", pa.bool_()),
        *_fields("turns", pa.int64()),
        *_fields("least", pa.float64(), nullable=True),
        *_fields("where", _list_of(pa.struct(_fields("key node parameter place", pa.string())))),
        *_fields("turned", _list_of(_TURN)),
    ]
)


def ranking_table(ranking: FleetRanking) -> pa.Table:
    """A row for each suspect, in the schema ``RANKING``."""
    rows = []
    for one, fields in zip(
        ranking.suspects, _listed(ranking_json(ranking), "suspects"), strict=True
    ):
        evidence = _inside(fields.pop("evidence"))
        # Beside `values`, which are the values themselves.
        evidence["from_values"] = evidence.pop("values")
        rows.append({**fields, **evidence, **_place(one.shows)})
    return _table(rows, RANKING, judgement_json(ranking))


def drifts_table(drifts: FleetDrifts) -> pa.Table:
    """A row for each drift, in the schema ``DRIFTS``."""
    documents = _listed(drifts_json(drifts), "drifts")
    rows = [
        {**fields, **_place(one.where), "parameter": one.where.parameter}
        for one, fields in zip(drifts.drifts, documents, strict=True)
    ]
    return _table(rows, DRIFTS, tested_json(drifts))


def outliers_table(outliers: FleetOutliers) -> pa.Table:
    """A row for each decision and setting that differs, in the schema ``OUTLIERS``."""
    document = outliers_json(outliers)
    decisions, settings = _listed(document, "decisions"), _listed(document, "settings")
    rows = [
        {**fields, **_place(one.where), "kind": "decision", "parameter": one.where.parameter}
        for one, fields in zip(outliers.decisions, decisions, strict=True)
    ]
    rows += [
        {
            **fields,
            "kind": "setting",
            "usual_value": fields["usual"],
            "usual": None,
            "set_otherwise": True,
        }
        for fields in settings
    ]
    return _table(rows, OUTLIERS, {name: document[name] for name in ("robots", "tested", "notes")})


def found_table(found: Sequence[Found]) -> pa.Table:
    """A row for each mission, in the schema ``FOUND``."""
    return _table(found_json(found), FOUND)


def _place(one: FleetPlace | None) -> Json:
    names = ("key", "node", "place")
    return {name: None if one is None else getattr(one, name) for name in names}


def _listed(document: Json, name: str) -> list[Json]:
    found = document[name]
    assert isinstance(found, list)
    return found


def _inside(document: object) -> Json:
    assert isinstance(document, dict)
    return document


def _table(rows: Iterable[Json], schema: pa.Schema, about: Json | None = None) -> pa.Table:
    """The rows; Arrow takes of each the fields that the schema has."""
    table = pa.Table.from_pylist([_storable(row) for row in rows], schema=schema)
    if about is None:
        return table
    return table.replace_schema_metadata({METADATA: plain_json(about, indent=None).encode()})


def _storable(value: object) -> object:
    """A value whose texts, also those inside, any file can hold."""
    if isinstance(value, str):
        return utf8_text(value)
    if isinstance(value, Mapping):
        return {name: _storable(one) for name, one in value.items()}
    return [_storable(one) for one in value] if isinstance(value, list) else value
