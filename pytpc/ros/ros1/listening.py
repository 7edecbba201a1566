"""Servers that no peer can hold up, and the address at which they listen.

Each peer has a thread of its own. A peer that connects and says nothing, says half, or says one
byte at a time loses its connection after a few seconds, and the oldest one does when many wait.
"""

from __future__ import annotations

import contextlib
import ipaddress
import socket
import socketserver
import threading
import time
from typing import Any

from pytpc.ros.ros1.connection import TimedSocket

MOST_PEERS = 100
"""How many connections are served at a time; an honest one takes a few milliseconds."""
_PATIENCE_S = 5.0
_LARGEST_REQUEST = 1 << 22
_NO_FILES_S = 0.05

Request = socket.socket | tuple[bytes, socket.socket]


def bind_address(host: str) -> str:
    """The address to listen at for a graph that knows this machine as ``host``; "" is all.

    An address is listened at alone. A name may mean another address to another machine (a second
    interface, 127.0.1.1 for its own name on Debian), and an address that is not this machine's
    is translated on the way (a container): then there is no telling where peers arrive.
    """
    if host == "localhost":
        return "127.0.0.1"
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return ""
    if address.version == 6:
        return "127.0.0.1" if address.is_loopback else ""
    with socket.socket() as probe:
        try:
            probe.bind((host, 0))
        except OSError:
            return ""
    return host


class PeerServer(socketserver.ThreadingMixIn, socketserver.TCPServer):
    """A TCP server with a bounded number of threads, for which nobody waits at the end."""

    daemon_threads = True
    block_on_close = False
    request_queue_size = 128

    def __init__(self, *arguments: Any, **options: Any) -> None:  # noqa: ANN401
        """As ``socketserver.TCPServer``; on return it serves."""
        self._lock = threading.Lock()
        self._peers: dict[Request, None] = {}
        super().__init__(*arguments, **options)
        threading.Thread(target=self.serve_forever, args=(0.05,), daemon=True).start()

    @property
    def port(self) -> int:
        """The port at which it listens."""
        port: int = self.socket.getsockname()[1]
        return port

    def close(self) -> None:
        """Serve no more, and hang up on all peers."""
        self.shutdown()
        self.server_close()
        with self._lock:
            peers, self._peers = self._peers, {}
        for peer in peers:
            _hang_up(peer)

    def get_request(self) -> tuple[socket.socket, Any]:
        """The next connection, limited in time and size."""
        try:
            connection, address = self.socket.accept()
        except OSError:
            # Out of file descriptors: the connection stays in the queue, and this is called again.
            time.sleep(_NO_FILES_S)
            raise
        return TimedSocket(connection, _PATIENCE_S, _LARGEST_REQUEST), address

    def process_request(self, request: Request, client_address: object) -> None:
        """Serve in a thread; of too many peers the oldest one loses its connection."""
        oldest = None
        with self._lock:
            self._peers[request] = None
            if len(self._peers) > MOST_PEERS:
                oldest = next(iter(self._peers))
                del self._peers[oldest]
        if oldest is not None:
            _hang_up(oldest)
        super().process_request(request, client_address)

    def close_request(self, request: Request) -> None:
        """Close a connection that was served."""
        with self._lock:
            self._peers.pop(request, None)
        super().close_request(request)

    def handle_error(self, request: Request, client_address: object) -> None:
        """A peer that left, or sent nonsense, is no error of ours, and the terminal is in use."""


def _hang_up(peer: Request) -> None:
    # Not closed: the thread that serves it still has it.
    with contextlib.suppress(OSError):
        if isinstance(peer, socket.socket):
            peer.shutdown(socket.SHUT_RDWR)
