"""The reports on a graph of ROS 2, as they come."""

from __future__ import annotations

from collections.abc import Iterator

from pytpc.base.errors import RunError
from pytpc.ingest.decoders import ROS2
from pytpc.ingest.messages import REPORTS, ROSOUT
from pytpc.ros.ros2.address import Ros2Address
from pytpc.ros.ros2.agent_process import Agent
from pytpc.ros.ros2.found_nodes import is_somebody, nobody, visible
from pytpc.ros.source import Source


class Ros2Reports:
    """Receives the topics of reports.

    Raises:
        TpcError: ROS 2 does not work here.
    """

    decoders = ROS2

    def __init__(self, address: Ros2Address) -> None:
        """Subscribe."""
        self._agent = Agent(address)
        self._agent.subscribe(ROSOUT, "rcl_interfaces/msg/Log")
        self._agent.subscribe(REPORTS, "std_msgs/msg/String")

    @property
    def broken(self) -> dict[str, int]:
        """DDS gives whole messages alone."""
        return {}

    def poll(self, timeout_s: float) -> Iterator[tuple[Source, bytes]]:
        """Wait for messages and yield those that came."""
        for source, _, data in self._agent.poll(timeout_s):
            yield source, data

    def look(self) -> None:
        """See whether anybody is there.

        Raises:
            RunError: nobody is, or the agent has ended.
        """
        if self._agent.fault:
            raise RunError(self._agent.fault)
        if not visible(self._agent.wait_for_graph(is_somebody).nodes):
            raise RunError(nobody(self._agent.address))

    def close(self) -> None:
        """Leave the graph."""
        self._agent.close()
