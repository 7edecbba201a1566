"""A subscriber that takes any topic's messages as bytes: ROS 1's slave API and TCPROS.

For a recorder that must not lose a message neither rosbag's recorder nor rospy will do: the first
drops what does not fit into 100 places, and of the second, when many nodes start at once, two
threads connect to one publisher, which then drops one connection a second later, with what was in
it. Here each publisher of a topic has one connection, in which unread messages wait.

The protocols: http://wiki.ros.org/ROS/Slave_API, http://wiki.ros.org/ROS/TCPROS.
"""

from __future__ import annotations

import contextlib
import selectors
import socket
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import cast

from pytpc.base.errors import RunError
from pytpc.ros.ros1.connection import LENGTH, encode_header, receive_header
from pytpc.ros.ros1.master import CALL_ERRORS, Master, SlaveServer, call

_LARGEST = 1 << 28
_RECEIVE_BYTES = 1 << 18
_PATIENCE_S = 5.0
_RETRY_S = 0.2
_MOST_RETRIES = 25


@dataclass(frozen=True, slots=True)
class Source:
    """Where messages come from: one publisher of one topic, with what it says of their type.

    ``latched``: it sends its last message to each new subscriber.
    """

    topic: str
    node: str
    type: str
    md5sum: str
    definition: str
    latched: bool = False


class Frames:
    """Cuts a stream of bytes into messages; each comes after its length."""

    def __init__(self) -> None:
        self._buffer = bytearray()

    def feed(self, data: bytes) -> list[bytes]:
        """Take in what was received; return the messages that are complete now.

        Raises:
            ValueError: a length that no message has.
        """
        self._buffer += data
        found = []
        at = 0
        while at + LENGTH.size <= len(self._buffer):
            (length,) = LENGTH.unpack_from(self._buffer, at)
            if length > _LARGEST:
                raise ValueError(f"a message of {length:,} bytes")
            end = at + LENGTH.size + length
            if end > len(self._buffer):
                break
            found.append(bytes(self._buffer[at + LENGTH.size : end]))
            at = end
        del self._buffer[:at]
        return found


@dataclass(slots=True)
class _Link:
    """One connection to a publisher."""

    key: tuple[str, str]
    source: Source
    frames: Frames = field(default_factory=Frames)


