"""A subscriber that takes any topic's messages as bytes: ROS 1's slave API and TCPROS.

For a recorder that must not lose a message neither rosbag's recorder nor rospy will do: the first
drops what does not fit into 100 places, and of the second, when many nodes start at once, two
threads connect to one publisher, which then drops one connection a second later, with what was in
it. Here each publisher of a topic has one connection, in which unread messages wait.

The protocols: http://wiki.ros.org/ROS/Slave_API, http://wiki.ros.org/ROS/TCPROS.
"""

from __future__ import annotations

import contextlib
import reprlib
import selectors
import socket
import threading
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import cast

from pytpc.ros.ros1.connecting import Connector
from pytpc.ros.ros1.connection import LENGTH, TimedSocket, encode_header, receive_header
from pytpc.ros.ros1.master import CALL_ERRORS, Master, SlaveServer, call
from pytpc.ros.source import Source

_LARGEST = 1 << 28
_RECEIVE_BYTES = 1 << 18
_LARGEST_ANSWER = 1 << 21
_MOST_PUBLISHERS = 1000
_PATIENCE_S = 5.0
_RETRY_S = 0.2
_LONGEST_RETRY_S = 5.0


class Frames:
    """Cuts a stream of bytes into messages; each comes after its length.

    ``is_lost`` after a length that no message has: what comes then means nothing.
    """

    def __init__(self) -> None:
        self._buffer = bytearray()
        self.is_lost = False

    @property
    def waits(self) -> bool:
        """Whether a message has begun and not ended."""
        return bool(self._buffer)

    def feed(self, data: bytes) -> list[bytes]:
        """Take in what was received; return the messages that are complete now."""
        self._buffer += data
        found = []
        at = 0
        while at + LENGTH.size <= len(self._buffer):
            (length,) = LENGTH.unpack_from(self._buffer, at)
            if length > _LARGEST:
                self.is_lost = True
                break
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


class Receiver:
    """Receives topics of all types; ``poll`` gives their messages, in one thread.

    A publisher is tried for as long as it is listed: it may be just starting, or out of reach.
    ``received`` grows as long as anything comes: bytes, and connections.

    Args:
        caller: name of the node that this is.
        topics: what to receive.
    """

    def __init__(self, caller: str, topics: Sequence[str]) -> None:
        """See the class; no publisher is known yet."""
        self.received = 0
        self._caller = caller
        self._lock = threading.Lock()
        self._wanted: dict[str, set[str]] = {topic: set() for topic in topics}
        self._known: set[tuple[str, str]] = set()
        self._tries: Counter[tuple[str, str]] = Counter()
        self._new: list[tuple[socket.socket, _Link]] = []
        self._broken: Counter[str] = Counter()
        self._closed = False
        self._selector = selectors.DefaultSelector()
        self._wake_receive, self._wake_send = socket.socketpair()
        self._wake_send.setblocking(False)
        self._selector.register(self._wake_receive, selectors.EVENT_READ)
        self._connector = Connector(self._connect)

    @property
    def broken(self) -> dict[str, int]:
        """Node -> how many of its connections ended within a message, or were out of step."""
        return dict(self._broken)

    def poll(self, timeout_s: float) -> Iterator[tuple[Source, bytes]]:
        """Wait for messages and yield those that came; none after ``timeout_s`` without any."""
        for key, _ in self._selector.select(timeout_s):
            if key.data is None:
                self.received += len(self._wake_receive.recv(4096))
                self._adopt()
                continue
            link: _Link = key.data
            connection = cast(socket.socket, key.fileobj)
            try:
                data = connection.recv(_RECEIVE_BYTES)
            except BlockingIOError:
                continue
            except OSError:
                data = b""
            self.received += len(data)
            messages = link.frames.feed(data)
            if messages:
                with self._lock:
                    self._tries.pop(link.key, None)
            for message in messages:
                yield link.source, message
            if not data or link.frames.is_lost:
                if link.frames.waits:
                    self._broken[link.source.node] += 1
                self._drop(connection, link)

    def connections(self) -> set[tuple[str, str]]:
        """The publishers that are connected, as topic and name of the node, as of the last poll."""
        return {
            (link.source.topic, link.source.node)
            for link in (key.data for key in self._selector.get_map().values())
            if link is not None
        }

    def close(self) -> None:
        """Hang up."""
        self._connector.close()
        with self._lock:
            self._closed = True
            self._wanted.clear()
        self._adopt()
        for key in list(self._selector.get_map().values()):
            cast(socket.socket, key.fileobj).close()
        self._selector.close()
        self._wake_send.close()

    def _set_publishers(self, topic: str, publishers: Iterable[object]) -> None:
        """Connect to the new ones among the publishers that a topic has now."""
        found = {uri for uri in islice(publishers, _MOST_PUBLISHERS) if isinstance(uri, str)}
        with self._lock:
            if topic not in self._wanted:
                return
            self._wanted[topic] = found
            new = sorted((topic, uri) for uri in found if (topic, uri) not in self._known)
            self._known.update(new)
        for key in new:
            self._connector.add(key)

    def _connect(self, key: tuple[str, str]) -> float | None:
        """Try once; in how many seconds to try again, None if not."""
        with self._lock:
            if key[1] not in self._wanted.get(key[0], ()):
                self._known.discard(key)
                self._tries.pop(key, None)
                return None
        try:
            connection, source = _open(key[0], key[1], self._caller)
        except CALL_ERRORS:
            return self._pause_s(key)
        with self._lock:
            if self._closed:
                connection.close()
                return None
            self._new.append((connection, _Link(key, source)))
        # It is full: it wakes all the same. It is closed: nobody polls any more.
        with contextlib.suppress(OSError):
            self._wake_send.send(b"+")
        return None

    def _pause_s(self, key: tuple[str, str]) -> float:
        """How long to wait before the next try, a little longer each time."""
        with self._lock:
            self._tries[key] += 1
            return min(_RETRY_S * 1.5 ** (self._tries[key] - 1), _LONGEST_RETRY_S)

    def _adopt(self) -> None:
        with self._lock:
            new, self._new = self._new, []
        for connection, link in new:
            self._selector.register(connection, selectors.EVENT_READ, link)

    def _drop(self, connection: socket.socket, link: _Link) -> None:
        self._selector.unregister(connection)
        connection.close()
        self._connector.add(link.key, self._pause_s(link.key))


