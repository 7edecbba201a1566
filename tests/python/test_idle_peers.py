"""Peers that connect and say nothing, or half, or nonsense: none of them holds up the others."""

from __future__ import annotations

import contextlib
import os
import select
import socket
import struct
import threading
import time
import xmlrpc.client
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from test_tcpros import HOST, MasterServer, Publisher, collect, wait_for

from pytpc.base.errors import RunError
from pytpc.ros.ros1 import connection, listening
from pytpc.ros.ros1.connection import TimedSocket, encode_header, receive, receive_header, sized
from pytpc.ros.ros1.listening import MOST_PEERS, bind_address
from pytpc.ros.ros1.marking import GraphMarks
from pytpc.ros.ros1.master import CALL_ERRORS, Master, SlaveServer, call
from pytpc.ros.ros1.publisher import STRING, RawPublisher, encode_string
from pytpc.ros.ros1.recorder import GraphRecorder, Wanted
from pytpc.ros.ros1.subscriber import RawSubscriber, UnregisteredSubscriber

# What a peer may say and then fall silent: nothing, half of a request, all but the body of one.
SILENT = [
    b"",
    b"POST / HTTP/1.1\r\nHo",
    b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 1000\r\n\r\n<?xml",
]
# Longer than any machine takes, and far shorter than for ever.
LIMIT_S = 60.0


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


@contextlib.contextmanager
def idle(uri: str, says: bytes = b"", times: int = 1) -> Iterator[list[socket.socket]]:
    """Connections that stay open and say no more."""
    place = urlsplit(uri)
    with contextlib.ExitStack() as stack:
        made = []
        for _ in range(times):
            one = stack.enter_context(socket.create_connection((place.hostname, place.port)))
            one.sendall(says)
            made.append(one)
        yield made


def ends(close: Callable[[], None]) -> None:
    """Run it in a thread that must end."""
    thread = threading.Thread(target=close, daemon=True)
    thread.start()
    thread.join(LIMIT_S)
    assert not thread.is_alive(), "it waits for its peer"


@pytest.mark.parametrize("says", SILENT)
def test_a_silent_peer_does_not_make_a_subscriber_deaf(master, publisher, says):
    subscriber = RawSubscriber(Master(master.rpc.uri, "/me"), HOST, ["/chat"])
    with idle(master.subscribers["/chat"], says, times=3):
        master.tell("/chat", [publisher.rpc.uri])
        wait_for(lambda: publisher.connections, LIMIT_S)
        publisher.send(b"heard")
        assert [data for _, data in collect(subscriber, 1, LIMIT_S)] == [b"heard"]
        ends(subscriber.close)


def test_more_silent_peers_than_are_served_at_a_time(master, publisher):
    subscriber = RawSubscriber(Master(master.rpc.uri, "/me"), HOST, ["/chat"])
    with idle(master.subscribers["/chat"], times=MOST_PEERS + 20) as peers:
        master.tell("/chat", [publisher.rpc.uri])
        wait_for(lambda: publisher.connections, LIMIT_S)
        # The oldest were sent away.
        assert select.select(peers[:20], [], [], LIMIT_S)[0]
        ends(subscriber.close)


def test_a_peer_that_says_a_byte_at_a_time_is_sent_away(monkeypatch, capfd):
    monkeypatch.setattr(listening, "_PATIENCE_S", 0.5)
    server = SlaveServer(HOST, {})
    with idle(server.uri) as (peer,):
        until = time.monotonic() + LIMIT_S
        with pytest.raises(OSError):  # noqa: PT011 (a reset, or a broken pipe)
            while time.monotonic() < until:
                peer.sendall(b"x")
                time.sleep(0.05)
    server.close()
    # The terminal belongs to the marks.
    assert capfd.readouterr() == ("", "")


