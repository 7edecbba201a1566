"""Programs on rclcpp, for tests where it is installed: PyPI has none."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from patience import PATIENCE_S
from pytpc.base.paths import ROS_PREFIXES, installed, prefix
from pytpc.workspace.ros2 import AMENT, has_cmake_package

LIBRARIES = (
    *("rclcpp", "rcl", "rcutils", "rcpputils", "rmw", "rosidl_runtime_c", "rosidl_typesupport_cpp"),
    *("tracetools", "libstatistics_collector"),
)
MESSAGES = ("std_msgs", "rcl_interfaces", "builtin_interfaces", "statistics_msgs")


PACKAGES = ("rclcpp", "rclcpp_action", "rclcpp_components", "rclcpp_lifecycle")


def rclcpp_prefix() -> Path | None:
    """The folder of a ROS 2 that was sourced, or is in /opt/ros, and has rclcpp; or None."""
    listed = filter(None, os.environ.get(AMENT, "").split(os.pathsep))
    places = [*map(Path, listed), *ROS_PREFIXES]
    return next(
        (one for one in places if all(has_cmake_package(name, [one]) for name in PACKAGES)), None
    )


ROS = rclcpp_prefix()
needs_rclcpp = pytest.mark.skipif(
    ROS is None, reason=f"no {', '.join(PACKAGES)} in {AMENT} or /opt/ros (source its setup)"
)


def rclcpp_env() -> dict[str, str]:
    """What a program on rclcpp needs to be found and to run, with TPC's library."""
    assert ROS is not None
    return {
        "AMENT_PREFIX_PATH": str(ROS),
        "LD_LIBRARY_PATH": f"{prefix()}/lib:{ROS}/lib",
        "PYTHONPATH": ":".join(map(str, sorted(ROS.glob("lib/python3*/site-packages")))),
    }


def ros_python() -> Path:
    """The interpreter of this ROS."""
    assert ROS is not None
    own = ROS / "bin/python3"
    return own if own.exists() else Path("/usr/bin/python3")


def compile_on_rclcpp(source: Path, output: Path, *flags: str) -> Path:
    """Build one C++ file with TPC; its static information is in ``static`` beside the output."""
    assert ROS is not None
    kept = {name: value for name, value in os.environ.items() if "TPC" not in name}
    packages = sorted(one for one in (ROS / "include").iterdir() if one.is_dir())
    words = [f"-l{name}" for name in LIBRARIES]
    words += [f"-l{name}__rosidl_typesupport_cpp" for name in MESSAGES]
    done = subprocess.run(
        [
            str(installed("bin/tpc-clang++")),
            *["-std=c++17", "-O2", "-fPIC", *flags, str(source), "-o", str(output)],
            *[word for one in packages for word in ("-isystem", str(one))],
            *[f"-L{ROS}/lib", *words, "-Wl,--allow-shlib-undefined"],
        ],
        cwd=source.parent,
        env={**kept, "TPC_STATIC_INFO": str(output.parent / "static")},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return output
