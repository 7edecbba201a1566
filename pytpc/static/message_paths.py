"""Where the outcome of a comparison goes on: through messages, to comparisons of other nodes.

A comparison decides what a node publishes. Where the comparison of another node depends on the
messages of that topic, by its value or by being evaluated at all, the two are linked. What is
published is that of the nearest exposing statement.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from pytpc.static.link_unit import Comparison, Received
from pytpc.static.parameters import parameter_name
from pytpc.static.static_info import StaticInfo
from pytpc.static.wiring import RunningNode, Wiring, same_type

MOST_NODES = 5
"""The length of a path: farther effects are those of nearly everything."""
MOST_PATHS = 200
_GIVEN_BACK = " -> "
"""In the topic of what an overriding function gives back, which is none."""


@dataclass(frozen=True, slots=True, order=True)
class NodeComparison:
    """A comparison in one of the nodes that run it; ``node`` is the full name."""

    key: str
    node: str


@dataclass(frozen=True, slots=True)
class MessageLink:
    """A topic with its type (None if not known), and a comparison that depends on its messages."""

    topic: str
    type: str | None
    to: NodeComparison
    by: Literal["value", "control"]


@dataclass(frozen=True, slots=True)
class MessagePath:
    """From a comparison over topics to one in another node, with one link for each topic.

    ``topic`` is what the last comparison publishes; None if that is not known.
    """

    start: NodeComparison
    links: tuple[MessageLink, ...]
    topic: str | None

    @property
    def end(self) -> NodeComparison:
        """The last comparison."""
        return self.links[-1].to


_Spoken = tuple[RunningNode, str | None, str | None]
"""A node with the name of a topic in its code and the type; either is None if it is not known."""


@dataclass(frozen=True)
class MessagePaths:
    """The links between the comparisons of nodes that ``static`` and ``wiring`` know."""

    static: StaticInfo
    wiring: Wiring

    def from_key(self, key: str) -> list[MessagePath]:
        """The shortest path from a comparison to each that its outcome can reach, nearest first.

        At most `MOST_PATHS`, each over at most `MOST_NODES` nodes. Empty if no link is known.
        """
        nodes = sorted(node.name for node in self._nodes.get(key, ()))
        return [path for node in nodes for path in self.from_comparison(NodeComparison(key, node))]

    def from_comparison(self, start: NodeComparison) -> list[MessagePath]:
        """The same from a comparison in one of its nodes."""
        return list(self._from(start))

    def _from(self, start: NodeComparison) -> Iterator[MessagePath]:
        known = {start}
        ends: list[tuple[MessageLink, ...]] = [()]
        for _ in range(MOST_NODES - 1):
            further: list[tuple[MessageLink, ...]] = []
            for links in ends:
                here = links[-1].to if links else start
                for link in self.after(here):
                    if link.to in known:
                        continue
                    known.add(link.to)
                    further.append((*links, link))
                    yield MessagePath(start, further[-1], self._published_by(link.to))
                    if len(known) > MOST_PATHS:
                        return
            ends = further

    def after(self, here: NodeComparison) -> list[MessageLink]:
        """The links from a comparison: those by value first, then those to what hears least else.

        Alike ones are ordered by topic, node and place.
        """
        sender = self._sender_of.get(here)
        return [] if sender is None else self._links.get(sender, [])

    @cached_property
    def _nodes(self) -> dict[str, list[RunningNode]]:
        static, wiring = self.static, self.wiring
        return {
            found.key: wiring.nodes_of(unit, found)
            for unit in static.units
            for found in unit.comparisons
            if found.type != "constant"
        }

    @cached_property
    def _sender_of(self) -> dict[NodeComparison, _Spoken]:
        """What each comparison publishes; without those that publish nothing."""
        comparisons = self.static.comparisons
        return {
            NodeComparison(key, node.name): (node, found.topic, found.message)
            for key, nodes in self._nodes.items()
            for node in nodes
            if _GIVEN_BACK not in ((found := comparisons[key]).topic or "")
        }

    @cached_property
    def _links(self) -> dict[_Spoken, list[MessageLink]]:
        """The links from all comparisons that publish the same."""
        hearing: dict[_Spoken, list[tuple[NodeComparison, Received]]] = defaultdict(list)
        for key, nodes in self._nodes.items():
            for received in self.static.comparisons[key].received or ():
                for node in nodes:
                    one = NodeComparison(key, node.name)
                    hearing[node, received.topic, received.type].append((one, received))
        links: dict[_Spoken, list[MessageLink]] = defaultdict(list)
        for sender in dict.fromkeys(self._sender_of.values()):
            for hearer, others in hearing.items():
                joined = self._joined(sender, hearer)
                if joined is not None:
                    links[sender] += [MessageLink(*joined, to, heard.by) for to, heard in others]
        for each in links.values():
            each.sort(key=self._order)
        return dict(links)

    def _order(self, link: MessageLink) -> tuple[object, ...]:
        found = self.static.comparisons[link.to.key]
        place = found.file, found.lineno, found.column
        heard = len(found.received or ())
        return link.by == "control", heard, link.topic, link.to.node, *place, link.to.key

    def _joined(self, sender: _Spoken, hearer: _Spoken) -> tuple[str, str | None] | None:
        """Topic and type by which one node speaks to another; None if it does not."""
        (from_node, said, sent), (to_node, heard, got) = sender, hearer
        if from_node.name == to_node.name or not same_type(sent, got):
            return None
        kind = sent or got
        ours = None if said is None else from_node.topic(said)
        theirs = None if heard is None else to_node.topic(heard)
        graph = self.wiring.topics
        if not {from_node.name, to_node.name} <= self.wiring.connected:
            return (ours, kind) if ours is not None and ours == theirs else None
        shared = [
            topic
            for topic, ends in graph.items()
            if from_node.name in ends.publishers
            and to_node.name in ends.subscribers
            and same_type(kind, ends.type)
        ]
        # A name that the graph does not have is not the one under which the node runs.
        known = {topic for topic in (ours, theirs) if topic in graph}
        fitting = [topic for topic in shared if known <= {topic}]
        # Without a name, the type must tell.
        if len(fitting) != 1 or (not known and (kind is None or graph[fitting[0]].type is None)):
            return None
        return fitting[0], graph[fitting[0]].type or kind

    def _published_by(self, end: NodeComparison) -> str | None:
        found = self.static.comparisons[end.key]
        if found.topic is None or end not in self._sender_of:
            return None
        return self._sender_of[end][0].topic(found.topic)


def routes(paths: Iterable[MessagePath]) -> list[tuple[MessagePath, int]]:
    """The first path over each row of topics and nodes; and how many comparisons end others.

    A node that hears a message decides many things by it, which are alike for whoever looks at the
    nodes.
    """
    found: dict[object, list[MessagePath]] = {}
    for path in paths:
        way = tuple((link.topic, link.to.node) for link in path.links)
        found.setdefault((path.start, way), []).append(path)
    return [(same[0], len(same) - 1) for same in found.values()]


def leaves(paths: list[MessagePath]) -> list[MessagePath]:
    """The paths that are not the beginning of another one."""
    begun = {(path.start, path.links[:-1]) for path in paths}
    return [path for path in paths if (path.start, path.links) not in begun]


def path_text(static: StaticInfo, path: MessagePath, others: int = 0) -> str:
    """A path in one line; ``others`` is how many comparisons more are at its end.

    For example ``~min_coverage (camera) -> /done -> driver: src/driver.cpp:40 ~retry -> /cmd_vel``.
    """
    parts = [f"{parameter_name(static.comparisons[path.start.key])} ({_short(path.start.node)})"]
    for link in path.links:
        found = static.comparisons[link.to.key]
        place = f"{found.file}:{found.lineno} {parameter_name(found)}"
        parts += [link.topic, f"{_short(link.to.node)}: {place}"]
    if others:
        parts[-1] += f" (and {others} more)"
    return " -> ".join([*parts, *([path.topic] if path.topic else [])])


def path_json(static: StaticInfo, path: MessagePath) -> dict[str, object]:
    """A path as JSON (docs/reference/command-line.md#json)."""

    def end(one: NodeComparison) -> dict[str, object]:
        found: Comparison = static.comparisons[one.key]
        return {
            "node": one.node,
            "key": one.key,
            "parameter": found.source,
            "file": found.file,
            "lineno": found.lineno,
        }

    links = [
        {"topic": link.topic, "type": link.type, "by": link.by, **end(link.to)}
        for link in path.links
    ]
    return {"start": end(path.start), "links": links, "topic": path.topic}


def _short(node: str) -> str:
    return node.lstrip("/")
