"""Looking at a workspace, for ``doctor.workspace``: reads files, changes nothing."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

from pytpc.base.errors import InputError, WorkspaceError
from pytpc.base.paths import OWN_FOLDER, ROS_PREFIXES, prefix
from pytpc.workspace.doctor.workspace import BuildFolder, Known, SeenPackage, SeenWorkspace
from pytpc.workspace.packages import (
    MANIFEST,
    Manifest,
    package_folders,
    read_list_file,
    read_manifest,
)

_CACHE = "CMakeCache.txt"
_CACHE_LINE = re.compile(r"^(\w+):\w+=(.*)$", re.MULTILINE)
# The deepest is that of a package in the workspace's own: .tpc, build, package.
_BUILD_DEPTH = 3
_ODD_NAMES = 20


def look_at_workspace(workspace: Path) -> SeenWorkspace:
    """What is there now.

    Raises:
        WorkspaceError: no such folder.
        MissingToolError: catkin_pkg is not installed.
    """
    if not workspace.is_dir():
        raise WorkspaceError("no such folder", workspace)
    folder = workspace.absolute()
    return SeenWorkspace(
        folder,
        [_look_at_package(found) for found in package_folders(folder)],
        list(_build_folders(folder)),
        _odd_names(folder),
        os.access(folder, os.W_OK | os.X_OK),
    )


def look_at_known(workspace: Path) -> Known:
    """What there is outside of a workspace: in CMake's prefixes, and by apt and dpkg."""
    listed = [
        folder
        for variable in ("CMAKE_PREFIX_PATH", "AMENT_PREFIX_PATH")
        for folder in os.environ.get(variable, "").split(os.pathsep)
        if folder
    ]
    prefixes = [*map(Path, listed), *ROS_PREFIXES]
    shares = [path for one in prefixes for path in (one / "share").glob(f"*/{MANIFEST}")]
    installed = _lines(["dpkg-query", "-W", "-f", "${Package} ${db:Status-Status}\n"])
    return Known(
        packages=frozenset(path.parent.name for path in shares),
        debian=frozenset(_lines(["apt-cache", "pkgnames"])),
        installed=frozenset(line.split()[0] for line in installed if line.endswith(" installed")),
        cmake_file=str(prefix() / "share/tpc/cmake/tpc.cmake"),
        own_builds=workspace.absolute() / OWN_FOLDER,
    )


def read_cache(text: str, folder: Path) -> BuildFolder:
    """What a CMakeCache.txt says of its build folder."""
    values = dict(_CACHE_LINE.findall(text))
    return BuildFolder(
        folder,
        Path(values.get("CMAKE_HOME_DIRECTORY", "")),
        values.get("CMAKE_CXX_COMPILER") or values.get("CMAKE_C_COMPILER", ""),
        values.get("CMAKE_TOOLCHAIN_FILE", ""),
    )


def _look_at_package(folder: Path) -> SeenPackage:
    path = folder / "CMakeLists.txt"
    manifest: Manifest | InputError
    lists: bytes | InputError | None
    try:
        manifest = read_manifest(folder)
    except InputError as fault:
        manifest = fault
    try:
        lists = read_list_file(path)
        if lists is None and path.is_symlink():
            lists = InputError("a symbolic link that leads nowhere", path)
    except InputError as fault:
        lists = fault
    return SeenPackage(folder, manifest, lists, os.access(folder, os.W_OK | os.X_OK))


def _build_folders(workspace: Path) -> Iterator[BuildFolder]:
    for here, below, files in os.walk(workspace):
        folder = Path(here)
        if _CACHE in files:
            below.clear()
            yield read_cache((folder / _CACHE).read_text("utf-8", "replace"), folder)
        elif len(folder.relative_to(workspace).parts) >= _BUILD_DEPTH:
            below.clear()
        below[:] = sorted(name for name in below if name == OWN_FOLDER or not name.startswith("."))


def _odd_names(workspace: Path) -> list[str]:
    """Paths with names that are not UTF-8, at most twenty, shown with escapes."""
    found: list[str] = []
    for here, below, files in os.walk(workspace):
        below[:] = sorted(name for name in below if not name.startswith("."))
        for name in sorted([*below, *files]):
            try:
                name.encode()
            except UnicodeEncodeError:
                path = os.fsencode(Path(here) / name)
                found.append(path.decode("utf-8", "backslashreplace"))
                if len(found) == _ODD_NAMES:
                    return found
    return found


def _lines(command: list[str]) -> list[str]:
    """What a program says; nothing where it is not there or fails."""
    try:
        ran = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False
        )
    except OSError:
        return []
    return ran.stdout.splitlines()
