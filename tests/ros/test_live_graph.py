"""`pytpc live` on a real graph of ROS 1: updates, marks on their topics, what goes and returns."""

from __future__ import annotations

import os
import re
import signal
import struct
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from test_watch import Node, environment, graph, report, static

from live_page import Live, names
from patience import PATIENCE_S, wait_for
from pytpc.recording.marks import read_marks
from pytpc.ros.ros1.graph import RosGraph
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.subscriber import RawSubscriber

__all__ = ["graph", "static"]


def served(env: dict[str, str], static: Path) -> Live:
    return Live(env, static.parent, "--static", str(static), "-o", "marks.csv")


@pytest.fixture
def node(graph: RosGraph) -> Iterator[Node]:
    made = Node(graph.uri, "/logs")
    yield made
    made.publisher.close()


# ~flops is above 3, below, above: two turns. ~near comes as near as 0.01 to 1.
def test_reports_are_shown_and_marks_arrive_on_the_observers_topic(graph, static, node):
    topics = ["/ana/mark_no_action", "/ana/mark_note"]
    heard = RawSubscriber(Master(graph.uri, "/listener"), "127.0.0.1", topics)
    messages = []
    try:
        with served(environment(graph), static) as live:
            live.until(lambda board: board["state"]["live"])
            node.wait_for_listeners("tpc_watch")
            for cmp in (4, 2, 4):
                node.log(f"threshold_information:{report(0, cmp, 3)}")
            for cmp in (0.0, 0.5, 0.99):
                node.log(f"threshold_information:{report(1, cmp, 1)}")
            live.until(lambda board: "6 evaluations" in board["state"]["counts"])
            live.until(lambda board: names(board["turns"]) == ["~flops", "~flops"])
            assert names(live.board["near"])[0] == "~near"
            assert live.board["near"][0]["margin"] == "0.01"
            assert live.ask("2")["said"].startswith("marked: type II: 1 ~")
            assert live.ask("note", text="stuck")["ok"]

            def is_heard() -> bool:
                messages.extend(heard.poll(0.2))
                return len(messages) >= 2

            wait_for(is_heard)
            live.until(lambda board: [row["observer"] for row in board["marks"]] == ["ana"])
    finally:
        heard.close()
    (mark,) = read_marks(static.parent / "marks.csv")
    seconds, nanoseconds = struct.unpack("<II", messages[0][1])
    assert mark.time_ns == seconds * 10**9 + nanoseconds
    assert (mark.type, mark.observer, mark.note) == ("II", "ana", "stuck")
    assert b"stuck" in messages[1][1]


def test_the_graph_goes_and_comes_back(static: Path, tmp_path: Path):
    with RosGraph(dict(os.environ), tmp_path / "first") as graph:
        port = graph.uri.rpartition(":")[2]
        first = Node(graph.uri, "/first")
        with served(environment(graph), static) as live:
            first.wait_for_listeners("tpc_watch")
            first.log(f"threshold_information:{report(1, 0.5, 1)}")
            live.until(lambda board: "1 evaluation of 1 node" in board["state"]["counts"])
            first.publisher.close()
            graph.stop(graph._processes[0])
            live.until(lambda board: board["state"]["gone_since"] and board["state"]["quiet_since"])
            # What was last is still there, and one can still mark.
            assert live.ask("1")["ok"]
            graph.start("again", ["rosmaster", "--core", "-p", port])
            live.until(lambda board: board["state"]["gone_since"] is None)
            second = Node(graph.uri, "/second")
            try:
                second.wait_for_listeners("tpc_watch")
                second.log(f"threshold_information:{report(1, 0.7, 1)}")
                live.until(lambda board: "2 evaluations of 2 nodes" in board["state"]["counts"])
                live.until(lambda board: board["state"]["quiet_since"] is None)
            finally:
                second.publisher.close()
    assert len(read_marks(static.parent / "marks.csv")) == 1


def test_the_connection_of_a_page_is_cut(graph, static, node):
    with served(environment(graph), static) as live:
        node.wait_for_listeners("tpc_watch")
        node.log(f"threshold_information:{report(1, 0.5, 1)}")
        live.until(lambda board: "1 evaluation" in board["state"]["counts"])
        first = live.ask("1")
        live.again()
        # The whole board comes again; what was asked before is not done twice.
        live.until(lambda board: len(board.get("marks", ())) == 1)
        live._count = 0
        assert live.ask("1") == {**first, "done": "q1"}
    assert len(read_marks(static.parent / "marks.csv")) == 1


def test_it_listens_on_loopback_alone_and_ends_on_a_signal(graph, static):
    live = served(environment(graph), static)
    found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?token=[\w-]{32}", live.url)
    assert found
    listening = subprocess.run(
        ["ss", "-Hltn", f"sport = :{found[1]}"], capture_output=True, text=True, check=False
    ).stdout
    if listening:
        assert listening.split()[3] == f"127.0.0.1:{found[1]}"
    live.process.send_signal(signal.SIGTERM)
    live.process.communicate(timeout=PATIENCE_S)
    assert live.process.returncode == 128 + signal.SIGTERM
