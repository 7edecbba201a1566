"""Every CMake file that there is: patched, restored, identical.

All of them as bytes; and each CMakeLists.txt that is a project's as a file, copied to a folder of
its own with its mode. Counts are printed, and each file with which something is not as it should.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.progress import track

from pytpc.base.errors import WorkspaceError
from pytpc.base.paths import project_root
from pytpc.workspace.cmake_block import patch_text, restore_text
from pytpc.workspace.cmake_syntax import find_fault
from pytpc.workspace.patch import apply_changes, calls_project, plan_tree

INCLUDED = "/opt/tpc/share/tpc/cmake/tpc.cmake"
ROOTS = ("/usr/share", "/usr/lib", "/opt", str(project_root()))
_LISTS = "CMakeLists.txt"
_BUILD_MARKERS = frozenset({"CMakeCache.txt", ".ninja_log"})


@dataclass
class Tally:
    """How many files there are of each kind, and of which more is to be said."""

    counts: Counter[str] = field(default_factory=Counter)
    failed: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    def add(self, path: Path, data: bytes) -> None:
        """Patch and restore the bytes of one file."""
        self.counts["files"] += 1
        self.counts[kind_of(path)] += 1
        if b"\r\n" in data:
            self.counts["with CRLF"] += 1
        if not data.endswith(b"\n"):
            self.counts["without a final newline"] += 1
        if not _is_utf8(data):
            self.counts["not UTF-8"] += 1
        fault = find_fault(data)
        if fault is not None:
            self.faults.append(f"{path}:{fault.line}: {fault.message}")
        trouble = trouble_with(data)
        if trouble:
            self.failed.append(f"{path}: {trouble}")
        else:
            self.counts["identical"] += 1


def kind_of(path: Path) -> str:
    """``CMakeLists.txt``, ``*.cmake`` or ``*.in``: templates of either."""
    if path.name == _LISTS:
        return _LISTS
    return "*.in" if path.name.endswith(".in") else "*.cmake"


def trouble_with(data: bytes) -> str:
    """Why a file's bytes do not survive the round trip; empty where they do."""
    try:
        patched = patch_text(data, INCLUDED)
        if patched == data:
            return "has the block already"
        if patch_text(patched, INCLUDED) != patched:
            return "is patched twice"
        if (find_fault(data) is None) != (find_fault(patched) is None):
            return "is parsed in another way when it is patched"
        return "" if restore_text(patched) == data else "is another file when it is restored"
    except WorkspaceError as error:
        return error.message


def cmake_files(roots: Iterable[Path]) -> Iterator[Path]:
    """CMake's files below folders, without build folders and version control, each once."""
    seen: set[str] = set()
    for root in roots:
        for here, below, files in os.walk(root):
            if not _BUILD_MARKERS.isdisjoint(files):
                below.clear()
                continue
            below[:] = sorted(name for name in below if name not in (".git", ".venv"))
            for name in sorted(files):
                path = Path(here, name)
                is_ours = name in (_LISTS, f"{_LISTS}.in") or name.endswith((".cmake", ".cmake.in"))
                if is_ours and path.is_file() and (real := os.path.realpath(path)) not in seen:
                    seen.add(real)
                    yield path


def through_files(paths: Sequence[Path]) -> list[str]:
    """The round trip of real files, each in a folder of its own; what is not as it was."""
    with tempfile.TemporaryDirectory(prefix="tpc-round-trip-") as name:
        tree = Path(name)
        copies = {tree / str(number) / _LISTS: path for number, path in enumerate(paths)}
        for copy, path in copies.items():
            copy.parent.mkdir()
            shutil.copy2(path, copy)
        patched, already, _ = plan_tree(tree)
        apply_changes(patched)
        failed = [
            f"{copies[change.path]}: is as it was when it is patched"
            for change in patched
            if change.path.read_bytes() == change.before
        ]
        if len(patched) + already != len(paths):
            failed.append(f"{len(paths)} projects, but {len(patched)} patched and {already} not")
        restored, _, _ = plan_tree(tree, restore=True)
        apply_changes(restored)
        for copy, path in copies.items():
            same_mode = copy.stat().st_mode == path.stat().st_mode
            if copy.read_bytes() != path.read_bytes() or not same_mode:
                failed.append(f"{path}: is another file when it is restored")
        return failed


def main(arguments: Sequence[str] | None = None) -> int:
    """Status 1 where a file does not survive; files that CMake cannot parse are only shown."""
    parser = argparse.ArgumentParser(prog="tools/round-trip", description=__doc__)
    parser.add_argument("folder", nargs="*", type=Path, default=[Path(root) for root in ROOTS])
    roots = parser.parse_args(arguments).folder
    tally = Tally()
    projects: list[Path] = []
    for path in track(list(cmake_files(roots)), "round trip", disable=not sys.stderr.isatty()):
        data = path.read_bytes()
        tally.add(path, data)
        if path.name == _LISTS and find_fault(data) is None and calls_project(data):
            projects.append(path)
    if projects:
        tally.failed += through_files(projects)
    for name, count in tally.counts.items():
        print(f"{count:7,} {name}")
    print(f"{len(projects):7,} projects as files")
    for text in tally.faults:
        print(f"CMake cannot parse it, patched or not: {text}")
    for text in tally.failed:
        print(f"NOT IDENTICAL: {text}")
    return 1 if tally.failed else 0


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True


if __name__ == "__main__":
    sys.exit(main())
