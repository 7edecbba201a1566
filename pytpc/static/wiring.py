"""Which nodes run which comparisons, and what their topics are called in the running graph.

A launch file starts programs under names and renames their topics; a recording knows which nodes
evaluated what, and may know who published and subscribed to what.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from pytpc.static.link_unit import Comparison, LinkUnit
from pytpc.static.parameters import base_key, resolved

# What TPC and ROS themselves start on a graph. Anonymous names end with numbers; a robot may have a
# node /play_motion.
_TOOLS = re.compile(
    r"/(rosout|tpc_\w+|roslaunch\S*|(rviz|rqt)(_\S+)?|rosbag2_(recorder|player)"
    r"|(record|play|rostopic|rosservice)_(\S*_)?\d+)"
)


def is_tool(node: str) -> bool:
    """Whether a node of this name is no part of the robot: TPC and ROS have started it.

    >>> is_tool("/record_1732871"), is_tool("/play_motion")
    (True, False)
    """
    return _TOOLS.fullmatch(node) is not None


@dataclass(frozen=True, slots=True)
class RunningNode:
    """A node: its full name, its program (``package/name``; empty if not known), its remappings.

    ``remaps`` are pairs of names as they are written: what the code calls a topic, its new name.
    """

    name: str
    program: str = ""
    remaps: tuple[tuple[str, str], ...] = ()

    def topic(self, name: str) -> str:
        """The full name of the topic that its code calls ``name``.

        >>> RunningNode("/a/camera").topic("out"), RunningNode("/a/camera").topic("~out")
        ('/a/out', '/a/camera/out')
        >>> RunningNode("/camera", remaps=(("out", "/pictures"),)).topic("out")
        '/pictures'
        """
        full = resolved(name, self.name)
        for before, after in self.remaps:
            if resolved(before, self.name) == full:
                return resolved(after, self.name)
        return full


@dataclass(frozen=True, slots=True)
class GraphTopic:
    """A topic of a recorded graph: its type (None if not known), and nodes by their full names."""

    type: str | None
    publishers: frozenset[str]
    subscribers: frozenset[str]


class Connections(NamedTuple):
    """A graph by full names: its topics, and for each service the nodes that offer it."""

    topics: Mapping[str, GraphTopic]
    services: Mapping[str, frozenset[str]]


@dataclass(frozen=True)
class Wiring:
    """What is known of the nodes of a robot.

    Attributes:
        nodes: those that launch files start.
        evaluated: the nodes that evaluated a comparison, by key; empty without a recording.
        topics: all topics of the graph by full name; empty if it was not recorded.
        services: for each service of the graph the nodes that offer it, by full names; empty if
            that was not recorded.
    """

    nodes: tuple[RunningNode, ...] = ()
    evaluated: Mapping[str, frozenset[str]] = field(default_factory=dict)
    topics: Mapping[str, GraphTopic] = field(default_factory=dict)
    services: Mapping[str, frozenset[str]] = field(default_factory=dict)

    @cached_property
    def _by_name(self) -> dict[str, RunningNode]:
        return {node.name: node for node in self.nodes}

    @cached_property
    def connected(self) -> frozenset[str]:
        """The nodes that have a topic in the recorded graph; others may have ended before."""
        ends = (node for topic in self.topics.values() for node in topic.publishers)
        return frozenset(ends).union(*(topic.subscribers for topic in self.topics.values()))

    def nodes_of(self, unit: LinkUnit, comparison: Comparison) -> list[RunningNode]:
        """The nodes that run a comparison, by name.

        Those that evaluated it; else those whose program has it. Where nothing is known of any
        node, each link unit is one node of its own name.
        """
        evaluated = self.evaluated.get(comparison.key) or self.evaluated.get(
            base_key(comparison.key), frozenset()
        )
        # A Python node that reports under its program's name has the process behind it.
        names = sorted({name.partition(" ")[0] for name in evaluated})
        if names:
            return [self._by_name.get(name) or RunningNode(name) for name in names]
        if not self.nodes:
            return [] if self.evaluated else [RunningNode(f"/{_node_name(unit)}")]
        programs = {f"{unit.package}/{unit.link_unit}"}
        if unit.script is not None:
            programs.add(f"{unit.package}/{unit.script.rpartition('/')[2]}")
        programs |= {name.partition("@")[0] for name in comparison.processes or ()}
        return sorted(
            (node for node in self.nodes if node.program in programs), key=lambda node: node.name
        )


UNKNOWN = Wiring()
"""Nothing is known: names of topics are those in the code, in the root namespace."""


def _node_name(unit: LinkUnit) -> str:
    return unit.link_unit.rpartition("/")[2].removesuffix(".py")


def same_type(one: str | None, other: str | None) -> bool:
    """Whether messages of these types can be one; a type that is not known fits all.

    >>> same_type("std_msgs/Bool", "std_msgs/msg/Bool"), same_type("std_msgs/Bool", "std_msgs/Int8")
    (True, False)
    """
    if one is None or other is None:
        return True
    return one.replace("/msg/", "/") == other.replace("/msg/", "/")
