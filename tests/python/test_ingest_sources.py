"""Messages of ROS 2, text, batches, and several recordings of one mission at once."""

from __future__ import annotations

import gzip
import shutil
import sqlite3

import numpy as np
import pytest
import tpc_file
from mission_samples import BagFile, equal_tables, key, line, ns
from recorded_messages import log
from ros2_bags import Ros2Bag
from tpc_file import TpcFile, report, site, sync

from pytpc.base.errors import InputError
from pytpc.ingest.bag_chunks import ChunkMessages as Chunk
from pytpc.ingest.decoders import ROS1
from pytpc.ingest.gathering import Gathering
from pytpc.ingest.messages import Messages
from pytpc.ingest.reading import read
from pytpc.ingest.rosout_line import PREFIX
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Dropped, save_recording

SUMMARY = (
    "threshold_summary:{key},1,cmp:1,thresh:0.5,res:1,count:3,flops:1,diff:-0.25;0.5;0.1,"
    "abs:0.3,range:0.25;1,far:3,odd:0,span:10.000000001;10.1"
)


def stamped(seconds: str, number: int, result: int, cmp: float, thresh: float) -> str:
    return f"{seconds},{line(number, result, cmp, thresh).removeprefix(PREFIX)}"


def found(recording) -> list[tuple]:
    table = recording.events
    return [
        (time, table.nodes[node], table.keys[code], cmp)
        for time, node, code, cmp in zip(
            table.time_ns.tolist(),
            table.node.tolist(),
            table.key.tolist(),
            table.cmp.tolist(),
            strict=True,
        )
    ]


# --- ROS 2


@pytest.fixture(params=["mcap", "db3"])
def ros2(request, tmp_path):
    with Ros2Bag(tmp_path / "mission", request.param) as bag:
        bag.log(10.5, "uav", line(1, 0, 0.2, 0.5))
        bag.log(11, "uav", "taking off")
        bag.log(12, "uav", PREFIX + "oops")
        bag.text(13, "/threshold_information", stamped("12.9000000", 2, 1, 3, 1))
        bag.mark(14, "/marks1/mark_no_action", 13.5)
        bag.text(15, "/mark_action", "now")
    return bag.file


def test_ros2(ros2):
    recording = read(ros2)
    assert found(recording) == [(ns(10.5), "/uav", key(1), 0.2), (ns(12.9), "", key(2), 3)]
    assert recording.marks == (Mark(ns(13.5), "II", "marks1"),)
    assert recording.malformed == 1
    assert recording.malformed_first[0].topic == "/rosout"
    assert recording.notes == (
        "/mark_action carries std_msgs/msg/String, not builtin_interfaces/msg/Time or"
        " std_msgs/msg/Time: not read",
    )
    assert (recording.start_ns, recording.end_ns) == (ns(10.5), ns(15))
    # The folder in which rosbag2 keeps it, and a name that says nothing (and is no URI).
    assert found(read(ros2.parent)) == found(recording)
    other = ros2.parent / "what is this?#%41"
    shutil.copy(ros2, other)
    assert found(read(other)) == found(recording)


