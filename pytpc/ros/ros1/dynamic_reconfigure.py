"""The service ``set_parameters`` of dynamic_reconfigure, and its message.

The message is dynamic_reconfigure/Config; neither ROS nor the package is needed.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import Any

from pytpc.ros.ros1.connection import LENGTH, ServiceType, call_service, sized
from pytpc.values.scalars import type_of

SERVICE = "set_parameters"
_TYPE = ServiceType("dynamic_reconfigure/Reconfigure", "bb125d226a21982a4a98760418dc2672")
# The parts of the message in their order, with the form of a value; texts have none.
_PARTS: Mapping[str, str] = {"bool": "<?", "int": "<i", "string": "", "double": "<d"}


def reconfigure(uri: str, service: str, name: str, value: object, caller: str) -> object:
    """Call ``set_parameters`` at ``rosrpc://HOST:PORT``; the value that the node then has.

    None where the answer does not have the name.

    Raises:
        OSError: nobody is there, or does not answer in time.
        ValueError: what is there does not speak the protocol, or refuses.
    """
    request = encode_config(name, value)
    return decode_config(call_service(uri, service, _TYPE, request, caller)).get(name)


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
        message += LENGTH.pack(part == kind)
        if part == kind:
            try:
                data = struct.pack(form, value) if form else sized(str(value).encode())
            except struct.error as error:
                raise ValueError(f"{value} does not fit: {error}") from error
            message += sized(name.encode()) + data
    return message + LENGTH.pack(0)


def decode_config(data: bytes) -> dict[str, bool | int | float | str]:
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
