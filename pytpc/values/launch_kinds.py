"""Tells launch files, params files and other YAML of ROS 1 and ROS 2 apart."""

from __future__ import annotations

import re
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.base.source_bytes import read_bytes
from pytpc.values.rcl_params import is_params_text

_YAML = (".yaml", ".yml")
# `launch:` with a list below it, behind comments and empty lines.
_YAML_LAUNCH = re.compile(
    rb"^launch[ \t]*:[ \t]*(?:\[|(?:#[^\n]*)?\r?\n(?:[ \t]*(?:#[^\n]*)?\r?\n)*[ \t]*-)",
    re.MULTILINE,
)
_XML_OF_ROS2 = re.compile(
    rb"\sexec\s*=|\$\((?:var|find-pkg-share|find-pkg-prefix)\b"
    rb"|<(?:let|executable|set_parameter|set_parameters_from_file|push[_-]ros[_-]namespace"
    rb"|node_container|load_composable_node|composable_node|set_remap|set_use_sim_time)\b"
)


def is_ros2_launch(path: Path) -> bool:
    """Whether a path is that of a launch file of ROS 2: Python, or XML or YAML that looks so."""
    suffix = path.suffix.lower()
    if suffix == ".py":
        return True
    if suffix not in (".xml", ".launch", *_YAML) or not path.is_file():
        return False
    try:
        data = read_bytes(path)
    except InputError:
        return False
    return (_YAML_LAUNCH if suffix in _YAML else _XML_OF_ROS2).search(data) is not None


def is_yaml(path: Path) -> bool:
    """Whether a path names a YAML file that is no launch file."""
    return path.suffix.lower() in _YAML and not is_ros2_launch(path)


def is_of_ros2(path: Path) -> bool:
    """Whether a path is that of a params file or a launch file of ROS 2."""
    if is_ros2_launch(path):
        return True
    try:
        return is_yaml(path) and is_params_text(read_bytes(path).decode("utf-8", "replace"))
    except InputError:
        return False
