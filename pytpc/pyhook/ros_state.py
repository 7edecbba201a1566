"""What rospy knows, where the program has imported it. Nothing here imports it."""

from __future__ import annotations

import sys
from typing import Any

from pytpc.pyhook.log_file import Now

_UNKNOWN = Now("", 0, False)


def rospy() -> Any:  # noqa: ANN401
    """The module, once the program has a node that was initialised; else None."""
    module = sys.modules.get("rospy")
    core = sys.modules.get("rospy.core")
    try:
        return module if core is not None and core.is_initialized() else None
    except AttributeError:
        # It is being imported.
        return None


def is_shut_down() -> bool:
    """Whether the node was, and has ended."""
    core = sys.modules.get("rospy.core")
    try:
        return bool(core is not None and core.is_shutdown() and core.get_node_uri() is not None)
    except AttributeError:
        return False


def now() -> Now:
    """The node, and its time in ns."""
    ros = rospy()
    if ros is None:
        return _UNKNOWN
    try:
        rostime = sys.modules["rospy.rostime"]
        simulated = not rostime.is_wallclock()
        return Now(str(ros.get_name()), int(ros.get_rostime().to_nsec()), simulated)
    except Exception:
        # Its time is not initialised yet, or no longer.
        return _UNKNOWN
