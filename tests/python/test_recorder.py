"""The recorder of ROS 1: topics, times, marks, counts and bag; the real graph is in tests/ros."""

from __future__ import annotations

import shutil
import struct
import subprocess
import time
from dataclasses import replace

import pytest
from mission_samples import ns
from recorded_messages import CHAT, CLOCK, DONE, MARK, ROSOUT, log
from rosbags.highlevel import AnyReader

from pytpc.base.errors import RunError
from pytpc.recording.mission import Dropped
from pytpc.ros.mission_run import (
    MissionRun,
    Progress,
    RecorderStatus,
    read_status,
    save_status,
)
from pytpc.ros.ros1.bag_file import BagFile
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.recorder import Discovery, Recorder
from pytpc.ros.source import Source


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
