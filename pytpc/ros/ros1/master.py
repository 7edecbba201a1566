"""XML-RPC in ROS 1: calls of the master and of other nodes, and the server for their calls.

Protocols: http://wiki.ros.org/ROS/Master_API, http://wiki.ros.org/ROS/Slave_API.
"""

from __future__ import annotations

import os
import reprlib
import socket
import threading
import xmlrpc.client
from collections.abc import Callable, Mapping, Sequence
from http.client import HTTPConnection, HTTPException, HTTPResponse
from typing import Any, NamedTuple
from urllib.parse import urlsplit
from xml.parsers.expat import ExpatError
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

from pytpc.base.errors import RunError
from pytpc.ros.ros1.connection import TimedSocket
from pytpc.ros.ros1.listening import PeerServer, bind_address
from pytpc.static.wiring import Connections, GraphTopic

DEFAULT_URI = "http://localhost:11311"
# A number over 32 bits is an OverflowError, a URI of another scheme a plain OSError.
CALL_ERRORS = (OSError, HTTPException, xmlrpc.client.Error, ValueError, OverflowError)
_PATIENCE_S = 5.0
_LARGEST_ANSWER = 1 << 24
# How long the end of this program waits for the master to take note of it.
_LEAVE_S = 0.5
_PAIR = 2

Names = dict[str, list[str]]


def uri_of(env: Mapping[str, str]) -> str:
    """URI of the ROS master."""
    return env.get("ROS_MASTER_URI") or DEFAULT_URI


def own_host(env: Mapping[str, str], master: str) -> str:
    """The address at which the graph of ``master`` reaches this machine, as ROS finds it.

    It is ROS_HOSTNAME or ROS_IP, else the address from which the master is reached.
    """
    for name in ("ROS_HOSTNAME", "ROS_IP"):
        if env.get(name):
            return env[name]
    parts = urlsplit(master)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            # No packet is sent: this only asks for the route.
            probe.connect((parts.hostname or "localhost", parts.port or 11311))
            address: str = probe.getsockname()[0]
        except OSError:
            return "127.0.0.1"
    return address


def call(uri: str, method: str, *arguments: object) -> object:
    """Call a method of the master or slave API, which answers code, message and value.

    Returns:
        The value.

    Raises:
        CALL_ERRORS: no answer, or a code other than 1.
    """
    proxy = xmlrpc.client.ServerProxy(uri, transport=_PatientTransport())
    try:
        answer = getattr(proxy, method)(*arguments)
    finally:
        proxy("close")()
    if not isinstance(answer, list) or len(answer) != 3 or answer[0] != 1:
        # One that is nested ten thousand times is no text.
        raise xmlrpc.client.Fault(0, reprlib.repr(answer))
    return answer[2]


def reason_of(error: Exception) -> str:
    """The message of one of ``CALL_ERRORS``, in a few words."""
    if isinstance(error, xmlrpc.client.Fault):
        return error.faultString
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return str(error) or type(error).__name__


class SystemState(NamedTuple):
    """Topic or service -> the nodes that publish, subscribe to, or offer it."""

    publishers: Names
    subscribers: Names
    services: Names

    @property
    def nodes(self) -> set[str]:
        """The names of all nodes."""
        return {node for part in self for names in part.values() for node in names}


