from __future__ import annotations

import json
import struct
import subprocess
from dataclasses import replace

import pytest
from mission_samples import BagFile, equal_tables, key, line, ns
from rosbags.rosbag1 import Writer

from pytpc.base.errors import InputError
from pytpc.ingest.reading import read
from pytpc.ingest.rosout_line import PREFIX
from pytpc.recording.marks import Mark, topic_of_marks
from pytpc.recording.mission import load_recording, save_recording

K = "0a1b2c3d-0000-5000-8000-00000000000F"


@pytest.mark.parametrize(
    ("topic", "expected"),
    [
        ("/mark_action", ("I", "")),
        ("/mark_no_action", ("II", "")),
        ("/marks0/mark_action", ("I", "marks0")),
        ("/lab/marks1/mark_no_action", ("II", "lab/marks1")),
        ("/mark_actions", None),
        ("/unmark_action", None),
        ("/mark_action/x", None),
    ],
)
def test_topics_of_marks(topic, expected):
    assert topic_of_marks(topic) == expected


@pytest.fixture
def mission(tmp_path):
    """A small bag: two nodes, other log messages, marks of two observers, three broken reports."""
    path = tmp_path / "mission.bag"
    with BagFile(path) as bag:
        bag.log(10.0, "/uav", "taking off")
        bag.log(10.5, "/uav", line(1, 0, 0.2, 0.5), stamp=10.4)
        bag.log(11.0, "/face", line(2, 1, 3, 1))
        bag.log(11.0, "/uav", line(1, 1, 0.7, 0.5), seq=5)
        bag.log(12.0, "/uav", PREFIX + "truncat")
        bag.log(12.5, "/face", line(2, 0, 0, 1), seq=3)
        bag.log(13.0, "/face", line(2, 1, 3, 1), seq=0)
        bag.mark(13.5, "/mark_action", 12.9)
        bag.mark(13.6, "/marks1/mark_no_action", 0)
        bag.text(14.0, "/threshold_information", "/brain", f"13.9,{K},True,cmp:1,thresh:2,res:True")
        bag.text(14.5, "/threshold_information", "/brain", "nonsense")
        bag.text(14.6, "/chatter", "/brain", "threshold_information: nothing to do with it")
    return path


# /uav sends numbers 0, 1, 5, 6: 2, 3 and 4 are lost. /face sends 0, 3 (1 and 2 lost) and then 0: it
# was started again, nothing is lost there. 13.6 is the bag's time of the unstamped mark.
def test_read_bag(mission):
    seen = []
    recording = read(mission, lambda *step: seen.append(step))
    table = recording.events
    assert recording.name == "mission"
    assert table.time_ns.tolist() == [ns(t) for t in (10.4, 11, 11, 12.5, 13, 13.9)]
    reported = [(table.nodes[n], cmp) for n, cmp in zip(table.node, table.cmp, strict=True)]
    assert sorted(reported) == [
        ("/brain", 1),
        ("/face", 0),
        ("/face", 3),
        ("/face", 3),
        ("/uav", 0.2),
        ("/uav", 0.7),
    ]
    assert recording.marks == (
        Mark(ns(12.9), "I", ""),
        Mark(ns(13.6), "II", "marks1"),
    )
    assert recording.lost == {"/face": 2, "/uav": 3}
    assert recording.malformed == 2
    broken = recording.malformed_first
    assert [(r.topic, r.time_ns, r.text) for r in broken] == [
        ("/rosout", ns(12), PREFIX + "truncat"),
        ("/threshold_information", ns(14.5), "nonsense"),
    ]
    assert broken[0].what == "a key (a UUID) is expected, column 23"
    # The bag's first message that TPC knows of is at 10 s, its last one of all at 14.6 s.
    assert (recording.start_ns, recording.end_ns) == (ns(10), ns(14.6))
    assert recording.notes == ("1 record without a stamp got the bag's time",)
    assert seen[-1][0] == seen[-1][1]


# /uav has no time before its first /clock, 0.9 s long: that is how it begins. A second later it is
# odd, and so it is from the first record on of a node that logged before.
def test_records_from_before_the_first_clock(tmp_path):
    path = tmp_path / "early.bag"
    with BagFile(path) as bag:
        bag.log(5.0, "/face", "starting")
        bag.log(10.0, "/uav", line(1, 0, 0.2, 0.5), stamp=0)
        bag.log(10.9, "/uav", line(1, 0, 0.3, 0.5), stamp=0)
        bag.log(11.5, "/uav", line(1, 0, 0.4, 0.5))
    recording = read(path)
    assert recording.events.time_ns.tolist() == [ns(10), ns(10.9), ns(11.5)]
    assert recording.notes == ()
    odd = tmp_path / "odd.bag"
    with BagFile(odd) as bag:
        bag.log(5.0, "/face", "starting")
        bag.log(10.0, "/uav", line(1, 0, 0.2, 0.5))
        bag.log(11.1, "/uav", line(1, 0, 0.3, 0.5), stamp=0)
        bag.log(11.1, "/face", line(1, 0, 0.3, 0.5), stamp=0)
    assert read(odd).notes == ("2 records without a stamp got the bag's time",)


