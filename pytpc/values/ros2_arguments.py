"""Where the values of a node of ROS 2 came from, given the params files and rules it got."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pytpc.base.source_bytes import read_bytes
from pytpc.values.apply import decoded
from pytpc.values.new_value import Refused
from pytpc.values.origins import Origin
from pytpc.values.params_target import split_name
from pytpc.values.rcl_edit import store_of
from pytpc.values.ros2_trace import Fields, NodeOrigins


def origins_of_arguments(node: str, words: Sequence[str], folder: Path) -> dict[str, Origin]:
    """The origins of the values that a node gets from its command line.

    Args:
        node: its full name.
        words: of the command line: ``--ros-args --params-file F -p name:=value ...``.
        folder: in which it was started.

    Raises:
        InputError: a file cannot be read, or rcl refuses it or a rule.
    """
    steps: list[Fields] = []
    inside = False
    for word, following in zip(words, [*words[1:], ""], strict=True):
        if word == "--ros-args":
            inside = True
        elif word == "--":
            inside = False
        elif inside and word == "--params-file":
            steps.append(_file(folder / following))
        elif inside and word in ("-p", "--param"):
            steps.append({"rule": following})
    return NodeOrigins().of_nodes([_node(node, steps)])


def origins_in_params(path: Path, parameter: str | None = None) -> dict[str, Origin]:
    """The origins of the values that nodes get from one params file.

    Args:
        path: of the file.
        parameter: names a node with it, whose values are added; else the nodes are those that the
            file names.

    Raises:
        InputError: the file cannot be read, or rcl refuses it.
    """
    step = _file(path)
    nodes = [split_name(parameter)[0]] if parameter and parameter.startswith("/") else []
    try:
        entries = store_of(step["text"]).entries
    except Refused:
        # With its place, below.
        entries = []
    nodes += [entry.pattern for entry in entries if not entry.is_wildcard]
    return NodeOrigins().of_nodes(_node(node, [step]) for node in dict.fromkeys(nodes or ["/"]))


def _file(path: Path) -> Fields:
    return {"file": str(path), "text": decoded(read_bytes(path), path)}


def _node(name: str, steps: Sequence[Fields]) -> Fields:
    return {"name": name, "named": True, "composed": False, "steps": steps}
