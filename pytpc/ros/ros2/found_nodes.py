"""The nodes that are found on a graph of ROS 2, and what to say where there is none."""

from __future__ import annotations

from pytpc.ros.ros2.address import DOMAIN, RANGE, Ros2Address
from pytpc.ros.ros2.agent_process import Graph

HIDDEN = "/_tpc"
"""What the name of a node is followed by in that of its hidden node, which has its settings."""


def visible(nodes: tuple[str, ...]) -> list[str]:
    """The nodes without hidden ones, such as those of other commands of TPC."""
    return [name for name in nodes if not name.rpartition("/")[2].startswith("_")]


def settable(graph: Graph) -> list[str]:
    """The hidden nodes with the settings of the instrumented ones."""
    return [name for name in graph.nodes if name.endswith(HIDDEN)]


def is_somebody(graph: Graph) -> bool:
    """Whether there is a node that is not hidden."""
    return bool(visible(graph.nodes))


def nobody(address: Ros2Address) -> str:
    """What to say where no node is found."""
    if dict(address.settings).get(RANGE) == "OFF":
        return f"with {RANGE}=OFF no node is found; unset it, or set it as in the robot's shell"
    settings = "".join(f", {name}={value}" for name, value in address.settings)
    return (
        f"no node in domain {address.domain}; {DOMAIN}={address.domain}{settings} must be as in the"
        " robot's shell"
    )
