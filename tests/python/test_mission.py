"""Recording: the recorder, the settings and the runs; the real graph is in tests/ros."""

from __future__ import annotations

import json
import os
import shutil
import struct
import subprocess
import threading
import time
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st
from mission_samples import mission_run, ns
from rosbags.highlevel import AnyReader

from pytpc.api.record import sink_settings
from pytpc.base.errors import MissingToolError, RunError
from pytpc.cli.main import main
from pytpc.cli.mission_commands import record_command
from pytpc.ingest.losses import LossCounter
from pytpc.ingest.ros1 import decode_log
from pytpc.recording.mission import Dropped
from pytpc.ros.mission_run import (
    MissionRun,
    Progress,
    RecorderStatus,
    RecordOptions,
    clear_earlier,
    read_status,
    save_run,
    save_status,
)
from pytpc.ros.ros1 import param_dump
from pytpc.ros.ros1.bag_file import BagFile
from pytpc.ros.ros1.graph import GraphProcess, RosGraph
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.param_dump import dump_params
from pytpc.ros.ros1.record_mission import launch_command, record_graph, run_mission
from pytpc.ros.ros1.recorder import Discovery, Recorder
from pytpc.ros.ros1.relay import Relay
from pytpc.ros.source import Source

CLOCK = Source("/clock", "/sim", "rosgraph_msgs/Clock", "a9c97c1d230cfc112e270351a944ee47", "")
CHAT = Source(
    "/chat", "/talker", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n"
)
DONE = Source("/done", "/boss", "std_msgs/Bool", "8b94c1b53db61fb6aed406028ad6332a", "bool data\n")
MARK = Source(
    "/a/mark_action", "/a", "std_msgs/Time", "cd7166c74c552c311fbcc2fe5a7bc289", "time data\n"
)
LOG_DEFINITION = """byte DEBUG=1
byte INFO=2
byte WARN=4
byte ERROR=8
byte FATAL=16
Header header
byte level
string name
string msg
string file
string function
uint32 line
string[] topics
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
"""
ROSOUT = Source(
    "/rosout", "/a", "rosgraph_msgs/Log", "acffd30cd6b6de30f120938c17c593fb", LOG_DEFINITION
)


def log(node: bytes, number: int, text: bytes = b"hello", frame: bytes = b"") -> bytes:
    """A rosgraph_msgs/Log as it goes over the wire."""
    texts = b"".join(struct.pack("<I", len(t)) + t for t in (node, text, b"f.cpp", b"run"))
    head = struct.pack("<IIII", number, 7, 500, len(frame)) + frame + b"\x02"
    return head + texts + struct.pack("<II", 12, 0)


# --- the recorder


def test_loss_counter_counts_the_numbers_that_are_missing():
    counter = LossCounter()
    # /a: 0 1 2 | 5: two are missing (3, 4) | 6. /b begins at 4: 1 to 3 were sent before.
    for node, number in [("/a", 0), ("/a", 1), ("/b", 4), ("/a", 2), ("/a", 5), ("/b", 5)]:
        counter.see(node, number)
    counter.see("/a", 6)
    assert counter.lost == Counter({"/a": 2})
    assert counter.missed_before == Counter({"/b": 3})


def test_loss_counter_spares_the_number_that_rosout_got_of_a_latched_sender():
    # 1 | 3: rosout came after 1, and was sent it again as 2. 3 | 5: 4 is missing. /b: no latch.
    counter = LossCounter()
    for number in (1, 3, 5):
        counter.see("/a", number, latched=True)
    for number in (1, 3):
        counter.see("/b", number)
    assert counter.lost == Counter({"/a": 1, "/b": 1})


def test_loss_counter_spares_no_larger_gap():
    # 1 | 4: 2 and 3 are missing, and only one of them can have gone to rosout.
    counter = LossCounter()
    for number in (1, 4):
        counter.see("/a", number, latched=True)
    assert counter.lost == Counter({"/a": 2})


def test_loss_counter_takes_a_restarted_node_for_a_new_beginning():
    counter = LossCounter()
    for number in (8, 9, 0, 1):
        counter.see("/a", number)
    assert counter.lost == Counter()


