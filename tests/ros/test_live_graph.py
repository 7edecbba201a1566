"""`pytpc live` on a real graph of ROS 1: updates, marks on their topics, what goes and returns."""

from __future__ import annotations

import asyncio
import json
import os
import re
import signal
import struct
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from test_watch import Node, environment, graph, report, static
from tornado.httpclient import AsyncHTTPClient, HTTPRequest
from tornado.websocket import WebSocketClientConnection, websocket_connect

from patience import PATIENCE_S, wait_for
from pytpc.recording.marks import read_marks
from pytpc.ros.ros1.graph import RosGraph
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.subscriber import RawSubscriber
from terminals import pytpc

__all__ = ["graph", "static"]


class Live:
    """`pytpc live` on the graph, and one page without a browser."""

    def __init__(self, env: dict[str, str], static: Path, *options: str) -> None:
        command = pytpc("live", "--static", str(static), "-o", "marks.csv", "--no-browser")
        self.process = subprocess.Popen(
            [*command, *options], cwd=static.parent, env=env, stdout=subprocess.PIPE, text=True
        )
        assert self.process.stdout is not None
        self.url = self.process.stdout.readline().strip()
        self.origin, _, self.token = self.url.partition("/?token=")
        self.board: dict = {}
        self._count = 0

    def __enter__(self) -> Live:
        self._loop = asyncio.new_event_loop()
        self.run = self._loop.run_until_complete
        self.socket = self.run(self._connect())
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()
        self._loop.close()
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        self.process.communicate(timeout=PATIENCE_S)

    async def _connect(self) -> WebSocketClientConnection:
        found = await AsyncHTTPClient().fetch(self.url)
        cookie = found.headers["Set-Cookie"].partition(";")[0]
        address = f"{self.origin.replace('http', 'ws', 1)}/socket"
        request = HTTPRequest(address, headers={"Cookie": cookie, "Origin": self.origin})
        socket = await websocket_connect(request)
        self.board = {}
        await socket.write_message('{"do":"hello","id":"h","observer":"ana"}')
        return socket

    def again(self) -> None:
        """The network was cut: a new connection."""
        self.socket.close()
        self.socket = self.run(self._connect())

    def ask(self, what: str, **more) -> dict:
        self._count += 1
        ident = f"q{self._count}"
        self.run(self._say({"do": what, "id": ident, **more}))
        while True:
            message = self.read()
            if message.get("done") == ident:
                return message

    async def _say(self, message: dict) -> None:
        await self.socket.write_message(json.dumps(message))

    def read(self) -> dict:
        text = self.run(asyncio.wait_for(self._read(), PATIENCE_S))
        assert text is not None
        message = json.loads(text)
        for name, part in message.get("changes", {}).items():
            if "is" in part:
                self.board[name] = part["is"]
                continue
            rows = {row["id"]: row for row in [*self.board.get(name, ()), *part["rows"]]}
            order = part.get("order", [row["id"] for row in self.board.get(name, ())])
            self.board[name] = [rows[ident] for ident in order]
        if "board" in message:
            self.run(self._say({"do": "seen"}))
        return message

    async def _read(self):
        return await self.socket.read_message()

    def until(self, is_so) -> None:
        """Read boards until one is so."""
        while not (self.board and is_so(self.board)):
            self.read()


@pytest.fixture
def node(graph: RosGraph) -> Iterator[Node]:
    made = Node(graph.uri, "/logs")
    yield made
    made.publisher.close()


def names(rows) -> list[str]:
    return [row["parameter"] for row in rows]


# ~flops is above 3, below, above: two turns. ~near comes as near as 0.01 to 1.
def test_reports_are_shown_and_marks_arrive_on_the_observers_topic(graph, static, node):
    topics = ["/ana/mark_no_action", "/ana/mark_note"]
    heard = RawSubscriber(Master(graph.uri, "/listener"), "127.0.0.1", topics)
    messages = []
    try:
        with Live(environment(graph), static) as live:
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
        with Live(environment(graph), static) as live:
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
    with Live(environment(graph), static) as live:
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
    live = Live(environment(graph), static)
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
