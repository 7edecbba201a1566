"""Setting a value on a running robot of ROS 2: the node is asked, and may refuse.

Protocol: rcl_interfaces/SetParameters. A node keeps the type that a parameter was declared with.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import cached_property

from pytpc.base.closest import did_you_mean
from pytpc.base.errors import InputError, RunError
from pytpc.ingest.parameter_events import decode_parameter_event
from pytpc.ros.live_change import LiveChange
from pytpc.ros.ros2.address import Ros2Address
from pytpc.ros.ros2.agent_process import AT_A_TIME, Agent
from pytpc.ros.ros2.found_nodes import is_somebody, nobody, visible
from pytpc.ros.ros2.parameter_types import type_number
from pytpc.values.apply import shown
from pytpc.values.new_value import Refused, guessed, read_value
from pytpc.values.scalars import type_of

_SET = "set_parameters"


class Ros2Robot:
    """The running graph of ROS 2 at an address.

    Raises:
        TpcError: ROS 2 does not work here.
    """

    def __init__(self, address: Ros2Address) -> None:
        """Become a node of it."""
        self._address = address
        self._agent = Agent(address)

    @cached_property
    def _values(self) -> dict[str, object]:
        """The values of all nodes that answer, by full names.

        Raises:
            RunError: nobody is there.
        """
        nodes = visible(self._agent.wait_for_graph(is_somebody).nodes)
        if not nodes:
            raise RunError(nobody(self._address))
        with ThreadPoolExecutor(AT_A_TIME) as pool:
            return {
                name: value
                for found in pool.map(self._of_node, nodes)
                for name, value in found.items()
            }

    def _of_node(self, node: str) -> dict[str, object]:
        try:
            event = decode_parameter_event(self._agent.values(node))
        except (RunError, ValueError):
            # It has no services of parameters, or hangs.
            return {}
        return {f"{node}/{name}": value for name, value in event.values.items()}

    def parameters(self) -> list[str]:
        """The names of all parameters.

        Raises:
            RunError: nobody is there.
        """
        return sorted(self._values)

    def values(self) -> dict[str, object]:
        """The values of all parameters, by full names.

        Raises:
            RunError: nobody is there.
        """
        return dict(self._values)

    def value(self, name: str) -> object:
        """The value of a parameter now, None where there is none."""
        node, parameter = self._split(name)
        return self._of_node(node).get(f"{node}/{parameter}")

    def plan(self, name: str, given: str, *, force: bool = False) -> LiveChange:
        """Work out what to set; nothing is set.

        Args:
            name: full name.
            given: the new value as typed.
            force: set what the node does not have yet, if it allows that.

        Raises:
            InputError: the value does not fit.
            RunError: nobody is there.
        """
        node, _ = self._split(name)
        old = self.value(name)
        if old is None and not force:
            hint = did_you_mean(name, self.parameters())
            raise InputError(f"no node has {name}{hint or '; --force sets it all the same'}")
        try:
            new = guessed(given) if old is None else read_value(given, type_of(old), force=force)
        except Refused as error:
            raise InputError(f"{name}: {error}") from error
        if not type_number(new):
            raise InputError(f"{name}: a {type_of(new)} cannot be a parameter of ROS 2")
        return LiveChange(str(self._address), name, old, new, f"{node}/{_SET}", (node,))

    def put(self, name: str, value: object, service: str) -> tuple[object, bool]:
        """Set a value.

        Returns:
            The value that holds then, and that the node has taken it.

        Raises:
            RunError: the node does not answer, or refuses; with its reason.
        """
        node, parameter = self._split(name)
        ((taken, why),) = self._agent.set(node, [(parameter, type_number(value), value)])
        if not taken:
            raise RunError(
                f"{node} refuses {parameter}={shown(value)}: {why or 'it does not say why'}"
            )
        return self.value(name), True

    def take_back(self, name: str, old: object, service: str) -> None:
        """Set the value of before; if there was none, delete the parameter.

        Raises:
            RunError: the node does not answer, or refuses.
        """
        self.put(name, old, service)

    def close(self) -> None:
        """Leave the graph."""
        self._agent.close()

    def _split(self, name: str) -> tuple[str, str]:
        """The node and the parameter of a full name: the node is the longest that runs.

        Raises:
            InputError: no node of this name runs.
            RunError: nobody is there.
        """
        nodes = visible(self._agent.wait_for_graph(is_somebody).nodes)
        if not nodes:
            raise RunError(nobody(self._address))
        of = [node for node in nodes if name.startswith(f"{node}/")]
        if not of:
            there = did_you_mean(name.rpartition("/")[0], nodes)
            raise InputError(f"no node of {name} is running{there}")
        node = max(of, key=len)
        return node, name[len(node) + 1 :]