@given(
    st.lists(st.tuples(st.sampled_from(["/a", "/b"]), st.integers(0, 9)), min_size=1),
    st.integers(0, 50),
)
def test_many_messages_at_once_are_counted_as_one_by_one(messages, cut):
    one_by_one, at_once = LossCounter(), LossCounter()
    for node, number in messages:
        one_by_one.see(node, number, latched=node == "/a")
    for part in (messages[:cut], messages[cut:]):
        numbers = np.array([number for _, number in part], np.int64)
        at_once.see_all([node for node, _ in part], numbers, {"/a"})
    assert (at_once.lost, at_once.missed_before) == (one_by_one.lost, one_by_one.missed_before)


def test_who_replays_a_bag_numbers_anew():
    relay = Relay(pytest.fail)
    for number, node in enumerate([b"/a", b"/b", b"/b", b"/a"]):
        relay.take(log(node, number), "/play")
    relay.take(log(b"/b", 9), "/play")
    assert relay.lost == 5


def test_a_log_message_has_its_text_behind_a_frame_name():
    assert decode_log(log(b"/a", 1, b"threshold_information:x", b"map")).msg == (
        b"threshold_information:x"
    )


def batch(seq: int, count: int, pid: int = 1) -> bytes:
    return f"#seq:{seq},count:{count},dropped:0,pid:{pid},steady:1.0\n1.5,...".encode()


# /a's process 1 begins with 3: 0 to 2 were sent before. 3 4 | 7 8 9: two are missing. Process 2 is
# /a started again. A message of one line has no number.
def test_batches_that_are_missing_are_counted():
    counter = LossCounter()
    seen = [counter.see_text("/a", batch(3, 2)), counter.see_text("/a", batch(7, 3))]
    seen += [counter.see_text("/a", batch(0, 4, pid=2)), counter.see_text("/a", batch(4, 1, pid=2))]
    assert seen == [2, 3, 4, 1]
    assert counter.see_text("/b", b"1.5,k") == 1
    assert counter.see_text("/b", b"#seq:x") == 0
    assert (counter.lost, counter.missed_before) == (Counter({"/a": 2}), Counter({"/a": 3}))


class Subscriber:
    """Only notes; ``state`` is what its master answers to getSystemState."""

    def __init__(self, state: object) -> None:
        self.state = state
        self.subscribed: list[str] = []
        self.master = Master("http://127.0.0.1:9", "/tpc")
        self.master.call = self._call

    def _call(self, method: str, *_: object) -> object:
        assert method in {"getSystemState", "hasParam"}
        if self.state is None:
            raise RunError("no master")
        return self.state

    def subscribe(self, topic: str) -> None:
        self.subscribed.append(topic)


def test_topics_of_observers_are_found(tmp_path):
    publishers = [["/m1/mark_action", ["/x"]], ["/m1/mark_note", ["/x"]], ["/chat", ["/x"]]]
    subscriber = Subscriber([publishers, [["/rosout", ["/other", "/tpc"]]], []])
    bag = BagFile(tmp_path / "a.bag")
    recorder = Recorder(bag, ["/rosout"], None, sim_time=False)
    discovery = Discovery(subscriber, recorder, ["/rosout"])
    discovery.look()
    # Found, and, as this master does not list them yet, once more.
    assert set(subscriber.subscribed) == {"/m1/mark_action", "/m1/mark_note"}
    recorder.take(replace(CHAT, topic="/m1/mark_note"), b"\0\0\0\0")
    recorder.take(CHAT, b"\0\0\0\0")
    assert recorder.status().messages == {"/m1/mark_note": 1}
    bag.close()


@pytest.mark.parametrize("state", [None, [], "nonsense", [[], [["/rosout", ["/other"]]], []]])
def test_a_master_that_is_gone_or_new(tmp_path, state):
    subscriber = Subscriber(state)
    bag = BagFile(tmp_path / "a.bag")
    Discovery(subscriber, Recorder(bag, [], None, sim_time=False), ["/rosout"]).look()
    # One that does not know this node any more is told again; one that is silent is waited for.
    assert subscriber.subscribed == ([] if state is None else ["/rosout"])
    bag.close()


@pytest.mark.parametrize("length", [0, 15, 17, 24, 30])
def test_a_message_that_is_no_log_is_an_error(length):
    with pytest.raises(ValueError, match=f"^a log message of {length} bytes ends too early$"):
        decode_log(log(b"/node", 1)[:length])


