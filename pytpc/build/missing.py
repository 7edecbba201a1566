"""What a package of ROS 2 lacks, from the output of a build that failed.

A package that is not installed shows in three ways: CMake has no file for it, a header is missing
(ament_cmake_auto skips what it does not find), or a Python module. On a machine with ROS 1, CMake
may also have found the package of ROS 1 that has the same name.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from pathlib import Path

from pytpc.workspace.packages import Package
from pytpc.workspace.ros2 import Ros2

_SAID = (
    re.compile(r'configuration file provided by "(?P<name>[\w-]+)"'),
    re.compile(r'By not providing "Find(?P<name>[\w-]+)\.cmake"'),
    re.compile(r"fatal error: '?(?P<name>\w+)/[\w./-]+'?(?:: No such file| file not found)"),
    re.compile(r"No module named '(?P<name>\w+)"),
)
_ROS1 = "share/{}/package.xml"


def missing_package(tail: Iterable[str], needs: Collection[str]) -> str:
    """The package that the first such message of a build's output is about; empty without one.

    Args:
        tail: lines of the output.
        needs: the packages that the manifest names: another folder of headers is no package.
    """
    text = "\n".join(tail)
    found = (match for pattern in _SAID for match in pattern.finditer(text))
    first = min(found, key=lambda match: match.start(), default=None)
    if first is None:
        return ""
    name = first["name"]
    is_header = first.re is _SAID[2]
    return "" if is_header and name not in needs else name


def hint(package: Package, tail: Iterable[str], ros2: Ros2 | None, source: str) -> str:
    """What to say of a package of ROS 2 that does not build; empty if nothing is known.

    Args:
        package: the one that failed.
        tail: the end of its output.
        ros2: what it was built for.
        source: the command that gives a shell a ROS 2.
    """
    name = missing_package(tail, package.needs) if package.ros == "2" else ""
    if not name or (ros2 is not None and ros2.has(name)):
        return ""
    what = f"{name} of ROS 2 is not installed"
    if (Path("/usr") / _ROS1.format(name)).is_file():
        what += ", and the one in /usr is not for it"
    if ros2 is None or not ros2.is_sourced:
        what += f"; a ROS 2 was not sourced: {source}"
    key = f" (rosdep's key {name})" if name in package.needs else ""
    return f"{what}; or: rosdep install --ignore-src --from-paths {package.path}{key}"