def test_ros2_files_that_are_cut_are_one_line(ros2):
    data = ros2.read_bytes()
    # An .mcap file with whole records behind its header is read.
    cuts = [200, len(data) // 3, len(data) // 2, len(data) - 9]
    for size in [30, *(cuts if ros2.suffix == ".db3" else [])]:
        ros2.write_bytes(data[:size])
        with pytest.raises(InputError) as caught:
            read(ros2)
        assert "\n" not in str(caught.value)
        assert "truncated or damaged" in str(caught.value)
        assert ("recovers the rest" in str(caught.value)) == (ros2.suffix == ".db3")


# Found by fuzzing.
@pytest.mark.parametrize("change", ["data = 7", "timestamp = 'x'"])
def test_columns_of_another_type_in_db3(tmp_path, change):
    with Ros2Bag(tmp_path / "m", "db3") as bag:
        bag.log(1, "uav", line(1, 0, 1, 2))
        bag.log(2, "uav", line(1, 1, 3, 2))
    with sqlite3.connect(bag.file) as base:
        base.execute(f"UPDATE messages SET {change} WHERE id = 1")
    base.close()
    try:
        recording = read(bag.file)
    except InputError as error:
        assert "truncated or damaged" in str(error)
    else:
        assert (len(recording.events), recording.malformed) == (1, 1)


# --- text

LOG = """\
\x1b[0m[ INFO] [1700000000.123456789]: {a}\x1b[0m
plain words
[ INFO] [1700000001.5, 42.250000000]: {b}
[ WARN] [1700000002.000000001]: something else
{c}
[INFO] [/uav/face] [1700000003.25] {d}
1700000004.000000000 INFO /brain [brain.cpp:12(step)] [topics: /rosout, /cmd] {e}
[ INFO] [1700000005.0]: {a}[ INFO] [1700000005.1]: {b}
"""


def test_console_text(tmp_path):
    path = tmp_path / "roslaunch.txt"
    names = {name: line(n, n % 2, n, 0.5) for n, name in enumerate("abcde", start=1)}
    path.write_text(LOG.format(**names))
    recording = read(path)
    assert found(recording) == [
        (42_250_000_000, "roslaunch", key(2), 2),
        (1_700_000_000_123_456_789, "roslaunch", key(1), 1),
        (1_700_000_002_000_000_001, "roslaunch", key(3), 3),
        (1_700_000_003_250_000_000, "/uav/face", key(4), 4),
        (1_700_000_004_000_000_000, "/brain", key(5), 5),
    ]
    assert recording.malformed == 1
    assert recording.malformed_first[0].what.startswith("line 8: ")
    assert "roslaunch.txt: 1 line without a time got that of the line before" in recording.notes


@pytest.mark.parametrize("headline", ["", "time,key,result,cmp,thresh,res\n"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_csv(tmp_path, headline, end):
    path = tmp_path / "reports.csv"
    rows = [
        stamped("1700000000.1234567", 1, 0, 0.25, 0.5),
        stamped("1700000001.0000000", 2, 1, float("inf"), 1e-300),
        "broken",
        "",
        stamped("1700000002.123456789", 1, 1, 7, 0.5),
        f"1700000003.0,{SUMMARY.format(key=key(1))}",
        f"1700000003.0,threshold_dropped:{key(2)},count:12,flops:3,why:site",
    ]
    path.write_bytes((headline + end.join(rows)).encode())
    recording = read(path)
    assert [(time, cmp) for time, _, _, cmp in found(recording)] == [
        (1_700_000_000_123_456_700, 0.25),
        (1_700_000_001_000_000_000, float("inf")),
        (1_700_000_002_123_456_789, 7),
    ]
    number = 3 + bool(headline)
    assert [record.what for record in recording.malformed_first] == [
        f"line {number}: a time in seconds is expected, column 1"
    ]
    assert recording.summaries.begin_ns.tolist() == [10_000_000_001]
    assert recording.dropped == (Dropped(key(2), "reports", 12, 3, "site"),)


@pytest.mark.parametrize("headline", ["", "time,key,result,cmp,thresh,res\r\n"])
def test_csv_with_a_byte_order_mark(tmp_path, headline):
    path = tmp_path / "reports.csv"
    rows = [stamped("1.5", 1, 0, 1, 2), stamped("2.5", 1, 1, 3, 2)]
    path.write_bytes(b"\xef\xbb\xbf" + (headline + "\r\n".join(rows)).encode())
    recording = read(path)
    assert [cmp for *_, cmp in found(recording)] == [1, 3]
    assert recording.malformed == 0


def test_a_first_line_that_is_broken_is_no_headline(tmp_path):
    path = tmp_path / "reports.csv"
    path.write_text("\n".join([stamped("12345678901.5", 1, 0, 1, 2), stamped("2.5", 1, 1, 3, 2)]))
    recording = read(path)
    assert recording.malformed_first[0].what == "line 1: a time in seconds is expected, column 1"
    assert len(recording.events) == 1


@pytest.mark.parametrize(
    "spoilt",
    [
        lambda text: text.replace(",", ";"),
        lambda text: f'"{text}"',
        lambda text: text.replace("1.5", "1"),
        lambda text: f'data: "{text}"',
    ],
)
def test_what_a_spreadsheet_made_of_csv_is_counted(tmp_path, spoilt):
    path = tmp_path / "reports.csv"
    path.write_text("\n".join(spoilt(stamped("1.5", 1, 0, 1, 2)) for _ in range(3)))
    recording = read(path)
    assert (len(recording.events), recording.malformed) == (0, 3)
    assert recording.malformed_first[0].what.startswith("line 1: neither a line of a log nor TIME,")


def test_text_without_reports_is_told(tmp_path):
    (tmp_path / "a.log").write_text("[ INFO] [1.5]: hello\n")
    (tmp_path / "b.log").write_text(f"[ INFO] [1.5]: {line(1, 0, 1, 2)}\n")
    recording = read(tmp_path)
    assert recording.notes == (f"1 text file without a report, for example {tmp_path / 'a.log'}",)


def test_marks_as_a_spreadsheet_writes_them(tmp_path):
    path = tmp_path / "marks.csv"
    path.write_bytes(b"\xef\xbb\xbftime_ns,type,observer,note\r\n1500000000,I,ana,hm\r\n")
    assert read(path).marks == (Mark(1_500_000_000, "I", "ana", "hm"),)
    path.write_text("time_ns;type;observer;note\n1500000000;I;ana;hm\n")
    with pytest.raises(InputError, match="the first line is not time_ns,type,observer,note"):
        read(path)


# Found by fuzzing: 2^63 ns is 9,223,372,036.854775808 s.
@pytest.mark.parametrize("text", ["9223372036.854775808", "9999999999.999999999"])
def test_times_that_no_table_holds(tmp_path, text):
    good = [stamped("9223372036.854775807", 1, 0, 1, 2), stamped("1.0", 1, 0, 1, 2)]
    path = tmp_path / "x.csv"
    path.write_text("\n".join([*good, stamped(text, 1, 0, 1, 2)]))
    recording = read(path)
    assert [time for time, *_ in found(recording)] == [10**9, 2**63 - 1]
    assert recording.malformed_first[0].what == "line 3: a time beyond the year 2262, column 1"
    log = tmp_path / "x.log"
    log.write_text(f"[ INFO] [7.5]: up\n[ INFO] [{text}]: {line(1, 0, 1, 2)}\n")
    assert [time for time, *_ in found(read(log))] == [7_500_000_000]


def test_a_line_without_end(tmp_path):
    path = tmp_path / "x.log"
    report_text = f"[1700000000.5]: {line(1, 1, 2, 1)}"
    path.write_text(f"{PREFIX}{'9' * 3_000_000}\n{report_text}\n")
    recording = read(path)
    assert len(recording.events) == 1
    assert recording.malformed == 1
    assert len(recording.malformed_first[0].text) == 200


def test_what_is_nothing_that_is_read(tmp_path):
    (tmp_path / "x.gz").write_bytes(gzip.compress(b"abc"))
    with pytest.raises(InputError, match="neither a bag"):
        read(tmp_path / "x.gz")
    (tmp_path / "x").write_bytes(b"")
    with pytest.raises(InputError, match="the file is empty"):
        read(tmp_path / "x")
    with pytest.raises(InputError, match="no such bag, file or folder"):
        read(tmp_path / "y")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="no recordings in this folder"):
        read(tmp_path / "empty")


# Logs alone may be of anything, such as the `log` folder of a workspace.
def test_a_folder_of_missions_names_them(tmp_path):
    for number in range(8):
        (tmp_path / f"out/day{number}").mkdir(parents=True)
        (tmp_path / f"out/day{number}/run.json").write_text("{}")
    for name in ("bags/one/a.bag", "bags/log/build.log", "bags/notes.txt.d/x"):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_bytes(b"")
    with pytest.raises(InputError) as error:
        read(tmp_path / "out")
    days = ", ".join(f"{tmp_path}/out/day{number}" for number in range(6))
    assert str(error.value) == (
        f"{tmp_path}/out: no recordings in this folder; give one of the 8 below it: {days}"
        " and 2 more"
    )
    with pytest.raises(InputError, match=f"; give the one below it: {tmp_path}/bags/one$"):
        read(tmp_path / "bags")


# --- batches, summaries and drops in messages


# Process 9 of /uav: reports 0 and 1 (dropped 2 so far), then 4 (2 and 3 are missing), by then 7
# dropped of which a line tells of 4. A second message announces 3 reports and has 1.
def test_batches(tmp_path):
    path = tmp_path / "batch.bag"
    head = "#seq:{},count:{},dropped:{},pid:9,steady:1.000000000"
    with BagFile(path) as bag:
        first = [
            head.format(0, 2, 2),
            stamped("10.5", 1, 0, 1, 2),
            stamped("10.6", 1, 1, 3, 2),
            f"10.7,{SUMMARY.format(key=key(1))}",
        ]
        second = [
            head.format(4, 3, 7),
            stamped("10.9", 1, 0, 1, 2),
            f"11.0,threshold_dropped:{key(1)},count:4,flops:1,why:process",
        ]
        bag.text(11, "/threshold_information", "/uav", "\n".join(first))
        bag.text(12, "/threshold_information", "/uav", "\n".join(second) + "\n")
        bag.text(13, "/threshold_information", "/uav", "#seq:x")
    recording = read(path)
    assert [(time, node) for time, node, _, _ in found(recording)] == [
        (ns(10.5), "/uav"),
        (ns(10.6), "/uav"),
        (ns(10.9), "/uav"),
    ]
    assert recording.lost == {"/uav": 2}
    assert recording.dropped == (
        Dropped("", "/uav", 3, 0, "unknown"),
        Dropped(key(1), "/uav", 4, 1, "process"),
    )
    assert [record.what for record in recording.malformed_first] == [
        "the first line announces 3 reports, 1 found",
        "a line that begins with # is #seq:N,count:N,dropped:N,pid:P,steady:S, column 1",
    ]
    table = recording.summaries
    assert (table.count.tolist(), table.end_ns.tolist()) == ([3], [ns(10.1)])
    assert (table.diff_mean[0], table.abs_mean[0], table.low[0]) == (0.1, 0.3, 0.25)


# A key is on /rosout first; then the node's sink is changed: its own numbered messages are not what
# a converter passes on.
def test_a_sink_that_is_changed_meanwhile(tmp_path):
    path = tmp_path / "changed.bag"
    with BagFile(path) as bag:
        bag.log(10, "/uav", line(1, 0, 1, 2))
        batch = "#seq:0,count:1,dropped:0,pid:9,steady:1.0\n" + stamped("11.5", 1, 1, 3, 2)
        bag.text(12, "/threshold_information", "/uav", batch)
    recording = read(path)
    assert [cmp for *_, cmp in found(recording)] == [1, 3]


# `rosbag record -a` has both topics; the rosout node passes batches on like any message.
def test_a_batch_on_both_topics_is_counted_once(tmp_path):
    path = tmp_path / "all.bag"
    batch = "threshold_batch:#seq:0,count:1,dropped:0,pid:9,steady:1.0\n"
    batch += stamped("10.5", 1, 1, 3, 2)
    with BagFile(path) as bag:
        bag.log(11, "/uav", batch)
        bag.log(11, "/uav", batch, topic="/rosout_agg")
    recording = read(path)
    assert [cmp for *_, cmp in found(recording)] == [3]
    assert recording.notes == (
        "1 report on /rosout_agg that the node rosout copied from /rosout: counted once",
    )


def test_summaries_and_drops_on_rosout(tmp_path):
    path = tmp_path / "edges.bag"
    with BagFile(path) as bag:
        bag.log(10, "/uav", SUMMARY.format(key=key(1)))
        bag.log(10, "/uav", SUMMARY.format(key=key(1)), topic="/rosout_agg")
        bag.log(11, "/uav", f"threshold_dropped:{key(1)},count:12,flops:3,why:nested")
        bag.log(12, "/uav", "threshold_summary:nonsense")
        bag.log(13, "/uav", "threshold_whatever: another node's words")
    recording = read(path)
    assert len(recording.summaries) == 1
    assert recording.summaries.nodes == ("/uav",)
    assert recording.dropped == (Dropped(key(1), "/uav", 12, 3, "nested"),)
    assert recording.malformed == 1


@pytest.mark.parametrize(
    "change",
    [
        ("count:3", "count:0"),
        ("far:3", "far:4"),
        ("span:10.000000001;10.1", "span:10.2;10.1"),
        ("diff:-0.25", "diff:1e999"),
        ("abs:0.3", "abs:"),
    ],
)
def test_summaries_that_contradict_themselves(tmp_path, change):
    path = tmp_path / "edges.bag"
    with BagFile(path) as bag:
        bag.log(10, "/uav", SUMMARY.format(key=key(1)).replace(*change))
    recording = read(path)
    assert (len(recording.summaries), recording.malformed) == (0, 1)


# --- several recordings


def bag_of(path, *, node="/uav", shift=0.0, values=range(10)):
    with BagFile(path) as bag:
        for step in values:
            seconds = 1_700_000_000 + step + shift
            bag.log(seconds, node, line(1, step % 2, step, 5))
        bag.mark(1_700_000_003, "/mark_action")
    return path


def tpc_of(path, *, node="/uav", shift_ns=0, values=range(10)):
    made = TpcFile(tpc_file.header(node=node, real=ns(1_700_000_000)))
    made.system(site(1, key(1)), sync(0, ns(1_700_000_000)))
    made.thread(1, *(report(1, ns(n) + shift_ns, n, 5, result=n % 2) for n in values))
    return made.write(path)


def test_the_same_bag_twice(tmp_path):
    one = bag_of(tmp_path / "a.bag")
    two = tmp_path / "b.bag"
    shutil.copy(one, two)
    recording = read([one, two])
    assert [cmp for *_, cmp in found(recording)] == list(range(10))
    assert recording.notes == (
        f"10 reports in {two}: /rosout that also came another way: counted once",
    )
    assert len(recording.marks) == 1
    # By two names the same file.
    again = read([one, one])
    assert (len(again.events), again.notes) == (10, ())


# The bag has reports 0 to 9, the file 5 to 14, half a millisecond later: 5 are the same.
def test_a_binary_file_beside_a_bag(tmp_path):
    bag = bag_of(tmp_path / "a.bag")
    file = tpc_of(tmp_path / "b.tpc", shift_ns=500_000, values=range(5, 15))
    recording = read([bag, file])
    assert [cmp for *_, cmp in found(recording)] == list(range(15))
    assert recording.notes == (f"5 reports in {file} that also came another way: counted once",)
    # 2 ms apart, or of another node, they are not.
    far = tpc_of(tmp_path / "c.tpc", shift_ns=2_000_000)
    assert len(read([bag, far]).events) == 20
    assert len(read([bag, far], tolerance_ns=2_000_000).events) == 10
    assert len(read([bag, tpc_of(tmp_path / "d.tpc", node="/other")]).events) == 20


# Within 1 ms: a a in the bag and b b b in the file. Two are the same, one to one.
def test_equal_reports_in_a_burst_are_matched_one_to_one(tmp_path):
    bag = bag_of(tmp_path / "a.bag", values=[3, 3])
    file = tpc_of(tmp_path / "b.tpc", values=[3, 3, 3])
    assert len(read([bag, file]).events) == 3


# A node that was started twice at once, and a forked child: equal reports at the same times. Each
# of them is one of its own; only a copy of a file is the same again.
def test_files_of_two_processes_share_nothing(tmp_path):
    paths = []
    for number, changes in enumerate(({"pid": 1}, {"pid": 2}, {"pid": 3, "parent": 1})):
        made = TpcFile(tpc_file.header(node="/uav", real=ns(1_700_000_000), **changes))
        made.system(site(1, key(1)), sync(0, ns(1_700_000_000)))
        made.thread(1, *(report(1, ns(n), 1, 5) for n in range(5)))
        paths.append(made.write(tmp_path / f"{number}.tpc"))
    copy = tmp_path / "copy.tpc"
    shutil.copy(paths[0], copy)
    recording = read([*paths, copy])
    assert len(recording.events) == 15
    assert recording.events.nodes == ("/uav", "/uav (3)")
    assert recording.notes == (f"5 reports in {copy} that also came another way: counted once",)


def test_files_that_were_joined_are_refused(tmp_path):
    whole = tpc_of(tmp_path / "a.tpc").read_bytes()
    padded = whole + bytes((4096 - len(whole)) % tpc_file.CHUNK)
    (tmp_path / "b.tpc").write_bytes(padded + whole)
    with pytest.raises(InputError, match="another file begins at byte"):
        read(tmp_path / "b.tpc")


def test_sources_that_lie_apart_are_told(tmp_path):
    bag = bag_of(tmp_path / "a.bag")
    made = TpcFile(tpc_file.header(node="/sim"))
    made.system(site(1, key(1)))
    made.thread(1, report(1, ns(3), 1, 2), report(1, ns(8), 1, 2))
    file = made.write(tmp_path / "b.tpc")
    recording = read([bag, file])
    assert len(recording.events) == 12
    assert recording.notes == (
        f"{bag} begins 1,699,999,992 s after {file} ends: on different clocks, or one after the"
        " other? Their times are used as they are",
    )


def test_a_folder_of_several(tmp_path):
    tpc_of(tmp_path / "uav-1-1.tpc")
    tpc_of(tmp_path / "face-2-1.tpc", node="/face", shift_ns=1)
    (tmp_path / "notes.md").write_text("not a recording")
    recording = read(tmp_path)
    assert recording.name == tmp_path.name
    assert recording.events.nodes == ("/face", "/uav")
    assert [cmp for *_, cmp in found(recording)] == [n // 2 for n in range(20)]


def test_rotated_logs_and_a_bag_that_was_cut_off(tmp_path):
    for number, name in enumerate(["rosout.log", "rosout.log.1", "rosout.log.2"]):
        (tmp_path / name).write_text(f"{9 - number}.5 INFO /uav {line(1, 0, number, 2)}\n")
    (tmp_path / "m.bag.active").write_bytes(b"#ROSBAG V2.0\n")
    recording = read(tmp_path)
    assert [cmp for *_, cmp in found(recording)] == [2, 1, 0]
    assert recording.notes == (
        f"{tmp_path / 'm.bag.active'}: not read; recover it with: rosbag reindex",
    )


# Files of nodes are below a recorded mission; only there.
def test_a_recorded_mission_with_files(tmp_path):
    bag_of(tmp_path / "mission.bag", values=range(3))
    (tmp_path / "tpc").mkdir()
    tpc_of(tmp_path / "tpc/face-2-1.tpc", node="/face")
    assert read(tmp_path).events.nodes == ("/uav",)
    (tmp_path / "run.json").write_text("{}")
    assert read(tmp_path).events.nodes == ("/face", "/uav")


def test_an_ingested_folder_beside_others(tmp_path):
    first = read(bag_of(tmp_path / "a.bag"))
    save_recording(first, tmp_path / "a")
    assert equal_tables(read(tmp_path / "a").events, first.events)
    recording = read([tmp_path / "a", tpc_of(tmp_path / "b.tpc", values=range(8, 12))])
    assert [cmp for *_, cmp in found(recording)] == list(range(12))
    assert recording.marks == first.marks


# One mark is taken back, one gets a note; two more stand beside the bag.
def test_marks_of_all_kinds(tmp_path):
    path = tmp_path / "a.bag"
    with BagFile(path) as bag:
        bag.log(10, "/uav", line(1, 0, 1, 2))
        bag.mark(11, "/mark_wrong", 10.5)
        bag.mark(12, "/m/mark_action", 11.5)
        bag.mark(13, "/m/mark_undo", 11.5)
        bag.text(14, "/mark_note", "/x", "10.500000000,it hovers")
        bag.text(15, "/mark_note", "/x", "soon")
    (tmp_path / "a.bag.marks.csv").write_text(
        "time_ns,type,observer,note\n12000000000,II,later,\n10500000000,,,it hovers\n"
    )
    recording = read(path)
    expected = (
        Mark(ns(10.5), None, "", "it hovers"),
        Mark(ns(12), "II", "later"),
    )
    assert recording.marks == expected
    assert recording.malformed_first[0].what.startswith("not a note")
    assert read(tmp_path).marks == expected
    save_recording(recording, tmp_path / "m")
    (tmp_path / "m.marks.csv").write_text("time_ns,type,observer,note\n13000000000,I\n")
    assert read(tmp_path / "m").marks == (*expected, Mark(ns(13), "I"))
    assert read([tmp_path / "m.marks.csv"]).marks == (Mark(ns(13), "I"),)


# A latched /a sent rosout its first message again as number 2. In the second row 4 is missing, too;
# in the third 2 and 3 are, of which not both can have gone to rosout; in the fourth 5 and 6.
@pytest.mark.parametrize("at_once", [False, True])
@pytest.mark.parametrize(
    ("numbers", "lost"), [((1, 3), 0), ((1, 3, 5), 1), ((1, 4, 5), 2), ((1, 3, 4, 7), 2)]
)
def test_number_that_only_rosout_got_is_no_loss(numbers, lost, at_once):
    gathering = Gathering()
    messages = Messages(gathering, "x", ROS1, latched={b"/a"})
    raw = [log(b"/a", number) for number in numbers]
    if at_once:
        ends = np.cumsum([len(data) for data in raw])
        begins = np.concatenate([[0], ends[:-1]])
        times = np.ones(len(raw), np.int64)
        chunk = Chunk(b"".join(raw), np.zeros(len(raw), np.int64), times, begins, ends, 0)
        assert messages.take_logs(chunk, np.ones(len(raw), np.bool_), {0: b"/a"})
    else:
        for data in raw:
            messages.take("/rosout", "/a", 1, data)
    messages.close()
    assert gathering.lost.total() == lost


# rosbag play numbers the messages of all nodes in one row, rosbag filter names one sender for all:
# neither is a loss. In the third 3 of /a are missing, however it is counted.
@pytest.mark.parametrize(
    ("sent", "lost"),
    [
        ([("/play", "/a", 0), ("/play", "/b", 1), ("/play", "/b", 2), ("/play", "/a", 3)], {}),
        ([("/a", "/a", 0), ("/a", "/b", 70), ("/a", "/b", 71), ("/a", "/a", 1)], {}),
        ([("/a", "/a", 0), ("/b", "/b", 1), ("/b", "/b", 2), ("/a", "/a", 4)], {"/a": 3}),
    ],
)
@pytest.mark.parametrize("odd", [False, True])
def test_loss_is_told_by_who_numbers(tmp_path, sent, lost, odd):
    gathering = Gathering()
    messages = Messages(gathering, "x", ROS1)
    raw = [log(node.encode(), number) for _, node, number in sent]
    if odd:
        for (sender, _, _), data in zip(sent, raw, strict=True):
            messages.take("/rosout", sender, 1, data)
    else:
        ends = np.cumsum([len(data) for data in raw])
        begins = np.concatenate([[0], ends[:-1]])
        numbers = np.arange(len(sent))
        chunk = Chunk(b"".join(raw), numbers, np.ones(len(sent), np.int64), begins, ends, 0)
        senders = {number: sender.encode() for number, (sender, _, _) in enumerate(sent)}
        assert messages.take_logs(chunk, np.ones(len(sent), np.bool_), senders)
    messages.close()
    assert {node: count for node, count in gathering.lost.items() if count} == lost
