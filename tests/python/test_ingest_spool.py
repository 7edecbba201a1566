"""Rows come back sorted and in the order of equal times, whatever is held in memory."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytpc.ingest import spool as module
from pytpc.ingest.spool import Spool

KIND = [("time_ns", "<i8"), ("number", "<i4")]


def rows(*times: int, begin: int = 0) -> np.ndarray:
    made = np.empty(len(times), KIND)
    made["time_ns"] = times
    made["number"] = range(begin, begin + len(times))
    return made


def collect(spool: Spool) -> list[tuple[int, int]]:
    return [tuple(row) for block in spool.blocks() for row in block.tolist()]


# Times 3 1 1 | 2 1, numbered as they come: sorted 1(1) 1(2) 1(4) 2(3) 3(0).
@pytest.mark.parametrize("run_rows", [1, 3, 100])
def test_equal_times_keep_their_order(tmp_path, run_rows):
    spool = Spool(KIND, "time_ns", tmp_path / "runs", run_rows)
    spool.append(rows(3, 1, 1))
    spool.append(rows(2, 1, begin=3))
    assert len(spool) == 5
    assert collect(spool) == [(1, 1), (1, 2), (1, 4), (2, 3), (3, 0)]
    assert collect(spool) == [(1, 1), (1, 2), (1, 4), (2, 3), (3, 0)]
    spool.close()
    assert list(tmp_path.iterdir()) == []


@given(
    st.lists(st.lists(st.integers(0, 6), max_size=9), max_size=12),
    st.integers(1, 9),
    st.integers(1, 4),
)
@settings(deadline=None, max_examples=150)
def test_as_sorting_all_at_once(tmp_path_factory, batches, run_rows, block):
    folder = tmp_path_factory.mktemp("spool")
    kept = module._SMALLEST_BLOCK, module._BLOCK_ROWS
    module._SMALLEST_BLOCK = module._BLOCK_ROWS = block
    try:
        spool = Spool(KIND, "time_ns", folder / "runs", run_rows)
        expected = []
        for batch in batches:
            spool.append(rows(*batch, begin=len(expected)))
            expected += [(time, len(expected) + n) for n, time in enumerate(batch)]
        assert collect(spool) == sorted(expected, key=lambda row: row[0])
    finally:
        module._SMALLEST_BLOCK, module._BLOCK_ROWS = kept


def test_nothing(tmp_path):
    assert collect(Spool(KIND, "time_ns", tmp_path / "runs")) == []
    assert collect(Spool(KIND, "time_ns")) == []