# /uav reports on /rosout and, through the rosout node, on /rosout_agg; /far only on the latter (the
# recorder did not reach it). A converter passes both on; /brain reports its own key directly.
def test_each_report_is_counted_once(tmp_path):
    path = tmp_path / "twice.bag"
    with BagFile(path) as bag:
        for step in range(4):
            bag.log(step, "/uav", line(1, step % 2, step, 2))
            bag.log(step, "/uav", line(1, step % 2, step, 2), topic="/rosout_agg")
            bag.log(step, "/far", line(2, step % 2, step, 2), topic="/rosout_agg")
            for number, caller in ((1, "/converter"), (2, "/converter"), (3, "/brain")):
                text = line(number, step % 2, step, 2).removeprefix(PREFIX)
                bag.text(step + 0.1, "/threshold_information", caller, f"{step}.0000000,{text}")
    recording = read(path)
    table = recording.events
    counted = [
        (table.nodes[node], table.keys[code])
        for node, code in zip(table.node, table.key, strict=True)
    ]
    assert sorted(counted) == sorted(4 * [("/uav", key(1)), ("/far", key(2)), ("/brain", key(3))])
    assert recording.notes[:2] == (
        "4 reports on /rosout_agg that the node rosout copied from /rosout: counted once",
        "8 reports on /threshold_information with keys that are in the log messages too:"
        " counted once",
    )
    # The rosout node numbers what it passes on itself; that says nothing about /far.
    assert recording.lost == {}


def test_topics_of_another_type_are_named(tmp_path):
    path = tmp_path / "odd.bag"
    with BagFile(path) as bag:
        bag.text(1, "/mark_action", "/observer", "now!")
    recording = read(path)
    assert recording.marks == ()
    assert recording.notes == (
        "/mark_action carries std_msgs/msg/String, not std_msgs/msg/Time: not read",
    )


def test_a_bag_on_another_clock(tmp_path):
    path = tmp_path / "wall.bag"
    with BagFile(path) as bag:
        bag.log(1_700_000_000, "/uav", line(1, 0, 1, 2), stamp=5)
        bag.log(1_700_000_009, "/uav", line(1, 1, 3, 2), stamp=40)
    recording = read(path)
    assert (recording.start_ns, recording.end_ns) == (ns(5), ns(40))
    assert recording.notes == ("the bag was recorded on another clock than the reports",)


def test_messages_that_end_too_early_are_malformed(tmp_path):
    path = tmp_path / "short.bag"
    with BagFile(path) as bag:
        bag.log(1, "/uav", line(1, 0, 1, 2))
        connection = next(iter(bag.connections.values()))
        bag.writer.write(connection, ns(2), b"\x00" * 11)
        bag.writer.write(connection, ns(3), struct.pack("<IIII", 1, 2, 3, 4_000_000_000))
    recording = read(path)
    assert len(recording.events) == 1
    assert recording.malformed == 2
    assert recording.malformed_first[1].what == "a log message of 16 bytes ends too early"


def test_only_twenty_broken_records_are_kept(tmp_path):
    path = tmp_path / "many.bag"
    with BagFile(path) as bag:
        for step in range(50):
            bag.log(step, "/uav", PREFIX + "x" * 1000)
    recording = read(path)
    assert recording.malformed == 50
    assert len(recording.malformed_first) == 20
    assert {len(record.text) for record in recording.malformed_first} == {200}


def test_empty_bag(tmp_path):
    path = tmp_path / "empty.bag"
    with Writer(path):
        pass
    recording = read(path)
    assert (len(recording.events), recording.marks) == (0, ())


@pytest.mark.parametrize(
    "compression", [Writer.CompressionFormat.LZ4, Writer.CompressionFormat.BZ2]
)
def test_compressed_bags(tmp_path, compression):
    path = tmp_path / "small.bag"
    bag = BagFile(path)
    bag.writer.set_compression(compression)
    with bag:
        for step in range(100):
            bag.log(step, "/uav", line(1, step % 2, step, 50))
    assert len(read(path).events) == 100


def long_bag(path, reports=8000):
    with BagFile(path) as bag:
        for step in range(reports):
            bag.log(step / 100, "/uav", line(step % 7, step % 2, step / 3, 50))
    return path


