"""Settings of instrumented nodes while they run: ROS parameters and the service ``~tpc/reload``.

The master says who offers such a service; the parameters are set on it, and the call makes a node
take them over. Protocols: http://wiki.ros.org/ROS/Master_API, http://wiki.ros.org/ROS/TCPROS.
"""

from __future__ import annotations

import re
import socket
import struct
import xmlrpc.client
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from http.client import HTTPException
from urllib.parse import urlsplit

from pytpc.base.errors import RunError
from pytpc.python_runtime.config import NAMES
from pytpc.ros.ros1.tcpros import call, decode_header, encode_header, receive

_RELOAD = "/tpc/reload"
_CALLER = "/tpc_sink"
_FOLDER = "tpc"
_TRIGGER = "std_srvs/Trigger"
_TRIGGER_MD5 = "937c9679a518e3a18d831e57125ea522"
_PATIENCE_S = 5.0
_LARGEST = 1 << 20
_LENGTH = struct.Struct("<I")
# A value may have spaces (a folder), but none before a word and an equals sign.
_WORD = re.compile(r"(?:^| )([a-z_]+)=(.*?)(?= [a-z_]+=|$)")

Value = str | float | int


@dataclass(frozen=True, slots=True)
class NodeStatus:
    """What a node answers: ``message`` as it came, ``values`` its words ``name=value``.

    ``success`` is false where the node did not take something over, or did not answer; then
    ``message`` says what.
    """

    node: str
    success: bool
    message: str
    values: dict[str, str] = field(default_factory=dict)


class Graph:
    """The running graph, as its master tells of it.

    Args:
        master: URI of the ROS master.
    """

    def __init__(self, master: str) -> None:
        """See the class; nothing is asked yet."""
        self._master = master

    def nodes(self) -> list[str]:
        """The names of the nodes that can be set, sorted.

        Raises:
            RunError: the master does not answer.
        """
        state = self._call("getSystemState")
        try:
            services = [str(name) for name, _ in state[2]]  # type: ignore[index]
        except (TypeError, ValueError, IndexError) as error:
            raise RunError(f"the ROS master at {self._master} gives no list of services") from error
        return sorted(name[: -len(_RELOAD)] for name in services if name.endswith(_RELOAD))

    def set(self, node: str | None, settings: Mapping[str, Value]) -> None:
        """Set parameters of one node, or (None) those that hold for all nodes.

        Raises:
            RunError: the master does not answer or refuses.
        """
        for name, value in settings.items():
            self._call("setParam", f"{node or ''}/{_FOLDER}/{name}", value)

    def clear(self, node: str | None) -> None:
        """Forget what was set for one node, or (None) for all nodes together.

        Raises:
            RunError: the master does not answer or refuses.
        """
        for name in NAMES:
            parameter = f"{node or ''}/{_FOLDER}/{name}"
            if self._call("hasParam", parameter):
                self._call("deleteParam", parameter)

    def reload(self, node: str) -> NodeStatus:
        """Have a node take over its parameters, and say what holds.

        Raises:
            RunError: the master does not answer.
        """
        try:
            uri = call(self._master, "lookupService", _CALLER, node + _RELOAD)
            success, message = _trigger(str(uri), node + _RELOAD)
        except (OSError, HTTPException, xmlrpc.client.Error, ValueError, struct.error) as error:
            return NodeStatus(node, False, f"does not answer: {_said(error)}")
        return NodeStatus(node, success, message, values_of(message))

    def _call(self, method: str, *arguments: object) -> object:
        try:
            return call(self._master, method, _CALLER, *arguments)
        except (OSError, HTTPException, xmlrpc.client.Error, ValueError) as error:
            raise RunError(
                f"the ROS master at {self._master} does not answer ({method}: {_said(error)});"
                " is roscore running, and is ROS_MASTER_URI right?"
            ) from error


def chosen(running: Sequence[str], named: Iterable[str]) -> list[str]:
    """The nodes that are meant: those that are named, all where none is.

    Raises:
        RunError: one of them is not running, or none is.
    """
    wanted = ["/" + name.strip("/") for name in named]
    if not running:
        raise RunError(
            "no instrumented node is running, or none has reported yet: see docs/running.md"
        )
    for name in wanted:
        if name not in running:
            raise RunError(f"{name} is no instrumented node that runs; there are {_list(running)}")
    return list(dict.fromkeys(wanted)) or list(running)


def values_of(message: str) -> dict[str, str]:
    """The words ``name=value`` of a status line; what stands before them is left out.

    >>> values_of("no such folder; sink=file file=/a b.tpc dropped=0")
    {'sink': 'file', 'file': '/a b.tpc', 'dropped': '0'}
    """
    return dict(_WORD.findall(message))


def _trigger(uri: str, service: str) -> tuple[bool, str]:
    """Call a service of type std_srvs/Trigger at ``rosrpc://HOST:PORT``.

    Raises:
        OSError: nobody is there, or does not answer in time.
        ValueError: what is there does not speak the protocol, or refuses.
    """
    place = urlsplit(uri)
    if place.hostname is None or place.port is None:
        raise ValueError(f"{uri} is no address of a service")
    with socket.create_connection((place.hostname, place.port), _PATIENCE_S) as connection:
        connection.sendall(
            encode_header(
                {"callerid": _CALLER, "service": service, "md5sum": _TRIGGER_MD5, "type": _TRIGGER}
            )
        )
        fields = decode_header(_sized(connection))
        if "error" in fields:
            raise ValueError(fields["error"])
        connection.sendall(_LENGTH.pack(0))
        worked = receive(connection, 1) != b"\0"
        body = _sized(connection)
    if not worked:
        raise ValueError(body.decode("utf-8", "replace"))
    (length,) = _LENGTH.unpack_from(body, 1)
    return body[0] != 0, body[1 + _LENGTH.size :][:length].decode("utf-8", "replace")


def _sized(connection: socket.socket) -> bytes:
    (length,) = _LENGTH.unpack(receive(connection, _LENGTH.size))
    if length > _LARGEST:
        raise ValueError(f"an answer of {length:,} bytes")
    return receive(connection, length)


def _said(error: Exception) -> str:
    if isinstance(error, xmlrpc.client.Fault):
        return error.faultString
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return str(error) or type(error).__name__


def _list(names: Sequence[str]) -> str:
    shown = ", ".join(names[:5])
    return shown if len(names) <= 5 else f"{shown} and {len(names) - 5} more"
