"""Whether the outcome of a comparison can get to where the robot was seen to go wrong.

A mark may say where (`Mark.where`). Messages go from node to node, and whatever a node publishes
may depend on any of its comparisons: the analysis names only the nearest exposing statement. So it
is asked of nodes. Without such a mark, what counts is whether anybody hears the node at all.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pytpc.base.closest import did_you_mean
from pytpc.base.columns import Floats
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.static.graph_names import (
    OWN_SERVICES,
    OWN_TOPICS,
    ROS2_ACTION,
    action_names,
    action_of,
    robots,
)
from pytpc.static.static_info import StaticInfo
from pytpc.static.wiring import Wiring

UNREACHED = -6.0
"""The log odds of a parameter whose nodes cannot reach what a mark names."""

ELSEWHERE = -2.5
"""The same of one whose nodes are not those that the marks name: people may be wrong about it."""

UNHEARD = -4.0
"""The same of one whose nodes nobody hears, if no mark says where. A driver acts by its hardware,
which no graph has, so it is not impossible."""

UNKNOWN_SERVICES = 0.5
"""What of ``UNREACHED`` and ``UNHEARD`` is left if nobody recorded who offers which service."""

_OWN_SERVICES = OWN_SERVICES | {
    *("change_state", "get_state", "tf2_frames"),
    *("load_node", "unload_node", "list_nodes", "load_nodelet", "unload_nodelet", "list"),
}
"""With those that only tools call."""
_OWN_TOPICS = OWN_TOPICS | {"/diagnostics"}
_LISTENER = "/transform_listener_impl_"
"""So begins the node of ROS 2 that hears tf for another one; nobody knows for which."""


@dataclass(frozen=True, slots=True)
class End:
    """What a person meant by a place: topics and services, and the nodes that act by them.

    Without topics it is all that the nodes do.
    """

    topics: frozenset[str]
    nodes: frozenset[str]


@dataclass(frozen=True)
class Reach:
    """The way of messages through a recorded graph.

    ``calls`` are the nodes whose code names a service, by its full name: who calls a service is in
    no graph.
    """

    wiring: Wiring
    calls: Mapping[str, frozenset[str]]

    @classmethod
    def of(cls, static_info: StaticInfo, wiring: Wiring | None) -> Reach | None:
        """The graph of a mission; None if it was not recorded."""
        if wiring is None or not wiring.topics:
            return None
        calls = defaultdict[str, set[str]](set)
        for unit in static_info.units:
            ran = {node for one in unit.comparisons for node in wiring.nodes_of(unit, one)}
            ran = {node for node in ran if node.name in wiring.connected}
            said = {one.topic for one in unit.comparisons} | {one.topic for one in unit.exposing}
            for node in ran:
                for name in map(node.topic, filter(None, said)):
                    if name.startswith("/") and name not in wiring.topics:
                        calls[name].add(node.name)
        return cls(wiring, {name: frozenset(nodes) for name, nodes in calls.items()})

    @cached_property
    def senders(self) -> Mapping[str, frozenset[str]]:
        """The nodes that publish each topic, or call each service."""
        published = {name: topic.publishers for name, topic in self.wiring.topics.items()}
        every = {**published, **self.calls}
        return {name: nodes for name, nodes in every.items() if name not in _OWN_TOPICS}

    @cached_property
    def callers(self) -> Mapping[str, frozenset[str]]:
        """The nodes that are known to call each service that another node offers."""
        return {
            name: self.calls.get(name, frozenset())
            for name in self.wiring.services
            if name.rpartition("/")[2] not in _OWN_SERVICES and ROS2_ACTION not in name
        }

    @cached_property
    def answers_anybody(self) -> frozenset[str]:
        """The nodes of which nobody knows who hears them.

        They offer a service of which nobody is known who calls it, or tf's listener hears them.
        """
        unknown = (self.wiring.services[name] for name, nodes in self.callers.items() if not nodes)
        by_tf = (
            topic.publishers
            for topic in self.wiring.topics.values()
            if any(_LISTENER in one for one in topic.subscribers)
        )
        return robots(frozenset[str]().union(*unknown, *by_tf))

    @cached_property
    def hearers(self) -> Mapping[str, frozenset[str]]:
        """The other nodes of the robot that hear each node: its messages, calls and answers."""
        found = defaultdict[str, set[str]](set)
        for name, nodes in self.callers.items():
            for node in self.wiring.services[name]:
                found[node] |= nodes - {node}
        for name, nodes in self.senders.items():
            topic = self.wiring.topics.get(name)
            offered = self.wiring.services.get(name, frozenset())
            others = offered if topic is None else topic.subscribers
            for node in nodes:
                found[node] |= robots(others) - {node}
        for name, topic in self.wiring.topics.items():
            # A client sends its goal to the server by a service, and hears of it by these topics.
            if ROS2_ACTION in name:
                for node in topic.subscribers:
                    found[node] |= robots(topic.publishers) - {node}
        return {node: frozenset(others) for node, others in found.items()}

    @cached_property
    def unheard(self) -> frozenset[str]:
        """The nodes that no other node of the robot hears, as far as the graph can tell.

        Who offers a service that a node calls may not have been recorded.
        """
        unknown = (nodes for name, nodes in self.calls.items() if name not in self.wiring.services)
        heard = {node for node, others in self.hearers.items() if others}
        return self.wiring.connected - heard - self.answers_anybody.union(*unknown)

    def end(self, where: str) -> End | None:
        """What a person means by a place; None if no node of the robot acts at one called so.

        The last parts of a name are enough if only one thing has them. A full name of a node is
        that node, unless it is an action, too.
        """
        actions = action_names(self.wiring.topics)
        known = robots(self.wiring.connected)
        acting = _named(where, actions)
        topics = frozenset(one for one in self.senders if action_of(one, actions) in acting)
        if not acting and _full(where) not in known:
            topics = _named(where, {*self.senders, *self.wiring.services})
        acted_by = (self.senders.get(one) or self.wiring.services[one] for one in topics)
        nodes = robots(frozenset[str]().union(*acted_by))
        if nodes:
            return End(topics, nodes)
        named = _named(where, known)
        return End(frozenset(), named) if named else None

    def reaching(self, ends: Iterable[End]) -> frozenset[str]:
        """The nodes that can lead to one of these, themselves among them.

        Who answers anybody can lead anywhere.
        """
        found = {node for one in ends for node in one.nodes} | self.answers_anybody
        left = list(found)
        while left:
            node = left.pop()
            new = [one for one, others in self.hearers.items() if node in others]
            left += [one for one in new if one not in found]
            found |= {*new}
        return frozenset(found)


def _full(said: str) -> str:
    return f"/{said.strip('~/')}"


def _named(said: str, names: Collection[str]) -> frozenset[str]:
    """The name that a person means: in full, or by its last parts."""
    full = _full(said)
    if full in names:
        return frozenset({full})
    ending = [name for name in names if name.endswith(full)]
    return frozenset(ending if len(ending) == 1 else ())


def reach_prior(recording: Recording, static_info: StaticInfo, tpcs: Tpcs) -> Floats:
    """float64[p], the log odds of each parameter by what the marks say of where, and the graph.

    0 for one that no node evaluated, and for all if no graph was recorded. A mark whose place the
    graph does not have says nothing.
    """
    prior = np.zeros(len(tpcs.names))
    reach = Reach.of(static_info, recording.wiring)
    if reach is None:
        return prior
    ends = [one for one in map(reach.end, places(recording.marks)) if one is not None]
    reaching = reach.reaching(ends)
    # A topic says nothing of the node that is wrong: its cause may be far before it.
    are_nodes = bool(ends) and not any(one.topics for one in ends)
    named = frozenset[str]().union(*(one.nodes for one in ends)) if are_nodes else reaching
    nodes_of = recording.nodes_of
    known = 1.0 if reach.wiring.services else UNKNOWN_SERVICES
    for column, name in enumerate(tpcs.names):
        ran = [node for key in tpcs.keys_of[name] for node in nodes_of.get(key, ())]
        # A Python node that reports under its program's name has the process behind it.
        nodes = {node.partition(" ")[0] for node in ran} & reach.wiring.connected
        if not nodes:
            continue
        if ends:
            prior[column] = (
                UNREACHED * known if not nodes & reaching else 0.0 if nodes & named else ELSEWHERE
            )
        elif nodes <= reach.unheard:
            prior[column] = UNHEARD * known
    return prior


def places(marks: Iterable[Mark]) -> list[str]:
    """The places that marks name, each once."""
    return list(dict.fromkeys(name for mark in marks for name in mark.where))


def place_notes(recording: Recording, static_info: StaticInfo) -> tuple[str, ...]:
    """A sentence for each place that the graph does not have, or for want of a graph."""
    said: Sequence[str] = places(recording.marks)
    if not said:
        return ()
    reach = Reach.of(static_info, recording.wiring)
    if reach is None:
        return ("marks say where it was wrong, but the graph was not recorded (graph.json)",)
    names = sorted({*reach.senders, *reach.wiring.connected})
    unknown = [name for name in said if reach.end(name) is None]
    hints = [did_you_mean(_full(name), names) for name in unknown]
    return tuple(
        f"a mark says @{name}, which is no topic, service, action or node of the recorded graph"
        f"{hint}"
        for name, hint in zip(unknown, hints, strict=True)
    )