def test_every_truncation_is_one_line(tmp_path):
    whole = long_bag(tmp_path / "whole.bag").read_bytes()
    path = tmp_path / "cut.bag"
    for size in [0, 5, 13, 14, 100, 4117, 5000, len(whole) // 2, len(whole) - 1]:
        path.write_bytes(whole[:size])
        with pytest.raises(InputError) as caught:
            read(path)
        text = str(caught.value)
        assert text.startswith(f"{path}: ")
        assert "\n" not in text
        assert "truncated" in text or text.startswith(f"{path}: the file is empty")
        if size > 13:
            assert f"{size}" in text
            assert "byte" in text


# A recorder that was killed leaves a bag header whose index_pos is 0.
def test_a_bag_that_was_not_closed(tmp_path):
    whole = long_bag(tmp_path / "whole.bag", 100).read_bytes()
    place = whole.index(b"index_pos=") + len(b"index_pos=")
    path = tmp_path / "killed.bag"
    path.write_bytes(whole[:place] + bytes(8) + whole[place + 8 :])
    with pytest.raises(
        InputError, match=r'not closed .*; "rosbag reindex killed\.bag" recovers the'
    ):
        read(path)


# Found by fuzzing: a place that no file has.
def test_an_index_beyond_all_files(tmp_path):
    whole = long_bag(tmp_path / "whole.bag", 100).read_bytes()
    place = whole.index(b"index_pos=") + len(b"index_pos=")
    path = tmp_path / "far.bag"
    path.write_bytes(whole[:place] + b"\xff" * 8 + whole[place + 8 :])
    with pytest.raises(InputError, match="the index should be at byte 18446744073709551615"):
        read(path)


# Any single corrupt byte: either it does not matter for us, or it is one line.
@pytest.mark.parametrize("seed", range(40))
def test_flipped_bytes_never_end_in_a_traceback(tmp_path, seed):
    whole = bytearray(long_bag(tmp_path / "whole.bag", 50).read_bytes())
    whole[len(whole) * seed // 40] ^= 0xFF
    path = tmp_path / "flipped.bag"
    path.write_bytes(whole)
    try:
        read(path)
    except InputError as error:
        assert "\n" not in str(error)


def test_files_that_are_no_bags(tmp_path):
    path = tmp_path / "x.bag"
    with pytest.raises(InputError, match=r"x\.bag: no such bag, file or folder"):
        read(path)
    path.write_text("#ROSBAG V1.2\n")
    with pytest.raises(InputError, match=r'not a ROS 1 bag: "#ROSBAG V2\.0" is not at byte 0'):
        read(path)
    path.write_bytes(b"\xff\xfe" * 5000)
    with pytest.raises(InputError, match="not a ROS 1 bag"):
        read(path)


def test_recording_on_disk_and_back(mission, tmp_path):
    recording = read(mission)
    save_recording(recording, tmp_path / "out")
    again = load_recording(tmp_path / "out")
    assert equal_tables(again.events, recording.events)
    for name in ("name", "marks", "start_ns", "end_ns", "malformed", "lost", "notes"):
        assert getattr(again, name) == getattr(recording, name)
    assert again.malformed_first == recording.malformed_first
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["events.parquet", "marks.json"]


# The name of a file that is not UTF-8, as Python has it.
def test_a_note_with_half_a_character_is_kept(mission, tmp_path):
    recording = replace(
        read(mission), notes=("1 text file without a report, for example \udcff.log",)
    )
    save_recording(recording, tmp_path / "out")
    assert load_recording(tmp_path / "out").notes == recording.notes


def test_recordings_that_are_broken(mission, tmp_path):
    folder = tmp_path / "out"
    with pytest.raises(InputError, match=r"marks\.json: cannot be read"):
        load_recording(folder)
    save_recording(read(mission), folder)
    path = folder / "marks.json"
    good = json.loads(path.read_text())
    for change, message in [
        ({"schema": 2}, "not of format 1, the only one that this TPC reads"),
        ({"events": 7}, "7 events, but events.parquet has 6"),
        ({"marks": [{"time_ns": 1.5, "type": "I", "observer": ""}]}, "without a time in ns"),
        ({"marks": [{"time_ns": 1, "type": "III", "observer": ""}]}, "a mark of type 'III'"),
        ({"lost": None}, "not the marks of a recording"),
    ]:
        path.write_text(json.dumps({**good, **change}))
        with pytest.raises(InputError, match=message):
            load_recording(folder)
    path.write_text('{"schema": 1,\n oops')
    with pytest.raises(InputError, match=r"marks\.json:2: not JSON"):
        load_recording(folder)


# What rosbag itself writes, not only what our writer makes of the format.
def test_a_bag_of_rosbag_itself(tmp_path):
    program = f"""
import rosbag, rospy
from rosgraph_msgs.msg import Log
from std_msgs.msg import Time
with rosbag.Bag({str(tmp_path / "ros.bag")!r}, "w", compression="lz4") as bag:
    for n in range(3000):
        log = Log(level=2, name="/uav", msg={line(1, 1, 2, 1)!r} if n % 3 else "flying")
        log.header.seq = n
        log.header.stamp = rospy.Time(n, 500)
        bag.write("/rosout", log, rospy.Time(n, 900))
    bag.write("/mark_action", Time(rospy.Time(7)), rospy.Time(8))
"""
    made = subprocess.run(
        ["/usr/bin/python3", "-c", program],
        check=False,
        capture_output=True,
        text=True,
        env={"PATH": "/usr/bin:/bin"},
    )
    if "No module named 'rosbag'" in made.stderr:
        pytest.skip("ROS is not installed")
    assert made.returncode == 0, made.stderr
    recording = read(tmp_path / "ros.bag")
    assert len(recording.events) == 2000
    assert recording.events.time_ns[0] == ns(1) + 500
    assert recording.marks == (Mark(ns(7), "I", ""),)
    assert recording.lost == {}
