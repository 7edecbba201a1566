"""Peers that say nothing, and a master that hangs: nothing is lost, and Ctrl-C ends everything."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from pytpc.ingest.reading import read
from pytpc.ros.ros1.graph import GraphProcess, RosGraph
from pytpc.ros.ros1.master import Master, call
from pytpc.ros.ros1.subscriber import RawSubscriber
from terminals import Terminal, pytpc

sys.path.insert(0, str(Path(__file__).parents[1] / "python"))
from mission_samples import comparison, static_info

ROOT = Path(__file__).parents[2]
LIMIT_S = 60.0
REPORTS = 500
KEY = "0a1b2c3d-0000-5000-8000-00000000000f"
# It waits for the recorder, then reports.
NODE = f"""
import rospy
from rosgraph_msgs.msg import Log
rospy.init_node("talker", disable_rosout=True)
out = rospy.Publisher("/rosout", Log, queue_size=None)
while out.get_num_connections() < 2:
    rospy.sleep(0.05)
for number in range({REPORTS}):
    text = "threshold_information:{KEY},%d,cmp:%d,thresh:5,res:1" % (number % 2, number)
    out.publish(Log(msg=text, name="/talker"))
rospy.sleep(0.5)
print("done", flush=True)
"""
# What they say before they fall silent.
HALF = (b"", b"P", b"POST / HTTP/1.1\r\nContent-Length: 100\r\n\r\n<", b"\x40\0\0\0\x10\0\0\0to")


@pytest.fixture
def graph(tmp_path: Path) -> Iterator[RosGraph]:
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(tmp_path)}
    with RosGraph(environment, tmp_path / "graph") as started:
        yield started


def wait_for(condition: Callable[[], object]) -> None:
    until = time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.05)


def nodes(graph: RosGraph, name: str) -> list[str]:
    return sorted(node for node in Master(graph.uri, "/test").state().nodes if name in node)


@contextlib.contextmanager
def idle(graph: RosGraph, *names: str) -> Iterator[None]:
    """Several silent peers at each port at which these nodes listen."""
    master = Master(graph.uri, "/test")
    with contextlib.ExitStack() as stack:
        for node in names:
            uri = master.node_uri(node)
            assert uri is not None
            ports = [urlsplit(uri).port]
            for topic, publishers in master.state().publishers.items():
                if node in publishers:
                    answer = call(uri, "requestTopic", "/test", topic, [["TCPROS"]])
                    assert isinstance(answer, list)
                    ports.append(answer[2])
            for port in set(ports):
                for says in HALF:
                    peer = socket.create_connection(("127.0.0.1", port))
                    stack.enter_context(peer).sendall(says)
        yield


@contextlib.contextmanager
def stopped(master: GraphProcess) -> Iterator[None]:
    """A master that takes connections and does not answer."""
    os.killpg(master.popen.pid, signal.SIGSTOP)
    try:
        yield
    finally:
        os.killpg(master.popen.pid, signal.SIGCONT)


def environment(graph: RosGraph) -> dict[str, str]:
    return {**os.environ, **graph.env, "PYTHONPATH": str(ROOT)}


@contextlib.contextmanager
def recording(graph: RosGraph, out: Path) -> Iterator[subprocess.Popen[str]]:
    with subprocess.Popen(
        pytpc("record", "-o", str(out)),
        env=environment(graph),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            wait_for(lambda: process.poll() is not None or nodes(graph, "tpc_recorder"))
            yield process
        finally:
            process.kill()


def test_silent_peers_of_the_recorder(graph: RosGraph, tmp_path: Path) -> None:
    out = tmp_path / "out"
    with recording(graph, out) as process, idle(graph, *nodes(graph, "tpc_recorder")):
        done = subprocess.run(
            ["/usr/bin/python3", "-c", NODE],
            env=graph.env,
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            check=False,
        )
        assert "done" in done.stdout, done.stderr
        process.send_signal(signal.SIGINT)
        said, complaints = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, complaints
    assert said.startswith(f"{REPORTS} reports and 0 marks in ")
    assert len(read(out / "mission.bag").events) == REPORTS


def test_the_recorder_ends_though_the_master_hangs(graph: RosGraph, tmp_path: Path) -> None:
    out = tmp_path / "out"
    with recording(graph, out) as process:
        # What it asks the master for at its start has come by then.
        wait_for((out / "params_start.yaml").is_file)
        with stopped(graph._processes[0]):
            process.send_signal(signal.SIGINT)
            # The bag is closed before the master is asked for the values at the end.
            wait_for((out / "mission.bag").is_file)
        said, complaints = process.communicate(timeout=3 * LIMIT_S)
    assert process.returncode == 0, complaints
    assert "(interrupted)" in said


def test_silent_peers_of_the_marks(graph: RosGraph, tmp_path: Path) -> None:
    command = pytpc("mark", "-o", "marks.csv")
    heard = RawSubscriber(Master(graph.uri, "/listener"), "127.0.0.1", ["/mark_action"])
    try:
        with Terminal(command, tmp_path, env=environment(graph), columns=120) as terminal:
            terminal.wait_for("1 node listening")
            with idle(graph, *nodes(graph, "tpc_mark")):
                terminal.press("1")
                messages: list[object] = []
                wait_for(lambda: messages.extend(heard.poll(0.1)) or messages)
                with stopped(graph._processes[0]):
                    terminal.press("\x03")
                    assert terminal.wait(LIMIT_S) == 0
    finally:
        heard.close()
    assert len(messages) == 1


def test_watching_is_no_node_until_it_marks(graph: RosGraph, tmp_path: Path) -> None:
    static = tmp_path / "static.json"
    static_info(comparison(0, "~flops"), comparison(1, "~near")).save(static)
    command = pytpc("watch", "--static", str(static), "-o", "marks.csv")
    heard = RawSubscriber(Master(graph.uri, "/listener"), "127.0.0.1", ["/mark_action"])
    try:
        with Terminal(command, tmp_path, env=environment(graph), columns=120, lines=30) as terminal:
            terminal.wait_for("found with the first mark")
            # /listener is the only one that subscribes to anything besides rosout itself.
            assert nodes(graph, "tpc_") == []
            terminal.press("1")
            messages: list[object] = []
            wait_for(lambda: messages.extend(heard.poll(0.1)) or messages)
            assert len(nodes(graph, "tpc_mark")) == 1
            assert nodes(graph, "tpc_watch") == []
            with idle(graph, *nodes(graph, "tpc_mark")), stopped(graph._processes[0]):
                terminal.press("\x03")
                assert terminal.wait(LIMIT_S) == 0
    finally:
        heard.close()


# The mark is sent although the observer leaves at once.
def test_the_first_mark_of_a_watch_that_ends_at_once(graph: RosGraph, tmp_path: Path) -> None:
    static = tmp_path / "static.json"
    static_info(comparison(0, "~flops")).save(static)
    command = pytpc("watch", "--static", str(static), "-o", "marks.csv")
    heard = RawSubscriber(Master(graph.uri, "/listener"), "127.0.0.1", ["/mark_action"])
    try:
        with Terminal(command, tmp_path, env=environment(graph), columns=120, lines=30) as terminal:
            terminal.wait_for("found with the first mark")
            terminal.press("1q")
            messages: list[object] = []
            wait_for(lambda: messages.extend(heard.poll(0.1)) or messages)
            assert terminal.wait(LIMIT_S) == 0
    finally:
        heard.close()


def test_silent_peers_of_the_relay(graph: RosGraph) -> None:
    relay = graph.start("relay", pytpc("relay"), env={"PYTHONPATH": str(ROOT)}, patience_s=LIMIT_S)
    topic = "/threshold_information"
    heard = RawSubscriber(Master(graph.uri, "/listener"), "127.0.0.1", [topic])
    try:
        wait_for(lambda: nodes(graph, "tpc_relay") == ["/tpc_relay", "/tpc_relay_reader"])
        wait_for(lambda: list(heard.poll(0.1)) or heard.connections())
        with idle(graph, "/tpc_relay", "/tpc_relay_reader"):
            done = subprocess.run(
                ["/usr/bin/python3", "-c", NODE],
                env=graph.env,
                capture_output=True,
                text=True,
                timeout=LIMIT_S,
                check=False,
            )
            assert "done" in done.stdout, done.stderr
            messages: list[object] = []
            wait_for(lambda: messages.extend(heard.poll(0.1)) or len(messages) == REPORTS)
            assert graph.stop(relay) == 0
    finally:
        heard.close()
    assert f"{REPORTS} reports passed on" in relay.log.read_text()


def test_the_relay_ends_though_the_master_hangs(graph: RosGraph) -> None:
    relay = graph.start("relay", pytpc("relay"), env={"PYTHONPATH": str(ROOT)}, patience_s=LIMIT_S)
    wait_for(lambda: "passing on reports" in relay.log.read_text())
    with stopped(graph._processes[0]):
        assert graph.stop(relay) == 0
    assert "0 reports passed on" in relay.log.read_text()
