from __future__ import annotations

import json
import math
from dataclasses import replace

import pyarrow as pa
import pytest
from mission_samples import SummaryBuilder, equal_tables, events, key, ns

from pytpc.base.errors import InputError
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Dropped, Recording, load_recording, save_recording
from pytpc.recording.summaries import (
    Summaries,
    Summary,
)


def summary(begin: float, number: int = 1, node: str = "/uav", **changes) -> Summary:
    """Three evaluations against 0.5, of 0.25, 0.75 and 1.0, within a tenth of a second."""
    plain = Summary(
        key=key(number),
        node=node,
        begin_ns=ns(begin),
        end_ns=ns(begin + 0.1),
        count=3,
        flops=1,
        far=3,
        odd=0,
        result=True,
        res=True,
        cmp=1.0,
        thresh=0.5,
        diff_min=-0.25,
        diff_max=0.5,
        diff_mean=0.5 / 3,
        abs_mean=1 / 3,
        low=0.25,
        high=1.0,
    )
    return replace(plain, **changes)


def table(*rows: Summary) -> Summaries:
    builder = SummaryBuilder()
    for row in rows:
        builder.add(row)
    return builder.build()


def test_sorted_by_begin_with_sorted_words():
    built = table(summary(2, 2, "/b", count=7), summary(1, 1, "/a"), summary(2, 1, "/b", count=8))
    assert built.begin_ns.tolist() == [ns(1), ns(2), ns(2)]
    assert built.count.tolist() == [3, 7, 8]
    assert (built.keys, built.nodes) == ((key(1), key(2)), ("/a", "/b"))
    assert (built.key.tolist(), built.node.tolist()) == ([0, 1, 0], [0, 1, 1])
    with pytest.raises(ValueError, match="read-only"):
        built.count[0] = 1


def test_every_field_comes_back(tmp_path):
    odd = summary(3, odd=3, far=0, cmp=math.nan, diff_min=math.nan, diff_max=math.nan,
                  diff_mean=math.nan, abs_mean=math.nan, low=math.nan, high=math.nan,
                  result=False, res=False)  # fmt: skip
    built = table(summary(1), odd)
    built.write(tmp_path / "s.parquet")
    again = Summaries.read(tmp_path / "s.parquet")
    assert equal_tables(again, built)
    assert again.abs_mean[0] == 1 / 3
    assert again.diff_min[0] == -0.25
    assert (again.result.tolist(), again.odd.tolist()) == ([True, False], [0, 3])
    assert math.isnan(again.low[1])
    assert not equal_tables(again.take([0]), built)


def test_take():
    both = table(summary(2, 3, "/z"), summary(1))
    assert both.keys == (key(1), key(3))
    assert [both.nodes[code] for code in both.node] == ["/uav", "/z"]
    assert both.take(both.count > 3).begin_ns.tolist() == []
    assert both.take([1]).begin_ns.tolist() == both.begin_ns[1:].tolist()


def test_columns_that_do_not_fit():
    columns = {name: [0] for name in Summaries.schema.names}
    with pytest.raises(ValueError, match="different lengths"):
        Summaries.of(**{**columns, "far": [1, 2]}, keys=["k"], nodes=["/n"])
    with pytest.raises(ValueError, match="a code has no key or node"):
        Summaries.of(**{**columns, "node": [1]}, keys=["k"], nodes=["/n"])
    lacking = Summaries.empty().to_arrow().drop_columns(["far"])
    with pytest.raises(InputError, match="column far occurs 0 times"):
        Summaries.from_arrow(lacking)
    other = Summaries.empty().to_arrow().set_column(4, "count", pa.array([], pa.int32()))
    with pytest.raises(InputError, match="column count is int32"):
        Summaries.from_arrow(other)


@pytest.fixture
def recording():
    return Recording(
        name="m",
        events=events([(1, 1, 0, 0.25, 0.5)]),
        marks=(Mark(ns(2), "I"),),
        start_ns=ns(1),
        end_ns=ns(3),
        summaries=table(summary(1), summary(1.1)),
        dropped=(Dropped(key(1), "/uav", 12, 2, "site"),),
    )


def test_a_recording_keeps_them(recording, tmp_path):
    save_recording(recording, tmp_path)
    again = load_recording(tmp_path)
    assert equal_tables(again.summaries, recording.summaries)
    assert again.dropped == recording.dropped
    # Written again without them, the folder has none.
    save_recording(replace(recording, summaries=Summaries.empty()), tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["events.parquet", "marks.json"]
    assert len(load_recording(tmp_path).summaries) == 0


def test_folders_of_before_and_of_two_recordings(recording, tmp_path):
    save_recording(recording, tmp_path)
    path = tmp_path / "marks.json"
    good = json.loads(path.read_text())
    old = {name: value for name, value in good.items() if name not in {"summaries", "dropped"}}
    path.write_text(json.dumps(old))
    assert len(load_recording(tmp_path).summaries) == 0
    assert load_recording(tmp_path).dropped == ()
    path.write_text(json.dumps({**good, "summaries": 5}))
    with pytest.raises(InputError, match=r"5 summaries, but summaries\.parquet has 2"):
        load_recording(tmp_path)
    path.write_text(json.dumps({**good, "dropped": [{"key": "k"}]}))
    with pytest.raises(InputError, match="not the marks of a recording"):
        load_recording(tmp_path)


def test_the_rows_of_a_key_are_in_the_order_of_the_table():
    found = table(summary(3.0, 2), summary(1.0, 1), summary(2.0, 2))
    assert found.rows_of(key(2)).tolist() == [1, 2]
    assert found.rows_of(key(1)).tolist() == [0]
    assert not found.rows_of(key(7)).size
