"""TCPROS: the header of a connection, messages that stand after their length, and service calls.

Protocol: http://wiki.ros.org/ROS/TCPROS.
"""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import urlsplit

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer, WriteableBuffer
    from typing_extensions import Self

LENGTH = struct.Struct("<I")
_LARGEST_HEADER = 1 << 20
_LARGEST_ANSWER = 1 << 22
_PATIENCE_S = 5.0
_PART = 1 << 16
# As roscpp has it: a host without power is noticed after a minute and a half.
_IDLE_S, _PROBE_S, _PROBES = 60, 10, 3


class TimedSocket(socket.socket):
    """A connection that ends after a time, and after as many bytes, whatever the other side does.

    A socket's own time-out begins anew with each byte.

    Args:
        connection: is taken over.
        patience_s: how long all that is received and sent may take.
        largest: how many bytes may be received.
    """

    def __init__(self, connection: socket.socket, patience_s: float, largest: int) -> None:
        """See the class."""
        super().__init__(fileno=connection.detach())
        self._until = time.monotonic() + patience_s
        self._left = largest

    @classmethod
    def connect_to(cls, host: str, port: int, patience_s: float, largest: int) -> Self:
        """Connect, within the time that all the rest has, too.

        Raises:
            OSError: nobody is there, or does not answer in time.
        """
        began = time.monotonic()
        connection = socket.create_connection((host, port), patience_s)
        return cls(connection, patience_s - (time.monotonic() - began), largest)

    def recv(self, bufsize: int, flags: int = 0, /) -> bytes:
        """As a socket does."""
        self._limit()
        data = super().recv(bufsize, flags)
        self._left -= len(data)
        return data

    def recv_into(self, buffer: WriteableBuffer, nbytes: int = 0, flags: int = 0) -> int:
        """As a socket does."""
        self._limit()
        count = super().recv_into(buffer, nbytes, flags)
        self._left -= count
        return count

    def sendall(self, data: ReadableBuffer, flags: int = 0, /) -> None:
        """As a socket does."""
        self._limit()
        super().sendall(data, flags)

    def released(self) -> socket.socket:
        """The connection without limits, which does not block; this object has none any more."""
        connection = socket.socket(fileno=self.detach())
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, _IDLE_S)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, _PROBE_S)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPCNT, _PROBES)
        return connection

    def _limit(self) -> None:
        if self._left < 0:
            raise ConnectionAbortedError("more bytes than expected")
        left_s = self._until - time.monotonic()
        if left_s <= 0:
            raise TimeoutError("timed out")
        self.settimeout(left_s)


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
    data = bytearray()
    while len(data) < count:
        part = connection.recv(min(count - len(data), _PART))
        if not part:
            raise ConnectionResetError("closed before the end")
        data += part
    return bytes(data)


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


def receive_header(connection: socket.socket) -> dict[str, str]:
    """The fields of the other side's header.

    Raises:
        OSError: as ``receive``.
        ValueError: it is no header, or an error of the other side.
    """
    fields = decode_header(receive_sized(connection, _LARGEST_HEADER))
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
    largest = _LARGEST_HEADER + _LARGEST_ANSWER
    with TimedSocket.connect_to(place.hostname, place.port, _PATIENCE_S, largest) as connection:
        connection.sendall(encode_header(header))
        receive_header(connection)
        connection.sendall(sized(request))
        worked = receive(connection, 1) != b"\0"
        answer = receive_sized(connection, _LARGEST_ANSWER)
    if not worked:
        raise ValueError(answer.decode("utf-8", "replace"))
    return answer