def test_a_request_without_end_is_not_kept(monkeypatch, capfd):
    monkeypatch.setattr(listening, "_LARGEST_REQUEST", 100_000)
    server = SlaveServer(HOST, {})
    says = b"POST / HTTP/1.1\r\nContent-Length: 4000000000\r\n\r\n"
    with idle(server.uri, says) as (peer,), pytest.raises(OSError):  # noqa: PT011
        while True:
            peer.sendall(bytes(65536))
    assert call(server.uri, "getPid", "/x") == os.getpid()
    server.close()
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("publishers", ["http://x", 7, [["nested"], 3, True], {"a": 1}])
def test_an_update_of_nonsense_is_answered(master, publisher, publishers):
    subscriber = RawSubscriber(Master(master.rpc.uri, "/me"), HOST, ["/chat"])
    proxy = xmlrpc.client.ServerProxy(master.subscribers["/chat"])
    assert proxy.publisherUpdate("/master", "/chat", publishers)[0] in (0, 1)
    proxy("close")()
    master.tell("/chat", [publisher.rpc.uri])
    wait_for(lambda: publisher.connections, LIMIT_S)
    subscriber.close()


def subscribed(marks: RawPublisher, topic: str, name: str = "/reader") -> socket.socket:
    """A subscriber's connection after its handshake."""
    _, host, port = call(marks._server.uri, "requestTopic", name, topic, [["TCPROS"]])
    made = socket.create_connection((host, port))
    made.sendall(encode_header({"callerid": name, "topic": topic, "md5sum": "*", "type": "*"}))
    assert receive_header(made)["topic"] == topic
    return made


@pytest.mark.parametrize("says", [b"", b"\x40", b"\x40\0\0\0\x10\0\0\0topic"])
def test_a_silent_peer_does_not_make_a_publisher_mute(master, says):
    marks = RawPublisher(Master(master.rpc.uri, "/me"), {"/mark": STRING})
    at = f"http://{HOST}:{marks._listener.port}"
    with idle(marks._server.uri, SILENT[1], times=2), idle(at, says, times=MOST_PEERS + 2):
        with subscribed(marks, "/mark") as reader:
            wait_for(lambda: marks.listeners() == {"/reader"}, LIMIT_S)
            assert marks.publish("/mark", encode_string("one")) == 1
            reader.settimeout(LIMIT_S)
            assert receive(reader, 11) == sized(encode_string("one"))
        ends(marks.close)


# A subscriber that never reads: what is sent to it stays in its connection until that is full.
def test_a_subscriber_that_does_not_read_loses_its_connection_alone(master):
    marks = RawPublisher(Master(master.rpc.uri, "/me"), {"/mark": STRING})
    message = encode_string("x" * 50_000)
    with subscribed(marks, "/mark", "/asleep"), subscribed(marks, "/mark") as reader:
        reader.settimeout(LIMIT_S)
        wait_for(lambda: len(marks.listeners()) == 2, LIMIT_S)
        for _ in range(1000):
            assert marks.publish("/mark", message) >= 1
            assert receive(reader, len(message) + 4) == sized(message)
            if marks.listeners() == {"/reader"}:
                break
        assert marks.listeners() == {"/reader"}
    marks.close()


def test_a_mark_is_not_sent_to_one_who_has_left(master):
    marks = RawPublisher(Master(master.rpc.uri, "/me"), {"/mark": STRING})
    with subscribed(marks, "/mark"):
        wait_for(lambda: marks.listeners() == {"/reader"}, LIMIT_S)
    # Closing is in the kernel's hands, and on one machine done at once.
    assert marks.publish("/mark", encode_string("one")) == 0
    marks.close()


def test_a_length_of_4_gigabytes_is_a_fault_and_not_the_end(master, publisher):
    subscriber = RawSubscriber(Master(master.rpc.uri, "/me"), HOST, ["/chat"])
    master.tell("/chat", [publisher.rpc.uri])
    wait_for(lambda: publisher.connections, LIMIT_S)
    with publisher.connections.pop() as mad:
        mad.sendall(sized(b"good") + b"\xff\xff\xff\xff" + bytes(100))
    assert [data for _, data in collect(subscriber, 1, LIMIT_S)] == [b"good"]
    wait_for(lambda: publisher.connections, LIMIT_S)
    publisher.send(b"again")
    assert [data for _, data in collect(subscriber, 1, LIMIT_S)] == [b"again"]
    assert subscriber.broken == {"/talker": 1}
    subscriber.close()


