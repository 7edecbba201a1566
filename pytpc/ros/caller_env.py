"""What a mission's nodes get of the environment of the shell in which `pytpc record` is typed."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping

_PREFIXES = "CMAKE_PREFIX_PATH"
# Lists of folders, of which all entries are taken.
_WHOLE_LISTS = (_PREFIXES, "ROS_PACKAGE_PATH", "LD_LIBRARY_PATH")
# Of these, only the entries of sourced workspaces: a Python that is not ROS's breaks nodes.
_SOURCED_LISTS = ("PYTHONPATH", "PATH")
# What belongs to the shell, to its Python, to another graph, or to the build.
_NOT_TAKEN = re.compile(
    r"ROS_|TPC_|PYTHON|PYTEST|COV|LD_|VIRTUAL_ENV|CONDA|BASH_FUNC_|BASH_ENV|COLCON_|AMENT_|CATKIN_"
    r"|PKG_CONFIG|(_|SHLVL|PWD|OLDPWD|PS[0-9]|LINES|COLUMNS|TMPDIR)$"
)


def with_callers(env: Mapping[str, str], caller: Mapping[str, str]) -> dict[str, str]:
    """The environment ``env`` of a workspace, and behind it what the caller's shell has sourced.

    A launch file may need packages of another workspace that was sourced (ROS_PACKAGE_PATH,
    CMAKE_PREFIX_PATH), the variables that it names (``$(env ROBOT)``), and the screen (DISPLAY).
    What ``env`` has comes first.
    """
    prefixes = _entries(caller, _PREFIXES)
    given = {
        name: value
        for name, value in caller.items()
        if name not in (*_WHOLE_LISTS, *_SOURCED_LISTS) and not _NOT_TAKEN.match(name)
    }
    found = {**given, **env}
    for name in (*_WHOLE_LISTS, *_SOURCED_LISTS):
        added = _entries(caller, name)
        if name in _SOURCED_LISTS:
            added = [one for one in added if any(one.startswith(f"{root}/") for root in prefixes)]
        joined = list(dict.fromkeys([*_entries(env, name), *added]))
        if joined:
            found[name] = os.pathsep.join(joined)
    return found


def _entries(env: Mapping[str, str], name: str) -> list[str]:
    return [entry for entry in env.get(name, "").split(os.pathsep) if entry]
