"""Whose a report is, in a process with several nodes of rclpy.

With the program's second node, each report is looked at: the nearest frame that has something to do
with one node alone says whose it is. Its method's object is the node, or has the node in an
attribute; or one local variable is a node. In rclpy's own frames, which call the callbacks, it is
the node's timer or subscription. What has called rclpy, or is in no function, does not count.
Under a key, the node that reports first has the key itself, the others have ``KEY#2`` and so on, as
two objects have in C++.
"""

from __future__ import annotations

import os
import sys
from types import CodeType
from typing import TYPE_CHECKING, Any

from pytpc.python_runtime import ros2_state
from pytpc.python_runtime.sites import Reported

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from types import FrameType

    from pytpc.python_runtime.sites import Take

_FOLDER = os.path.dirname(__file__) + os.sep
_MOST_FRAMES = 32
_MOST_ATTRIBUTES = 256
# Where code is, if in no function of the program: none has such an argument.
_HERE, _RCLPY, _MODULE = " here", " rclpy", " module"
# By `id`: code takes long to hash. It is kept, so that no other has its number.
_WHERE: dict[int, tuple[CodeType, str]] = {}
# What the objects of a class are: nodes, others with attributes, or without.
_NODE, _OTHER, _PLAIN = "node", "other", "plain"
_KINDS: dict[type, str] = {}
_MOST_KNOWN = 4096


class Split:
    """Gives each node's reports to a report of its own.

    Args:
        new: makes the report of a key, and of the side of its threshold.
    """

    def __init__(self, new: Callable[[str, bool], Reported]) -> None:
        self._new = new
        self._own: dict[tuple[str, bool, str], Reported] = {}
        # The nodes that report under each key, in this order.
        self._nodes: dict[str, list[str]] = {}

    def over(self, take: Take) -> Take:
        """The function that takes reports, which then passes them to ``take``."""

        def split(one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
            take(self._of(one), result, cmp, thresh, res)

        return split

    def _of(self, one: Reported) -> Reported:
        try:
            node = node_of_frame(sys._getframe(2))
        except Exception:
            # What is not known of a report must not stop it.
            node = ""
        if not node:
            return one
        own = self._own.get((one.key, one.swapped, node))
        return own if own is not None else self._made(one, node)

    def _made(self, one: Reported, node: str) -> Reported:
        nodes = self._nodes.setdefault(one.key, [])
        if not nodes and (one.last >= 0 or one.file is not None):
            # It has reported before there was a second node.
            nodes.append(ros2_state.name())
        if node not in nodes:
            nodes.append(node)
        number = nodes.index(node) + 1
        own = one if number == 1 else self._new(f"{one.key}#{number}", one.swapped)
        if node != ros2_state.name():
            own.node = node
        return self._own.setdefault((one.key, one.swapped, node), own)


def node_of_frame(frame: FrameType | None) -> str:
    """The full name of the node that the code of a frame works for; empty if it is not known."""
    is_called_back = False
    for _ in range(_MOST_FRAMES):
        if frame is None:
            break
        code = frame.f_code
        known = _WHERE.get(id(code))
        where = _where(code) if known is None else known[1]
        if where is _RCLPY:
            is_called_back = True
            found = ros2_state.name_of_owner(frame.f_locals.values())
            if found:
                return found
        elif is_called_back or where is _MODULE:
            break
        elif where is not _HERE:
            found = _in_frame(frame.f_locals, where)
            if found:
                return found
        frame = frame.f_back
    return ""


def _where(code: CodeType) -> str:
    """Where code is; for a function of the program, the name of its first argument."""
    path = code.co_filename
    if path.startswith(_FOLDER):
        found = _HERE
    elif f"{os.sep}rclpy{os.sep}" in path:
        found = _RCLPY
    elif code.co_name == "<module>":
        found = _MODULE
    else:
        found = code.co_varnames[0] if code.co_argcount else "self"
    if len(_WHERE) >= _MOST_KNOWN:
        _WHERE.clear()
    _WHERE[id(code)] = code, found
    return found


def _in_frame(values: dict[str, Any], first: str) -> str:
    found = _of_object(values.get(first))
    if not found and first != "self":
        found = _of_object(values.get("self"))
    return found or _only(values.values())


def _of_object(value: object) -> str:
    """The node that an object is, or has; nothing of the program's is called."""
    what = _KINDS.get(type(value)) or _kind(type(value))
    if what is _NODE:
        return ros2_state.name_of(value)
    if what is _PLAIN:
        return ""
    try:
        own = object.__getattribute__(value, "__dict__")
    except AttributeError:
        return ""
    return _only(own.values()) if type(own) is dict and len(own) <= _MOST_ATTRIBUTES else ""


def _only(values: Iterable[object]) -> str:
    """The one node among these."""
    only = ""
    for value in values:
        kind = type(value)
        if (_KINDS.get(kind) or _kind(kind)) is _NODE:
            name = ros2_state.name_of(value)
            if only and name and name != only:
                return ""
            only = name or only
    return only


def _kind(kind: type) -> str:
    """What the objects of a class are."""
    is_node = ros2_state.kind() in kind.__mro__
    found = _NODE if is_node else _OTHER if kind.__dictoffset__ else _PLAIN
    if len(_KINDS) >= _MOST_KNOWN:
        _KINDS.clear()
    _KINDS[kind] = found
    return found


def lines_of(reported: list[Reported]) -> list[str]:
    """What says whose keys these are."""
    return [f"{one.key},node:{one.node}" for one in reported if one.node]
