"""Instrumented nodes of a ROS 2 graph: the parameters of the hidden node ``NODE/_tpc`` of each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor

from pytpc.base.errors import RunError
from pytpc.ingest.parameter_events import decode_parameter_event
from pytpc.python_runtime.config import PARAMETERS
from pytpc.ros.node_status import NodeStatus, Value, values_of
from pytpc.ros.ros2.address import Ros2Address
from pytpc.ros.ros2.agent_process import AT_A_TIME, Agent
from pytpc.ros.ros2.found_nodes import HIDDEN, nobody, settable, visible
from pytpc.ros.ros2.parameter_types import type_number

_STATUS = "status"


class Ros2Nodes:
    """The nodes of a graph that can be set.

    Raises:
        TpcError: ROS 2 does not work here.
    """

    def __init__(self, address: Ros2Address) -> None:
        """Find them."""
        self._agent = Agent(address)
        self._refused: dict[str, str] = {}

    def names(self) -> list[str]:
        """The names of the nodes, sorted.

        Raises:
            RunError: there is no node at all.
        """
        graph = self._agent.wait_for_graph(lambda graph: bool(settable(graph)))
        if not visible(graph.nodes):
            raise RunError(self._agent.fault or nobody(self._agent.address))
        return sorted(name[: -len(HIDDEN)] for name in settable(graph))

    def set(self, node: str | None, settings: Mapping[str, Value]) -> None:
        """Set parameters of one node, or (None) of all that run."""
        for name in self.names() if node is None else [node]:
            self._set(name, settings)

    def _set(self, node: str, settings: Mapping[str, Value]) -> None:
        if not settings:
            return
        try:
            kinds = {name: type_number(value) for name, value in self._values(node).items()}
            given = [
                (name, kind, _as(kind, value))
                for name, value in settings.items()
                for kind in [kinds.get(name) or type_number(value)]
            ]
            results = self._agent.set(f"{node}{HIDDEN}", given)
        except RunError as error:
            self._refused[node] = str(error)
            return
        whys = [why or "refused" for taken, why in results if not taken]
        if whys:
            self._refused[node] = "; ".join(whys)

    def clear(self, node: str | None) -> None:
        """Nothing is kept but what the node has itself.

        Raises:
            RunError: always; a node of ROS 2 does not know its earlier settings.
        """
        raise RunError(
            "--clear is for ROS 1, where the master keeps settings; on ROS 2 set each anew, or"
            " restart the node"
        )

    def reload_all(self, nodes: Sequence[str]) -> Iterator[NodeStatus]:
        """The settings that are in effect, of many nodes at a time, in their order."""
        with ThreadPoolExecutor(AT_A_TIME) as pool:
            yield from pool.map(self._reload, nodes)

    def _reload(self, node: str) -> NodeStatus:
        try:
            values = self._values(node)
        except RunError as error:
            return NodeStatus(node, False, self._refused.get(node, str(error)))
        status = str(values.pop(_STATUS, ""))
        shown = {name: str(values[name]) for name in PARAMETERS if name in values}
        found = {**values_of(status), **shown}
        why = self._refused.get(node)
        return NodeStatus(node, why is None, why or status, found)

    def _values(self, node: str) -> dict[str, object]:
        """The parameters of the hidden node.

        Raises:
            RunError: it does not answer.
        """
        try:
            event = decode_parameter_event(self._agent.values(f"{node}{HIDDEN}"))
        except ValueError as error:
            raise RunError(f"{node}{HIDDEN} does not answer: {error}") from error
        return dict(event.values)

    def close(self) -> None:
        """Leave the graph."""
        self._agent.close()


def _as(kind: int, value: Value) -> object:
    """The value as one of the parameter's own type: a whole number may stand for a double."""
    as_double = type_number(0.0)
    return float(value) if kind == as_double and not isinstance(value, str) else value
