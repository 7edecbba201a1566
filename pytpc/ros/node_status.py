"""What an instrumented node that runs says of its settings."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from pytpc.base.errors import RunError
from pytpc.base.wording import listed

Value = str | float | int


# A value may have spaces (a folder), but none before a word and an equals sign.
_WORD = re.compile(r"(?:^| )([a-z_]+)=(.*?)(?= [a-z_]+=|$)")
_LISTED = 5


@dataclass(frozen=True, slots=True)
class NodeStatus:
    """The answer of a node: ``message`` as it came, ``values`` its words ``name=value``.

    ``success`` is false where the node did not take something over, or did not answer; then
    ``message`` says what.
    """

    node: str
    success: bool
    message: str
    values: dict[str, str] = field(default_factory=dict)


class SettableNodes(Protocol):
    """The instrumented nodes of a graph."""

    def names(self) -> list[str]:
        """The names of the nodes, sorted."""

    def set(self, node: str | None, settings: Mapping[str, Value]) -> None:
        """Set one node, or (None) all."""

    def clear(self, node: str | None) -> None:
        """Forget what was set for one node, or (None) for all nodes together."""

    def reload_all(self, nodes: Sequence[str]) -> Iterator[NodeStatus]:
        """Have nodes take it over; what each says."""

    def close(self) -> None:
        """Leave the graph."""


def chosen(running: Sequence[str], named: Iterable[str]) -> list[str]:
    """The nodes that a user names; all if no name is given.

    Raises:
        RunError: one of them is not running, or none is.
    """
    wanted = ["/" + name.strip("/") for name in named]
    if not running:
        raise RunError(
            "no instrumented node is running, or none has reported yet; `pytpc doctor WORKSPACE`"
            " says whether its nodes report"
        )
    for name in wanted:
        if name not in running:
            there = listed(running, _LISTED)
            raise RunError(f"{name} is not a running instrumented node; there are {there}")
    return list(dict.fromkeys(wanted)) or list(running)


def values_of(message: str) -> dict[str, str]:
    """The words ``name=value`` of a status line; what stands before them is left out.

    >>> values_of("no such folder; sink=file file=/a b.tpc dropped=0")
    {'sink': 'file', 'file': '/a b.tpc', 'dropped': '0'}
    """
    return dict(_WORD.findall(message))
