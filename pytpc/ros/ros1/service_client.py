"""Calls a service of ROS 1 with bytes; neither rospy nor the service's package is needed.

Protocol: http://wiki.ros.org/ROS/TCPROS.
"""

from __future__ import annotations

import socket
from typing import NamedTuple
from urllib.parse import urlsplit

from pytpc.ros.ros1.connection import encode_header, receive, receive_header, receive_sized, sized

_PATIENCE_S = 5.0
_LARGEST = 1 << 22


class ServiceType(NamedTuple):
    """What a server compares before it takes a request."""

    name: str
    md5sum: str


def call_service(uri: str, service: str, kind: ServiceType, request: bytes, caller: str) -> bytes:
    """Call a service at ``rosrpc://HOST:PORT``; the serialized answer.

    Raises:
        OSError: nobody is there, or does not answer in time.
        ValueError: what is there does not speak the protocol, or refuses.
    """
    place = urlsplit(uri)
    if place.hostname is None or place.port is None:
        raise ValueError(f"{uri} is no address of a service")
    header = {"callerid": caller, "service": service, "md5sum": kind.md5sum, "type": kind.name}
    with socket.create_connection((place.hostname, place.port), _PATIENCE_S) as connection:
        connection.sendall(encode_header(header))
        receive_header(connection, _LARGEST)
        connection.sendall(sized(request))
        worked = receive(connection, 1) != b"\0"
        answer = receive_sized(connection, _LARGEST)
    if not worked:
        raise ValueError(answer.decode("utf-8", "replace"))
    return answer