def test_bag_has_its_name_only_when_it_is_complete(tmp_path):
    path = tmp_path / "a.bag"
    bag = BagFile(path)
    bag.write(CHAT, ns(1.5), struct.pack("<I", 2) + b"hi")
    bag.write(CHAT, ns(2.5), struct.pack("<I", 3) + b"you")
    assert not path.exists()
    bag.close()
    assert [p.name for p in tmp_path.iterdir()] == ["a.bag"]
    with AnyReader([path]) as reader:
        found = [
            (time, reader.deserialize(data, connection.msgtype).data)
            for connection, time, data in reader.messages()
        ]
    assert found == [(1_500_000_000, "hi"), (2_500_000_000, "you")]


def test_what_a_killed_recorder_left_is_replaced(tmp_path):
    (tmp_path / "a.bag.active").write_bytes(b"half a bag")
    bag = BagFile(tmp_path / "a.bag")
    bag.write(CHAT, 0, b"\0\0\0\0")
    bag.close()
    assert (tmp_path / "a.bag").read_bytes().startswith(b"#ROSBAG V2.0\n")


def test_recorder_stamps_with_the_clock_and_keeps_the_account(tmp_path):
    bag = BagFile(tmp_path / "a.bag")
    recorder = Recorder(bag, ["/chat", "/rosout", "/done"], "/done", sim_time=True)
    assert recorder.status().now_ns == 0
    recorder.take(CLOCK, struct.pack("<II", 3, 250_000_000))
    recorder.take(CHAT, b"\0\0\0\0")
    recorder.take(DONE, b"\0")
    assert not recorder.status().done
    recorder.take(CLOCK, struct.pack("<II", 4, 0))
    recorder.take(ROSOUT, log(b"/a", 1, b"threshold_information:k,1,cmp:1,thresh:1,res:1"))
    recorder.take(ROSOUT, log(b"/a", 4, b"threshold_informant"))
    recorder.take(DONE, b"\1")
    assert recorder.status().done
    bag.close()
    # /clock was not asked for, so it is not in the bag. Of two log messages one is a report, and
    # 2 and 3 are missing between them.
    assert recorder.status(closed=True) == RecorderStatus(
        ready=True,
        done_ns=4_000_000_000,
        closed=True,
        began_ns=3_250_000_000,
        now_ns=4_000_000_000,
        reports=1,
        messages={"/chat": 1, "/done": 2, "/rosout": 2},
        lost={"/a": 2},
        is_reporting=True,
    )
    with AnyReader([tmp_path / "a.bag"]) as reader:
        times = [(connection.topic, time) for connection, time, _ in reader.messages()]
    assert sorted(times) == [
        ("/chat", 3_250_000_000),
        ("/done", 3_250_000_000),
        ("/done", 4_000_000_000),
        ("/rosout", 4_000_000_000),
        ("/rosout", 4_000_000_000),
    ]


# Marks at 5, 6 and at the time of the clock, which one without a stamp gets; that of 6 s is taken
# back. A message that is no mark is in the bag alone.
def test_marks_that_were_taken_back_do_not_count(tmp_path):
    topics = ("/ana/mark_action", "/ana/mark_undo")
    did, undo = (Source(topic, "/ana", "std_msgs/Time", "0" * 32, "") for topic in topics)
    bag = BagFile(tmp_path / "a.bag")
    recorder = Recorder(bag, [did.topic, undo.topic], None, sim_time=True)
    recorder.take(CLOCK, struct.pack("<II", 7, 0))
    for source, seconds in ((did, 5), (did, 6), (undo, 6), (did, 0), (did, 5)):
        recorder.take(source, struct.pack("<II", seconds, 0))
    recorder.take(did, b"\0")
    bag.close()
    status = recorder.status(closed=True)
    assert (status.marks, status.messages[did.topic]) == (2, 5)
    assert Progress.of(status, 1.0).marks == 2
    assert MissionRun.of(status, tmp_path, "done", 1.0).marks == 2