class Master:
    """The ROS master, as one node calls it.

    Args:
        uri: of the master.
        caller: name of the node that calls.
    """

    def __init__(self, uri: str, caller: str) -> None:
        self.uri = uri
        self.caller = caller

    def call(self, method: str, *arguments: object) -> object:
        """Call a method of the master API.

        Raises:
            RunError: the master does not answer or refuses.
        """
        try:
            return call(self.uri, method, self.caller, *arguments)
        except OverflowError as error:
            raise RunError(
                f"the parameter server takes whole numbers of 32 bits: {error}"
            ) from error
        except xmlrpc.client.Fault as error:
            raise RunError(
                f"the ROS master at {self.uri} refuses {method}: {error.faultString}"
            ) from error
        except CALL_ERRORS as error:
            raise RunError(
                f"the ROS master at {self.uri} does not answer ({method}: {reason_of(error)}); is"
                " roscore running, and is ROS_MASTER_URI right?"
            ) from error

    def parameter(self, name: str) -> object:
        """The value of a parameter, None where it is not set.

        Raises:
            RunError: the master does not answer.
        """
        return self.call("getParam", name) if self.call("hasParam", name) is True else None

    def has_sim_time(self) -> bool:
        """Whether /clock is the graph's clock.

        Raises:
            RunError: the master does not answer.
        """
        return self.parameter("/use_sim_time") is True

    def leave(self, calls: Sequence[tuple[str, ...]]) -> None:
        """Make these calls, of a method with its arguments; nobody waits for a slow master."""

        def run() -> None:
            try:
                for method, *arguments in calls:
                    self.call(method, *arguments)
            except RunError:
                return

        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        thread.join(_LEAVE_S)

    def state(self) -> SystemState:
        """Who publishes, subscribes to and offers what; a part in another form is empty.

        Raises:
            RunError: the master does not answer.
        """
        answer = self.call("getSystemState")
        return SystemState(*(_names(answer, part) for part in range(3)))

    def connections(self) -> Connections:
        """All topics with their types and nodes, and all services.

        Raises:
            RunError: the master does not answer.
        """
        state = self.state()
        known = self.call("getTopicTypes")
        kinds = {
            str(pair[0]): str(pair[1])
            for pair in (known if isinstance(known, list) else ())
            if isinstance(pair, list) and len(pair) == _PAIR and pair[1] != "*"
        }
        topics = {
            name: GraphTopic(
                kinds.get(name),
                frozenset(state.publishers.get(name, ())),
                frozenset(state.subscribers.get(name, ())),
            )
            for name in {*state.publishers, *state.subscribers}
        }
        services = {name: frozenset(nodes) for name, nodes in state.services.items()}
        return Connections(topics, services)

    def node_uri(self, node: str) -> str | None:
        """Where a node's slave API is; None where the master does not know the node.

        Raises:
            RunError: the master does not answer.
        """
        return self._lookup("lookupNode", node)

    def service_uri(self, service: str) -> str | None:
        """``rosrpc://HOST:PORT`` of a service; None where nobody offers it.

        Raises:
            RunError: the master does not answer.
        """
        return self._lookup("lookupService", service)

    def _lookup(self, method: str, name: str) -> str | None:
        try:
            return str(self.call(method, name))
        except RunError as error:
            if isinstance(error.__cause__, xmlrpc.client.Fault):
                return None
            raise


class SlaveServer:
    """Answers the calls of a node's slave API; no caller can keep another one waiting.

    Args:
        host: the address at which the graph reaches this machine.
        answers: for each method that this node has, a function of the caller's name and the
            other arguments; a ValueError says why it refuses.

    Raises:
        RunError: it cannot listen.
    """

    def __init__(self, host: str, answers: Mapping[str, Callable[..., object]]) -> None:
        """See the class; on return it answers."""
        self._answers = answers
        try:
            self._server = _RpcServer(
                (bind_address(host), 0), _Handler, logRequests=False, allow_none=True
            )
        except OSError as error:
            raise RunError(f"cannot listen at {host}: {reason_of(error)}") from error
        self._server.register_instance(self)
        self.uri = f"http://{host}:{self._server.port}/"

    def close(self) -> None:
        """Answer no more calls."""
        self._server.close()

    def _dispatch(self, method: str, arguments: tuple[object, ...]) -> list[object]:
        """Code, message and value, as the slave API has them."""
        try:
            if method in self._answers:
                return [1, "", self._answers[method](*arguments)]
        except (TypeError, ValueError) as error:
            return [0, str(error), 0]
        if method == "getPid":
            return [1, "", os.getpid()]
        if method in ("getBusStats", "getBusInfo", "getSubscriptions", "getPublications"):
            return [1, "", []]
        if method in ("paramUpdate", "publisherUpdate"):
            return [1, "", 0]
        return [0, f"{method} is not for this node", 0]


class _RpcServer(PeerServer, SimpleXMLRPCServer):
    """Neither waits for a caller that is slow."""


class _Handler(SimpleXMLRPCRequestHandler):
    """ROS posts to any path."""

    rpc_paths = ()

    def log_message(self, *_: object) -> None:
        """What is wrong with a call is the caller's affair, and the terminal is in use."""


class _TimedConnection(HTTPConnection):
    def connect(self) -> None:
        super().connect()
        self.sock = TimedSocket(self.sock, _PATIENCE_S, _LARGEST_ANSWER)


class _PatientTransport(xmlrpc.client.Transport):
    """Gives up on a node that does not answer, or never stops."""

    accept_gzip_encoding = False

    def make_connection(self, host: tuple[str, dict[str, str]] | str) -> HTTPConnection:
        place, self._extra_headers, _ = self.get_host_info(host)
        connection = _TimedConnection(place, timeout=_PATIENCE_S)
        self._connection = host, connection
        return connection

    def parse_response(self, response: HTTPResponse) -> Any:  # noqa: ANN401
        parser, unmarshaller = self.getparser()
        try:
            parser.feed(response.read())
            parser.close()
            return unmarshaller.close()
        except (ExpatError, LookupError, TypeError, AttributeError, AssertionError) as error:
            raise ValueError(f"the answer is not XML-RPC: {error}") from error


def _names(answer: object, part: int) -> Names:
    try:
        return {str(name): [str(node) for node in nodes] for name, nodes in answer[part]}  # type: ignore[index]
    except (TypeError, ValueError, IndexError, KeyError):
        return {}