class RawSubscriber:
    """Subscribes to topics of all types; ``poll`` gives their messages, in one thread.

    Args:
        master: the ROS master; its caller is the node that this is.
        host: the address at which the graph reaches it.
        topics: what to subscribe to.

    Raises:
        RunError: the master does not answer or refuses.
    """

    def __init__(self, master: Master, host: str, topics: Sequence[str]) -> None:
        """See the class; on return all topics are registered."""
        self.master = master
        self._lock = threading.Lock()
        self._wanted: dict[str, set[str]] = {topic: set() for topic in topics}
        self._known: set[tuple[str, str]] = set()
        self._new: list[tuple[socket.socket, _Link]] = []
        self._closed = threading.Event()
        self._selector = selectors.DefaultSelector()
        self._wake_receive, self._wake_send = socket.socketpair()
        self._selector.register(self._wake_receive, selectors.EVENT_READ)
        self._server = SlaveServer(host, {"publisherUpdate": self._update}, host)
        try:
            for topic in topics:
                self.subscribe(topic)
        except BaseException:
            self.close()
            raise

    def subscribe(self, topic: str) -> None:
        """Subscribe to a further topic, or again to one that the master has forgotten.

        Raises:
            RunError: the master does not answer or refuses.
        """
        with self._lock:
            self._wanted.setdefault(topic, set())
        publishers = self.master.call("registerSubscriber", topic, "*", self._server.uri)
        self._on_publishers(topic, cast(list[str], publishers))

    def register(self) -> None:
        """Register all topics once more: the master was started again.

        Raises:
            RunError: the master does not answer or refuses.
        """
        for topic in list(self._wanted):
            self.subscribe(topic)

    def poll(self, timeout_s: float) -> Iterator[tuple[Source, bytes]]:
        """Wait for messages and yield those that came; none after ``timeout_s`` without any."""
        for key, _ in self._selector.select(timeout_s):
            if key.data is None:
                self._wake_receive.recv(4096)
                self._adopt()
                continue
            link: _Link = key.data
            connection = cast(socket.socket, key.fileobj)
            try:
                data = connection.recv(_RECEIVE_BYTES)
                messages = link.frames.feed(data)
            except BlockingIOError:
                continue
            except (OSError, ValueError):
                data, messages = b"", []
            for message in messages:
                yield link.source, message
            if not data:
                self._drop(connection, link)

    def connections(self) -> set[tuple[str, str]]:
        """The publishers that are connected, as topic and name of the node, as of the last poll."""
        return {
            (link.source.topic, link.source.node)
            for link in (key.data for key in self._selector.get_map().values())
            if link is not None
        }

    def close(self) -> None:
        """Leave the graph. A master that is gone already is no error."""
        self._closed.set()
        for topic in list(self._wanted):
            with contextlib.suppress(RunError):
                self.master.call("unregisterSubscriber", topic, self._server.uri)
        self._server.close()
        self._adopt()
        for key in list(self._selector.get_map().values()):
            cast(socket.socket, key.fileobj).close()
        self._selector.close()
        self._wake_send.close()

    def _update(self, _caller: str, topic: str, publishers: Sequence[str]) -> int:
        self._on_publishers(topic, publishers)
        return 0

    def _on_publishers(self, topic: str, publishers: Sequence[str]) -> None:
        """Connect to the new ones among the publishers that a topic has now."""
        with self._lock:
            if topic not in self._wanted:
                return
            self._wanted[topic] = set(publishers)
            new = [(topic, uri) for uri in publishers if (topic, uri) not in self._known]
            self._known.update(new)
        for key in new:
            threading.Thread(target=self._connect, args=(key,), daemon=True).start()

    def _connect(self, key: tuple[str, str]) -> None:
        for _ in range(_MOST_RETRIES):
            if self._closed.is_set() or not self._is_wanted(key):
                break
            try:
                connection, source = _open(key[0], key[1], self.master.caller)
            except CALL_ERRORS:
                # A node that is just starting or just ending; it is tried again while it is listed.
                time.sleep(_RETRY_S)
                continue
            with self._lock:
                self._new.append((connection, _Link(key, source)))
            with contextlib.suppress(OSError):
                self._wake_send.send(b"+")
            return
        with self._lock:
            self._known.discard(key)

    def _is_wanted(self, key: tuple[str, str]) -> bool:
        with self._lock:
            return key[1] in self._wanted[key[0]]

    def _adopt(self) -> None:
        with self._lock:
            new, self._new = self._new, []
        for connection, link in new:
            self._selector.register(connection, selectors.EVENT_READ, link)

    def _drop(self, connection: socket.socket, link: _Link) -> None:
        self._selector.unregister(connection)
        connection.close()
        threading.Thread(target=self._connect, args=(link.key,), daemon=True).start()


def _open(topic: str, publisher: str, name: str) -> tuple[socket.socket, Source]:
    """Connect to a publisher of a topic and shake hands."""
    protocol = call(publisher, "requestTopic", name, topic, [["TCPROS"]])
    if not isinstance(protocol, list) or len(protocol) != 3:
        raise ValueError(f"no TCPROS: {protocol}")
    connection = socket.create_connection((str(protocol[1]), int(protocol[2])), _PATIENCE_S)
    try:
        wanted = {"callerid": name, "topic": topic, "type": "*", "md5sum": "*", "tcp_nodelay": "1"}
        connection.sendall(encode_header(wanted))
        fields = receive_header(connection)
        if not {"type", "md5sum"} <= fields.keys():
            raise ValueError("no type in the header")
        connection.setblocking(False)
    except BaseException:
        connection.close()
        raise
    definition = fields.get("message_definition", "")
    node = fields.get("callerid", "")
    latched = fields.get("latching") == "1"
    source = Source(topic, node, fields["type"], fields["md5sum"], definition, latched)
    return connection, source
