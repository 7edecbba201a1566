"""A publisher of ROS 1 topics that needs no ROS: master and slave API, and TCPROS.

An observer's laptop need not have ROS. Unlike rospy's publisher it registers again at a master
that was restarted, and it says how many listen.

The protocols: http://wiki.ros.org/ROS/Master_API, http://wiki.ros.org/ROS/TCPROS.
"""

from __future__ import annotations

import contextlib
import os
import socket
import struct
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from socketserver import BaseRequestHandler
from typing import cast

from pytpc.base.errors import RunError
from pytpc.ros.ros1.connection import TimedSocket, encode_header, receive_header, sized
from pytpc.ros.ros1.listening import PeerServer, Request, bind_address
from pytpc.ros.ros1.master import Master, SlaveServer, own_host, reason_of

_MOST_LISTENERS = 200
_PART = 4096


@dataclass(frozen=True, slots=True)
class MessageType:
    """The type of a topic's messages, as a subscriber asks for it."""

    name: str
    md5sum: str
    definition: str


TIME = MessageType("std_msgs/Time", "cd7166c74c552c311fbcc2fe5a7bc289", "time data\n")
STRING = MessageType("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n")


def encode_time(time_ns: int) -> bytes:
    """A std_msgs/Time; times that it cannot hold are its nearest."""
    seconds, nanoseconds = divmod(max(0, time_ns), 10**9)
    return struct.pack("<II", min(seconds, 2**32 - 1), nanoseconds)


def encode_string(text: str) -> bytes:
    """A std_msgs/String."""
    return sized(text.encode("utf-8", "backslashreplace"))


class RawPublisher:
    """Publishes messages that are bytes already. Registers only when told to (``register``).

    It is for a few small messages: a subscriber that leaves more unread than its connection holds
    loses the connection, so that it keeps no other one waiting. If it lives it connects again.

    Args:
        master: the ROS master; its caller is the node that this is.
        topics: with the type of their messages.

    Raises:
        RunError: it cannot listen.
    """

    def __init__(self, master: Master, topics: Mapping[str, MessageType]) -> None:
        """See the class; on return subscribers are served, though none knows of it yet."""
        self._master = master
        self._topics = dict(topics)
        self._lock = threading.Lock()
        self._links: dict[str, list[tuple[str, socket.socket]]] = {topic: [] for topic in topics}
        self._host = own_host(os.environ, master.uri)
        answers: dict[str, Callable[..., object]] = {
            "requestTopic": self._request,
            "getPublications": self._publications,
        }
        self._server = SlaveServer(self._host, answers)
        try:
            self._listener = _Acceptor(self._host, self._welcome)
        except OSError as error:
            self._server.close()
            raise RunError(f"cannot listen at {self._host}: {reason_of(error)}") from error

    def register(self) -> None:
        """Tell the master of all topics; it does no harm to tell it again.

        Raises:
            RunError: the master does not answer or refuses.
        """
        for topic, kind in self._topics.items():
            self._master.call("registerPublisher", topic, kind.name, self._server.uri)

    @property
    def topics(self) -> tuple[str, ...]:
        """What is published."""
        return tuple(self._topics)

    def is_registered(self) -> bool:
        """Whether the master still knows this node.

        Raises:
            RunError: the master does not answer.
        """
        return self._master.node_uri(self._master.caller) == self._server.uri

    def publish(self, topic: str, message: bytes) -> int:
        """Send to all who listen now, and return their number; one who is too slow is dropped."""
        sent = 0
        data = sized(message)
        with self._lock:
            for link in list(self._links[topic]):
                if _is_closed(link[1]) or not _takes(link[1], data):
                    self._drop(topic, link)
                else:
                    sent += 1
        return sent

    def listeners(self, only: str | None = None) -> set[str]:
        """The names of the nodes that listen to a topic, or to any."""
        with self._lock:
            for topic, links in self._links.items():
                for link in list(links):
                    if _is_closed(link[1]):
                        self._drop(topic, link)
            return {
                node
                for topic, links in self._links.items()
                for node, _ in links
                if only in (None, topic)
            }

    def close(self) -> None:
        """Leave the graph. A master that is gone already is no error."""
        self._master.leave(
            [("unregisterPublisher", topic, self._server.uri) for topic in self._topics]
        )
        self._server.close()
        self._listener.close()
        with self._lock:
            for topic, links in self._links.items():
                for link in list(links):
                    self._drop(topic, link)

    def _request(self, _caller: str, topic: str, _protocols: object) -> list[object]:
        if topic not in self._topics:
            raise ValueError(f"{topic} is not published here")
        return ["TCPROS", self._host, self._listener.port]

    def _publications(self, _caller: str) -> list[list[str]]:
        return [[topic, kind.name] for topic, kind in self._topics.items()]

    def _welcome(self, connection: TimedSocket) -> None:
        """Shake hands with a subscriber; the connection of anything else ends."""
        fields = receive_header(connection)
        topic = fields.get("topic", "")
        kind = self._topics.get(topic)
        if kind is None or fields.get("md5sum") not in ("*", kind.md5sum):
            connection.sendall(encode_header({"error": f"{topic} is not of that type here"}))
            return
        self.listeners()  # Forgets those that have left.
        if sum(map(len, self._links.values())) >= _MOST_LISTENERS:
            connection.sendall(encode_header({"error": "too many subscribers"}))
            return
        answer = {"callerid": self._master.caller, "topic": topic, "type": kind.name}
        answer |= {"md5sum": kind.md5sum, "message_definition": kind.definition}
        connection.sendall(encode_header(answer | {"latching": "0"}))
        with self._lock:
            self._links[topic].append((fields.get("callerid", ""), connection.released()))

    def _drop(self, topic: str, link: tuple[str, socket.socket]) -> None:
        self._links[topic].remove(link)
        with contextlib.suppress(OSError):
            link[1].close()


class _Acceptor(PeerServer):
    """Shakes hands with each subscriber; ``welcome`` takes the connection over, or leaves it."""

    def __init__(self, host: str, welcome: Callable[[TimedSocket], None]) -> None:
        self._welcome = welcome
        super().__init__((bind_address(host), 0), BaseRequestHandler)

    def finish_request(self, request: Request, client_address: object) -> None:
        self._welcome(cast(TimedSocket, request))

    def shutdown_request(self, request: Request) -> None:
        # Without the shutdown, which would end a connection that was taken over.
        self.close_request(request)


def _takes(connection: socket.socket, data: bytes) -> bool:
    """Whether there is room for the message. What has gone in part can only be broken off."""
    try:
        return connection.send(data) == len(data)
    except OSError:
        return False


def _is_closed(connection: socket.socket) -> bool:
    """Whether the other side has left; a subscriber sends nothing after its header."""
    try:
        return not connection.recv(_PART)
    except BlockingIOError:
        return False
    except OSError:
        return True
