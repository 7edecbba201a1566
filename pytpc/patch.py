"""Patching a workspace: TPC's block into every package's CMakeLists.txt, and out again.

All files are read, checked and written beside the old ones before the first is replaced, so that a
workspace is never half patched. What a file needs to be is worked out in ``pytpc.cmake_block``.

Commands: ``python -m pytpc.patch``, ``pytpc patch`` and ``modify_cmakelists.py``.
"""

from __future__ import annotations

import argparse
import contextlib
import difflib
import os
import re
import stat
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from pytpc.atomic import stage_beside
from pytpc.cmake_block import patch_text, restore_text
from pytpc.errors import InputError, TpcError, WorkspaceError
from pytpc.paths import cmake_file
from pytpc.workspace import Package, find_packages, read_cmakelists, select_packages

__all__ = ["Change", "apply_changes", "diff", "main", "patch_text", "plan", "restore_text", "run"]


@dataclass(frozen=True, slots=True)
class Change:
    """What a patch does to one file.

    ``path`` is the place within the workspace, ``real`` the file behind its symbolic links.
    """

    path: Path
    real: Path
    before: bytes
    after: bytes


def plan(
    workspace: Path, *, restore: bool = False, packages: Iterable[str] = ()
) -> tuple[list[Change], int]:
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
        InputError: a package.xml or CMakeLists.txt that is broken, with file and line.
        MissingToolError: TPC's C++ half is not installed (for patching only).
    """
    chosen = select_packages(find_packages(workspace), packages)
    included = "" if restore else str(cmake_file())
    changes: dict[Path, Change] = {}
    as_they_should_be: set[Path] = set()
    for package in chosen:
        before = _read_as_is(package) if restore else read_cmakelists(package)
        if before is None:
            continue
        path = package.cmakelists
        try:
            after = restore_text(before) if restore else patch_text(before, included)
        except WorkspaceError as error:
            raise WorkspaceError(error.message, path, error.line) from error
        real = path.resolve()
        if before == after:
            as_they_should_be.add(real)
        else:
            changes.setdefault(real, Change(path, real, before, after))
    return list(changes.values()), len(as_they_should_be)


def apply_changes(changes: Sequence[Change]) -> None:
    """Write the changes: all or none.

    Mode and, where permitted, owner of each file stay, and so do symbolic links to it.

    Raises:
        WorkspaceError: a file cannot be written; then every file is as it was.
    """
    staged: list[Path] = []
    replaced: list[Change] = []
    try:
        for change in changes:
            staged.append(_stage(change, change.after))
        for change, new in zip(changes, staged, strict=True):
            replaced.append(change)
            new.replace(change.real)
    except BaseException as error:
        for change in replaced:
            _stage(change, change.before).replace(change.real)
        for new in staged:
            new.unlink(missing_ok=True)
        if isinstance(error, OSError):
            at_fault = changes[len(staged)] if len(staged) < len(changes) else replaced[-1]
            raise WorkspaceError(
                f"cannot be written: {error.strerror}; no file was changed", at_fault.path
            ) from error
        raise


def diff(change: Change, workspace: Path) -> bytes:
    """The change as a unified diff that ``patch -p1`` takes in the workspace."""
    try:
        shown = change.path.relative_to(workspace)
    except ValueError:
        shown = change.path
    name = os.fsencode(shown)
    lines = difflib.diff_bytes(
        difflib.unified_diff,
        _lines(change.before),
        _lines(change.after),
        b"a/" + name,
        b"b/" + name,
    )
    ended = (
        line if line.endswith(b"\n") else line + b"\n\\ No newline at end of file\n"
        for line in lines
    )
    return b"".join(ended)


def run(
    workspace: Path, *, restore: bool = False, dry_run: bool = False, packages: Iterable[str] = ()
) -> None:
    """Plan, then show the diff or write, and say on standard output what was done.

    Raises:
        TpcError: as ``plan`` and ``apply_changes``.
    """
    changes, unchanged = plan(workspace, restore=restore, packages=packages)
    if dry_run:
        sys.stdout.flush()
        sys.stdout.buffer.write(b"".join(diff(change, workspace) for change in changes))
        sys.stdout.buffer.flush()
        return
    apply_changes(changes)
    done = "restored" if restore else "patched"
    for change in changes:
        print(f"{done} {change.path}")
    already = f", {unchanged} already {'without' if restore else 'with'} the block"
    print(f"{len(changes)} {done}{already if unchanged else ''}")


def main(arguments: Sequence[str] | None = None, program: str = "python -m pytpc.patch") -> int:
    """The command line; it needs no package from outside Debian, unlike ``pytpc``.

    Returns:
        The exit status: 0, 1 after an error that was shown as one line, 130 when interrupted.
    """
    parser = argparse.ArgumentParser(
        prog=program,
        description="Put TPC's three lines at the top of each package's CMakeLists.txt,"
        " or take them out again.",
    )
    parser.add_argument("workspace", type=Path, help="folder with ROS packages")
    parser.add_argument("--restore", action="store_true", help="take the lines out again")
    parser.add_argument("--dry-run", action="store_true", help="only show the difference")
    parser.add_argument(
        "--package", action="append", default=[], metavar="NAME", help="only this one (repeatable)"
    )
    chosen = parser.parse_args(arguments)
    try:
        run(
            chosen.workspace,
            restore=chosen.restore,
            dry_run=chosen.dry_run,
            packages=chosen.package,
        )
    except TpcError as error:
        print(f"pytpc: error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0


def _read_as_is(package: Package) -> bytes | None:
    """Unchecked: a file that was broken after it was patched can still be restored."""
    try:
        return package.cmakelists.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", package.cmakelists) from error


def _stage(change: Change, data: bytes) -> Path:
    status = change.real.stat()
    staged = stage_beside(change.real, data)
    try:
        if (status.st_uid, status.st_gid) != (os.geteuid(), os.getegid()):
            with contextlib.suppress(PermissionError):
                os.chown(staged, status.st_uid, status.st_gid)
        staged.chmod(stat.S_IMODE(status.st_mode))
    except BaseException:
        staged.unlink()
        raise
    return staged


def _lines(data: bytes) -> list[bytes]:
    """Lines as diff and patch count them: a carriage return alone ends none."""
    return re.findall(rb"[^\n]*\n|[^\n]+", data)


if __name__ == "__main__":
    sys.exit(main())
