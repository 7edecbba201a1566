"""graph.json of a recorded mission: who published and subscribed to what when it ended."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.static.wiring import GraphTopic

GRAPH_FILE = "graph.json"
_SCHEMA = 1


def write_graph(topics: Mapping[str, GraphTopic], path: Path) -> None:
    """Write the topics of a graph by their full names.

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
    document = {"schema": _SCHEMA, "topics": found}
    write_atomic(path, json.dumps(document, indent=1).encode() + b"\n")


def read_graph(folder: Path) -> dict[str, GraphTopic]:
    """The topics of the graph of a mission, by its folder; empty if they were not recorded.

    Raises:
        InputError: the file is there and is broken.
    """
    path = folder / GRAPH_FILE
    if not path.is_file():
        return {}
    document = parse_json(path)
    try:
        if not isinstance(document, dict) or document["schema"] != _SCHEMA:
            raise ValueError(f"not of format {_SCHEMA}, the only one that this TPC reads")
        return {str(name): _topic(found) for name, found in document["topics"].items()}
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"not the graph of a mission: {error!r}", path) from error


def _topic(found: Mapping[str, object]) -> GraphTopic:
    def names(part: str) -> frozenset[str]:
        given = found[part]
        if not isinstance(given, list):
            raise TypeError(f"{part} is no list")
        return frozenset(map(str, given))

    kind = found["type"]
    return GraphTopic(
        None if kind is None else str(kind), names("publishers"), names("subscribers")
    )
