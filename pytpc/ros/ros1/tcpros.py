"""A subscriber that takes any topic's messages as bytes: ROS 1's slave API and TCPROS.

For a recorder that must not lose a message neither rosbag's recorder nor rospy will do: the first
drops what does not fit into 100 places, and of the second, when many nodes start at once, two
threads connect to one publisher, which then drops one connection a second later, with what was in
it. Here each publisher of a topic has one connection, and what is not yet read waits in it.

The protocols: http://wiki.ros.org/ROS/Slave_API, http://wiki.ros.org/ROS/TCPROS.
"""

from __future__ import annotations

import contextlib
import os
import selectors
import socket
import struct
import threading
import time
import xmlrpc.client
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from http.client import HTTPException
from typing import cast
from urllib.parse import urlsplit
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

from pytpc.base.errors import RunError

_LENGTH = struct.Struct("<I")
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


def encode_header(fields: Mapping[str, str]) -> bytes:
    """A TCPROS connection header: its length, then each ``name=value`` after its length."""
    parts = [f"{name}={value}".encode() for name, value in fields.items()]
    body = b"".join(_LENGTH.pack(len(part)) + part for part in parts)
    return _LENGTH.pack(len(body)) + body


def decode_header(body: bytes) -> dict[str, str]:
    """The fields of a connection header, without the length in front.

    Raises:
        ValueError: the lengths do not fit, or a field has no ``=``.
    """
    fields = {}
    at = 0
    while at < len(body):
        if at + _LENGTH.size > len(body):
            raise ValueError(f"a length is cut off at byte {at}")
        (length,) = _LENGTH.unpack_from(body, at)
        at += _LENGTH.size
        if at + length > len(body):
            raise ValueError(f"the field at byte {at} goes past the end")
        name, separator, value = body[at : at + length].decode("utf-8", "replace").partition("=")
        if not separator:
            raise ValueError(f"the field at byte {at} has no =")
        fields[name] = value
        at += length
    return fields


