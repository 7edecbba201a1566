"""The values of parameters that the nodes of a mission are given, and where they stand."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.values.origins import ORIGINS_FILE, PARAMS_FILE, write_origins
from pytpc.values.ros2_arguments import origins_of_arguments


def save_params(
    words: Mapping[str, Sequence[str]], arguments: Mapping[str, str], folder: Path
) -> None:
    """Write params.yaml and origins.json of a mission.

    Args:
        words: the command line of each node, by its name without a slash.
        arguments: of the mission.
        folder: of the mission.

    Raises:
        TpcError: a file cannot be read or written.
    """
    origins = {}
    for node, given in words.items():
        origins.update(origins_of_arguments(f"/{node}", given, Path.cwd()))
    tree: dict[str, dict[str, object]] = {}
    for name, origin in origins.items():
        node, _, parameter = name[1:].partition("/")
        tree.setdefault(node, {})[parameter] = origin.value
    # JSON is YAML.
    write_atomic(folder / PARAMS_FILE, json.dumps(tree, indent=1).encode() + b"\n")
    document: dict[str, object] = {
        "launch": None,
        "args": dict(arguments),
        "env": {},
        "reason": "",
        "files": {},
        "nodes": [],
    }
    write_origins(document, origins, folder / ORIGINS_FILE)
