"""Where the values of a node of ROS 2 came from, given the params files and rules it got."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from pytpc.base.source_bytes import read_bytes
from pytpc.values.apply import decoded
from pytpc.values.journal import digest
from pytpc.values.new_value import Refused
from pytpc.values.origins import Origin
from pytpc.values.params_target import split_given
from pytpc.values.rcl_edit import store_of
from pytpc.values.ros2_trace import Fields, NodeOrigins

BY_LAUNCH = "a launch file sets it; `pytpc record --launch FILE` finds the line"
_WRITTEN_BY_LAUNCH = "launch_params_"


class NodeArguments(NamedTuple):
    """What the command line of a process has for its nodes.

    Attributes:
        steps: what it sets, in order.
        name: the name that it gives to its node, empty where the code does.
        namespace: the same; with a slash in front.
        files: the SHA-256 of its params files, by their paths.
    """

    steps: tuple[Fields, ...]
    name: str = ""
    namespace: str = ""
    files: Mapping[str, str] = MappingProxyType({})

    @classmethod
    def of(cls, words: Sequence[str], folder: Path) -> NodeArguments:
        """Read a command line: ``--ros-args --params-file F -p name:=value -r __node:=guard``.

        Args:
            words: of the command line.
            folder: in which it was started.

        Raises:
            InputError: a file cannot be read.
        """
        steps: list[Fields] = []
        names: dict[str, str] = {}
        for option, value in _ros_options(words):
            if option == "--params-file":
                steps.append(_file(folder / value))
            elif option in ("-p", "--param"):
                steps.append({"rule": value})
            elif option in ("-r", "--remap"):
                what, _, name = value.partition(":=")
                names.setdefault("__node" if what == "__name" else what, name)
        read = [one for one in steps if "file" in one and not one.get("inline")]
        files = {one["file"]: digest(one["text"].encode()) for one in read}
        namespace = names.get("__ns", "").strip("/")
        return cls(
            tuple(steps), names.get("__node", ""), f"/{namespace}" if namespace else "", files
        )

    def may_be(self, node: str) -> bool:
        """Whether the process may have a node of this full name."""
        space, _, name = node.rpartition("/")
        return self.name in ("", name) and self.namespace in ("", space)

    def origins(self, node: str) -> dict[str, Origin]:
        """The origins of the values that a node of this full name gets, by full names.

        Raises:
            InputError: rcl refuses a file or a rule.
        """
        found = NodeOrigins().of_nodes([_node(node, self.steps)])
        return {name: _of_launch(one) for name, one in found.items()}


def _of_launch(origin: Origin) -> Origin:
    """The origin; of a file that launch has written for the node, its place is not known."""
    if origin.kind == "launch" and origin.path is None and not origin.note:
        return replace(origin, note=BY_LAUNCH)
    return origin


def _ros_options(words: Sequence[str]) -> Iterator[tuple[str, str]]:
    """The options for ROS of a command line, each with the word behind it."""
    inside = False
    for word, following in pairwise([*words, ""]):
        if word == "--ros-args":
            inside = True
        elif word == "--":
            inside = False
        elif inside:
            yield word, following


def origins_of_arguments(node: str, words: Sequence[str], folder: Path) -> dict[str, Origin]:
    """The origins of the values that a node gets from its command line.

    Args:
        node: its full name.
        words: of the command line.
        folder: in which it was started.

    Raises:
        InputError: a file cannot be read, or rcl refuses it or a rule.
    """
    return NodeArguments.of(words, folder).origins(node)


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
    nodes = [split_given(parameter)[0]] if parameter and parameter.startswith("/") else []
    try:
        entries = store_of(step["text"]).entries
    except Refused:
        # With its place, below.
        entries = []
    nodes += [entry.pattern for entry in entries if not entry.is_wildcard]
    return NodeOrigins().of_nodes(_node(node, [step]) for node in dict.fromkeys(nodes or ["/"]))


def _file(path: Path) -> Fields:
    text = decoded(read_bytes(path), path)
    # launch writes inline parameters to files of its own.
    is_inline = path.name.startswith(_WRITTEN_BY_LAUNCH)
    return {"file": str(path), "text": text, **({"inline": True} if is_inline else {})}


def _node(name: str, steps: Sequence[Fields]) -> Fields:
    return {"name": name, "named": True, "composed": False, "steps": steps}
