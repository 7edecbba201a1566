"""Instrumented nodes of a running graph: their ROS parameters and the service ``~tpc/reload``.

The master says who offers such a service; the parameters are set on it, and the call makes a node
take them over.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor

from pytpc.base.errors import RunError
from pytpc.python_runtime.config import NAMES
from pytpc.ros.node_status import NodeStatus, Value, values_of
from pytpc.ros.ros1.connection import LENGTH, ServiceType, call_service
from pytpc.ros.ros1.master import Master, reason_of

_RELOAD = "/tpc/reload"
_CALLER = "/tpc_sink"
_FOLDER = "tpc"
_AT_A_TIME = 16
_TRIGGER = ServiceType("std_srvs/Trigger", "937c9679a518e3a18d831e57125ea522")


class InstrumentedNodes:
    """The nodes of a graph that can be set.

    Args:
        master: URI of the ROS master.
    """

    def __init__(self, master: str) -> None:
        self._master = Master(master, _CALLER)

    def names(self) -> list[str]:
        """The names of the nodes, sorted.

        Raises:
            RunError: the master does not answer.
        """
        services = self._master.state().services
        return sorted(name[: -len(_RELOAD)] for name in services if name.endswith(_RELOAD))

    def set(self, node: str | None, settings: Mapping[str, Value]) -> None:
        """Set parameters of one node, or (None) those that hold for all nodes.

        Raises:
            RunError: the master does not answer or refuses.
        """
        for name, value in settings.items():
            self._master.call("setParam", f"{node or ''}/{_FOLDER}/{name}", value)

    def clear(self, node: str | None) -> None:
        """Forget what was set for one node, or (None) for all nodes together.

        Raises:
            RunError: the master does not answer or refuses.
        """
        for name in NAMES:
            parameter = f"{node or ''}/{_FOLDER}/{name}"
            if self._master.call("hasParam", parameter):
                self._master.call("deleteParam", parameter)

    def reload_all(self, nodes: Sequence[str]) -> Iterator[NodeStatus]:
        """``reload`` of many at a time, in their order: nobody waits behind a node that hangs."""
        with ThreadPoolExecutor(_AT_A_TIME) as pool:
            yield from pool.map(self.reload, nodes)

    def close(self) -> None:
        """There is no connection to close."""

    def reload(self, node: str) -> NodeStatus:
        """Have a node take over its parameters, and say which settings are in effect."""
        try:
            uri = self._master.service_uri(node + _RELOAD)
        except RunError as error:
            return NodeStatus(node, False, str(error))
        if uri is None:
            return NodeStatus(node, False, f"does not answer: nobody offers {node}{_RELOAD}")
        try:
            answer = call_service(uri, node + _RELOAD, _TRIGGER, b"", _CALLER)
            (length,) = LENGTH.unpack_from(answer, 1)
        except (OSError, ValueError, struct.error) as error:
            return NodeStatus(node, False, f"does not answer: {reason_of(error)}")
        message = answer[1 + LENGTH.size :][:length].decode("utf-8", "replace")
        return NodeStatus(node, answer[0] != 0, message, values_of(message))