class Frames:
    """Cuts a stream of bytes into messages, each of which stands after its length."""

    def __init__(self) -> None:
        """Nothing was received yet."""
        self._buffer = bytearray()

    def feed(self, data: bytes) -> list[bytes]:
        """Take in what was received; return the messages that are complete now.

        Raises:
            ValueError: a length that no message has.
        """
        self._buffer += data
        found = []
        at = 0
        while at + _LENGTH.size <= len(self._buffer):
            (length,) = _LENGTH.unpack_from(self._buffer, at)
            if length > _LARGEST:
                raise ValueError(f"a message of {length:,} bytes")
            end = at + _LENGTH.size + length
            if end > len(self._buffer):
                break
            found.append(bytes(self._buffer[at + _LENGTH.size : end]))
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
        master: URI of the ROS master.
        name: of the node that this is.
        host: the address at which the graph reaches it.
        topics: what to subscribe to.

    Raises:
        RunError: the master does not answer or refuses.
    """

    def __init__(self, master: str, name: str, host: str, topics: Sequence[str]) -> None:
        """See the class; on return all topics are registered."""
        self.name = name
        self._master = master
        self._lock = threading.Lock()
        self._wanted: dict[str, set[str]] = {topic: set() for topic in topics}
        self._known: set[tuple[str, str]] = set()
        self._new: list[tuple[socket.socket, _Link]] = []
        self._closed = threading.Event()
        self._selector = selectors.DefaultSelector()
        self._wake_receive, self._wake_send = socket.socketpair()
        self._selector.register(self._wake_receive, selectors.EVENT_READ)
        self._server = _slave_server(host, self._on_publishers)
        self._uri = f"http://{host}:{self._server.server_address[1]}/"
        threading.Thread(target=self._server.serve_forever, args=(0.05,), daemon=True).start()
        try:
            for topic in topics:
                self.subscribe(topic)
        except BaseException:
            self.close()
            raise

    def subscribe(self, topic: str) -> None:
        """Subscribe to a further topic; or to one again, of which the master does not know.

        Raises:
            RunError: the master does not answer or refuses.
        """
        with self._lock:
            self._wanted.setdefault(topic, set())
        publishers = self.call_master("registerSubscriber", topic, "*", self._uri)
        self._on_publishers(topic, cast(list[str], publishers))

    def register(self) -> None:
        """Register all topics once more: the master was started again.

        Raises:
            RunError: the master does not answer or refuses.
        """
        for topic in list(self._wanted):
            self.subscribe(topic)

    def call_master(self, method: str, *arguments: object) -> object:
        """Call a method of the master API.

        Raises:
            RunError: the master does not answer or refuses.
        """
        return self.call_master_as(self.name, method, *arguments)

    def call_master_as(self, name: str, method: str, *arguments: object) -> object:
        """The same in the name of another node of this process.

        Raises:
            RunError: the master does not answer or refuses.
        """
        try:
            return call(self._master, method, name, *arguments)
        except (OSError, HTTPException, xmlrpc.client.Error) as error:
            raise RunError(f"the ROS master at {self._master}: {method}: {error}") from error

    def poll(self, timeout_s: float) -> Iterator[tuple[Source, bytes]]:
        """Wait for messages and give those that came; none after ``timeout_s`` without any."""
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
                self.call_master("unregisterSubscriber", topic, self._uri)
        self._server.shutdown()
        self._server.server_close()
        self._adopt()
        for key in list(self._selector.get_map().values()):
            cast(socket.socket, key.fileobj).close()
        self._selector.close()
        self._wake_send.close()

    def _on_publishers(self, topic: str, publishers: Sequence[str]) -> None:
        """The publishers of a topic are these now; connect to those that are new."""
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
                connection, source = _open(key[0], key[1], self.name)
            except (OSError, HTTPException, xmlrpc.client.Error, ValueError):
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


class Handler(SimpleXMLRPCRequestHandler):
    """ROS posts to any path."""

    rpc_paths = ()


class _SlaveApi:
    """What the master and other nodes ask of a node, as far as one that only listens is asked."""

    def __init__(self, on_publishers: Callable[[str, list[str]], None]) -> None:
        self._on_publishers = on_publishers

    def _dispatch(self, method: str, arguments: tuple[object, ...]) -> list[object]:
        if method == "publisherUpdate" and len(arguments) == 3:
            self._on_publishers(str(arguments[1]), cast(list[str], arguments[2]))
            return [1, "", 0]
        if method == "getPid":
            return [1, "", os.getpid()]
        if method in ("getBusStats", "getBusInfo", "getSubscriptions", "getPublications"):
            return [1, "", []]
        if method == "paramUpdate":
            return [1, "", 0]
        return [0, f"{method} is not for this node", 0]


def _slave_server(host: str, on_publishers: Callable[[str, list[str]], None]) -> SimpleXMLRPCServer:
    server = SimpleXMLRPCServer((host, 0), Handler, logRequests=False, allow_none=True)
    server.register_instance(_SlaveApi(on_publishers))
    return server


def own_host(env: Mapping[str, str], master: str) -> str:
    """The address at which the graph of ``master`` reaches this machine, as ROS finds it.

    It is what ROS_HOSTNAME or ROS_IP say, else the address from which the master is reached.
    """
    for name in ("ROS_HOSTNAME", "ROS_IP"):
        if env.get(name):
            return env[name]
    parts = urlsplit(master)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            # No packet is sent: this only asks which way one would go.
            probe.connect((parts.hostname or "localhost", parts.port or 11311))
            address: str = probe.getsockname()[0]
        except OSError:
            return "127.0.0.1"
    return address


def call(uri: str, method: str, *arguments: object) -> object:
    """Call a method of ROS's master or slave API, which answers code, message and value.

    Returns:
        The value.

    Raises:
        OSError, HTTPException, xmlrpc.client.Error: nobody answers, or with another code than 1.
    """
    proxy = xmlrpc.client.ServerProxy(uri, transport=_PatientTransport())
    try:
        answer = getattr(proxy, method)(*arguments)
    finally:
        proxy("close")()
    if not isinstance(answer, list) or len(answer) != 3 or answer[0] != 1:
        raise xmlrpc.client.Fault(0, str(answer))
    return answer[2]


class _PatientTransport(xmlrpc.client.Transport):
    """Gives up on a node that does not answer."""

    def make_connection(self, host: object) -> object:  # type: ignore[override]
        connection = super().make_connection(host)  # type: ignore[arg-type]
        connection.timeout = _PATIENCE_S
        return connection


def _open(topic: str, publisher: str, name: str) -> tuple[socket.socket, Source]:
    """Connect to a publisher of a topic and shake hands."""
    protocol = call(publisher, "requestTopic", name, topic, [["TCPROS"]])
    if not isinstance(protocol, list) or len(protocol) != 3:
        raise ValueError(f"no TCPROS: {protocol}")
    connection = socket.create_connection((str(protocol[1]), int(protocol[2])), _PATIENCE_S)
    try:
        wanted = {"callerid": name, "topic": topic, "type": "*", "md5sum": "*", "tcp_nodelay": "1"}
        connection.sendall(encode_header(wanted))
        (length,) = _LENGTH.unpack(receive(connection, _LENGTH.size))
        if length > _LARGEST:
            raise ValueError(f"a header of {length:,} bytes")
        fields = decode_header(receive(connection, length))
        if "error" in fields or not {"type", "md5sum"} <= fields.keys():
            raise ValueError(fields.get("error", "no type in the header"))
        connection.setblocking(False)
    except BaseException:
        connection.close()
        raise
    definition = fields.get("message_definition", "")
    node = fields.get("callerid", "")
    latched = fields.get("latching") == "1"
    source = Source(topic, node, fields["type"], fields["md5sum"], definition, latched)
    return connection, source


def receive(connection: socket.socket, count: int) -> bytes:
    """Exactly so many bytes.

    Raises:
        OSError: the other side closes the connection before, or is too slow.
    """
    data = b""
    while len(data) < count:
        part = connection.recv(count - len(data))
        if not part:
            raise ConnectionResetError("closed before the end")
        data += part
    return data
