"""Patching a workspace: TPC's block into every package's CMakeLists.txt, and out again.

All files are read, checked and written beside the old ones before the first is replaced, so that a
workspace is never half patched. ``pytpc.workspace.cmake_block`` edits the bytes of a file.

A run that was killed between two files leaves the first ones patched; the next run does the others
and removes what the killed one had written beside them.

``pytpc patch`` and ``modify_cmakelists.py`` call ``run``.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from pytpc.base.atomic import leftovers, stage_like
from pytpc.base.closest import no_folder
from pytpc.base.diff import unified_diff
from pytpc.base.errors import InputError, WorkspaceError
from pytpc.base.paths import cmake_file
from pytpc.workspace.cmake_block import MARKER, patch_text, restore_text
from pytpc.workspace.cmake_syntax import commands
from pytpc.workspace.packages import (
    IGNORE_MARKERS,
    MANIFEST,
    PRODUCT_MARKERS,
    check_syntax,
    find_packages,
    read_cmakelists,
    read_list_file,
    select_packages,
)

_LIST_FILE = "CMakeLists.txt"


@dataclass(frozen=True, slots=True)
class ListFileChange:
    """The change of one CMakeLists.txt.

    ``path`` is the place within the workspace, ``real`` the file behind its symbolic links.
    """

    path: Path
    real: Path
    before: bytes
    after: bytes


def plan(
    workspace: Path, *, restore: bool = False, packages: Iterable[str] = ()
) -> tuple[list[ListFileChange], int]:
    """Work out what a patch, or its reverse, has to change; nothing is written.

    A file that several packages share through symbolic links is changed once.

    Args:
        workspace: folder with packages.
        restore: take the blocks out instead of putting them in.
        packages: names; all where empty.

    Returns:
        The changes, sorted by path, and the number of files that are already as they should be.

    Raises:
        WorkspaceError: no packages, an unknown name, or a block that was edited by hand.
        InputError: a package.xml or CMakeLists.txt that is broken, with file and line, or one
            that does not call project() itself (for patching only).
        MissingToolError: TPC's C++ half is not installed (for patching only).
    """
    chosen = select_packages(find_packages(workspace), packages)
    files = [
        (package.cmakelists, before)
        for package in chosen
        # A file that was broken after it was patched can still be restored.
        if (before := read_list_file(package.cmakelists) if restore else read_cmakelists(package))
        is not None
    ]
    return _plan_files(files, restore=restore)


def plan_tree(
    folder: Path, *, restore: bool = False
) -> tuple[list[ListFileChange], int, list[Path]]:
    """The same for any folder: each CMakeLists.txt below it that calls project().

    Hidden folders, build folders and folders with ``COLCON_IGNORE`` or its like are skipped.

    Returns:
        As ``plan``, and the files that are left alone because they are symbolic links to one
        outside of the folder, which is not the user's (the toplevel file of catkin_make).

    Raises:
        WorkspaceError: no such folder, no such file in it, or a block that was edited by hand.
        InputError: a file that is broken, with its line, or a package's without project().
        MissingToolError: TPC's C++ half is not installed (for patching only).
    """
    if not folder.is_dir():
        raise WorkspaceError(no_folder(folder), folder)
    files: list[tuple[Path, bytes]] = []
    foreign: list[Path] = []
    top = folder.resolve()
    for path in _list_files(folder):
        if path.is_symlink() and not path.resolve().is_relative_to(top):
            foreign.append(path)
            continue
        before = read_list_file(path)
        is_package = (path.parent / MANIFEST).is_file()
        if before is not None and (is_package or calls_project(before) or MARKER.search(before)):
            if not restore:
                check_syntax(before, path)
            files.append((path, before))
    if not files and not restore:
        raise WorkspaceError("no CMakeLists.txt with project() in this folder or below", folder)
    return (*_plan_files(files, restore=restore), foreign)


def calls_project(data: bytes) -> bool:
    """Whether a list file calls project() itself; CMake wants that of a top-level one."""
    return any(command.name == "project" for command in commands(data))


def apply_changes(changes: Sequence[ListFileChange]) -> None:
    """Write the changes: all or none.

    Mode and, where permitted, owner of each file stay, and so do symbolic links to it.

    Raises:
        WorkspaceError: a file cannot be written, or was changed since it was read; then every
            file is as it was, or the message says which is not.
    """
    staged: list[Path] = []
    replaced: list[ListFileChange] = []
    try:
        for change in changes:
            staged.append(stage_like(change.real, change.after))
        for change, new in zip(changes, staged, strict=True):
            replaced.append(change)
            if change.real.read_bytes() != change.before:
                replaced.pop()
                raise WorkspaceError("changed meanwhile; no file was written", change.path)
            new.replace(change.real)
    except BaseException as error:
        stuck = [change for change in replaced if not _put_back(change)]
        for new in staged:
            with contextlib.suppress(OSError):
                new.unlink(missing_ok=True)
        if isinstance(error, OSError):
            at_fault = changes[len(staged)] if len(staged) < len(changes) else replaced[-1]
            done = f"still changed: {stuck[0].path}" if stuck else "no file was changed"
            raise WorkspaceError(
                f"cannot be written: {error.strerror}; {done}", at_fault.path
            ) from error
        raise


def _put_back(change: ListFileChange) -> bool:
    """Whether the file has its old content again, or still."""
    try:
        if change.real.read_bytes() != change.before:
            stage_like(change.real, change.before).replace(change.real)
    except OSError:
        return False
    return True


def diff(change: ListFileChange, workspace: Path) -> bytes:
    """The change as a unified diff that ``patch -p1`` takes in the workspace."""
    try:
        shown = change.path.relative_to(workspace)
    except ValueError:
        shown = change.path
    return unified_diff(os.fsencode(shown), change.before, change.after)


def run(
    workspace: Path,
    *,
    restore: bool = False,
    dry_run: bool = False,
    packages: Iterable[str] = (),
    any_tree: bool = False,
) -> None:
    """Plan, then show the diff or write, and say on standard output what was done.

    Args:
        workspace: folder with packages; with ``any_tree`` any folder, as for ``plan_tree``.
        restore: take the blocks out.
        dry_run: write nothing.
        packages: names; all where empty.
        any_tree: see above; then without ``packages``.

    Raises:
        TpcError: as ``plan``, ``plan_tree`` and ``apply_changes``.
    """
    with _alone(workspace):
        foreign: list[Path] = []
        if any_tree:
            changes, unchanged, foreign = plan_tree(workspace, restore=restore)
        else:
            changes, unchanged = plan(workspace, restore=restore, packages=packages)
        if dry_run:
            sys.stdout.flush()
            sys.stdout.buffer.write(b"".join(diff(change, workspace) for change in changes))
            sys.stdout.buffer.flush()
            return
        for path in {*_list_files(workspace), *(change.real for change in changes)}:
            for left in leftovers(path):
                with contextlib.suppress(OSError):
                    left.unlink()
        apply_changes(changes)
    done = "restored" if restore else "patched"
    for change in changes:
        print(f"{done} {change.path}")
    for path in foreign:
        print(f"left alone {path}, a link to {path.resolve()}")
    already = f", {unchanged} already {'without' if restore else 'with'} the block"
    print(f"{len(changes)} {done}{already if unchanged else ''}")


@contextlib.contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Wait until no other patch is at work in the folder; where it cannot be locked, do not."""
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError):
            descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
            stack.callback(os.close, descriptor)
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield


