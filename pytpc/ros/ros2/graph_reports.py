"""The reports on a graph of ROS 2, as they come."""

from __future__ import annotations

from collections.abc import Iterator

from pytpc.base.errors import RunError
from pytpc.ingest.decoders import ROS2
from pytpc.ingest.messages import BEGIN, REPORTS, ROSOUT
from pytpc.ros.ros2.address import Ros2Address
from pytpc.ros.ros2.agent_process import Agent, Graph
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
        # By anybody, since the last look; and ever by a node that reports.
        self._is_heard = self._has_reporter = False
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
            self._has_reporter = self._has_reporter or _is_of_reporter(source, data)
            yield source, data

    @property
    def patience_s(self) -> float:
        """See `LiveSource`."""
        return self._agent.patience_s if self._is_found(self._agent.graph) else 0.0

    def look(self) -> None:
        """See whether anybody is there; the first time, until a node that reports is found.

        Raises:
            RunError: nobody is, or the agent has ended.
        """
        graph = self._agent.wait_for_graph(self._is_found)
        if self._agent.fault:
            raise RunError(self._agent.fault)
        is_heard, self._is_heard = self._is_heard, False
        # Messages may come before the name of who has sent them.
        if not is_heard and not visible(graph.nodes):
            raise RunError(nobody(self._agent.address))

    def close(self) -> None:
        """Leave the graph."""
        self._agent.close()

    def _is_found(self, graph: Graph) -> bool:
        """Whether a node that reports is there."""
        return self._has_reporter or bool(settable(graph))


def _is_of_reporter(source: Source, data: bytes) -> bool:
    """Whether a node that reports has sent it: on /rosout all nodes log."""
    if source.topic != ROSOUT:
        return True
    try:
        return ROS2.log(data).msg.startswith(BEGIN)
    except ValueError:
        return False
