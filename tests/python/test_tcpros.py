"""The raw subscriber against a master and publishers of its own kind, without ROS."""

from __future__ import annotations

import contextlib
import socket
import struct
import threading
import time
import xmlrpc.client
from collections.abc import Iterator
from itertools import pairwise
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytpc.base.errors import RunError
from pytpc.ros.ros1.connection import decode_header, encode_header
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.subscriber import Frames, RawSubscriber

HOST = "127.0.0.1"


class Handler(SimpleXMLRPCRequestHandler):
    rpc_paths = ()


class Server:
    """An XML-RPC server in a thread."""

    def __init__(self, functions: object) -> None:
        self.server = SimpleXMLRPCServer((HOST, 0), Handler, logRequests=False)
        self.server.register_instance(functions)
        self.uri = f"http://{HOST}:{self.server.server_address[1]}/"
        self.thread = threading.Thread(target=self.server.serve_forever, args=(0.01,))
        self.thread.start()

    def close(self) -> None:
        self.server.shutdown()
        self.thread.join()
        self.server.server_close()


class MasterServer:
    """A master. While ``answers`` is not set it takes calls and answers none."""

    def __init__(self) -> None:
        self.publishers: dict[str, list[str]] = {}
        self.subscribers: dict[str, str] = {}
        self.state: list = [[], [], []]
        self.types: list | None = None
        self.nodes: dict[str, str] = {}
        self.params: dict[str, object] = {}
        self.answers = threading.Event()
        self.answers.set()
        self.rpc = Server(self)

    def _dispatch(self, method: str, arguments: tuple) -> list:
        self.answers.wait()
        asked = {
            "getSystemState": lambda: self.state,
            "lookupNode": lambda: self.nodes[arguments[1]],
            "hasParam": lambda: arguments[1] in self.params,
        }
        if self.types is not None:
            asked["getTopicTypes"] = lambda: self.types
        if method in asked:
            return [1, "", asked[method]()]
        if method == "registerSubscriber":
            _, topic, _, uri = arguments
            self.subscribers[topic] = uri
            return [1, "", self.publishers.get(topic, [])]
        if method == "unregisterSubscriber":
            del self.subscribers[arguments[1]]
            return [1, "", 1]
        return [-1, f"no {method}", 0]

    def tell(self, topic: str, publishers: list[str], times: int = 1) -> None:
        """Send the update, several times at once, as when many nodes start together."""
        self.publishers[topic] = publishers

        def call() -> None:
            proxy = xmlrpc.client.ServerProxy(self.subscribers[topic])
            assert proxy.publisherUpdate("/master", topic, publishers)[0] == 1
            proxy("close")()

        threads = [threading.Thread(target=call) for _ in range(times)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()


class Publisher:
    """Accepts connections, shakes hands and counts them; ``send`` writes to all."""

    def __init__(self, answer: dict[str, str] | None = None) -> None:
        self.answer = answer or {
            "type": "std_msgs/String",
            "md5sum": "992ce8a1687cec8c8bd883ec73ca41d1",
            "message_definition": "string data\n",
            "callerid": "/talker",
        }
        self.listener = socket.create_server((HOST, 0))
        self.accepted = 0
        self.wanted: list[dict[str, str]] = []
        self.connections: list[socket.socket] = []
        self.rpc = Server(self)
        self.thread = threading.Thread(target=self._accept)
        self.thread.start()

    def _dispatch(self, method: str, arguments: tuple) -> list:
        assert method == "requestTopic"
        return [1, "", ["TCPROS", HOST, self.listener.getsockname()[1]]]

    def _accept(self) -> None:
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            self.accepted += 1
            (length,) = struct.unpack("<I", connection.recv(4, socket.MSG_WAITALL))
            body = connection.recv(length, socket.MSG_WAITALL)
            self.wanted.append(decode_header(body))
            connection.sendall(encode_header(self.answer))
            self.connections.append(connection)

    def send(self, *messages: bytes) -> None:
        data = b"".join(struct.pack("<I", len(m)) + m for m in messages)
        for connection in self.connections:
            connection.sendall(data)

    def hang_up(self) -> None:
        for connection in self.connections:
            connection.close()
        self.connections = []

    def close(self) -> None:
        self.hang_up()
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()
        self.thread.join()
        self.rpc.close()


@pytest.fixture
def master() -> Iterator[MasterServer]:
    made = MasterServer()
    yield made
    made.rpc.close()


@pytest.fixture
def publisher() -> Iterator[Publisher]:
    made = Publisher()
    yield made
    made.close()


def collect(subscriber: RawSubscriber, count: int, seconds: float = 5.0) -> list:
    found: list = []
    until = time.monotonic() + seconds
    while len(found) < count and time.monotonic() < until:
        found += subscriber.poll(0.05)
    return found


def wait_for(condition, seconds: float = 5.0) -> None:
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.01)


def test_header_is_written_as_tcpros_says():
    # 9 bytes "topic=/ab" after their length, 8 bytes "type=a/B" after theirs: 4+9+4+8 = 25.
    expected = b"\x19\0\0\0" + b"\x09\0\0\0topic=/ab" + b"\x08\0\0\0type=a/B"
    assert encode_header({"topic": "/ab", "type": "a/B"}) == expected
    assert decode_header(expected[4:]) == {"topic": "/ab", "type": "a/B"}


