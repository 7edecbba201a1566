"""Refuses to build a folder inside a workspace, most often its ``src``, as a workspace."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator
from pathlib import Path

from pytpc.base.errors import WorkspaceError
from pytpc.base.paths import MERGED_FILE, OWN_FOLDER
from pytpc.workspace.packages import IGNORE_MARKERS, MANIFEST, is_searched, read_manifest

_ROOT_MARKS = (".catkin_workspace", ".catkin_tools")
"""What catkin_make and catkin_tools leave in the root of a workspace."""


def refuse_inside(folder: Path) -> None:
    """Check that a folder is not a part of a workspace.

    It is one if a folder above it, to whose packages it belongs, was built by `pytpc build`; or if
    it is called ``src`` and is no package. A folder with another name that was built itself is a
    workspace. The root of a machine, a home and a package are no workspaces to be a part of.

    Raises:
        WorkspaceError: it is; the message has the commands that build the workspace, and that
            build this folder all the same.
    """
    workspace = _workspace_above(folder.absolute())
    if workspace is None:
        return
    shown = _as_given(folder, workspace)
    build = f"pytpc build {shlex.quote(str(shown))}"
    if (folder / MANIFEST).is_file():
        build += f" --package {shlex.quote(read_manifest(folder).name)}"
    base = shlex.quote(str(folder / OWN_FOLDER))
    raise WorkspaceError(
        f"is inside the workspace {shown}; type: {build} (or, to build this folder as a workspace"
        f" of its own: pytpc build {shlex.quote(str(folder))} --base {base})",
        folder,
    )


def _workspace_above(folder: Path) -> Path | None:
    """The workspace of which the folder is a part."""
    if folder.name != "src" and (folder / OWN_FOLDER / MERGED_FILE).is_file():
        return None
    not_one = {Path("/"), Path(os.environ.get("HOME") or "/")}
    for above in _holders(folder):
        if (above / OWN_FOLDER / MERGED_FILE).is_file() and above not in not_one:
            return above
    above = folder.parent
    if folder.name != "src" or (folder / MANIFEST).is_file() or (folder / OWN_FOLDER).is_dir():
        return None
    if any((above / mark).exists() for mark in _ROOT_MARKS):
        return above
    return None if above in not_one or (above / MANIFEST).exists() else above


def _holders(folder: Path) -> Iterator[Path]:
    """The folders above in whose packages those of this folder are, the nearest first."""
    while folder.parent != folder and is_searched(folder):
        if any((folder / marker).exists() for marker in IGNORE_MARKERS):
            return
        folder = folder.parent
        if (folder / MANIFEST).is_file():
            # Packages do not nest.
            return
        yield folder


def _as_given(folder: Path, workspace: Path) -> Path:
    """The workspace as the user would type it."""
    above = folder
    while above.absolute() != workspace:
        if above == above.parent:
            return workspace
        above = above.parent
    return above
