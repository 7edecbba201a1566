"""Long binary files: comparisons in hot loops become flops and summaries while they are read."""

from __future__ import annotations

import math
import random
from pathlib import Path

import numpy as np
import pytest
from tpc_file import FULL, TpcFile, header, report, simulated, site, sync

from pytpc.diagnosis.scores.scores import type1
from pytpc.diagnosis.scores.summary_scores import LogTables, type2_of_summaries
from pytpc.ingest import condense
from pytpc.ingest.condense import condensed
from pytpc.ingest.gathering import Gathering
from pytpc.ingest.merged import Merged
from pytpc.ingest.reading import gather, read
from pytpc.recording.marks import Mark, marks_beside, write_marks
from pytpc.recording.mission import Recording

SECOND = 10**9
HOT, RARE = "aaaaaaaa-0000-5000-8000-000000000001", "bbbbbbbb-0000-5000-8000-000000000002"


def read_with_room(path: Path, rows: int | None) -> Recording:
    """Read a file where so many reports have room; None: all."""
    gathering = Gathering(most_rows=rows)
    gather([path], gathering)
    return Merged(gathering, "mission").recording()


def write(path: Path, reports: list[bytes], marks_ns: list[int], second: list[bytes] = ()) -> Path:  # type: ignore[assignment]
    """A file of one node with two sites, the reports of one or two threads, and marks."""
    file = TpcFile(header(real=0))
    file.system(sync(0, 0), site(1, HOT), site(2, RARE))
    for number, own in enumerate((reports, second), start=1):
        for first in range(0, len(own), FULL):
            file.thread(number, *own[first : first + FULL])
    file.write(path)
    write_marks([Mark(at, "II") for at in marks_ns], marks_beside(path))
    return path


