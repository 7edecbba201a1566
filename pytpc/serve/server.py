"""The server of the page: makes boards ten times a second, and gives each page what is new.

The board has one thread of its own, in which all that concerns the mission is done, one thing after
the other: a jump in a long recording, or a graph that does not answer, holds up no socket.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import logging
import os
import socket
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar
from weakref import WeakSet

from tornado.httpserver import HTTPServer
from tornado.httputil import HTTPServerRequest
from tornado.iostream import IOStream
from tornado.web import Application

from pytpc.api.live_board import Board, LiveBoard
from pytpc.api.live_observers import Answer, free_name
from pytpc.api.live_values import LiveValues, Planned
from pytpc.base.errors import RunError
from pytpc.recording.marks import is_observer
from pytpc.serve.access import Access, host_name, is_private, names_of, shown_host
from pytpc.serve.handlers import AssetHandler, PageHandler
from pytpc.serve.limits import LONGEST_MESSAGE
from pytpc.serve.pages import Answers, PageSocket

Done = TypeVar("Done")

_EACH_S = 0.1
_PATIENCE_S = 0.5
"""So long a jump in a recording is read before the pages are told how much of it is left."""
_LINE_EACH = 5
"""The open comparison's line is sent with each so-many-th board."""
_MOST_CONNECTIONS = 200
_BACKLOG = 64
_IDLE_S = 30.0


@dataclass(frozen=True)
class ServeOptions:
    """Where to listen, and what pages may do.

    Attributes:
        host: the address to listen at.
        port: 0: one that is free.
        observer: the name of the first observer; the others get a number.
        values: changes values for pages; None: they may not.
    """

    host: str = "127.0.0.1"
    port: int = 0
    observer: str = "observer"
    values: LiveValues | None = None


