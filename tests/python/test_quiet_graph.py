"""Why a graph that is recorded reports nothing, and what to type then."""

from __future__ import annotations

import socket

import pytest

from pytpc.ros.ros1.master import Master, SystemState
from pytpc.ros.ros1.quiet_graph import QuietNode, gone_nodes, robot_nodes, why_quiet

MASTER = "http://robot:11311"
OLD = QuietNode("/old", is_built=False)
NEW = QuietNode("/new", is_built=True, sink="auto")
OFF = QuietNode("/off", is_built=True, sink="off")
FILE = QuietNode("/file", is_built=True, sink="file", file="/home/ana/.ros/tpc/file-7-1.tpc")
FAR = QuietNode("/far")
DEAF = QuietNode("/deaf", is_reached=False)
EVAL = 'eval "$(pytpc env --setup WORKSPACE)"'

CASES = {
    "no node": ([], False, f"runs at {MASTER} yet", "export ROS_MASTER_URI=http://HOST:11311"),
    "switched off": ([OLD, NEW, OFF], True, "1 node (/off) is switched off", "sink --sink auto"),
    "cannot be reached": ([OLD, DEAF], True, "messages of 1 node (/deaf) cannot", "set ROS_IP"),
    "one is reached": ([FAR, DEAF], True, "2 nodes (/far, /deaf) are not built", "pytpc doctor"),
    "to files": (
        [FILE, NEW],
        False,
        f"1 node (/file) writes reports to files ({FILE.file})",
        "tpc",
    ),
    "nothing compared": ([OLD, NEW], False, "1 node (/new) is built with TPC", "nothing so far"),
    "not built": ([OLD, OLD], True, "2 nodes (/old, /old) are not built with TPC; start", EVAL),
    "not known": ([OLD, FAR], True, "are not built with TPC, or have compared nothing", "doctor"),
    "many": ([OLD] * 5, True, "5 nodes (/old, /old, /old and 2 more)", EVAL),
}


@pytest.mark.parametrize("case", CASES)
def test_what_it_looks_like_and_what_to_type(case: str) -> None:
    nodes, is_fault, *parts = CASES[case]
    found = why_quiet(nodes, MASTER)
    assert found.is_fault == is_fault
    assert "\n" not in found.line
    for part in parts:
        assert part in found.line


def test_the_nodes_of_a_robot_are_told_from_tools(monkeypatch: pytest.MonkeyPatch) -> None:
    tools = ["/rosout", "/tpc_recorder_7", "/record_1700000000123456789", "/play_1700000000123456"]
    tools += ["/rostopic_812_1700000000123", "/rqt_gui_py_node_4711", "/rviz"]
    own = ["/play_motion", "/record_scan2"]
    state = SystemState({"/rosout": [*tools, *own]}, {}, {})
    monkeypatch.setattr(Master, "state", lambda _: state)
    assert robot_nodes(Master(MASTER, "/me")) == own


def test_nodes_that_died_are_told_and_are_not_the_robot() -> None:
    found = why_quiet([], MASTER, ["/human_1"])
    assert found.line.startswith(
        f"no node of a robot runs at {MASTER} yet; 1 node (/human_1) that the master lists cannot"
        " be reached: dead, or in a container whose ports are not published; start the robot"
    )
    assert "2 nodes (/a, /b) that" in why_quiet([], MASTER, ["/a", "/b"]).line


class FakeMaster(Master):
    """A master that knows where one node is."""

    def __init__(self, uri: str, node: str) -> None:
        super().__init__(uri, "/me")
        self._node = node

    def node_uri(self, node: str) -> str | None:
        return self._node


def test_a_node_is_gone_if_nothing_listens_at_its_address_on_this_machine() -> None:
    here, elsewhere = "http://127.0.0.1:11311", "http://192.0.2.7:11311"
    with socket.create_server(("127.0.0.1", 0)) as listener:
        node = f"http://127.0.0.1:{listener.getsockname()[1]}/"
        assert gone_nodes(FakeMaster(here, node), ["/n"], []) == []
    assert gone_nodes(FakeMaster(here, node), ["/n"], []) == ["/n"]
    # The recorder is connected to it; a robot whose nodes call themselves localhost; far nodes.
    assert gone_nodes(FakeMaster(here, node), ["/n"], ["/n"]) == []
    assert gone_nodes(FakeMaster(elsewhere, node), ["/n"], []) == []
    assert gone_nodes(FakeMaster(here, "http://192.0.2.7:9/"), ["/n"], []) == []
    assert gone_nodes(FakeMaster(here, "http://127.0.0.1:x/"), ["/n"], []) == []