def test_a_node_that_dies_within_a_message_is_counted(master, publisher):
    subscriber = RawSubscriber(Master(master.rpc.uri, "/me"), HOST, ["/chat"])
    master.tell("/chat", [publisher.rpc.uri])
    wait_for(lambda: publisher.connections, LIMIT_S)
    master.tell("/chat", [])
    with publisher.connections.pop() as dying:
        dying.sendall(sized(b"whole") + sized(b"half of it")[:9])
    assert [data for _, data in collect(subscriber, 1, LIMIT_S)] == [b"whole"]
    wait_for(lambda: list(subscriber.poll(0.05)) or subscriber.broken == {"/talker": 1}, LIMIT_S)
    # One that ends between messages is no fault.
    master.tell("/chat", [publisher.rpc.uri])
    wait_for(lambda: publisher.connections, LIMIT_S)
    wait_for(lambda: list(subscriber.poll(0.05)) or subscriber.connections(), LIMIT_S)
    master.tell("/chat", [])
    publisher.hang_up()
    wait_for(lambda: list(subscriber.poll(0.05)) or not subscriber.connections(), LIMIT_S)
    assert subscriber.broken == {"/talker": 1}
    subscriber.close()


# The hosts that do not answer listen and never accept: a call to each takes all of its patience.
def test_a_publisher_does_not_wait_behind_dead_hosts(master, publisher):
    with contextlib.ExitStack() as stack:
        dead = []
        for _ in range(20):
            one = stack.enter_context(socket.create_server((HOST, 0)))
            dead.append(f"http://{HOST}:{one.getsockname()[1]}/")
        subscriber = RawSubscriber(Master(master.rpc.uri, "/me"), HOST, ["/chat"])
        master.tell("/chat", [*dead, publisher.rpc.uri])
        wait_for(lambda: publisher.connections, LIMIT_S)
        ends(subscriber.close)


def test_a_subscriber_without_a_registration(master, publisher):
    master.state = [[["/chat", ["/talker"]]], [], []]
    master.nodes = {"/talker": publisher.rpc.uri}
    subscriber = UnregisteredSubscriber(Master(master.rpc.uri, "/me"), ["/chat"])
    subscriber.look()
    wait_for(lambda: publisher.connections, LIMIT_S)
    publisher.send(b"one")
    assert [data for _, data in collect(subscriber, 1, LIMIT_S)] == [b"one"]
    subscriber.look()
    assert master.subscribers == {}
    assert publisher.accepted == 1
    # The node is started again, and has another address under the same name.
    again = Publisher()
    master.nodes = {"/talker": again.rpc.uri}
    publisher.hang_up()
    until = time.monotonic() + LIMIT_S
    while not again.connections:
        assert time.monotonic() < until
        list(subscriber.poll(0.05))
        subscriber.look()
    ends(subscriber.close)
    again.close()


class GuardedTries(Counter):
    """Another thread goes through them to find nodes that moved."""

    lock: threading.Lock

    def pop(self, *key):
        assert self.lock.locked()
        return super().pop(*key)


def test_what_failed_is_forgotten_under_the_lock(master, publisher):
    subscriber = UnregisteredSubscriber(Master(master.rpc.uri, "/me"), ["/chat"])
    subscriber._tries = GuardedTries({("/chat", publisher.rpc.uri): 1})
    subscriber._tries.lock = subscriber._lock
    master.state = [[["/chat", ["/talker"]]], [], []]
    master.nodes = {"/talker": publisher.rpc.uri}
    subscriber.look()
    wait_for(lambda: publisher.connections, LIMIT_S)
    publisher.send(b"one")
    assert len(collect(subscriber, 1, LIMIT_S)) == 1
    assert not subscriber._tries
    ends(subscriber.close)


@pytest.fixture
def deaf() -> Iterator[str]:
    """A master that takes connections and never answers."""
    with socket.create_server((HOST, 0)) as listener:
        yield f"http://{HOST}:{listener.getsockname()[1]}/"


def test_an_observer_chooses_from_what_the_master_knows(master):
    master.state = [[["/out", ["/a"]]], [["/out", ["/b"]]], [["/go", ["/a"]]]]
    master.types = [["/out", "std_msgs/Bool"]]
    marks = GraphMarks(master.rpc.uri, "ana", advertise=False)
    try:
        wait_for(lambda: marks.view().places, LIMIT_S)
        assert [str(place) for place in marks.view().places] == [
            "/out (std_msgs/Bool)",
            "/go (service)",
            "/a (node)",
            "/b (node)",
        ]
    finally:
        marks.close()


