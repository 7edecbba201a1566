from __future__ import annotations

import math

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mission_samples import SECOND, EventBuilder, equal_tables, events, key, ns

from pytpc.base.errors import InputError
from pytpc.recording.events import (
    Events,
    Report,
)

ROWS = st.lists(
    st.tuples(
        st.integers(0, 9),
        st.integers(0, 4),
        st.booleans(),
        st.floats(),
        st.floats(),
        st.sampled_from(["/b", "/a", "/c"]),
    )
)


def test_builder_sorts_by_time_and_keeps_recorded_order_of_equal_times():
    table = events([(2, 1, 1, 5, 0), (1, 0, 0, 6, 0), (2, 0, 1, 7, 0), (1, 1, 0, 8, 0)])
    assert table.time_ns.tolist() == [SECOND, SECOND, 2 * SECOND, 2 * SECOND]
    assert table.cmp.tolist() == [6, 8, 5, 7]
    assert [table.keys[code] for code in table.key] == [key(0), key(1), key(1), key(0)]


def test_words_are_sorted_whatever_came_first():
    builder = EventBuilder()
    builder.add(0, "/z", Report("b", True, 1.0, 2.0, True))
    builder.add(1, "/y", Report("a", True, 3.0, 4.0, True))
    table = builder.build()
    assert (table.keys, table.nodes) == (("a", "b"), ("/y", "/z"))
    assert (table.key.tolist(), table.node.tolist()) == ([1, 0], [1, 0])


# Rows by time: key 1 at 1 s (row 0), key 0 at 2 s (row 1), key 1 at 3 s (row 2).
def test_index_by_key():
    table = events([(1, 1, 0, 0, 0), (2, 0, 0, 0, 0), (3, 1, 0, 0, 0)])
    assert table.by_key.rows(0).tolist() == [1]
    assert table.by_key.rows(1).tolist() == [0, 2]
    assert table.by_key is table.by_key


# Key 0 in /a: F F T T F -> flops at rows 2 and 4. Key 1 in /a and /b: T in /a, F in /b: none.
def test_flops():
    table = events(
        [
            (0, 0, 0, 0, 0, "/a"),
            (1, 0, 0, 0, 0, "/a"),
            (2, 0, 1, 0, 0, "/a"),
            (3, 0, 1, 0, 0, "/a"),
            (4, 0, 0, 0, 0, "/a"),
            (5, 1, 1, 0, 0, "/a"),
            (6, 1, 0, 0, 0, "/b"),
            (7, 1, 1, 0, 0, "/a"),
        ]
    )
    assert np.flatnonzero(table.flop).tolist() == [2, 4]
    assert table.previous.tolist() == [-1, 0, 1, 2, 3, -1, -1, 5]


def test_between_is_closed():
    table = events([(second, 0, 0, second, 0) for second in range(5)])
    assert table.between(ns(1), ns(3)).cmp.tolist() == [1, 2, 3]
    assert len(table.between(ns(9), ns(1))) == 0


def test_with_keys_leaves_others_out_and_adds_missing_ones():
    table = events([(0, 1, 0, 1, 0), (1, 2, 0, 2, 0), (2, 3, 0, 3, 0)])
    other = table.with_keys([key(3), key(9), key(1)])
    assert other.cmp.tolist() == [1, 3]
    assert other.key.tolist() == [2, 0]
    assert other.by_key.rows(1).tolist() == []


def test_columns_that_do_not_fit_are_refused():
    good = {
        "time_ns": [0],
        "key": [0],
        "result": [1],
        "cmp": [1.0],
        "thresh": [1.0],
        "res": [1],
        "node": [0],
        "keys": ["k"],
        "nodes": ["/n"],
    }
    assert len(Events.of(**good)) == 1
    for name, wrong, message in [
        ("cmp", [1.0, 2.0], "different lengths"),
        ("key", [1], "a code has no key"),
        ("node", [-1], "a code has no key"),
        ("keys", ["k", "k"], "named twice"),
    ]:
        with pytest.raises(ValueError, match=message):
            Events.of(**{**good, name: wrong})


def test_arrays_are_read_only():
    table = events([(0, 0, 1, 1, 1)])
    with pytest.raises(ValueError, match="read-only"):
        table.cmp[0] = 7


@settings(deadline=None)
@given(ROWS)
def test_arrow_and_back(rows):
    table = events(rows)
    arrow = table.to_arrow()
    assert arrow.schema.equals(Events.schema)
    assert equal_tables(Events.from_arrow(arrow), table)


def test_parquet_and_back(tmp_path):
    table = events([(1, 0, 1, math.nan, -math.inf, "/a"), (0, 1, 0, 0.1, 5e-324, "/b")])
    path = tmp_path / "deep" / "events.parquet"
    table.write(path)
    assert equal_tables(Events.read(path), table)
    # The types survive for other readers too.
    assert pq.read_schema(path).field("key").type == Events.schema.field("key").type
    assert [p.name for p in path.parent.iterdir()] == ["events.parquet"]


def test_the_same_events_make_the_same_bytes(tmp_path):
    rows = [(1, 0, 1, 2, 3, "/a"), (0, 1, 0, 0.1, 5, "/b")]
    events(rows).write(tmp_path / "one")
    events(rows).write(tmp_path / "two")
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()


def test_chunks_with_their_own_dictionaries():
    left = events([(0, 0, 1, 1, 1)]).to_arrow()
    right = events([(1, 5, 1, 2, 1)]).to_arrow()
    table = Events.from_arrow(pa.concat_tables([right, left]))
    assert [table.keys[code] for code in table.key] == [key(0), key(5)]


def test_files_that_are_not_events(tmp_path):
    path = tmp_path / "e.parquet"
    with pytest.raises(InputError, match=r"e\.parquet: cannot be read: No such file"):
        Events.read(path)
    path.write_bytes(b"PAR1 and then nothing")
    with pytest.raises(InputError, match="not a file of events"):
        Events.read(path)
    whole = tmp_path / "whole.parquet"
    events([(n, 0, 1, n, 1) for n in range(1000)]).write(whole)
    path.write_bytes(whole.read_bytes()[:-40])
    with pytest.raises(InputError, match="not a file of events"):
        Events.read(path)
    table = events([(0, 0, 1, 1, 1)]).to_arrow()
    pq.write_table(table.drop_columns(["thresh"]), path)
    with pytest.raises(InputError, match="column thresh occurs 0 times"):
        Events.read(path)
    floats = table.set_column(0, "time_ns", pa.array([0.5]))
    pq.write_table(floats, path)
    with pytest.raises(InputError, match="column time_ns is double, not int64"):
        Events.read(path)
    empty_place = table.set_column(3, "cmp", pa.array([None], pa.float64()))
    pq.write_table(empty_place, path)
    with pytest.raises(InputError, match="column cmp has 1 missing values"):
        Events.read(path)


# A process that ends while a thread of Arrow's lets go of something of Python is aborted: now and
# then, after all of its work. Neither bytes nor a stream of Python's may be what is read.
def test_what_is_read_is_nothing_of_python(tmp_path, monkeypatch):
    path = tmp_path / "events.parquet"
    events([(1, 0, 1, 5, 0)]).write(path)
    read, sources = pq.ParquetFile, []
    monkeypatch.setattr(pq, "ParquetFile", lambda source: sources.append(source) or read(source))
    monkeypatch.setattr(pq, "read_table", None)
    assert len(Events.read(path)) == 1
    assert [type(source) for source in sources] == [pa.OSFile]
