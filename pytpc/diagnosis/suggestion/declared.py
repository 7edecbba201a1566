"""What is declared of a parameter: its type, range and step (dynamic_reconfigure, descriptors).

``read_declared`` is the entrance. Read are dynamic_reconfigure's ``.cfg`` files below folders of
sources, and the descriptions that its servers publish, where a bag has them. Descriptors of ROS 2
are not read: they stand in the program, and no topic has them.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from pytpc.diagnosis.ranking.blame import Accused
from pytpc.diagnosis.ranking.ranking import Suspect
from pytpc.ingest.declared_bag import is_bag, read_bag
from pytpc.recording.declaration import Declared
from pytpc.static.parameters import same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc.values.declared_cfg import read_cfg

__all__ = ["Declared", "declared_for", "declared_in", "read_declared"]

_LARGEST_FILE = 1 << 20
_NOT_SOURCES = frozenset({"build", "devel", "install", "log", "node_modules", "__pycache__"})
_GENERATOR = b"ParameterGenerator"


def read_declared(
    paths: Iterable[Path], on_skipped: Callable[[str], None] | None = None
) -> list[Declared]:
    """The declarations in files and below folders, in the order of the paths.

    Args:
        paths: ``.cfg`` files, ROS 1 bags, and folders that have such files: sources, whose hidden
            and built folders are not looked into, or a recorded mission. One that is not there has
            none.
        on_skipped: called with a line for each declaration or file that could not be read.
    """
    found: list[Declared] = []
    for path in dict.fromkeys(file for given in paths for file in _files(given)):
        try:
            if path.suffix == ".bag":
                some, skipped = read_bag(path) if is_bag(path) else ([], [])
            elif path.stat().st_size > _LARGEST_FILE:
                some, skipped = [], [f"{path}: too large"]
            else:
                text = path.read_bytes()
                some, skipped = read_cfg(text, path) if _GENERATOR in text else ([], [])
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


def declared_for(
    declared: Sequence[Declared], suspect: Suspect | Accused, source: Path | None = None
) -> Declared | None:
    """What is declared of the parameter of a suspect; None where nothing is, or not one thing.

    What its node published counts before what a file says. Of files with ``source``, where the
    comparison stands, only those below one folder with it that holds a package.xml.
    """
    same = [one for one in declared if same_parameter(one.parameter, suspect.parameter)]
    said = [one for one in same if one.parameter.startswith(f"{suspect.last.node}/")]
    if not said:
        # Full names are those of messages: other nodes have parameters of their own.
        said = [one for one in same if not one.parameter.startswith("/")]
        package = None if source is None else _package_of(source)
        if package is not None:
            said = [one for one in said if package in Path(one.place).parents]
    meanings = {replace(one, parameter="", description="", place="") for one in said}
    return said[0] if len(meanings) == 1 else None


def _files(path: Path) -> list[Path]:
    if path.is_file():
        return [path]
    found = []
    for folder, below, files in os.walk(path):
        below[:] = sorted(b for b in below if not b.startswith(".") and b not in _NOT_SOURCES)
        found += [Path(folder, name) for name in sorted(files) if name.endswith((".cfg", ".bag"))]
    return found


def _package_of(source: Path) -> Path:
    """The folder of the package that a source file is in; its own, where none is there."""
    above = (folder for folder in source.parents if (folder / "package.xml").is_file())
    return next(above, source.parent)
