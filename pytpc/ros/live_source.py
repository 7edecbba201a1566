"""Where the reports of a running graph come from."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator, Mapping
from typing import Protocol

from pytpc.ingest.decoders import ROS1, Decoders
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.relay import ROSOUT, TOPIC
from pytpc.ros.ros1.subscriber import UnregisteredSubscriber
from pytpc.ros.ros2.address import Ros2Address, is_ros2
from pytpc.ros.ros2.graph_reports import Ros2Reports
from pytpc.ros.source import Source


class LiveSource(Protocol):
    """Receives the topics of reports; ``decoders`` are those of its ROS."""

    decoders: Decoders

    @property
    def broken(self) -> Mapping[str, int]:
        """How many connections of each node ended within a message."""

    @property
    def patience_s(self) -> float:
        """How long the first report of those who were found may take; 0 where it is there."""

    def look(self) -> None:
        """Find new publishers, or raise RunError where nobody is."""

    def poll(self, timeout_s: float) -> Iterator[tuple[Source, bytes]]:
        """Wait for messages and yield those that came."""

    def close(self) -> None:
        """Leave the graph."""


class _Ros1Reports(UnregisteredSubscriber):
    decoders = ROS1
    patience_s = 0.0


def reports_at(address: str) -> LiveSource:
    """The reports of the graph at a ROS 1 master's URI, or at ``ros2://DOMAIN``.

    Raises:
        TpcError: ROS 2 does not work here.
    """
    if is_ros2(address):
        return Ros2Reports(Ros2Address.parse(address))
    name = f"/tpc_watch_{os.getpid()}_{secrets.token_hex(3)}"
    return _Ros1Reports(Master(address, name), (ROSOUT, TOPIC))