def test_an_observer_can_mark_where_the_master_tells_no_places(master):
    marks = GraphMarks(master.rpc.uri, "ana", advertise=False)
    try:
        wait_for(lambda: marks.view().status[0].startswith("connected;"), LIMIT_S)
        assert marks.view().places == ()
        assert marks._thread.is_alive()
    finally:
        marks.close()


def test_nothing_waits_for_a_deaf_master_at_the_end(deaf):
    marks = GraphMarks(deaf, "ana")
    ends(marks.close)
    reader = UnregisteredSubscriber(Master(deaf, "/me"), ["/chat"])
    ends(reader.close)


def test_a_master_that_falls_silent_ends_no_recording(master, publisher, tmp_path: Path):
    master.publishers["/chat"] = [publisher.rpc.uri]
    recorder = GraphRecorder(
        Master(master.rpc.uri, "/me"), HOST, Wanted(["/chat"]), tmp_path / "a.bag", strict=False
    )
    wait_for(lambda: publisher.connections, LIMIT_S)
    master.answers.clear()
    publisher.send(b"one")
    wait_for(lambda: recorder.step().messages == {"/chat": 1}, LIMIT_S)
    ends(recorder.finish)
    master.answers.set()
    assert (tmp_path / "a.bag").is_file()


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"nonsense\r\n\r\n",
        b"HTTP/1.0 200 OK\r\n\r\n",
        b"HTTP/1.0 200 OK\r\n\r\nno XML",
        b"HTTP/1.0 200 OK\r\n\r\n<methodResponse><params><param><value></int></value>",
        b"HTTP/1.0 200 OK\r\n\r\n<methodResponse><params/></methodResponse>",
        b"HTTP/1.0 200 OK\r\n\r\n<methodResponse><params><param><value><array><data>"
        + b"<value><array><data>" * 20_000
        + b"</data></array></value>" * 20_000
        + b"</data></array></value></param></params></methodResponse>",
        b"HTTP/1.0 500 No\r\nContent-Length: 4000000000\r\n\r\nx",
    ],
)
def test_an_answer_of_nonsense_is_an_error_of_the_call(answer):
    with socket.create_server((HOST, 0)) as listener:

        def serve() -> None:
            with contextlib.suppress(OSError):
                while True:
                    peer, _ = listener.accept()
                    with peer:
                        peer.recv(65536)
                        peer.sendall(answer)

        threading.Thread(target=serve, daemon=True).start()
        uri = f"http://{HOST}:{listener.getsockname()[1]}/"
        with pytest.raises(CALL_ERRORS):
            call(uri, "getPid", "/x")
        with pytest.raises(RunError):
            Master(uri, "/x").call("getPid")


def test_a_connection_ends_after_its_time_and_after_its_bytes():
    left, right = socket.socketpair()
    timed = TimedSocket(left, 0.2, 10**6)
    with right, timed, pytest.raises(TimeoutError):
        for _ in range(10**6):
            right.sendall(b"x")
            timed.recv(1)
            time.sleep(0.01)
    left, right = socket.socketpair()
    timed = TimedSocket(left, LIMIT_S, 100)
    with right, timed, pytest.raises(ConnectionAbortedError):
        for _ in range(200):
            right.sendall(b"x")
            timed.recv(1)


def test_a_header_is_at_most_a_megabyte():
    left, right = socket.socketpair()
    with left, right:
        right.sendall(struct.pack("<I", connection._LARGEST_HEADER + 1))
        with pytest.raises(ValueError, match="1,048,577 bytes"):
            receive_header(left)


# 192.0.2.1 is an address of documentation, which no machine has.
@pytest.mark.parametrize(
    ("host", "bound"),
    [
        ("127.0.0.1", "127.0.0.1"),
        ("127.0.1.1", "127.0.1.1"),
        ("localhost", "127.0.0.1"),
        ("::1", "127.0.0.1"),
        ("192.0.2.1", ""),
        ("robot.local", ""),
    ],
)
def test_what_is_announced_is_listened_at(host, bound):
    assert bind_address(host) == bound


def test_what_is_on_loopback_listens_there_alone():
    server = SlaveServer("127.0.0.1", {})
    assert server._server.socket.getsockname()[0] == "127.0.0.1"
    server.close()
    marks = RawPublisher(Master("http://127.0.0.1:9", "/me"), {"/mark": STRING})
    assert marks._listener.socket.getsockname()[0] == "127.0.0.1"
    marks.close()
