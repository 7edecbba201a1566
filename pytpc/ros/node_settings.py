"""Settings of instrumented nodes while they run: which nodes are meant, and what one answers."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from pytpc.base.errors import RunError

# A value may have spaces (a folder), but none before a word and an equals sign.
_WORD = re.compile(r"(?:^| )([a-z_]+)=(.*?)(?= [a-z_]+=|$)")
_LISTED = 5


@dataclass(frozen=True, slots=True)
class NodeStatus:
    """What a node answers: ``message`` as it came, ``values`` its words ``name=value``.

    ``success`` is false where the node did not take something over, or did not answer; then
    ``message`` says what.
    """

    node: str
    success: bool
    message: str
    values: dict[str, str] = field(default_factory=dict)


def chosen(running: Sequence[str], named: Iterable[str]) -> list[str]:
    """The nodes that are meant: those that are named, all where none is.

    Raises:
        RunError: one of them is not running, or none is.
    """
    wanted = ["/" + name.strip("/") for name in named]
    if not running:
        raise RunError(
            "no instrumented node is running, or none has reported yet: see docs/how-to/record.md"
        )
    for name in wanted:
        if name not in running:
            raise RunError(f"{name} is not a running instrumented node; there are {_list(running)}")
    return list(dict.fromkeys(wanted)) or list(running)


def values_of(message: str) -> dict[str, str]:
    """The words ``name=value`` of a status line; what stands before them is left out.

    >>> values_of("no such folder; sink=file file=/a b.tpc dropped=0")
    {'sink': 'file', 'file': '/a b.tpc', 'dropped': '0'}
    """
    return dict(_WORD.findall(message))


def _list(names: Sequence[str]) -> str:
    shown = ", ".join(names[:_LISTED])
    return shown if len(names) <= _LISTED else f"{shown} and {len(names) - _LISTED} more"
