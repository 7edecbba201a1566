"""Setting a value on the running robot: the parameter server, and dynamic_reconfigure.

A node of ROS 1 reads a parameter when it asks for it, mostly once, when it starts. One with
dynamic_reconfigure takes a new value over at once, by its service ``set_parameters``; what it then
has (its own limits hold) is in the answer. Neither ROS nor the node's package is needed here.

Protocols: http://wiki.ros.org/ROS/Parameter%20Server%20API, http://wiki.ros.org/ROS/TCPROS;
messages: dynamic_reconfigure/Config.
"""

from __future__ import annotations

import socket
import struct
import xmlrpc.client
from collections.abc import Mapping
from dataclasses import dataclass
from http.client import HTTPException
from typing import Any
from urllib.parse import urlsplit

from pytpc.base.errors import InputError, RunError
from pytpc.ros.ros1.tcpros import call, decode_header, encode_header, receive
from pytpc.values.new_value import Refused, guessed, read_value
from pytpc.values.scalars import type_of

_CALLER = "/tpc_apply"
_SERVICE = "set_parameters"
_TYPE = "dynamic_reconfigure/Reconfigure"
_MD5 = "bb125d226a21982a4a98760418dc2672"
_PATIENCE_S = 5.0
_LARGEST = 1 << 22
_LENGTH = struct.Struct("<I")
# The parts of dynamic_reconfigure/Config in their order, with the form of a value; texts have none.
_PARTS: Mapping[str, str] = {"bool": "<?", "int": "<i", "string": "", "double": "<d"}
_CALL_ERRORS = (OSError, HTTPException, xmlrpc.client.Error, ValueError, OverflowError)


@dataclass(frozen=True, slots=True)
class LiveChange:
    """A value that is set on a running robot.

    ``old`` is None where nothing stood there. ``service`` is that of dynamic_reconfigure, empty
    where the node has none. ``nodes`` run in whose namespace the name is.
    """

    master: str
    name: str
    old: object
    new: object
    service: str
    nodes: tuple[str, ...]


class Robot:
    """The running graph at a master."""

    def __init__(self, master: str) -> None:
        """Nothing is asked yet."""
        self.master = master

    def parameters(self) -> list[str]:
        """The names of all parameters.

        Raises:
            RunError: the master does not answer.
        """
        names = self._call("getParamNames")
        return sorted(map(str, names)) if isinstance(names, list) else []

    def value(self, name: str) -> object:
        """The value of a parameter, None where there is none.

        Raises:
            RunError: the master does not answer.
        """
        return self._call("getParam", name) if self._call("hasParam", name) is True else None

    def plan(self, name: str, given: str, *, force: bool = False) -> LiveChange:
        """Work out what to set; nothing is set.

        Args:
            name: full name.
            given: the new value as typed.
            force: change the type, or set what nobody has set.

        Raises:
            InputError: the value does not fit.
            RunError: the master does not answer.
        """
        old = self.value(name)
        if old is None and not force:
            raise InputError(
                f"{name} is not on the parameter server of {self.master}; --force sets it"
            )
        try:
            new = guessed(given) if old is None else read_value(given, type_of(old), force=force)
        except Refused as error:
            raise InputError(f"{name}: {error}") from error
        if not isinstance(new, bool | int | float | str):
            raise InputError(f"{name} is a {type_of(new)}, which is not set here")
        services, nodes = self._graph()
        service = f"{name.rpartition('/')[0]}/{_SERVICE}"
        below = tuple(sorted(node for node in nodes if name.startswith(f"{node}/")))
        return LiveChange(
            self.master, name, old, new, service if service in services else "", below
        )

    def put(self, change: LiveChange) -> tuple[object, bool]:
        """Set the new value.

        A node with dynamic_reconfigure is asked first, for it writes its own values to the server.

        Returns:
            The value that holds then, and whether the node has taken it over by itself.

        Raises:
            RunError: the master or the node does not answer, or refuses.
        """
        return self._put(change.name, change.new, change.service)

    def take_back(self, name: str, old: object, service: str) -> None:
        """Set what stood there before; where nothing did, the parameter is deleted.

        Raises:
            RunError: the master or the node does not answer, or refuses.
        """
        if old is not None:
            self._put(name, old, service)
        elif self.value(name) is not None:
            self._call("deleteParam", name)

    def _put(self, name: str, value: object, service: str) -> tuple[object, bool]:
        if service:
            try:
                uri = call(self.master, "lookupService", _CALLER, service)
            except xmlrpc.client.Fault:
                # The node has ended meanwhile: the next one reads the server.
                service = ""
            except _CALL_ERRORS as error:
                raise RunError(f"the ROS master at {self.master} does not answer") from error
        if service:
            try:
                taken = _reconfigure(str(uri), service, name.rpartition("/")[2], value)
            except (*_CALL_ERRORS, struct.error) as error:
                raise RunError(f"{service} does not take it: {error}") from error
            # A name that is not among what the node sets may be in its answer all the same, but
            # before it answers it has written to the server all that it does set.
            if taken is not None and self.value(name) == taken:
                return taken, True
        self._call("setParam", name, value)
        return self.value(name), False

    def _graph(self) -> tuple[set[str], set[str]]:
        state = self._call("getSystemState")
        try:
            services = {str(name) for name, _ in state[2]}  # type: ignore[index]
            nodes = {
                str(node)
                for part in state  # type: ignore[attr-defined]
                for _, names in part
                for node in names
            }
        except (TypeError, ValueError, IndexError) as error:
            raise RunError(f"the ROS master at {self.master} gives no list of services") from error
        return services, nodes

    def _call(self, method: str, *arguments: object) -> object:
        try:
            return call(self.master, method, _CALLER, *arguments)
        except OverflowError as error:
            raise RunError(
                f"the parameter server takes whole numbers of 32 bits: {error}"
            ) from error
        except _CALL_ERRORS as error:
            raise RunError(
                f"the ROS master at {self.master} does not answer ({method}: {error}); is roscore"
                " running, and is ROS_MASTER_URI right?"
            ) from error