def _plan_files(
    files: Iterable[tuple[Path, bytes]], *, restore: bool
) -> tuple[list[ListFileChange], int]:
    included = "" if restore else str(cmake_file())
    changes: dict[Path, ListFileChange] = {}
    as_they_should_be: set[Path] = set()
    for path, before in files:
        if not restore and not calls_project(before):
            raise InputError(
                "does not call project() itself, as CMake wants it of a package's file; add"
                " project(NAME) behind cmake_minimum_required()",
                path,
            )
        try:
            after = restore_text(before) if restore else patch_text(before, included)
        except WorkspaceError as error:
            raise WorkspaceError(error.message, path, error.line) from error
        real = path.resolve()
        if before == after:
            as_they_should_be.add(real)
        else:
            changes.setdefault(real, ListFileChange(path, real, before, after))
    return list(changes.values()), len(as_they_should_be)


def _list_files(folder: Path) -> Iterator[Path]:
    """The files CMakeLists.txt below a folder, sorted, without those of build folders."""
    for here, below, files in os.walk(folder):
        if "CMakeCache.txt" in files or not (IGNORE_MARKERS | PRODUCT_MARKERS).isdisjoint(files):
            below.clear()
            continue
        below[:] = sorted(name for name in below if not name.startswith("."))
        if _LIST_FILE in files:
            yield Path(here, _LIST_FILE)
