"""Digests of missions of a fleet for the tests, written out by hand."""

from __future__ import annotations

from typing import Any, NamedTuple

import pyarrow as pa
from mission_samples import key

DAY_NS = 86_400 * 10**9
# 2026-03-01 00:00 UTC is 1772323200 s.
FIRST_DAY_NS = 1_772_323_200 * 10**9

_SCHEMA = pa.schema(
    [
        *((name, pa.string()) for name in ("mission", "robot", "day", "verdict", "key", "node")),
        *((name, pa.string()) for name in ("parameter", "file", "relation", "kind", "unit")),
        *((name, pa.int64()) for name in ("start_ns", "lineno", "turns", "thresholds")),
        *((name, pa.float64()) for name in ("seconds", "true_share", "thresh_last")),
        *((name, pa.float64()) for name in ("value_low", "value_high", "least", "median")),
        *((name, pa.bool_()) for name in ("result_first", "result_last")),
    ]
)


class Flight(NamedTuple):
    """A mission: its name, robot, number of the day from 1, and verdict."""

    mission: str
    robot: str = "r1"
    day: int = 1
    verdict: str = "good"


def digest(flight: Flight, number: int = 0, thresh: float = 0.5, **changes: Any) -> dict[str, Any]:
    """A row: comparison ``number`` of one parameter; 60 s true, 1 turn, margins 0.1 and 0.2."""
    return {
        "mission": flight.mission,
        "robot": flight.robot,
        "day": f"2026-03-{flight.day:02}",
        "start_ns": FIRST_DAY_NS + (flight.day - 1) * DAY_NS + changes.pop("at_ns", 0),
        "verdict": flight.verdict,
        "key": key(number),
        "node": "/nav",
        "parameter": f"/nav/p{number}",
        "file": "src/nav.cpp",
        "lineno": 10 + number,
        "relation": ">",
        "kind": "parameter",
        "unit": "parameter",
        "turns": 1,
        "seconds": 60.0,
        "true_share": 1.0,
        "result_first": True,
        "result_last": True,
        "thresh_last": thresh,
        "thresholds": 1,
        "value_low": 0.0,
        "value_high": 1.0,
        "least": 0.1,
        "median": 0.2,
        **changes,
    }


def table(rows: list[dict[str, Any]]) -> pa.Table:
    """The rows in the schema of a fleet's digests, joined with their missions."""
    return pa.Table.from_pylist(rows, schema=_SCHEMA)
