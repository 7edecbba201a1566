"""The state of rospy, if the program has imported it; this module never imports it."""

from __future__ import annotations

import sys
from time import time_ns
from typing import Any


def rospy() -> Any:  # noqa: ANN401
    """The module, once the program has initialised a node; else None."""
    module = sys.modules.get("rospy")
    core = sys.modules.get("rospy.core")
    try:
        return module if core is not None and core.is_initialized() else None
    except AttributeError:
        # It is still being imported.
        return None


def is_imported() -> bool:
    """Whether the program may have a node yet."""
    return "rospy" in sys.modules


def time_now_ns() -> int:
    """The node's time where it is simulated, else the wall clock's."""
    rostime = sys.modules.get("rospy.rostime")
    try:
        if rostime is None or rostime.is_wallclock():
            return time_ns()
    except Exception:
        # It is still being imported, or has no time yet.
        return time_ns()
    known = now()
    return 0 if known is None else known[1]


def now() -> tuple[str, int, bool] | None:
    """The node's name, its time in ns, and whether that is simulated; None if not known."""
    ros = rospy()
    if ros is None:
        return None
    try:
        rostime = sys.modules["rospy.rostime"]
        simulated = not rostime.is_wallclock()
        return str(ros.get_name()), int(ros.get_rostime().to_nsec()), simulated
    except Exception:
        # Its time is not initialised yet, or it is shut down.
        return None