class LiveServer:
    """Serves a board.

    Args:
        board: what is shown; from now on only this server's thread calls it.
        options: see there.

    Raises:
        RunError: nobody can listen at this address.
    """

    def __init__(self, board: LiveBoard, options: ServeOptions) -> None:
        """Listen."""
        self._board = board
        self._options = options
        self._socket = _bound(options.host, options.port)
        self.port: int = self._socket.getsockname()[1]
        # The printed address is served, whatever name ROS has for this machine.
        shown = host_name(shown_host(options.host, os.environ))
        self.access = Access(names_of(options.host) | {shown})
        self.pages: set[PageSocket] = set()
        self.answers: dict[str, Answers] = {}
        self._thread = ThreadPoolExecutor(1, "board")
        self._changes = ThreadPoolExecutor(1, "values")
        self._newest: tuple[int, Board] | None = None
        self._stopped = asyncio.Event()

    @property
    def url(self) -> str:
        """The address of the page, with the token."""
        host = shown_host(self._options.host, os.environ)
        return f"http://{host}:{self.port}/?token={self.access.token}"

    @property
    def phone_url(self) -> str:
        """The same if other machines reach it; else empty."""
        return "" if is_private(shown_host(self._options.host, os.environ)) else self.url

    @property
    def allows_apply(self) -> bool:
        """Whether pages may change values."""
        return self._options.values is not None

    def stop(self) -> None:
        """End `run`."""
        self._stopped.set()

    async def run(self) -> None:
        """Serve until `stop`."""
        logging.getLogger("tornado.access").disabled = True
        handled = {"server": self}
        application = Application(
            [
                (r"/", PageHandler, handled),
                (r"/assets/([a-z.-]{1,40})", AssetHandler, handled),
                (r"/socket", PageSocket, handled),
            ],
            default_handler_class=_NothingHere,
            default_handler_args=handled,
            log_function=lambda _handler: None,
            compress_response=True,
            websocket_max_message_size=LONGEST_MESSAGE,
            websocket_ping_interval=10.0,
        )
        server = _BoundedServer(
            application,
            max_header_size=16_384,
            max_body_size=1024,
            idle_connection_timeout=_IDLE_S,
            body_timeout=_IDLE_S,
        )
        server.add_socket(self._socket)
        try:
            await self._keep_up()
        finally:
            server.stop()
            for page in list(self.pages):
                page.close(1001, "pytpc live has ended")
            # The pages are told before the process ends.
            with contextlib.suppress(asyncio.TimeoutError):
                await asyncio.wait_for(server.close_all_connections(), 2.0)
            self._thread.shutdown()
            self._changes.shutdown()

    async def _keep_up(self) -> None:
        number = 0
        while not self._stopped.is_set():
            began = time.monotonic()
            number += 1
            await self._on_board(partial(self._board.tick, _PATIENCE_S))
            if self.pages:
                self._newest = number, await self._on_board(self._board.board)
                for page in list(self.pages):
                    page.offer(*self._newest)
                if number % _LINE_EACH == 0:
                    await self._send_lines()
            left_s = began + _EACH_S - time.monotonic()
            with contextlib.suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self._stopped.wait(), max(0.005, left_s))

    async def _send_lines(self) -> None:
        """Send the last values of the comparisons that pages look at."""
        for opened in {page.opened for page in self.pages if page.opened is not None}:
            line = await self._on_board(partial(self._board.line, *opened))
            for page in list(self.pages):
                if page.opened == opened:
                    page.offer_line(opened[0], line)

    async def _on_board(self, ask: Callable[[], Done]) -> Done:
        return await asyncio.get_running_loop().run_in_executor(self._thread, ask)

    def serves(self, request: HTTPServerRequest) -> bool:
        """Whether a request is for this machine."""
        reached = ""
        stream = getattr(request.connection, "stream", None)
        if isinstance(stream, IOStream) and stream.socket is not None:
            with contextlib.suppress(OSError):
                reached = str(stream.socket.getsockname()[0])
        return self.access.serves(request.host, reached)

    def about(self, observer: str) -> dict[str, Any]:
        """What a page is told first."""
        return {
            "observer": observer,
            "apply": self.allows_apply,
            "recording": self._board.recorded is not None,
            "phone": bool(self.phone_url),
        }

    async def join(self, page: PageSocket, wanted: str | None) -> tuple[str, Answer]:
        """Begin the session of an observer, whose page may ask for a name."""
        if wanted is None:
            taken = [one.observer for one in self.pages if one is not page and one.observer]
            wanted = free_name(self._options.observer, taken)
        if wanted and not is_observer(wanted):
            said = "a name has letters, digits and _, and begins with a letter"
            return page.observer or "", Answer(False, said)
        return wanted, await self._on_board(lambda: self._board.observers.join(wanted))

    async def mark(self, observer: str, what: str, text: str, at_s: float | None) -> Answer:
        """Make a mark, or say something about the last one."""

        def do() -> Answer:
            try:
                at_ns = self._board.mark_time(at_s)
            except ValueError as error:
                return Answer(False, f"not marked: {error}")
            return self._board.observers.do(observer, what, text, at_ns)

        return await self._on_board(do)

    async def play(self, what: str, to: float) -> Answer:
        """Move the clock of a recording."""
        return await self._on_board(lambda: self._board.play(what, to))

    async def detail(self, key: str, node: str) -> Board | None:
        """All about a comparison in a node."""
        return await self._on_board(lambda: self._board.detail(key, node))

    async def plan(self, parameter: str, value: str) -> Planned:
        """Plan a change of a value.

        Raises:
            TpcError: it cannot be changed.
        """
        values = self._options.values
        assert values is not None
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._changes, values.plan, parameter, value)

    async def apply(self, number: int) -> Answer:
        """Make a change that was planned."""
        values = self._options.values
        assert values is not None
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._changes, values.apply, number)


class _NothingHere(AssetHandler):
    """Any other address; without the token it is not even said that there is nothing."""

    def get(self, *_: str) -> None:
        """Say so."""
        super().get("")


class _BoundedServer(HTTPServer):
    """An HTTP server with a limit on its connections."""

    def initialize(self, *args: Any, **options: Any) -> None:  # noqa: ANN401
        """None is open."""
        self._streams: WeakSet[IOStream] = WeakSet()
        super().initialize(*args, **options)

    def handle_stream(self, stream: IOStream, address: tuple[Any, ...]) -> None:
        """Serve a connection, unless there are too many."""
        if sum(not one.closed() for one in self._streams) >= _MOST_CONNECTIONS:
            stream.close()
            return
        self._streams.add(stream)
        super().handle_stream(stream, address)


def _bound(host: str, port: int) -> socket.socket:
    """A socket that listens.

    Raises:
        RunError: nobody can listen there.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    # At all addresses means those of IPv4, too: one of them is printed.
    both = host == "::" and socket.has_dualstack_ipv6()
    try:
        found = socket.create_server(
            (host, port), family=family, backlog=_BACKLOG, dualstack_ipv6=both
        )
    except socket.gaierror as error:
        raise RunError(f"--host {host}: no address of this machine has this name") from error
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            what = f"port {port} is in use: choose another one, or 0 for any that is free"
        elif error.errno == errno.EADDRNOTAVAIL:
            what = (
                f"--host {host}: this machine does not have this address; `hostname -I` lists them"
            )
        else:
            what = f"cannot listen at {host} port {port}: {error.strerror}"
        raise RunError(what) from error
    found.setblocking(False)
    return found