def test_header_keeps_an_equals_sign_in_the_value():
    # A message definition has constants: "uint8 A=1".
    body = b"\x1c\0\0\0message_definition=uint8 A=1"
    assert decode_header(body) == {"message_definition": "uint8 A=1"}


@pytest.mark.parametrize(
    ("body", "what"),
    [
        (b"\x01\0", "cut off at byte 0"),
        (b"\x05\0\0\0a=b", "byte 4 goes past the end"),
        (b"\x02\0\0\0ab", "byte 4 has no ="),
    ],
)
def test_broken_headers_say_where(body, what):
    with pytest.raises(ValueError, match=what):
        decode_header(body)


@given(st.lists(st.binary(max_size=40), max_size=20), st.lists(st.integers(0, 900), max_size=12))
def test_frames_come_out_whole_however_the_stream_is_cut(messages, cuts):
    stream = b"".join(struct.pack("<I", len(m)) + m for m in messages)
    places = sorted({min(cut, len(stream)) for cut in cuts} | {0, len(stream)})
    frames = Frames()
    found = []
    for begin, end in pairwise(places):
        found += frames.feed(stream[begin:end])
    assert found == messages


# What is complete before it is a message all the same.
def test_a_length_that_no_message_has_is_the_end():
    frames = Frames()
    assert frames.feed(b"\x02\0\0\0ab\xff\xff\xff\xff") == [b"ab"]
    assert frames.is_lost


def test_messages_of_a_publisher_that_was_there_before(master, publisher):
    master.publishers["/chat"] = [publisher.rpc.uri]
    subscriber = RawSubscriber(Master(master.rpc.uri, "/me"), HOST, ["/chat"])
    wait_for(lambda: publisher.connections)
    publisher.send(b"one", b"", b"three")
    found = collect(subscriber, 3)
    subscriber.close()
    assert [data for _, data in found] == [b"one", b"", b"three"]
    source = found[0][0]
    assert (source.topic, source.node, source.type) == ("/chat", "/talker", "std_msgs/String")
    assert source.definition == "string data\n"
    assert publisher.wanted[0]["md5sum"] == "*"
    assert master.subscribers == {}


def test_many_updates_at_once_make_one_connection(master, publisher):
    # What loses messages in rospy: the update comes again before the first connection stands.
    subscriber = RawSubscriber(Master(master.rpc.uri, "/me"), HOST, ["/chat"])
    master.tell("/chat", [publisher.rpc.uri], times=12)
    wait_for(lambda: publisher.connections)
    for number in range(500):
        publisher.send(b"%d" % number)
    found = collect(subscriber, 500)
    subscriber.close()
    assert [data for _, data in found] == [b"%d" % n for n in range(500)]
    assert publisher.accepted == 1


def test_connects_again_while_the_publisher_is_listed(master, publisher):
    subscriber = RawSubscriber(Master(master.rpc.uri, "/me"), HOST, ["/chat"])
    master.tell("/chat", [publisher.rpc.uri])
    wait_for(lambda: publisher.connections)
    publisher.send(b"before")
    assert len(collect(subscriber, 1)) == 1
    publisher.hang_up()
    collect(subscriber, 1, seconds=0.3)
    wait_for(lambda: publisher.connections)
    publisher.send(b"after")
    assert [data for _, data in collect(subscriber, 1)] == [b"after"]
    # Not listed any more: it is left alone.
    master.tell("/chat", [])
    publisher.hang_up()
    collect(subscriber, 1, seconds=0.8)
    subscriber.close()
    assert publisher.accepted == 2


# No bag can hold a message without a type or its sum.
@pytest.mark.parametrize(
    "answer",
    [{"error": "md5sums do not match"}, {"type": "a/B"}, {"type": "a/B", "md5sum": ""}],
)
def test_a_publisher_that_refuses_makes_no_messages(master, answer):
    refusing = Publisher(answer)
    subscriber = RawSubscriber(Master(master.rpc.uri, "/me"), HOST, ["/chat"])
    master.tell("/chat", [refusing.rpc.uri])
    wait_for(lambda: refusing.connections)
    with contextlib.suppress(OSError):
        refusing.send(b"one")
    assert collect(subscriber, 1, seconds=0.3) == []
    subscriber.close()
    refusing.close()


def test_no_master_is_one_line():
    with socket.create_server((HOST, 0)) as taken:
        port = taken.getsockname()[1]
    with pytest.raises(RunError, match=rf"the ROS master at http://{HOST}:{port}/ .*\(registerSub"):
        RawSubscriber(Master(f"http://{HOST}:{port}/", "/me"), HOST, ["/chat"])


def test_a_master_that_refuses_is_one_line(master):
    subscriber = RawSubscriber(Master(master.rpc.uri, "/me"), HOST, [])
    with pytest.raises(RunError, match="no getParam"):
        subscriber.master.call("getParam", "/x")
    subscriber.close()
