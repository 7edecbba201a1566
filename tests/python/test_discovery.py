"""How long pytpc waits for who is on a graph of ROS 2, however busy the machine is."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner
from mission_samples import comparison, key, link_unit

import pytpc.api.graph_feed
import pytpc.cli.console
import pytpc.cli.watch_commands
from patience import PATIENCE_S, wait_for
from pytpc.api.graph_feed import GraphFeed
from pytpc.api.live_mission import fresh_watching
from pytpc.base.errors import RunError
from pytpc.cli.main import main
from pytpc.diagnosis.question import Question
from pytpc.ingest.decoders import ROS2
from pytpc.ros.ros2.discovery import Discovery
from pytpc.ros.ros2.marking import encode_string
from pytpc.ros.source import Source
from pytpc.static.static_info import StaticInfo

GRAPH = "ros2://7"
NOBODY = "no node in domain 7"
STATIC = StaticInfo.of([link_unit([comparison(0, "~speed")])])
REPORTS = Source("/threshold_information", "", "std_msgs/msg/String", "", "")
BATCH = f"#seq:0,count:1,node:/a\n1.0,{key(0)},1,cmp:4,thresh:3,res:1"


# At least 7 s, or ten times what the start took; as much again after each thing that is found, up
# to four times as much: 100 + 4 * 20.
@pytest.mark.parametrize(
    ("took_s", "changed_s", "until_s"),
    [(0.3, 0, 107), (2, 0, 120), (0.3, 106, 113), (2, 110, 130), (2, 175, 180)],
)
def test_discovery_goes_on_while_something_is_found(took_s, changed_s, until_s):
    discovery = Discovery(100.0, took_s)
    discovery.changed_s = changed_s
    assert discovery.until_s == until_s


class Late:
    """A graph whose node is found, and reports, when the test says so."""

    decoders = ROS2
    patience_s = PATIENCE_S

    def __init__(self) -> None:
        self.is_found, self.reports, self.looks = threading.Event(), threading.Event(), 0
        self.is_there = True
        self.broken: dict[str, int] = {}

    def look(self) -> None:
        self.looks += 1
        self.is_found.wait(PATIENCE_S)
        if not self.is_there:
            raise RunError(NOBODY)

    def poll(self, timeout_s: float) -> Iterator[tuple[Source, bytes]]:
        if self.reports.wait(timeout_s):
            self.reports.clear()
            yield REPORTS, encode_string(BATCH)

    def close(self) -> None:
        self.is_found.set()


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Late:
    late = Late()
    monkeypatch.setattr(pytpc.api.graph_feed, "reports_at", lambda _: late)
    return late


@pytest.fixture
def feed(graph: Late) -> Iterator[GraphFeed]:
    one = GraphFeed(GRAPH, fresh_watching(STATIC, Question()))
    yield one
    one.close()


def test_nobody_is_missed_before_the_graph_was_looked_at(graph: Late, feed: GraphFeed):
    wait_for(lambda: graph.looks == 1)
    assert (feed.fault(), feed.is_settled) == ("", False)
    graph.is_there = False
    graph.is_found.set()
    wait_for(lambda: feed.is_settled)
    assert NOBODY in feed.fault()


def test_the_first_report_of_a_node_that_was_found_is_waited_for(graph: Late, feed: GraphFeed):
    graph.is_found.set()
    wait_for(lambda: graph.looks == 2)
    assert (feed.fault(), feed.is_settled) == ("", False)
    graph.reports.set()
    wait_for(lambda: feed.is_settled)
    assert feed.fault() == ""


class _NoMarks:
    """A marking session at the time of the report."""

    def __init__(self, *_: object, **__: object) -> None:
        pass

    def now_ns(self) -> int:
        return 10**9

    def tick(self) -> None:
        pass

    close = tick


# The time to listen, here none, begins with the first report. The node is found while the command
# looks for it, which takes as long as it takes.
def test_watch_listens_from_the_first_report_on(
    graph: Late, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(pytpc.cli.watch_commands, "marks_at", _NoMarks)
    monkeypatch.setattr(pytpc.cli.console, "_SILENT_S", 0.0)
    static = tmp_path / "static.json"
    STATIC.save(static)

    def appear() -> None:
        wait_for(lambda: graph.looks == 1)
        time.sleep(0.2)
        graph.is_found.set()
        wait_for(lambda: graph.looks == 2)
        graph.reports.set()

    thread = threading.Thread(target=appear)
    thread.start()
    words = ["watch", "--once", "--seconds", "0", "--static", str(static), "--ros", "2"]
    env = {"ROS_DOMAIN_ID": "7", "XDG_RUNTIME_DIR": str(tmp_path), "TPC_ROS": "2"}
    result = CliRunner().invoke(main, words, env=env)
    thread.join()
    assert result.exit_code == 0, result.output
    assert "1 evaluation" in result.output
    assert NOBODY not in result.output
    assert "pytpc: looking for nodes that report: ROS 2 domain 7" in result.output
