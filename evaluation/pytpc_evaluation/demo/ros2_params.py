"""The values of parameters that files of ROS 2 give to nodes, and where they stand."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.errors import InputError
from pytpc.base.source_bytes import read_bytes
from pytpc.values.origins import ORIGINS_FILE, PARAMS_FILE, Origin, write_origins
from pytpc.values.yaml_tree import read_yaml, settings, value_of

_BELOW = "ros__parameters"


def params_of(files: Sequence[Path], nodes: Sequence[str]) -> dict[str, Origin]:
    """The origins of all values by full names (``/mission/limit``); a later file wins.

    Args:
        files: as given with ``--params-file``, whose first keys are the names of nodes or ``/**``.
        nodes: the names of the nodes that get them, without a slash.

    Raises:
        InputError: a file cannot be read.
    """
    found: dict[str, Origin] = {}
    for path in files:
        try:
            text = read_bytes(path).decode()
            documents = read_yaml(text)
        except ValueError as error:
            raise InputError(str(error), path) from error
        lines = text.splitlines()
        for keys, setting in settings(documents[0]).items() if documents else ():
            if len(keys) < 3 or keys[1] != _BELOW:
                continue
            for node in nodes if keys[0] == "/**" else [keys[0].strip("/")]:
                name = f"/{node}/{'.'.join(keys[2:])}"
                lineno = setting.key.lineno
                found[name] = Origin(
                    name,
                    "yaml",
                    value_of(setting.node),
                    path.absolute(),
                    lineno,
                    lines[lineno - 1],
                    keys=keys,
                    overridden=(found[name].words(),) if name in found else (),
                )
    return found


def save_params(origins: Mapping[str, Origin], arguments: Mapping[str, str], folder: Path) -> None:
    """Write params.yaml and origins.json of a mission.

    Raises:
        TpcError: a file cannot be written.
    """
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
