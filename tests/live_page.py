"""A page of `pytpc live` without a browser, for tests on real graphs."""

from __future__ import annotations

import asyncio
import json
import signal
import subprocess
from collections.abc import Mapping
from pathlib import Path

from tornado.httpclient import AsyncHTTPClient, HTTPRequest
from tornado.websocket import WebSocketClientConnection, websocket_connect

from patience import PATIENCE_S
from terminals import pytpc

ROOT = Path(__file__).resolve().parents[1]


class Live:
    """A context manager: `pytpc live` in a process of its own, and one page of it.

    ``board`` is what the page shows.
    """

    def __init__(
        self, env: Mapping[str, str], folder: Path, *options: str, observer: str = "ana"
    ) -> None:
        self.observer = observer
        self.process = subprocess.Popen(
            [*pytpc("live", "--no-browser"), *options],
            cwd=folder,
            env={"PYTHONPATH": str(ROOT), **env},
            stdout=subprocess.PIPE,
            text=True,
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
        hello = {"do": "hello", "id": "h", "observer": self.observer, "token": self.token}
        await socket.write_message(json.dumps(hello))
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


def names(rows) -> list[str]:
    """The parameters of rows."""
    return [row["parameter"] for row in rows]
