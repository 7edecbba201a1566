"""The recorder of a graph, with a master and a publisher of ours."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_tcpros import HOST, master, publisher, wait_for

from pytpc.base.signals import Stop
from pytpc.ingest.reading import read
from pytpc.ros.mission_run import RecordOptions
from pytpc.ros.ros1 import bag_file, subscriber
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.record_mission import record_graph
from pytpc.ros.ros1.recorder import GraphRecorder, Wanted

__all__ = ["master", "publisher"]
LIMIT_S = 20.0


def recording(master, publisher, bag: Path, wanted: Wanted) -> GraphRecorder:
    """A recorder with a connection to the publisher of /chat."""
    master.publishers["/chat"] = [publisher.rpc.uri]
    recorder = GraphRecorder(Master(master.rpc.uri, "/me"), HOST, wanted, bag, strict=False)
    wait_for(lambda: recorder.step() and recorder._subscriber.connections(), LIMIT_S)
    return recorder


# It is read in ten parts, of which the first nine make no message.
def test_a_long_message_at_the_end_is_recorded(master, publisher, tmp_path: Path, monkeypatch):
    monkeypatch.setattr(subscriber, "_RECEIVE_BYTES", 1000)
    recorder = recording(master, publisher, tmp_path / "a.bag", Wanted(["/chat"]))
    publisher.send(b"x" * 9996)
    assert recorder.finish().messages == {"/chat": 1}


def test_topics_without_the_slash_in_front(master, publisher, tmp_path: Path):
    recorder = recording(master, publisher, tmp_path / "a.bag", Wanted(["chat"], "done"))
    assert {"/chat", "/done"} <= set(master.subscribers)
    publisher.send(b"one")
    assert recorder.finish().messages == {"/chat": 1}


def test_a_bag_is_on_the_disk_before_it_has_its_name(tmp_path: Path, monkeypatch):
    synced = []
    monkeypatch.setattr(bag_file.os, "fsync", lambda _: synced.append(sorted(tmp_path.iterdir())))
    bag_file.BagFile(tmp_path / "a.bag").close()
    assert [path.name for path in synced[-1]] == [".a.bag.reserve", "a.bag.active"]
    assert list(tmp_path.iterdir()) == [tmp_path / "a.bag"]


# In a notebook, Ctrl-C is an exception.
def test_an_interrupted_recording_of_a_graph_is_a_whole_bag(master, publisher, tmp_path: Path):
    master.publishers["/rosout"] = [publisher.rpc.uri]

    def interrupt(_: object) -> None:
        if publisher.connections:
            raise KeyboardInterrupt

    options = RecordOptions(tmp_path / "out", on_progress=interrupt)
    # Without rosparam.
    env = {"ROS_MASTER_URI": master.rpc.uri, "ROS_IP": HOST, "PATH": "/nowhere"}
    with pytest.raises(KeyboardInterrupt):
        record_graph(options, Stop(), env)
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["mission.bag"]
    assert not read(tmp_path / "out/mission.bag").marks