def test_reports_that_never_left_their_process_are_counted_by_comparison(tmp_path):
    bag = BagFile(tmp_path / "a.bag")
    recorder = Recorder(bag, ["/rosout"], None, sim_time=False)
    one, other = (f"00000000-0000-5000-8000-00000000000{n}" for n in (1, 2))
    drop = b"threshold_dropped:%s,count:%d,flops:1,why:%s"
    batch = b"threshold_batch:#seq:0,count:0,dropped:7,pid:1,steady:0"
    first, second = (drop % (one.encode(), 2, b"site"), drop % (other.encode(), 5, b"process"))
    recorder.take(ROSOUT, log(b"/a", 1, drop % (one.encode(), 3, b"site")))
    recorder.take(ROSOUT, log(b"/a", 2, batch + b"\n1.0000000," + first + b"\n1.5000000," + second))
    recorder.take(ROSOUT, log(b"/b", 1, b"a word about threshold_dropped:"))
    bag.close()
    status = recorder.status()
    save_status(status, tmp_path / "status.json")
    assert read_status(tmp_path / "status.json") == status
    assert status.dropped == (
        Dropped(one, "/a", 5, 2, "site"),
        Dropped(other, "/a", 5, 1, "process"),
    )


def messages_in(path):
    with AnyReader([path]) as reader:
        return reader.message_count


# The clock stands at 1000 s when it is first heard: the recording is then 2 s long, not 1002.
def test_what_was_before_the_first_clock(tmp_path):
    bag = BagFile(tmp_path / "a.bag")
    recorder = Recorder(bag, ["/chat"], None, sim_time=True)
    recorder.take(CHAT, struct.pack("<I", 2) + b"hi")
    for seconds in (1000, 1001, 1002):
        recorder.take(CLOCK, struct.pack("<II", seconds, 0))
    recorder.take(CHAT, struct.pack("<I", 2) + b"yo")
    status = recorder.status()
    assert status.now_ns - status.began_ns == 2_000_000_000
    recorder.put_early()
    bag.close()
    with AnyReader([tmp_path / "a.bag"]) as reader:
        assert [(time, data[4:]) for _, time, data in reader.messages()] == [
            (1_000_000_000_000, b"hi"),
            (1_002_000_000_000, b"yo"),
        ]


# The recorder is there first. roslaunch says then that the graph runs on /clock, and starts nodes.
def test_a_clock_that_is_set_after_the_recording_began(tmp_path):
    bag = BagFile(tmp_path / "a.bag")
    recorder = Recorder(bag, ["/chat"], None, sim_time=False)
    recorder.hold()
    recorder.see_sim_time(False)
    recorder.settle()
    recorder.take(CHAT, struct.pack("<I", 2) + b"hi")
    assert bag.messages == {}
    recorder.see_sim_time(True)
    recorder.settle()
    recorder.take(CLOCK, struct.pack("<II", 1000, 0))
    recorder.take(CLOCK, struct.pack("<II", 1001, 0))
    status = recorder.status()
    assert (status.began_ns, status.now_ns) == (1000 * 10**9, 1001 * 10**9)
    bag.close()
    with AnyReader([tmp_path / "a.bag"]) as reader:
        assert [time for _, time, _ in reader.messages()] == [1000 * 10**9]


# It is the wall's time at which the message came, not that of the answer a second later.
def test_real_time_is_settled_by_the_first_message(tmp_path, monkeypatch):
    bag = BagFile(tmp_path / "a.bag")
    recorder = Recorder(bag, ["/chat"], None, sim_time=False)
    recorder.hold()
    recorder.see_sim_time(False)
    recorder.settle()
    monkeypatch.setattr(time, "time_ns", lambda: 5 * 10**9)
    recorder.take(CHAT, struct.pack("<I", 2) + b"hi")
    monkeypatch.setattr(time, "time_ns", lambda: 6 * 10**9)
    recorder.see_sim_time(False)
    recorder.settle()
    recorder.take(CHAT, struct.pack("<I", 2) + b"yo")
    bag.close()
    with AnyReader([tmp_path / "a.bag"]) as reader:
        assert [stamp for _, stamp, _ in reader.messages()] == [5 * 10**9, 6 * 10**9]