def encode_config(name: str, value: object) -> bytes:
    """A dynamic_reconfigure/Config with one value; its lists stand by type.

    Raises:
        ValueError: a value that such a message has no list for, or a number that is too large.
    """
    kind = type_of(value)
    if kind not in _PARTS:
        raise ValueError(f"no {kind} in dynamic_reconfigure")
    message = b""
    for part, form in _PARTS.items():
        message += _LENGTH.pack(part == kind)
        if part == kind:
            try:
                data = struct.pack(form, value) if form else _text(str(value))
            except struct.error as error:
                raise ValueError(f"{value} does not fit: {error}") from error
            message += _text(name) + data
    return message + _LENGTH.pack(0)


def decode_config(data: bytes) -> dict[str, bool | int | float | str]:
    """The values of a dynamic_reconfigure/Config, without its groups.

    Raises:
        ValueError: the bytes are no such message.
    """
    values: dict[str, Any] = {}
    at = 0

    def text() -> str:
        nonlocal at
        (length,) = _LENGTH.unpack_from(data, at)
        at += _LENGTH.size + length
        if at > len(data):
            raise ValueError("a text goes past the end")
        return data[at - length : at].decode("utf-8", "replace")

    try:
        for form in _PARTS.values():
            (count,) = _LENGTH.unpack_from(data, at)
            at += _LENGTH.size
            for _ in range(count):
                name = text()
                if form:
                    (values[name],) = struct.unpack_from(form, data, at)
                    at += struct.calcsize(form)
                else:
                    values[name] = text()
    except struct.error as error:
        raise ValueError(f"no dynamic_reconfigure/Config: {error}") from error
    return values


def _text(text: str) -> bytes:
    data = text.encode()
    return _LENGTH.pack(len(data)) + data


def _reconfigure(uri: str, service: str, name: str, value: object) -> object:
    """Call ``set_parameters`` at ``rosrpc://HOST:PORT``; the value that the node then has.

    None where the answer does not have the name.

    Raises:
        OSError: nobody is there, or does not answer in time.
        ValueError: what is there does not speak the protocol, or refuses.
    """
    place = urlsplit(uri)
    if place.hostname is None or place.port is None:
        raise ValueError(f"{uri} is no address of a service")
    header = {"callerid": _CALLER, "service": service, "md5sum": _MD5, "type": _TYPE}
    with socket.create_connection((place.hostname, place.port), _PATIENCE_S) as connection:
        connection.sendall(encode_header(header))
        fields = decode_header(_sized(connection))
        if "error" in fields:
            raise ValueError(fields["error"])
        request = encode_config(name, value)
        connection.sendall(_LENGTH.pack(len(request)) + request)
        worked = receive(connection, 1) != b"\0"
        body = _sized(connection)
    if not worked:
        raise ValueError(body.decode("utf-8", "replace"))
    return decode_config(body).get(name)


def _sized(connection: socket.socket) -> bytes:
    (length,) = _LENGTH.unpack(receive(connection, _LENGTH.size))
    if length > _LARGEST:
        raise ValueError(f"an answer of {length:,} bytes")
    return receive(connection, length)