class RawSubscriber(Receiver):
    """A subscriber that the master knows, and tells of each new publisher at once.

    Args:
        master: the ROS master; its caller is the node that this is.
        host: the address at which the graph reaches it.
        topics: what to subscribe to.

    Raises:
        RunError: the master does not answer or refuses.
    """

    def __init__(self, master: Master, host: str, topics: Sequence[str]) -> None:
        """See the class; on return all topics are registered."""
        super().__init__(master.caller, topics)
        self.master = master
        self._server = SlaveServer(host, {"publisherUpdate": self._update})
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
            if self._closed:
                return
            self._wanted.setdefault(topic, set())
        publishers = self.master.call("registerSubscriber", topic, "*", self._server.uri)
        self._set_publishers(topic, publishers if isinstance(publishers, list) else ())

    def register(self) -> None:
        """Register all topics once more: the master was started again.

        Raises:
            RunError: the master does not answer or refuses.
        """
        for topic in list(self._wanted):
            self.subscribe(topic)

    def close(self) -> None:
        """Leave the graph. A master that is gone already is no error."""
        calls = [("unregisterSubscriber", topic, self._server.uri) for topic in self._wanted]
        super().close()
        self.master.leave(calls)
        self._server.close()

    def _update(self, _caller: str, topic: str, publishers: object) -> int:
        if not isinstance(publishers, list):
            raise ValueError("the publishers are no list")
        self._set_publishers(topic, publishers)
        return 0


class UnregisteredSubscriber(Receiver):
    """Subscribes without a word to the master, which has to be asked for publishers (``look``).

    Nobody connects to it, so it works behind a firewall. What a new publisher sends before the next
    look is missed.

    Args:
        master: the ROS master; its caller is the name by which publishers know this.
        topics: what to receive.
    """

    def __init__(self, master: Master, topics: Sequence[str]) -> None:
        """See the class; nothing is asked yet."""
        super().__init__(master.caller, topics)
        self._master = master
        self._uris: dict[str, str] = {}

    def look(self) -> None:
        """Ask the master who publishes now, and connect to those who are new.

        Raises:
            RunError: the master does not answer.
        """
        publishers = self._master.state().publishers
        for topic in list(self._wanted):
            nodes = publishers.get(topic, [])[:_MOST_PUBLISHERS]
            self._set_publishers(topic, [uri for uri in map(self._uri_of, nodes) if uri])

    def _uri_of(self, node: str) -> str:
        """Where a node is. One that does not answer there may have been started again."""
        uri = self._uris.get(node)
        with self._lock:
            fails = any(key[1] == uri for key in self._tries)
        if uri is None or fails:
            uri = self._uris[node] = self._master.node_uri(node) or ""
        return uri


def _open(topic: str, publisher: str, name: str) -> tuple[socket.socket, Source]:
    """Connect to a publisher of a topic and shake hands."""
    protocol = call(publisher, "requestTopic", name, topic, [["TCPROS"]])
    if not isinstance(protocol, list) or len(protocol) != 3:
        raise ValueError(f"no TCPROS: {reprlib.repr(protocol)}")
    _, host, port = protocol
    if not isinstance(host, str) or not isinstance(port, int):
        raise ValueError(f"no address: {reprlib.repr(protocol)}")
    connection = TimedSocket.connect_to(host, port, _PATIENCE_S, _LARGEST_ANSWER)
    try:
        wanted = {"callerid": name, "topic": topic, "type": "*", "md5sum": "*", "tcp_nodelay": "1"}
        connection.sendall(encode_header(wanted))
        fields = receive_header(connection)
        if not fields.get("type") or not fields.get("md5sum"):
            raise ValueError("no type in the header")
    except BaseException:
        connection.close()
        raise
    definition = fields.get("message_definition", "")
    node = fields.get("callerid", "")
    latched = fields.get("latching") == "1"
    source = Source(topic, node, fields["type"], fields["md5sum"], definition, latched)
    return connection.released(), source
