"""Finds launch files and executables of packages of ROS 2, as `ros2 launch` and `ros2 run` do."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path

from pytpc.base.closest import did_you_mean
from pytpc.base.errors import RunError
from pytpc.base.wording import listed
from pytpc.workspace.ros2 import AMENT, MARKERS

_LAUNCH_NAMES = (".launch.py", ".launch.xml", ".launch.yaml", ".launch.yml")
_LAUNCH_TYPES = (".py", ".xml", ".yaml", ".yml", ".launch")
_LISTED = 8


def find_in_package(env: Mapping[str, str], package: str, name: str) -> tuple[Path, bool]:
    """The launch file or executable of this name, and whether it is a launch file.

    Args:
        env: the environment of the workspace, whose AMENT_PREFIX_PATH has the packages.
        package: its name.
        name: of a file anywhere below its share folder, or of an executable.

    Raises:
        RunError: there is no such package or file, or several.
    """
    prefix = _prefix(env, package)
    launches = list(_launch_files(prefix / "share" / package))
    found = [path for path in launches if path.name == name]
    if len(found) == 1:
        return found[0], True
    if found:
        places = listed([str(path) for path in found], _LISTED)
        raise RunError(f"package {package} has several {name}: {places}; give one by its path")
    program = prefix / "lib" / package / name
    if program.is_file() and os.access(program, os.X_OK):
        return program, False
    names = [*_short({path.name for path in launches}), *sorted(_programs(prefix, package))]
    hint = did_you_mean(name, names) or f"; it has {listed(names, _LISTED) or 'none'}"
    raise RunError(f"package {package} has no launch file or executable {name}{hint}")


def find_program(env: Mapping[str, str], package: str, word: str) -> Path:
    """The executable that a word names, which may be PACKAGE/EXECUTABLE of another package.

    Raises:
        RunError: there is none.
    """
    other, slash, name = word.rpartition("/")
    found, is_launch = find_in_package(env, other if slash else package, name)
    if is_launch:
        raise RunError("a launch file is run by itself, without other executables", found)
    return found


def _prefix(env: Mapping[str, str], package: str) -> Path:
    prefixes = [Path(one) for one in env.get(AMENT, "").split(os.pathsep) if one]
    for prefix in prefixes:
        if (prefix / MARKERS / package).is_file():
            return prefix
    known = {path.name for prefix in prefixes for path in (prefix / MARKERS).glob("*")}
    raise RunError(
        f"no package {package} in the workspace and those that are sourced"
        f"{did_you_mean(package, sorted(known)) or '; build it: pytpc build WORKSPACE'}"
    )


def _launch_files(share: Path) -> Iterator[Path]:
    """All files that may be launch files, by their paths."""
    yield from sorted(
        path for path in share.rglob("*") if path.suffix in _LAUNCH_TYPES and path.is_file()
    )


def _short(names: set[str]) -> list[str]:
    """Those that are most likely meant as launch files."""
    return sorted(name for name in names if name.endswith(_LAUNCH_NAMES))


def _programs(prefix: Path, package: str) -> Iterator[str]:
    for path in (prefix / "lib" / package).glob("*"):
        if path.is_file() and os.access(path, os.X_OK):
            yield path.name
