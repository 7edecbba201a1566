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
from typing import TYPE_CHECKING, Any

from pytpc.python_runtime import ros2_state
from pytpc.python_runtime.sites import Reported

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

    from pytpc.python_runtime.sites import Take

_HERE = os.path.dirname(__file__) + os.sep
_RCLPY = f"{os.sep}rclpy{os.sep}"
_MOST_FRAMES = 32
_MOST_ATTRIBUTES = 256


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
        if frame is None or frame.f_code.co_name == "<module>":
            break
        path = frame.f_code.co_filename
        is_rclpy = _RCLPY in path
        if is_called_back and not is_rclpy:
            break
        is_called_back = is_rclpy
        if is_rclpy:
            found = ros2_state.name_of_owner(frame.f_locals.values())
        else:
            found = "" if path.startswith(_HERE) else _in_frame(frame)
        if found:
            return found
        frame = frame.f_back
    return ""


def _in_frame(frame: FrameType) -> str:
    code, values = frame.f_code, frame.f_locals
    first = code.co_varnames[0] if code.co_argcount else "self"
    for name in (first, "self"):
        if name in values:
            found = _of_object(values[name])
            if found:
                return found
    return _only(values.values())


def _of_object(value: object) -> str:
    """The node that an object is, or has; nothing of the program's is called."""
    found = _only([value])
    if found:
        return found
    try:
        own = object.__getattribute__(value, "__dict__")
    except AttributeError:
        return ""
    return _only(own.values()) if type(own) is dict and len(own) <= _MOST_ATTRIBUTES else ""


def _only(values: Any) -> str:  # noqa: ANN401
    """The one node among these."""
    kind = ros2_state.kind()
    names = {ros2_state.name_of(each) for each in values if kind in type(each).__mro__}
    names.discard("")
    return names.pop() if len(names) == 1 else ""


def lines_of(reported: list[Reported]) -> list[str]:
    """What says whose keys these are."""
    return [f"{one.key},node:{one.node}" for one in reported if one.node]
