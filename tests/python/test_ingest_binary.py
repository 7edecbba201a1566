"""The binary file; what is expected here comes from docs/reference/formats.md, byte by byte."""

from __future__ import annotations

import math

import numpy as np
import pytest
import tpc_file
from mission_samples import key
from tpc_file import (
    FULL,
    TpcFile,
    chunk,
    dropped,
    header,
    report,
    simulated,
    site,
    slot,
    summary,
    sync,
)

from pytpc.base.errors import InputError
from pytpc.ingest.binary_clock import Clock
from pytpc.ingest.reading import read
from pytpc.recording.mission import Dropped

REAL = 1_700_000_000 * 10**9
SECOND = 10**9


def file(**changes) -> TpcFile:
    """Steady time 0 is 1.7e9 s of ROS; sites 1 and 2 are called."""
    made = TpcFile(header(real=REAL, **changes))
    made.system(site(1, key(1)), site(2, key(2)), sync(0, REAL))
    return made


def rows(recording) -> list[tuple]:
    table = recording.events
    return [
        (time - REAL, table.keys[k], cmp, thresh, result, res)
        for time, k, cmp, thresh, result, res in zip(
            table.time_ns.tolist(),
            table.key.tolist(),
            table.cmp.tolist(),
            table.thresh.tolist(),
            table.result.tolist(),
            table.res.tolist(),
            strict=True,
        )
    ]


def test_reports(tmp_path):
    made = file(node="/uav")
    made.thread(
        1, report(1, 5, 0.25, 0.5), report(2, 7, 3.0, -1.0, result=1), report(1, 7, 9, 8, res=1)
    )
    recording = read(made.write(tmp_path / "uav-77-3.tpc"))
    assert rows(recording) == [
        (5, key(1), 0.25, 0.5, False, False),
        (7, key(2), 3.0, -1.0, True, True),
        (7, key(1), 9.0, 8.0, False, True),
    ]
    assert recording.events.nodes == ("/uav",)
    assert (recording.name, recording.notes, recording.malformed) == ("uav-77-3", (), 0)


# 3 full chunks and 5 records, then what was set aside and not used.
def test_many_chunks_and_what_is_behind_them(tmp_path):
    made = file()
    count = 3 * FULL + 5
    records = [report(1 + n % 2, n, n, 0.5, result=n % 3 == 0) for n in range(count)]
    for begin in range(0, count, FULL):
        made.thread(1, *records[begin : begin + FULL])
    path = made.write(tmp_path / "x.tpc", bytes(5 * tpc_file.CHUNK + 77))
    table = read(path).events
    assert table.time_ns.tolist() == [REAL + n for n in range(count)]
    assert table.cmp.tolist() == list(range(count))
    assert [table.keys[code] for code in table.key[:3]] == [key(1), key(2), key(1)]
    assert np.flatnonzero(table.result).tolist() == list(range(0, count, 3))


# Thread 2 begins first in the file, and its chunk covers both chunks of thread 1.
def test_threads_are_brought_together(tmp_path):
    made = file()
    made.thread(2, *(report(2, 3 * n, n, 0) for n in range(2000)))
    made.thread(1, *(report(1, 2 * n, n, 0) for n in range(FULL)))
    made.thread(1, *(report(1, 2 * (FULL + n), FULL + n, 0) for n in range(10)))
    table = read(made.write(tmp_path / "x.tpc")).events
    expected = sorted([2 * n for n in range(FULL + 10)] + [3 * n for n in range(2000)])
    assert (table.time_ns - REAL).tolist() == expected
    of_one = table.cmp[table.key == table.keys.index(key(1))]
    assert of_one.tolist() == list(range(FULL + 10))


# A thread's clock that goes back (a processor's counter) keeps the order of the file: 10, 10, 12.
def test_order_within_a_thread_is_that_of_the_file(tmp_path):
    made = file()
    made.thread(1, report(1, 10, 1, 0), report(1, 4, 2, 0), report(1, 12, 3, 0))
    made.thread(2, report(2, 7, 9, 0))
    assert read(made.write(tmp_path / "x.tpc")).events.cmp.tolist() == [9, 1, 2, 3]


@pytest.mark.parametrize(
    ("steady", "real"),
    [
        # Half way to the second sync, at which real time has gone 800 us more: 400 us.
        (5 * SECOND, 5 * SECOND + 400_000),
        # Behind it, on the way to the third, real time jumped an hour at 20 s: 800 us, then 1 h.
        (15 * SECOND, 15 * SECOND + 800_000),
        (20 * SECOND, 20 * SECOND + 3600 * SECOND),
        (30 * SECOND, 30 * SECOND + 3600 * SECOND),
        # Before the first.
        (-SECOND, -SECOND),
    ],
)
def test_clock(tmp_path, steady, real):
    made = TpcFile(header(real=REAL))
    made.system(
        site(1, key(1)),
        sync(0, REAL),
        sync(10 * SECOND, REAL + 10 * SECOND + 800_000),
        sync(20 * SECOND, REAL + 3620 * SECOND),
    )
    made.thread(1, report(1, steady, 1, 0))
    assert [row[0] for row in rows(read(made.write(tmp_path / "x.tpc")))] == [real]


