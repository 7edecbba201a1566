"""The reports on a graph of ROS 2, as they come."""

from __future__ import annotations

from collections.abc import Iterator

from pytpc.base.errors import RunError
from pytpc.ingest.decoders import ROS2
from pytpc.ingest.messages import REPORTS, ROSOUT
from pytpc.ros.ros2.address import Ros2Address
from pytpc.ros.ros2.agent_process import Agent
from pytpc.ros.ros2.found_nodes import nobody, settable, visible
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
        self._is_heard = False
        self._agent.subscribe(ROSOUT, "rcl_interfaces/msg/Log")
        self._agent.subscribe(REPORTS, "std_msgs/msg/String")

    @property
    def broken(self) -> dict[str, int]:
        """DDS gives whole messages alone."""
        return {}

    def poll(self, timeout_s: float) -> Iterator[tuple[Source, bytes]]:
        """Wait for messages and yield those that came."""
        for source, _, data in self._agent.poll(timeout_s):
            self._is_heard = True
            yield source, data

    @property
    def patience_s(self) -> float:
        """See `LiveSource`."""
        return self._agent.patience_s if settable(self._agent.graph) else 0.0

    def look(self) -> None:
        """See whether anybody is there; the first time, until a node that reports is found.

        Raises:
            RunError: nobody is, or the agent has ended.
        """
        if self._agent.fault:
            raise RunError(self._agent.fault)
        graph = self._agent.wait_for_graph(lambda graph: self._is_heard or bool(settable(graph)))
        is_heard, self._is_heard = self._is_heard, False
        # Messages may come before the name of who has sent them.
        if not is_heard and not visible(graph.nodes):
            raise RunError(nobody(self._agent.address))

    def close(self) -> None:
        """Leave the graph."""
        self._agent.close()