@pytest.fixture(autouse=True)
def _nothing_stays_whole_but_the_rare(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(condense, "WHOLE_ROWS", 2)


def test_flops_and_summaries(tmp_path: Path) -> None:
    # Four evaluations of the hot one in the first tenth of a second, 1 > 2 is false; two in the
    # next. The mark's window begins at 0.15 s, which cuts the second period in two.
    reports = [
        report(1, 10**7, 1.0, 2.0),
        report(2, 2 * 10**7, 5.0, 4.0, result=1),
        report(1, 3 * 10**7, 2.5, 2.0, result=1),
        report(1, 4 * 10**7, 4.0, 2.0, result=1),
        report(1, 9 * 10**7, 1.5, 2.0),
        report(1, 12 * 10**7, 2.0, 2.0),
        report(1, 16 * 10**7, math.nan, 2.0),
    ]
    mark = 12 * SECOND + 15 * 10**7
    found = read_with_room(write(tmp_path / "a.tpc", reports, [mark]), 5)
    events = found.events
    assert [(int(t), events.keys[k], bool(r)) for t, k, r in zip(
        events.time_ns, events.key, events.result, strict=True
    )] == [
        (10**7, HOT, False),
        (2 * 10**7, RARE, True),
        (3 * 10**7, HOT, True),
        (9 * 10**7, HOT, False),
    ]  # fmt: skip
    rows = found.summaries
    # diff of the first four: -1, 0.5, 2, -0.5, of which all are far from 0.
    names = ("begin_ns", "end_ns", "count", "flops", "far", "odd", "diff_min", "diff_max", "low")
    table = [tuple(getattr(rows, name)[row] for name in names) for row in range(len(rows))]
    assert table[:2] == [
        (10**7, 9 * 10**7, 4, 2, 4, 0, -1.0, 2.0, 1.0),
        (12 * 10**7, 12 * 10**7, 1, 0, 0, 0, 0.0, 0.0, 2.0),
    ]
    assert table[2][:6] == (16 * 10**7, 16 * 10**7, 1, 0, 0, 1)
    assert math.isnan(table[2][6])
    assert (rows.diff_mean[0], rows.abs_mean[0], rows.high[0]) == (0.25, 1.0, 4.0)
    assert (rows.cmp[0], bool(rows.result[0])) == (1.5, False)
    assert (found.start_ns, found.end_ns) == (10**7, mark)
    (note,) = found.notes
    assert "6 evaluations of 1 comparison in hot loops" in note
    assert "summaries of 0.1 s" in note
    assert note.endswith(
        "; at other times than marks, and with another window than 12 s, the score of type II is an"
        " estimate"
    )


def test_whole_where_there_is_room(tmp_path: Path) -> None:
    reports = [report(1, at, 1.0, 2.0) for at in range(5)]
    path = write(tmp_path / "a.tpc", reports, [SECOND])
    assert len(read_with_room(path, None).events) == 5
    assert len(read_with_room(path, FULL).events) == 5
    assert len(read_with_room(path, FULL - 1).events) == 1


@pytest.mark.parametrize("seed", range(3))
def test_scores_are_those_of_all_evaluations(seed: int, tmp_path: Path) -> None:
    drawn = random.Random(seed)
    threads: list[list[bytes]] = []
    for _ in range(2):
        at, own = 0, []
        for _ in range(4000):
            at += drawn.randrange(1, 20 * 10**6)
            value = drawn.choice([drawn.gauss(0, 1), 1.0, math.nan]) if own else 0.0
            number = 2 if drawn.random() < 0.0002 else 1
            own.append(report(number, at, value, 1.0, result=int(value > 1.0)))
        threads.append(own)
    marks = [15 * SECOND, 31 * SECOND + 123456789]
    path = write(tmp_path / "a.tpc", threads[0], marks, threads[1])
    whole, short = read_with_room(path, None), read_with_room(path, 10)
    assert len(whole.events) == 8000
    assert len(short.summaries)
    keys = (HOT,)
    tables = [LogTables(each.events.with_keys(keys), each.summaries) for each in (whole, short)]
    ones = np.ones(1)
    first, second = (type1(each.events, marks, ones) for each in tables)
    np.testing.assert_array_equal(first, second)
    first, second = (type2_of_summaries(each, marks, ones) for each in tables)
    np.testing.assert_allclose(first, second, rtol=1e-9)


def test_of_very_many_flops_the_last_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(condense, "_MOST_FLOPS", 0)
    # A false one, then 7 flops, of which the last 2 may stay, or 3: those left out are even.
    reports = [report(1, 10**6 * n, float(n % 2), 0.5, result=n % 2) for n in range(8)]
    found = read_with_room(write(tmp_path / "a.tpc", reports, [SECOND]), 5)
    assert found.events.time_ns.tolist() == [0, 5 * 10**6, 6 * 10**6, 7 * 10**6]
    assert found.events.flop.tolist() == [False, True, True, True]
    assert found.summaries.flops.tolist() == [7]
    assert any("without 4 flops" in note for note in found.notes)


def test_a_window_ends_between_two_groups_of_chunks(tmp_path: Path) -> None:
    # 100,000 reports in a tenth of a second, which are read in several groups; the mark is within.
    reports = [report(1, 900 * n, n / 1e5, 2.0) for n in range(100_000)]
    path = write(tmp_path / "a.tpc", reports, [900 * 30_000])
    rows = read_with_room(path, 10).summaries
    assert rows.begin_ns.tolist() == [0, 900 * 30_001]
    assert rows.end_ns.tolist() == [900 * 30_000, 900 * 99_999]
    assert rows.count.tolist() == [30_001, 69_999]


def test_a_clock_that_is_set_within_a_block(tmp_path: Path) -> None:
    # The clock of the machine is 50 years fast for the first two reports: 1.6 * 10**10 periods.
    far = 50 * 365 * 24 * 3600 * SECOND
    file = TpcFile(header(real=0))
    file.system(sync(0, 0), site(1, HOT))
    file.thread(1, *(report(1, 10**6 * n, 1.0, 2.0) for n in range(2)))
    file.thread(1, simulated(3 * 10**6, far), *(report(1, 4 * 10**6, 1.0, 2.0) for _ in range(3)))
    rows = read_with_room(file.write(tmp_path / "a.tpc"), 1).summaries
    assert rows.begin_ns.tolist() == [0, far]
    assert rows.end_ns.tolist() == [10**6, far]
    assert rows.count.tolist() == [2, 3]


def test_a_file_without_reports_behind_a_full_mission(tmp_path: Path) -> None:
    write(tmp_path / "a.tpc", [report(1, at, 1.0, 2.0) for at in range(5)], [])
    empty = TpcFile(header(node="/other", pid=78))
    empty.system(sync(0, 0), site(1, HOT))
    empty.write(tmp_path / "b.tpc")
    assert len(read_with_room(tmp_path, 0).events) == 1


def test_a_binary_file_of_any_name_waits_for_the_marks(tmp_path: Path) -> None:
    # 0.01 s and 0.02 s are on both sides of the mark at 0.015 s, which is in another file.
    reports = [report(1, at * 10**7, 1.0, 2.0) for at in (1, 2, 3)]
    file = write(tmp_path / "a.log", reports, [])
    marks = tmp_path / "b.csv"
    write_marks([Mark(15 * 10**6, "II")], marks)
    gathering = Gathering(most_rows=0)
    gather([file, marks], gathering)
    found = Merged(gathering, "mission").recording()
    assert found.summaries.begin_ns.tolist() == [10**7, 2 * 10**7]


def test_the_periods_of_a_process_that_was_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Two summaries have room: of 2 s each, as the process has reported for 4 s. The last chunk
    # was begun, and has no record.
    monkeypatch.setattr(condense, "_MOST_SUMMARIES", 2)
    file = TpcFile(header(real=0))
    file.system(sync(0, 0), site(1, HOT))
    file.thread(1, *(report(1, at * SECOND, 1.0, 2.0) for at in (10, 11)))
    file.thread(1, *(report(1, at * SECOND, 1.0, 2.0) for at in (14, 15)))
    file.thread(1)
    rows = read_with_room(file.write(tmp_path / "a.tpc"), 1).summaries
    assert rows.count.tolist() == [2, 2]


@pytest.mark.parametrize("sites", [(1, 2), (1, 1)])
def test_threads_with_and_without_a_key_in_common(sites: tuple[int, int], tmp_path: Path) -> None:
    """Condensed while it is read, as in memory; in two threads the same key is one by time."""
    drawn = random.Random(7)
    threads = []
    for number in sites:
        times = sorted(drawn.sample(range(40 * SECOND), 5000))
        values = [drawn.choice([0.0, 1.0, 2.0, math.nan]) for _ in times]
        each = zip(times, values, strict=True)
        threads.append([report(number, at, cmp, 1.0, result=int(cmp > 1.0)) for at, cmp in each])
    path = write(tmp_path / "a.tpc", threads[0], [17 * SECOND], threads[1])
    found = read(path, period_ns=3 * SECOND)
    wanted = condensed(read_with_room(path, None), 3 * SECOND)
    assert found.events.keys == (HOT, RARE)[: len(set(sites))]
    for table in ("events", "summaries"):
        one, other = getattr(found, table), getattr(wanted, table)
        order = np.lexsort((getattr(one, one.order), one.key))
        same = np.lexsort((getattr(other, other.order), other.key))
        assert [one.keys[key] for key in one.key[order]] == [
            other.keys[key] for key in other.key[same]
        ]
        for name in one.columns().keys() - {"key", "node"}:
            np.testing.assert_allclose(
                getattr(one, name)[order], getattr(other, name)[same], rtol=1e-12, err_msg=name
            )
