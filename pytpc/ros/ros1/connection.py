"""TCPROS: the header of a connection, messages that stand after their length, and service calls.

Protocol: http://wiki.ros.org/ROS/TCPROS.
"""

from __future__ import annotations

import socket
import struct
from collections.abc import Mapping
from typing import NamedTuple
from urllib.parse import urlsplit

LENGTH = struct.Struct("<I")
_LARGEST_HEADER = 1 << 28
_LARGEST_ANSWER = 1 << 22
_PATIENCE_S = 5.0


def encode_header(fields: Mapping[str, str]) -> bytes:
    """A TCPROS connection header: its length, then each ``name=value`` after its length."""
    return sized(b"".join(sized(f"{name}={value}".encode()) for name, value in fields.items()))


def decode_header(body: bytes) -> dict[str, str]:
    """The fields of a connection header, without the length in front.

    Raises:
        ValueError: the lengths do not fit, or a field has no ``=``.
    """
    fields = {}
    at = 0
    while at < len(body):
        if at + LENGTH.size > len(body):
            raise ValueError(f"a length is cut off at byte {at}")
        (length,) = LENGTH.unpack_from(body, at)
        at += LENGTH.size
        if at + length > len(body):
            raise ValueError(f"the field at byte {at} goes past the end")
        name, separator, value = body[at : at + length].decode("utf-8", "replace").partition("=")
        if not separator:
            raise ValueError(f"the field at byte {at} has no =")
        fields[name] = value
        at += length
    return fields


def sized(data: bytes) -> bytes:
    """The bytes after their length, as messages, fields and texts stand."""
    return LENGTH.pack(len(data)) + data


def receive(connection: socket.socket, count: int) -> bytes:
    """Receive exactly ``count`` bytes.

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


def receive_sized(connection: socket.socket, largest: int) -> bytes:
    """Receive a length, and as many bytes.

    Raises:
        OSError: as ``receive``.
        ValueError: there are more than ``largest``.
    """
    (length,) = LENGTH.unpack(receive(connection, LENGTH.size))
    if length > largest:
        raise ValueError(f"a message of {length:,} bytes")
    return receive(connection, length)


def receive_header(connection: socket.socket, largest: int = _LARGEST_HEADER) -> dict[str, str]:
    """The fields of the other side's header.

    Raises:
        OSError: as ``receive``.
        ValueError: it is no header, or an error of the other side.
    """
    fields = decode_header(receive_sized(connection, largest))
    if "error" in fields:
        raise ValueError(fields["error"])
    return fields


class ServiceType(NamedTuple):
    """The name and checksum that a server compares before it takes a request."""

    name: str
    md5sum: str


def call_service(uri: str, service: str, kind: ServiceType, request: bytes, caller: str) -> bytes:
    """Call a service at ``rosrpc://HOST:PORT`` with bytes; the answer as bytes.

    Neither rospy nor the service's package is needed.

    Raises:
        OSError: nobody is there, or does not answer in time.
        ValueError: the server does not speak the protocol, or refuses.
    """
    place = urlsplit(uri)
    if place.hostname is None or place.port is None:
        raise ValueError(f"{uri} is no address of a service")
    header = {"callerid": caller, "service": service, "md5sum": kind.md5sum, "type": kind.name}
    with socket.create_connection((place.hostname, place.port), _PATIENCE_S) as connection:
        connection.sendall(encode_header(header))
        receive_header(connection, _LARGEST_ANSWER)
        connection.sendall(sized(request))
        worked = receive(connection, 1) != b"\0"
        answer = receive_sized(connection, _LARGEST_ANSWER)
    if not worked:
        raise ValueError(answer.decode("utf-8", "replace"))
    return answer
