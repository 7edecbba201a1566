"""graph.json of a recorded mission: who spoke to whom when it ended."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.static.wiring import Connections, GraphTopic

GRAPH_FILE = "graph.json"
_SCHEMA = 1


def write_graph(
    topics: Mapping[str, GraphTopic],
    path: Path,
    services: Mapping[str, frozenset[str]] | None = None,
) -> None:
    """Write the topics of a graph by their full names, and who offers its services.

    Raises:
        TpcError: the file cannot be written.
    """
    found = {
        name: {
            "type": topic.type,
            "publishers": sorted(topic.publishers),
            "subscribers": sorted(topic.subscribers),
        }
        for name, topic in sorted(topics.items())
    }
    offered = {name: sorted(nodes) for name, nodes in sorted((services or {}).items())}
    document = {"schema": _SCHEMA, "topics": found, "services": offered}
    write_atomic(path, json.dumps(document, indent=1).encode() + b"\n")


def read_graph(folder: Path) -> dict[str, GraphTopic]:
    """The topics of the graph of a mission, by its folder; empty if they were not recorded.

    Raises:
        InputError: the file is there and is broken.
    """
    return dict(read_recorded_graph(folder).topics)


def read_recorded_graph(folder: Path) -> Connections:
    """The graph of a mission, by its folder; empty if it was not recorded.

    Earlier versions recorded no services.

    Raises:
        InputError: the file is there and is broken.
    """
    path = folder / GRAPH_FILE
    if not path.is_file():
        return Connections({}, {})
    document = parse_json(path)
    try:
        if not isinstance(document, dict) or document["schema"] != _SCHEMA:
            raise ValueError(f"not of format {_SCHEMA}, the only one that this TPC reads")
        topics = {str(name): _topic(found) for name, found in document["topics"].items()}
        offered = document.get("services", {})
        services = {str(name): _names(offered, name) for name in offered}
        return Connections(topics, services)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"not the graph of a mission: {error!r}", path) from error


def _topic(found: Mapping[str, object]) -> GraphTopic:
    kind = found["type"]
    ends = _names(found, "publishers"), _names(found, "subscribers")
    return GraphTopic(None if kind is None else str(kind), *ends)


def _names(found: Mapping[str, object], part: str) -> frozenset[str]:
    given = found[part]
    if not isinstance(given, list):
        raise TypeError(f"{part} is no list")
    return frozenset(map(str, given))