def test_clock_of_many_at_once():
    clock = Clock.of([(0, 100), (10, 110), (20, 125), (30, 2_000_030)])
    steady = np.array([0, 9, 10, 18, 20, 29, 30, 40], np.int64)
    # 100; from 10 to 20 the difference grows from 100 to 105; then it jumps at 30.
    expected = [100, 109, 110, 122, 125, 134, 2_000_030, 2_000_040]
    assert clock.real(steady).tolist() == expected
    assert clock.real(steady[::-1]).tolist() == expected[::-1]


# 1 in wall time, then simulated time stands at 40 s for two reports and over the end of the chunk,
# then it is the wall's again.
def test_simulated_time(tmp_path):
    made = file()
    filler = [report(1, 3, 0, 0)] * (FULL - 4)
    made.thread(
        1,
        report(1, 1, 1, 0),
        simulated(2, 40 * SECOND),
        report(1, 3, 2, 0),
        report(2, 3, 3, 0),
        *filler,
    )
    made.thread(1, report(1, 4, 4, 0), simulated(5, -1), report(1, 6, 5, 0))
    table = read(made.write(tmp_path / "x.tpc")).events
    by_cmp = {cmp: time for cmp, time in zip(table.cmp, table.time_ns, strict=True) if cmp}
    assert by_cmp == {1: REAL + 1, 2: 40 * SECOND, 3: 40 * SECOND, 4: 40 * SECOND, 5: REAL + 6}


# The second record is half written: its first word, which is written last, is still 0.
def test_torn_record(tmp_path):
    made = file(state=0)
    made.thread(1, report(1, 1, 1, 2), bytes(4) + report(1, 2, 3, 4)[4:])
    recording = read(made.write(tmp_path / "x.tpc"))
    assert len(recording.events) == 1
    assert recording.notes == ("x.tpc: 1 record half written when the process ended",)


def test_a_gap_is_loss(tmp_path):
    made = file(node="/uav")
    made.thread(1, report(1, 1, 1, 2))
    made.thread(1, report(1, 9, 1, 2), skip=41)
    recording = read(made.write(tmp_path / "x.tpc"))
    assert recording.lost == {"/uav": 41}
    assert len(recording.events) == 2


def test_what_is_not_of_the_format_is_counted_and_located(tmp_path):
    made = file()
    made.thread(1, report(1, 1, 1, 2), report(9, 1, 1, 2), b"\x63" + bytes(31), report(2, 5, 3, 4))
    made.chunks.append(tpc_file.chunk(8, 0, 0, b""))
    made.system(site(1, key(7)), site(3, "\x07"), b"\x50" + bytes(31))
    recording = read(made.write(tmp_path / "x.tpc"))
    assert [row[1] for row in rows(recording)] == [key(1), key(2)]
    # The thread's chunk begins at 4096 + 65536, its records 64 bytes later.
    assert sorted(record.what for record in recording.malformed_first) == [
        "a chunk of the unknown kind 8 at byte 135168",
        "a record of the unknown kind 80 at byte 200864",
        "a record of the unknown kind 99 at byte 69760",
        "a report of the unknown site 9 at byte 69728",
        "site 1 has a second key at byte 200768",
        "the key of site 3 has no or odd characters at byte 200832",
    ]
    assert {record.topic for record in recording.malformed_first} == {"x.tpc"}


# 10 reports are missing because of the disk, 4 of them were told of; the rest is in the header.
def test_dropped_and_stopped(tmp_path):
    made = file(node="/uav", state=2, not_recorded=10)
    made.system(dropped(1, 1, 5, 2), dropped(1, 1, 3, 1), dropped(0, 4, 4, 0), dropped(2, 3, 1, 0))
    recording = read(made.write(tmp_path / "x.tpc"))
    assert recording.dropped == (
        Dropped("", "/uav", 10, 0, "stopped"),
        Dropped(key(1), "/uav", 8, 3, "site"),
        Dropped(key(2), "/uav", 1, 0, "nested"),
    )
    assert recording.notes == (
        "x.tpc: recording stopped before the process ended (disk full, or file_limit)",
    )


def test_keys_of_any_length(tmp_path):
    names = ["k", "x" * 16, "y" * 17, "z" * 48, "w" * 49]
    made = TpcFile(header(real=REAL))
    made.system(*(site(n, name) for n, name in enumerate(names, start=1)))
    made.thread(1, *(report(n, n, 0, 0) for n in range(1, 6)))
    assert [row[1] for row in rows(read(made.write(tmp_path / "x.tpc")))] == names


