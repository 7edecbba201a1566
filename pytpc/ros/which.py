"""Which ROS a command is about, where a machine may have both."""

from __future__ import annotations

from collections.abc import Mapping

from pytpc.base.errors import InputError

VARIABLE = "TPC_ROS"
_OF_ROS2 = (
    "AMENT_PREFIX_PATH",
    "ROS_DOMAIN_ID",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "RMW_IMPLEMENTATION",
    "TPC_ROS2_PYTHON",
)


def asked_ros(env: Mapping[str, str]) -> int | None:
    """The ROS that the user names, by --ros or the variable; None: whichever there is.

    Raises:
        InputError: the variable has another value.
    """
    given = env.get(VARIABLE, "")
    if given not in {"", "1", "2"}:
        raise InputError(f"{VARIABLE}={given}: give 1 or 2, or unset it")
    return int(given) if given else None


def sign_of_ros2(env: Mapping[str, str]) -> str:
    """The first variable of a shell that speaks for ROS 2, empty if none does."""
    if env.get("ROS_VERSION") == "2":
        return "ROS_VERSION=2"
    # Both may be sourced one after the other; the last one is in ROS_VERSION.
    names = _OF_ROS2 if env.get("ROS_VERSION") != "1" else _OF_ROS2[1:]
    return next((f"{name}={env[name]}" for name in names if env.get(name)), "")
