"""How long pytpc waits for who is on a graph of ROS 2, however busy the machine is."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Self, cast

import pytest
from click.testing import CliRunner
from mission_samples import comparison, key, link_unit
from ros2_bags import log_bytes

import pytpc.api.graph_feed
import pytpc.cli.console
import pytpc.cli.watch_commands
import pytpc.ros.ros2.graph_reports
from patience import PATIENCE_S, wait_for
from pytpc.api.graph_feed import GraphFeed
from pytpc.api.live_mission import fresh_watching
from pytpc.api.live_reports import Item
from pytpc.base.errors import RunError
from pytpc.cli.main import main
from pytpc.diagnosis.question import Question
from pytpc.ingest.decoders import ROS2
from pytpc.recording.mission import ReadName
from pytpc.ros.ros2.address import Ros2Address
from pytpc.ros.ros2.agent_process import Graph
from pytpc.ros.ros2.discovery import Discovery
from pytpc.ros.ros2.graph_reports import Ros2Reports
from pytpc.ros.ros2.marking import encode_string
from pytpc.ros.source import Source
from pytpc.static.static_info import StaticInfo

GRAPH = "ros2://7"
NOBODY = "no node in domain 7"
STATIC = StaticInfo.of([link_unit([comparison(0, "~speed")])])
REPORTS = Source("/threshold_information", "", "std_msgs/msg/String", "", "")
ROSOUT = Source("/rosout", "", "rcl_interfaces/msg/Log", "", "")
NAME = f"#seq:0,count:0,node:/a\n1.0,threshold_name:{key(9)},/a/speed"
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
        self.fault: Exception | None = None
        self.text = BATCH
        self.heard = 0
        self.broken: dict[str, int] = {}

    def look(self) -> None:
        self.looks += 1
        self.is_found.wait(PATIENCE_S)
        if self.fault is not None:
            raise self.fault

    def poll(self, timeout_s: float) -> Iterator[tuple[Source, bytes]]:
        if self.reports.wait(timeout_s):
            self.reports.clear()
            yield REPORTS, encode_string(self.text)
            self.heard += 1

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
    graph.fault = RunError(NOBODY)
    graph.is_found.set()
    wait_for(lambda: feed.is_settled)
    assert feed.fault() == NOBODY


# What the look says is what is wrong, such as the last words of an agent that has ended.
def test_why_a_graph_cannot_be_looked_at_is_told(graph: Late, feed: GraphFeed):
    graph.fault = RunError("the node of ROS 2 that pytpc runs has ended: Killed")
    graph.is_found.set()
    wait_for(lambda: feed.is_settled)
    assert feed.fault() == str(graph.fault)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_nothing_is_waited_for_once_a_look_has_failed(graph: Late, feed: GraphFeed):
    graph.fault = KeyError("nodes")
    graph.is_found.set()
    wait_for(lambda: feed.is_settled)


def test_the_first_report_of_a_node_that_was_found_is_waited_for(graph: Late, feed: GraphFeed):
    graph.is_found.set()
    wait_for(lambda: graph.looks == 2)
    assert (feed.fault(), feed.is_settled) == ("", False)
    graph.reports.set()
    wait_for(lambda: feed.is_settled)
    assert feed.fault() == ""


def test_a_name_is_not_the_first_report(graph: Late, feed: GraphFeed):
    graph.is_found.set()
    wait_for(lambda: graph.looks == 2)
    graph.text = NAME
    graph.reports.set()
    wait_for(lambda: graph.heard == 1)
    (item,) = feed.take(10**9)[1]
    assert isinstance(item, ReadName)
    assert not feed.is_settled
    graph.text = BATCH
    graph.reports.set()
    wait_for(lambda: feed.is_settled)


class Greedy(deque[Item]):
    """What waits is taken at once, as if by the other thread."""

    def __iadd__(self, items: Iterable[Item]) -> Self:  # type: ignore[override, misc]
        super().__iadd__(items)
        self.clear()
        return self


def test_a_report_is_heard_though_it_was_taken_at_once(graph: Late, feed: GraphFeed):
    feed._items = Greedy()
    graph.is_found.set()
    wait_for(lambda: graph.looks == 2)
    graph.reports.set()
    wait_for(lambda: graph.heard == 1)
    wait_for(lambda: feed.is_settled)


class Talking:
    """An agent with a node that is not instrumented, and logs."""

    patience_s = 20.0
    fault = ""
    texts = ("hello", "threshold information is a topic")

    def __init__(self, address: Ros2Address) -> None:
        self.address = address
        self.graph = Graph(("/chatty",))
        self.is_enough: bool | None = None

    def subscribe(self, topic: str, kind: str) -> None:
        pass

    def poll(self, timeout_s: float) -> Iterator[tuple[Source, int, bytes]]:
        for text in self.texts:
            yield ROSOUT, 0, log_bytes(1, "chatty", text)

    def wait_for_graph(self, enough: Callable[[Graph], bool]) -> Graph:
        self.is_enough = enough(self.graph)
        return self.graph


@pytest.fixture
def talking(monkeypatch: pytest.MonkeyPatch) -> Ros2Reports:
    monkeypatch.setattr(pytpc.ros.ros2.graph_reports, "Agent", Talking)
    return Ros2Reports(Ros2Address("7"))


# Nodes that report are looked for until one is found, whatever others log.
def test_the_logs_of_other_nodes_are_no_reports(talking: Ros2Reports):
    agent = cast("Talking", talking._agent)
    assert len(list(talking.poll(0))) == 2
    talking.look()
    assert (agent.is_enough, talking.patience_s) == (False, 0)


# Its hidden node may be found only after it has been heard.
def test_a_log_message_of_a_report_is_of_a_node_that_reports(talking: Ros2Reports):
    agent = cast("Talking", talking._agent)
    agent.texts = ("hello", f"threshold_information:{key(0)},1,cmp:4,thresh:3,res:1")
    assert len(list(talking.poll(0))) == 2
    talking.look()
    assert (agent.is_enough, talking.patience_s) == (True, 20)


def test_an_agent_that_ended_during_the_look_is_told(
    talking: Ros2Reports, monkeypatch: pytest.MonkeyPatch
):
    agent = cast("Talking", talking._agent)

    def end(_: Callable[[Graph], bool]) -> Graph:
        agent.fault = "has ended"
        return Graph()

    monkeypatch.setattr(agent, "wait_for_graph", end)
    with pytest.raises(RunError, match=r"^has ended$"):
        talking.look()


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
