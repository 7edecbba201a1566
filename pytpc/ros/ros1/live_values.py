"""Setting a value on the running robot: the parameter server, and dynamic_reconfigure.

A node of ROS 1 reads a parameter when it asks for it, usually once, when it starts. One with
dynamic_reconfigure takes a new value at once, by its service ``set_parameters``; the answer has the
value that it then uses (it applies limits of its own). Neither ROS nor the node's package is
needed here.

Protocol: http://wiki.ros.org/ROS/Parameter%20Server%20API.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import Any

from pytpc.base.closest import did_you_mean
from pytpc.base.errors import InputError, RunError
from pytpc.ros.live_change import LiveChange
from pytpc.ros.ros1.connection import LENGTH, ServiceType, call_service, sized
from pytpc.ros.ros1.master import Master
from pytpc.values.new_value import Refused, guessed, read_value
from pytpc.values.recording import leaves
from pytpc.values.scalars import type_of

_CALLER = "/tpc_apply"
_SERVICE = "set_parameters"
_RECONFIGURE = ServiceType("dynamic_reconfigure/Reconfigure", "bb125d226a21982a4a98760418dc2672")
# The parts of the message in their order, with the form of a value; texts have none.
_PARTS: Mapping[str, str] = {"bool": "<?", "int": "<i", "string": "", "double": "<d"}


class Robot:
    """The running graph at a master."""

    def __init__(self, master: str) -> None:
        self._master = Master(master, _CALLER)

    def parameters(self) -> list[str]:
        """The names of all parameters.

        Raises:
            RunError: the master does not answer.
        """
        names = self._master.call("getParamNames")
        return sorted(map(str, names)) if isinstance(names, list) else []

    def values(self) -> dict[str, object]:
        """All parameters, by full names.

        Raises:
            RunError: the master does not answer.
        """
        root = self._master.parameter("/")
        return dict(leaves("", root)) if root else {}

    def close(self) -> None:
        """There is no connection to close."""

    def value(self, name: str) -> object:
        """The value of a parameter, None where there is none.

        Raises:
            RunError: the master does not answer.
        """
        return self._master.parameter(name)

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
            hint = did_you_mean(name, self.parameters())
            raise InputError(
                f"{name} is not on the parameter server of"
                f" {self._master.uri}{hint or '; --force sets it'}"
            )
        try:
            new = guessed(given) if old is None else read_value(given, type_of(old), force=force)
        except Refused as error:
            raise InputError(f"{name}: {error}") from error
        if not isinstance(new, bool | int | float | str):
            raise InputError(f"{name} is a {type_of(new)}, which cannot be set on a running robot")
        state = self._master.state()
        service = f"{name.rpartition('/')[0]}/{_SERVICE}"
        below = tuple(sorted(node for node in state.nodes if name.startswith(f"{node}/")))
        taken_by = service if service in state.services else ""
        return LiveChange(self._master.uri, name, old, new, taken_by, below)

    def take_back(self, name: str, old: object, service: str) -> None:
        """Set the value of before; if there was none, delete the parameter.

        Raises:
            RunError: the master or the node does not answer, or refuses.
        """
        if old is not None:
            self.put(name, old, service)
        elif self.value(name) is not None:
            self._master.call("deleteParam", name)

    def put(self, name: str, value: object, service: str) -> tuple[object, bool]:
        """Set a value.

        A node with dynamic_reconfigure is asked first, for it writes its own values to the server.

        Returns:
            The value that holds then, and whether the node has taken it at once.

        Raises:
            RunError: the master or the node does not answer, or refuses.
        """
        # None: the node has ended meanwhile, and the next one reads the server.
        uri = self._master.service_uri(service) if service else None
        if uri is not None:
            try:
                taken = _reconfigure(uri, service, name.rpartition("/")[2], value, _CALLER)
            except (OSError, ValueError) as error:
                raise RunError(f"{service} refuses the value: {error}") from error
            # A name that is not among what the node sets may be in its answer all the same, but
            # before it answers it has written to the server all that it does set.
            if taken is not None and self.value(name) == taken:
                return taken, True
        self._master.call("setParam", name, value)
        return self.value(name), False


def _reconfigure(uri: str, service: str, name: str, value: object, caller: str) -> object:
    """Call ``set_parameters`` at ``rosrpc://HOST:PORT``; the value that the node then has.

    None where the answer does not have the name.

    Raises:
        OSError: nobody is there, or does not answer in time.
        ValueError: the server does not speak the protocol, or refuses.
    """
    request = _encode_config(name, value)
    return _decode_config(call_service(uri, service, _RECONFIGURE, request, caller)).get(name)


def _encode_config(name: str, value: object) -> bytes:
    """A dynamic_reconfigure/Config with one value; its lists stand by type.

    Raises:
        ValueError: a value that such a message has no list for, or a number that is too large.
    """
    kind = type_of(value)
    if kind not in _PARTS:
        raise ValueError(f"no {kind} in dynamic_reconfigure")
    message = b""
    for part, form in _PARTS.items():
        message += LENGTH.pack(part == kind)
        if part == kind:
            try:
                data = struct.pack(form, value) if form else sized(str(value).encode())
            except struct.error as error:
                raise ValueError(f"{value} does not fit: {error}") from error
            message += sized(name.encode()) + data
    return message + LENGTH.pack(0)


def _decode_config(data: bytes) -> dict[str, bool | int | float | str]:
    """The values of a dynamic_reconfigure/Config, without its groups.

    Raises:
        ValueError: the bytes are no such message.
    """
    values: dict[str, Any] = {}
    at = 0

    def text() -> str:
        nonlocal at
        (length,) = LENGTH.unpack_from(data, at)
        at += LENGTH.size + length
        if at > len(data):
            raise ValueError("a text goes past the end")
        return data[at - length : at].decode("utf-8", "replace")

    try:
        for form in _PARTS.values():
            (count,) = LENGTH.unpack_from(data, at)
            at += LENGTH.size
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