def test_a_clock_that_never_came(tmp_path):
    bag = BagFile(tmp_path / "a.bag")
    recorder = Recorder(bag, ["/chat"], None, sim_time=True)
    recorder.take(CHAT, struct.pack("<I", 2) + b"hi")
    recorder.put_early()
    bag.close()
    # Tools take an entry at 0 for a broken one.
    with AnyReader([tmp_path / "a.bag"]) as reader:
        assert [time for _, time, _ in reader.messages()] == [1]


# A mark is on the disk at once, and what was before it. What rosbag reindex writes over the begin
# of a bag is 13 + 4 + 4 + 4096 bytes long.
def test_a_recording_that_was_cut_off_can_be_reindexed(tmp_path):
    bag = BagFile(tmp_path / "a.bag")
    for number in range(20):
        bag.write(CHAT, number + 1, struct.pack("<I", 40) + bytes(40))
    bag.write(MARK, 30, bytes(8))
    killed = tmp_path / "killed.bag"
    shutil.copy(tmp_path / "a.bag.active", killed)
    bag.close()
    for path in (killed, tmp_path / "a.bag"):
        raw = path.read_bytes()
        (header,) = struct.unpack_from("<I", raw, 13)
        (data,) = struct.unpack_from("<I", raw, 17 + header)
        assert header + data == 4096
        assert raw[4117 + 4 :].startswith(b"\x04\0\0\0op=\x05")
    assert messages_in(tmp_path / "a.bag") == 21
    if shutil.which("rosbag") is None:
        pytest.skip("ROS is not installed")
    subprocess.run(["rosbag", "reindex", "-q", killed], check=True, capture_output=True)
    assert messages_in(killed) == 21


def test_status_survives_the_way_through_its_file(tmp_path):
    path = tmp_path / "status.json"
    assert read_status(path) is None
    status = RecorderStatus(
        ready=True, done_ns=4, now_ns=5, messages={"/rosout": 3}, lost={"/a": 1}
    )
    save_status(status, path)
    assert read_status(path) == status


# --- the parameters


@pytest.mark.parametrize("ending", ["exit 1", "exec sleep 600"])
def test_half_of_the_values_is_not_left_in_the_folder(tmp_path, monkeypatch, ending):
    monkeypatch.setattr(param_dump, "_HURRIED_S", 1.0)
    program = tmp_path / "bin/rosparam"
    program.parent.mkdir()
    program.write_text(f"#!/bin/sh\necho half > $2\n{ending}\n")
    program.chmod(0o755)
    env = {"PATH": f"{program.parent}:/usr/bin:/bin"}
    with pytest.raises(RunError, match="rosparam dump"):
        dump_params(env, tmp_path / "params.yaml", lambda: True)
    assert list(tmp_path.iterdir()) == [program.parent]


# --- running


def test_launch_command_has_its_arguments_in_order(tmp_path):
    launch = tmp_path / "a.launch"
    launch.write_text("<launch/>")
    command = launch_command(launch, {"seed": "3", "rate": "4.0"})
    assert command[0] == "roslaunch"
    assert command[-3:] == [str(launch), "rate:=4.0", "seed:=3"]


def test_missing_launch_file_is_said_before_anything_starts(tmp_path):
    with pytest.raises(RunError, match=r"no\.launch: no such launch file"):
        run_mission({}, RecordOptions(tmp_path / "out", tmp_path / "no.launch", {}, 5.0))
    assert not (tmp_path / "out").exists()


def test_missing_roslaunch_is_said_before_anything_starts(tmp_path):
    launch = tmp_path / "x.launch"
    launch.write_text("<launch/>")
    options = RecordOptions(tmp_path / "out", launch)
    with pytest.raises(
        MissingToolError, match=r"roslaunch, rosmaster, rosparam of ROS 1 not found"
    ):
        run_mission({"PATH": str(tmp_path)}, options)
    assert not (tmp_path / "out").exists()


def test_run_json_says_how_it_went(tmp_path):
    run = mission_run(tmp_path)
    save_run(run, RecordOptions(tmp_path, tmp_path / "a.launch", {"seed": "1"}))
    document = json.loads((tmp_path / "run.json").read_text())
    assert document["args"] == {"seed": "1"}
    assert document["bag"] == "mission.bag"
    assert (document["ended"], document["reports"]) == ("done", 10)
    assert document["messages"]["/mark_action"] == 2


