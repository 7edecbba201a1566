"""The default: reports as few batches on /rosout, from a node on a real graph."""

from __future__ import annotations

import contextlib
import os
import subprocess
import threading
import time
from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from test_sinks import THREAD, graph, key, made, nodes

from pytpc.api.live_reports import Reports
from pytpc.diagnosis.results.live import Seen
from pytpc.ingest.ros1 import decode_log
from pytpc.recording.summaries import Summary
from pytpc.ros.ros1.graph import RosGraph
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.publisher import MessageType, RawPublisher, encode_time
from pytpc.ros.ros1.subscriber import RawSubscriber

__all__ = ["graph", "nodes"]
ROSOUT = "/rosout"
CLOCK = MessageType("rosgraph_msgs/Clock", "a9c97c1d230cfc112e270351a944ee47", "time clock\n")


class Listener:
    """What came on /rosout in batches."""

    def __init__(self, graph: RosGraph) -> None:
        self._subscriber = RawSubscriber(Master(graph.uri, "/listener"), "127.0.0.1", [ROSOUT])
        self._reports = Reports()
        self.items: list[Seen | Summary] = []
        self.batches = self.bytes = 0

    def listen(self, process: subprocess.Popen[bytes]) -> None:
        end = time.monotonic() + 20
        while process.poll() is None:
            assert time.monotonic() < end
            self._poll()
        self._poll()
        self._subscriber.close()
        assert self._reports.malformed == 0

    def _poll(self) -> None:
        for source, data in self._subscriber.poll(0.05):
            msg = decode_log(data).msg
            self.batches += msg.startswith(b"threshold_batch:")
            self.bytes += len(msg) if msg.startswith(b"threshold_") else 0
            self.items += self._reports.read(source, data, time.monotonic())

    @property
    def counts(self) -> Counter[str]:
        found: Counter[str] = Counter()
        for item in self.items:
            if isinstance(item, Summary):
                found[item.key] += item.count
        return found


def run(graph: RosGraph, nodes: Path, *options: str, **env: str) -> tuple[Listener, int, str]:
    """What came, how many reports were made, and the node's output."""
    kept = {name: text for name, text in os.environ.items() if not name.startswith("TPC_")}
    listener = Listener(graph)
    command = [str(nodes / "reporter"), "--stay=1.5", *options]
    process = graph.start("reporter", command, env={**kept, **env})
    listener.listen(process.popen)
    return listener, made(process)["running"], process.log.read_text()


# 20,000 evaluations a second of four sites: all are counted, and a few batches have them.
def test_the_default_counts_everything_in_few_messages(graph, nodes):
    listener, count, output = run(graph, nodes, "--rate=20000", "--seconds=3", "--threads=4")
    assert count == 60_000
    assert listener.counts == {key(THREAD + i): 15_000 for i in range(4)}
    firsts = [item for item in listener.items if isinstance(item, Seen)]
    assert sorted(item.key for item in firsts) == [key(THREAD + i) for i in range(4)]
    assert listener.batches <= 8
    assert listener.bytes < 10_000
    assert "threshold" not in output


# Each is a flop: ten of a second are sent with their time, and what is left out is counted.
def test_flops_are_sent_up_to_the_cap_and_the_node_says_so_once(graph, nodes):
    listener, count, output = run(graph, nodes, "--rate=100", "--seconds=3", "--flops=1")
    assert listener.counts == {key(THREAD): count}
    flops = [item for item in listener.items if isinstance(item, Seen)]
    assert 25 <= len(flops) <= 50
    assert all(a.result != b.result for a, b in pairwise(flops))
    assert sum(item.flops for item in listener.items if isinstance(item, Summary)) == count - 1
    assert output.count("changes more often than 10 times a second") == 1


# 200 sites, and 120 summaries a second: the periods of some become longer, and nothing is missing.
def test_summaries_of_many_comparisons_come_in_rounds(graph, nodes):
    options = ("--rate=4000", "--seconds=3", "--threads=200", "--stay=5")
    listener, count, _ = run(graph, nodes, *options)
    assert listener.counts == {key(THREAD + i): count // 200 for i in range(200)}
    ends = Counter(item.end_ns for item in listener.items if isinstance(item, Summary))
    assert max(ends.values()) == 120
    assert len(ends) >= 3


@contextlib.contextmanager
def simulated(graph: RosGraph, speed: int) -> Iterator[None]:
    """A clock that is so many times as fast as real time."""
    graph.call("setParam", "/use_sim_time", True)
    clock = RawPublisher(Master(graph.uri, "/player"), {"/clock": CLOCK})
    clock.register()
    done = threading.Event()

    def play() -> None:
        begin = time.monotonic_ns()
        while not done.wait(0.01):
            clock.publish("/clock", encode_time(10**12 + speed * (time.monotonic_ns() - begin)))

    player = threading.Thread(target=play)
    player.start()
    try:
        yield
    finally:
        done.set()
        player.join()
        clock.close()
        graph.call("deleteParam", "/use_sim_time")


# As above, but five seconds of the robot's clock are a real one: up to 50 flops are sent of them,
# once the node has seen how fast the clock is. A cap that was set counts real time, so it is 10, or
# of two real seconds 20. Where the spans begin is open, so the limits lie between.
@pytest.mark.parametrize("settings", [{}, {"TPC_SITE_CAP": "10"}])
def test_the_default_caps_count_seconds_of_the_robot(graph, nodes, settings):
    with simulated(graph, 5):
        options = ("--rate=200", "--seconds=4", "--flops=1", "--wait=1")
        listener, *_ = run(graph, nodes, *options, **settings)
    flops = [item for item in listener.items if isinstance(item, Seen)]
    spans = Counter(item.time_ns // 5_000_000_000 for item in flops)
    assert (max(spans.values()) > 30) == (not settings)


def test_the_thesis_lines_by_name(graph, nodes):
    settings = {"TPC_SINK": "rosout", "TPC_POLICY": "every"}
    listener, count, _ = run(graph, nodes, "--rate=200", "--wait=1", **settings)
    assert listener.batches == 0
    assert len(listener.items) == count == 200


@pytest.mark.parametrize("sink", ["topic", "file"])
def test_a_named_sink_gets_every_report(graph, nodes, sink, tmp_path):
    kept = {"TPC_SINK": sink, "TPC_FOLDER": str(tmp_path / "files")}
    listener, count, _ = run(graph, nodes, "--rate=200", **kept)
    assert count == 200
    assert not listener.items
    if sink == "file":
        (path,) = (tmp_path / "files").glob("*.tpc")
        assert path.stat().st_size > 200 * 32
