"""A ROS master that falls ill: it passes requests on to a real one, until a certain one comes.

From then on it behaves as a roscore that hangs (it takes connections and never answers) or as one
that was killed (connections end, and nobody listens). Or it leaves only such requests unanswered.
"""

from __future__ import annotations

import contextlib
import re
import socket
import threading
from typing import Literal, Self

Illness = Literal["deaf", "hangs", "dies"]


class IllMaster:
    """A context manager; ``uri`` is its address.

    Args:
        port: of the real master, on this machine.
        request: a regular expression for the text of the requests that make it ill.
        illness: ``deaf`` answers all other requests.
    """

    def __init__(self, port: int, request: str, illness: Illness) -> None:
        self._port = port
        self._bad = re.compile(request, re.DOTALL)
        self._illness = illness
        self._open: list[socket.socket] = []
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.uri = f"http://127.0.0.1:{self._listener.getsockname()[1]}"
        self.is_ill = threading.Event()

    def __enter__(self) -> Self:
        threading.Thread(target=self._listen, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def _end(self) -> None:
        for each in (self._listener, *self._open):
            with contextlib.suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
            each.close()

    def _listen(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                client, _ = self._listener.accept()
                self._open.append(client)
                threading.Thread(target=self._serve, args=[client], daemon=True).start()

    def _serve(self, client: socket.socket) -> None:
        with contextlib.suppress(OSError):
            real = None
            while request := _message(client):
                if self._bad.search(request.decode("latin-1")):
                    self.is_ill.set()
                    if self._illness == "dies":
                        self._end()
                        return
                    if self._illness == "deaf":
                        return
                if self.is_ill.is_set() and self._illness == "hangs":
                    return
                real = real or socket.create_connection(("127.0.0.1", self._port))
                self._open.append(real)
                real.sendall(request)
                client.sendall(_message(real))


def _message(stream: socket.socket) -> bytes:
    """The next message of HTTP; empty if there is none."""
    data = b""
    while b"\r\n\r\n" not in data:
        more = stream.recv(65536)
        if not more:
            return b""
        data += more
    head, body = data.split(b"\r\n\r\n", 1)
    (length,) = re.findall(rb"(?i)content-length: *(\d+)", head)
    while len(body) < int(length):
        body += stream.recv(65536)
    return head + b"\r\n\r\n" + body