def test_record_command_wants_name_and_value():
    result = CliRunner().invoke(record_command, ["ws", "a.launch", "seed=1", "-o", "out"])
    assert result.exit_code == 2
    assert "'seed=1' is not NAME:=VALUE" in result.output


def test_settings_of_sinks_reach_the_nodes_and_nothing_else(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    given = {"TPC_SINK": "file", "TPC_POLICY": "", "TPC_FOLDER": "x", "TPC_PREFIX": "/y", "A": "b"}
    assert sink_settings(given) == {"TPC_SINK": "file", "TPC_FOLDER": str(tmp_path / "x")}


# What is left of it would be ranked as if it were of the next mission. Marks of a bag that stays,
# stay with it; those of the second mission do not replace those of the first.
def test_an_earlier_mission_is_cleared_and_its_marks_are_kept(tmp_path):
    folder = tmp_path / "today"
    (folder / "tpc").mkdir(parents=True)
    text = "time_ns,type,observer,note\n1,I\n"
    marks = ["mission.bag", "today", "tpc/uav-1-1.tpc"]
    stay = ["notes.md", "grades.csv", "other.bag", "other.bag.marks.csv"]
    names = ["mission.bag", "run.json", "events.parquet", "marks.json", "tpc/uav-1-1.tpc", *stay]
    for turn in range(2):
        (folder / "tpc").mkdir(exist_ok=True)
        for name in names:
            (folder / name).write_text(f"{turn}")
        for path in ["marks.csv", "ana.csv", *(f"{name}.marks.csv" for name in marks[::2])]:
            (folder / path).write_text(f"{text}{turn}\n")
        (tmp_path / "today.marks.csv").write_text(f"{text}{turn}\n")
        kept = clear_earlier(folder)
        ending = ".old.2" if turn else ".old"
        inside = ["ana.csv", "marks.csv", "mission.bag.marks.csv", "uav-1-1.tpc.marks.csv"]
        assert {str(path.relative_to(tmp_path)) for path in kept} == {
            f"today.marks.csv{ending}",
            *(f"today/{name}{ending}" for name in inside),
        }
        assert {path.read_text() for path in kept} == {f"{text}{turn}\n"}
    left = {path.name for path in folder.iterdir() if ".old" not in path.name}
    assert left == set(stay)
    assert len(list(folder.glob("*.old*"))) == 8
    assert clear_earlier(tmp_path / "new") == []


class _NoRecorder:
    """Stands for a recorder that reached the master, and then was interrupted."""

    def __init__(self, *_: object, **__: object) -> None:
        pass

    def step(self) -> None:
        raise RunError("interrupted")

    leave = step


# The bag of the earlier recording is gone, its marks are not; the master was reached.
def test_kept_marks_are_said(tmp_path, monkeypatch):
    monkeypatch.setattr("pytpc.ros.ros1.record_mission.GraphRecorder", _NoRecorder)
    monkeypatch.setattr(Master, "call", lambda *_: 1)
    path = tmp_path / "marks.csv"
    for ending in ("old", "old.2"):
        path.write_text("time_ns,type,observer,note\n1,I\n")
        result = CliRunner().invoke(main, ["record", "-o", str(tmp_path)])
        assert f"marks of the earlier recording are kept: {path}.{ending}\n" in result.output
    path.write_text("time_ns,type,observer,note\n1,I\n")
    (tmp_path / "monday.bag").write_text("has marks of its own")
    assert "are kept" not in CliRunner().invoke(main, ["record", "-o", str(tmp_path)]).output
    assert path.exists()


def test_marks_stay_if_nothing_is_recorded(tmp_path):
    path = tmp_path / "marks.csv"
    path.write_text("time_ns,type,observer,note\n1,I\n")
    env = {"ROS_MASTER_URI": "http://[::1]:1"}
    with pytest.raises(RunError):
        record_graph(RecordOptions(tmp_path), threading.Event(), env)
    assert path.exists()


def test_a_converted_mission_is_not_recorded_over(tmp_path):
    for name in ("events.parquet", "marks.json"):
        (tmp_path / name).write_text("the only one")
    with pytest.raises(RunError, match="another folder"):
        record_graph(RecordOptions(tmp_path), threading.Event(), {})


@pytest.mark.parametrize("name", ["mission.bag", "mission.bag.active"])
def test_a_recording_of_a_robot_is_not_replaced(tmp_path, name):
    (tmp_path / name).write_text("the only one")
    with pytest.raises(RunError, match="another folder"):
        record_graph(
            RecordOptions(tmp_path),
            stop=threading.Event(),
            env={"ROS_MASTER_URI": "http://[::1]:1"},
        )
    assert (tmp_path / name).read_text() == "the only one"


# As roslaunch 1.16 prints it.
def test_the_tail_has_the_place_in_a_broken_yaml_file(tmp_path):
    log_file = tmp_path / "x.log"
    log_file.write_text(
        "\x1b[31mRLException: error loading <rosparam> tag: \n"
        "\tfile /ws/task.yaml contains invalid YAML:\n"
        "mapping values are not allowed here\n"
        '  in "<unicode string>", line 7, column 16:\n'
        "      cooldown: 3.0: x\n"
        "                   ^\n"
        'XML is <rosparam file="$(find x)/task.yaml" command="load"/>\x1b[0m\n'
        "\x1b[31mThe traceback for the exception was written to the log file\x1b[0m\n"
    )
    process = GraphProcess("x", None, log_file, 1.0)  # type: ignore[arg-type]
    assert process.tail() == [
        "RLException: error loading <rosparam> tag: file /ws/task.yaml contains invalid YAML:"
        ' mapping values are not allowed here in "<unicode string>", line 7, column 16:'
        " cooldown: 3.0: x"
    ]


# A detail that reads like an error, as that of a tab does, is told once, and pushes out nothing.
def test_the_details_of_an_error_are_told_once(tmp_path):
    log_file = tmp_path / "x.log"
    log_file.write_text(
        "ERROR: first\n"
        "ERROR: second\n"
        "RLException: /ws/task.yaml contains invalid YAML:\n"
        "found character that cannot start any token\n"
        "  error_limit: 3\n"
        "XML is <rosparam/>\n"
    )
    process = GraphProcess("x", None, log_file, 1.0)  # type: ignore[arg-type]
    assert process.tail() == [
        "ERROR: first",
        "ERROR: second",
        "RLException: /ws/task.yaml contains invalid YAML: found character that cannot start any"
        " token error_limit: 3",
    ]


def test_tail_of_a_process_prefers_what_tells_of_an_error(tmp_path):
    log_file = tmp_path / "x.log"
    lines = ["started", "\x1b[31mRLException: no such file\x1b[0m", "", "====", "done", "bye"]
    log_file.write_text("\n".join(lines))
    process = GraphProcess("x", None, log_file, 1.0)  # type: ignore[arg-type]
    assert process.tail() == ["RLException: no such file"]
    log_file.write_text("one\ntwo\nthree\n\x1b]2;x.launch http://127.0.0.1:1\x07four\n")
    assert process.tail(2) == ["three", "four"]
    assert GraphProcess("x", None, tmp_path / "none", 1.0).tail() == []  # type: ignore[arg-type]


# roslaunch ends with status 0 when a required node is done: the mission is over, and no error.
def test_what_may_end_by_itself(tmp_path):
    graph = RosGraph({"PATH": os.environ["PATH"]}, tmp_path)
    (tmp_path / "out").mkdir()
    for status, may_end in ((0, True), (3, True), (0, False)):
        process = graph.start("one", ["sh", "-c", f"exit {status}"], may_end=may_end)
        process.popen.wait()
        is_well = status == 0 and may_end
        assert process.has_ended_well is is_well
        if is_well:
            graph.check()
        else:
            with pytest.raises(RunError, match=f"one ended with status {status}"):
                graph.check()
        graph.stop(process)
    died = "\x1b[31m=====REQUIRED process [a-1] has died!\nprocess has died [pid 5, exit code -11]"
    process = graph.start("three", ["printf", f"{died}\n"], may_end=True)
    process.popen.wait()
    with pytest.raises(RunError, match=r"three ended with status 0: .*exit code -11"):
        graph.check()
    graph.stop(process)
    running = graph.start("two", ["sleep", "60"], may_end=True)
    assert not running.has_ended_well
    graph.check()
    graph.stop(running)