def test_node_that_is_not_known(tmp_path):
    made = file(node="", program="/opt/ws/lib/pkg/talker", pid=12)
    made.thread(1, report(1, 1, 1, 2))
    assert read(made.write(tmp_path / "x.tpc")).events.nodes == ("talker (12)",)


# Of 5 evaluations one is odd; cmp - thresh of the others sums up to 2, their absolutes to 3.
def test_summaries(tmp_path):
    made = file(node="/uav")
    given = {"counts": (5, 1, 3, 2), "diff": (-0.5, 2.0, 2.0, 3.0), "span": (-1.0, 4.0)}
    made.system(
        summary(1, begin=(10, 0), end=(20, 0), last=(1.5, 0.5), result=1, **given),
        summary(2, begin=(1, 70), end=(2, 90), counts=(2, 2, 0, 0), period=4),
        summary(9),
        summary(1, counts=(1, 2, 0, 0)),
    )
    made.live(
        # Written above already, in the same period.
        slot(summary(2, counts=(2, 2, 0, 0), period=4), 2),
        # Still open: it ends with the last report of the file. Its last evaluation is half counted.
        slot(summary(2, begin=(15, 0), counts=(7, 0, 0, 0), period=5, res=1), 8),
        bytes(192),
    )
    made.thread(1, report(1, 33, 1, 0))
    recording = read(made.write(tmp_path / "x.tpc"))
    table = recording.summaries
    assert table.begin_ns.tolist() == [70, REAL + 10, REAL + 15]
    assert table.end_ns.tolist() == [90, REAL + 20, REAL + 33]
    assert [table.keys[code] for code in table.key] == [key(2), key(1), key(2)]
    assert table.count.tolist() == [2, 5, 7]
    assert (table.odd.tolist(), table.far.tolist(), table.flops.tolist()) == (
        [2, 1, 0],
        [0, 3, 0],
        [0, 2, 0],
    )
    assert (table.result.tolist(), table.res.tolist()) == ([0, 1, 0], [0, 0, 1])
    # 2 / 4 and 3 / 4; of evaluations that are all odd nothing is known.
    assert (table.diff_mean[1], table.abs_mean[1]) == (0.5, 0.75)
    assert (table.diff_min[1], table.diff_max[1], table.low[1], table.high[1]) == (-0.5, 2, -1, 4)
    assert (table.cmp[1], table.thresh[1]) == (1.5, 0.5)
    assert math.isnan(table.diff_min[0])
    assert math.isnan(table.diff_mean[0])
    assert recording.notes == ("x.tpc: 1 open period may lack an evaluation",)
    assert sorted(record.what for record in recording.malformed_first) == [
        "a summary of the unknown site 9",
        "a summary whose counts contradict one another",
    ]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda data: data[:2000], "the file ends at byte 2000, within its header"),
        (lambda data: data[:12] + b"\x40" + data[13:], "are not of this version"),
    ],
)
def test_files_of_another_form(tmp_path, change, message):
    path = tmp_path / "x.tpc"
    path.write_bytes(change(file().data()))
    with pytest.raises(InputError, match=message):
        read(path)


# Whatever byte it is cut at: what is whole is read.
@pytest.mark.parametrize("cut", [0, 1, 31, 32, 33, 65000])
def test_a_file_that_is_cut(tmp_path, cut):
    made = file()
    made.thread(1, *(report(1, n, n, 0) for n in range(FULL)))
    data = made.data()
    path = tmp_path / "x.tpc"
    path.write_bytes(data[: len(data) - cut])
    assert len(read(path).events) == FULL - -(-cut // 32)


def test_a_hole_of_a_terabyte_is_jumped_over(tmp_path):
    made = file()
    made.thread(1, report(1, 1, 1, 2))
    path = made.write(tmp_path / "x.tpc")
    with path.open("r+b") as stream:
        stream.truncate(1 << 40)
    assert len(read(path).events) == 1


def test_threads_of_many_groups_of_chunks(tmp_path):
    # Report n of thread t is at 10 n + t, and compares 3 n + t: memory is used again for each group
    # of chunks, also while other threads still wait with a part of theirs.
    count, threads = 40 * FULL + 5, 3
    data = header() + chunk(2, 0, 0, sync(0, 0) + site(1, key(1)))
    for first in range(0, count, FULL):
        for thread in range(threads):
            numbers = np.arange(first, min(first + FULL, count))
            records = np.zeros(numbers.size, "<u4, <u4, <i8, <f8, <f8")
            records.dtype.names = ("what", "site", "steady", "cmp", "thresh")
            records["what"], records["site"] = 1, 1
            records["steady"] = 10 * numbers + thread
            records["cmp"] = 3 * numbers + thread
            data += chunk(1, thread + 1, first, records.tobytes())
    path = tmp_path / "a.tpc"
    path.write_bytes(data)
    events = read(path).events
    assert events.cmp.tolist() == list(range(threads * count))
    assert events.time_ns.tolist() == [10 * n + t for n in range(count) for t in range(threads)]
