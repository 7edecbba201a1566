"""What the agent (`pytpc.ros.ros2.agent.connections`) answers of a graph: who speaks to whom."""

from __future__ import annotations

from typing import Any

from pytpc.static.wiring import Connections, GraphTopic


def connections_of(answer: dict[str, Any]) -> Connections:
    """The graph of an answer."""
    topics = {
        topic: GraphTopic(one["type"], frozenset(one["publishers"]), frozenset(one["subscribers"]))
        for topic, one in answer["topics"].items()
    }
    services = {name: frozenset(nodes) for name, nodes in answer["services"].items()}
    return Connections(topics, services)
