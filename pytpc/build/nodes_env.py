"""The environment in which the nodes of a workspace run.

It is that of the install space, and before it the devel space of the build, where each package is
its source folder: a changed launch file, YAML file or script is used without a build.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from pytpc.build.build import installed, workspace_env
from pytpc.build.devel_space import package_places
from pytpc.workspace.colcon import Bases

DEVEL = "TPC_DEVEL"
"""The variable that names the devel space which an environment has."""
_PACKAGES = "ROS_PACKAGE_PATH"
# Python that runs from the sources would write its bytecode there. Any text means yes.
_NO_BYTECODE = ("PYTHONDONTWRITEBYTECODE", "tpc")


def nodes_env(workspace: Path, begin: Mapping[str, str] | None = None) -> dict[str, str]:
    """The environment for the nodes of a built workspace.

    Args:
        workspace: built by ``pytpc build``, or with an install or devel space of its own, which is
            then taken as it is.
        begin: the environment in which its set-up script is sourced; see ``workspace_env``.

    Raises:
        WorkspaceError: it is not built.
        RunError: the set-up script fails.
    """
    bases, prefix = Bases.of(workspace), installed(workspace)
    env = workspace_env(prefix, begin)
    return with_devel_space(env, bases.devel) if prefix == bases.install else env


def with_devel_space(env: Mapping[str, str], devel: Path) -> dict[str, str]:
    """The environment with a devel space in front; unchanged if there is no such space."""
    devel = devel.absolute()
    places = package_places(devel)
    if not places:
        return dict(env)
    changed = without_devel_space(env)
    for name, folders in _folders(devel, places).items():
        if folders:
            changed[name] = _joined([*folders, *_others(changed, name, folders)])
    changed[DEVEL] = str(devel)
    name, value = _NO_BYTECODE
    changed.setdefault(name, value)
    return changed


def without_devel_space(env: Mapping[str, str]) -> dict[str, str]:
    """The environment that ``with_devel_space`` was given."""
    changed = dict(env)
    named = changed.pop(DEVEL, "")
    if not named:
        return changed
    devel = Path(named)
    for name, folders in _folders(devel, package_places(devel)).items():
        rest = _joined(_others(changed, name, folders))
        if rest:
            changed[name] = rest
        else:
            changed.pop(name, None)
    name, value = _NO_BYTECODE
    if changed.get(name) == value:
        del changed[name]
    return changed


def _folders(devel: Path, places: Sequence[str]) -> dict[str, list[str]]:
    """What a devel space adds to each list of folders."""
    found: dict[str, list[Path]] = {
        "CMAKE_PREFIX_PATH": [devel],
        "LD_LIBRARY_PATH": [devel / "lib"],
        "PATH": [devel / "bin"],
        "PYTHONPATH": sorted(devel.glob("lib/python*/*-packages")),
    }
    lists = {name: [str(one) for one in some if one.is_dir()] for name, some in found.items()}
    return {**lists, _PACKAGES: list(places)}


def _others(env: Mapping[str, str], name: str, folders: Iterable[str]) -> list[str]:
    # An empty one is the current folder for some of their readers.
    given = env[name].split(os.pathsep) if env.get(name) else []
    taken = set(folders)
    return [folder for folder in given if folder not in taken]


def _joined(folders: Iterable[str]) -> str:
    return os.pathsep.join(folders)
