"""Finds and reads declarations of parameters: in ``.cfg`` files, and in recorded messages.

``read_declared`` is the entrance. It reads the ``.cfg`` files of dynamic_reconfigure below folders
of sources, and the descriptions that its servers published, where a bag has them. Descriptors of
ROS 2 are not read: they exist in the running program only, and no topic carries them.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

from pytpc.ingest.declared_bag import read_declared_bag
from pytpc.recording.declaration import Declared
from pytpc.static.static_info import StaticInfo
from pytpc.values.declared_cfg import read_cfg

_LARGEST_FILE = 1 << 20
_NOT_SOURCES = frozenset({"build", "devel", "install", "log", "node_modules", "__pycache__"})
_GENERATOR = b"ParameterGenerator"


def read_declared(
    paths: Iterable[Path], on_skipped: Callable[[str], None] | None = None
) -> list[Declared]:
    """The declarations in files and below folders, in the order of the paths.

    Args:
        paths: ``.cfg`` files, ROS 1 bags, and folders that have such files: sources (hidden and
            build folders are skipped) or a recorded mission. A path that does not exist has none.
        on_skipped: called with one line for each declaration or file that could not be read.
    """
    found: list[Declared] = []
    for path in dict.fromkeys(file for given in paths for file in _files(given)):
        try:
            some, skipped = _read(path)
        except OSError as error:
            some, skipped = [], [f"{path}: {error.strerror or error}"]
        found += some
        for line in skipped if on_skipped is not None else ():
            on_skipped(line)  # type: ignore[misc]
    return found


def declared_in(
    static_info: StaticInfo,
    recordings: Iterable[Path] = (),
    on_skipped: Callable[[str], None] | None = None,
) -> list[Declared]:
    """The declarations in the packages of ``static_info``, and in what was recorded."""
    roots = sorted({Path(unit.source_root) for unit in static_info.units})
    tops = [root for root in roots if not any(above in roots for above in root.parents)]
    return read_declared([*tops, *recordings], on_skipped)


def _read(path: Path) -> tuple[list[Declared], list[str]]:
    """The declarations of one file, and a line for each that could not be read.

    Raises:
        OSError: the file cannot be read.
    """
    if path.suffix == ".bag":
        return read_declared_bag(path)
    if path.stat().st_size > _LARGEST_FILE:
        return [], [f"{path}: too large"]
    text = path.read_bytes()
    if _GENERATOR not in text:
        return [], []
    found, skipped = read_cfg(text, path)
    package = str(_package_of(path))
    return [replace(one, package=package) for one in found], skipped


def _files(path: Path) -> list[Path]:
    if path.is_file():
        return [path]
    found = []
    for folder, below, files in os.walk(path):
        below[:] = sorted(b for b in below if not b.startswith(".") and b not in _NOT_SOURCES)
        found += [Path(folder, name) for name in sorted(files) if name.endswith((".cfg", ".bag"))]
    return found


def _package_of(source: Path) -> Path:
    """The folder of the package that a file belongs to; its own folder if there is no package."""
    above = (folder for folder in source.parents if (folder / "package.xml").is_file())
    return next(above, source.parent)
