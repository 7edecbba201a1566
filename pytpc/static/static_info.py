"""What the static analysis found in a workspace: its link units, read, checked and merged.

Every link unit has one JSON file (docs/reference/formats.md#static-information). ``load_link_unit``
reads one, ``collect`` all of a build base, and ``StaticInfo`` is the merged document that the rest
of pytpc works with.
"""

from __future__ import annotations

import hashlib
import os
import shlex
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any
from urllib.parse import quote

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import (
    MERGED_SCHEMA,
    SCHEMA_VERSION,
    check_schema,
    check_version,
    dump_json,
    parse_json,
)
from pytpc.base.closest import path_hint
from pytpc.base.collector import without_collector
from pytpc.base.errors import InputError, WorkspaceError
from pytpc.base.paths import MERGED_FILE, OWN_FOLDER
from pytpc.static.link_unit import Comparison, Doubled, LeftOut, LinkUnit
from pytpc.static.places import Tpc, merge_places


@dataclass(frozen=True)
class StaticInfo:
    """All link units of a workspace, sorted by package and name.

    Make one with ``of``, ``collect``, ``load`` or ``from_json``: they check that no unit and no
    key occurs twice. ``copies`` are the installed headers that are a package's own, as sorted pairs
    (absolute path of the copy, absolute path of the original), ``left_out`` the link units that
    were not analysed, ``doubled`` the source files whose comparisons do not report since another
    unit has them, too. ``set_aside`` are the keys of comparisons that are known and do not count in
    a mission; no file has them. ``sources`` are the SHA-256 of the source files when they were
    built, as sorted pairs (absolute path, digest); empty where that is not known.
    """

    units: tuple[LinkUnit, ...]
    copies: tuple[tuple[str, str], ...] = ()
    left_out: tuple[LeftOut, ...] = ()
    doubled: tuple[Doubled, ...] = ()
    set_aside: frozenset[str] = frozenset()
    sources: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of(
        cls,
        units: Iterable[LinkUnit],
        path: Path | None = None,
        copies: Mapping[str, str] | None = None,
        left_out: Iterable[LeftOut] = (),
        doubled: Iterable[Doubled] = (),
    ) -> StaticInfo:
        """Merge units.

        Args:
            units: in any order.
            path: where they came from, for messages.
            copies: installed headers -> the files that they are copies of.
            left_out: link units that were not analysed, in any order.
            doubled: source files whose comparisons do not report.

        Raises:
            InputError: a unit of a package, or a key, occurs twice.
        """
        merged = sorted(units, key=lambda unit: (unit.package, unit.link_unit))
        for before, after in pairwise(merged):
            if (before.package, before.link_unit) == (after.package, after.link_unit):
                raise InputError(
                    f"link unit {after.link_unit} of package {after.package} occurs twice;"
                    " an old build folder may have to be removed",
                    path,
                )
        owners: dict[str, LinkUnit] = {}
        for unit in merged:
            for comparison in unit.comparisons:
                if comparison.key in owners:
                    raise InputError(
                        f"key {comparison.key} occurs twice, in"
                        f" {owners[comparison.key].link_unit} and {unit.link_unit}",
                        path,
                    )
                owners[comparison.key] = unit
        without = sorted(left_out, key=lambda unit: (unit.package, unit.link_unit))
        known = tuple(sorted((copies or {}).items()))
        return cls(tuple(merged), known, tuple(without), tuple(doubled))

    @cached_property
    def comparisons(self) -> dict[str, Comparison]:
        """Every comparison by its key, in the order of the units and their lists."""
        return {found.key: found for unit in self.units for found in unit.comparisons}

    @cached_property
    def thresholds(self) -> dict[str, Comparison]:
        """The comparisons with parameters: those with constants left out."""
        return {key: found for key, found in self.comparisons.items() if found.type != "constant"}

    @cached_property
    def tpcs(self) -> tuple[Tpc, ...]:
        """The comparisons in the source, each once, however many link units hold it."""
        return merge_places(self.units, dict(self.copies))

    @cached_property
    def _owners(self) -> dict[str, LinkUnit]:
        return {found.key: unit for unit in self.units for found in unit.comparisons}

    @property
    def failed(self) -> tuple[LinkUnit, ...]:
        """The units that were not instrumented."""
        return tuple(unit for unit in self.units if unit.status == "failed")

    @property
    def troubles(self) -> tuple[str, ...]:
        """A line for each unit that was not analysed, or not to the end."""
        return tuple(unit.trouble for unit in self.units if unit.trouble is not None)

    def unit_of(self, key: str) -> LinkUnit:
        """The link unit that holds the comparison ``key``.

        Raises:
            KeyError: no comparison has this key.
        """
        return self._owners[key]

    def source_path(self, key: str) -> Path:
        """Absolute path of the source file of the comparison ``key`` (it may be gone by now).

        Raises:
            KeyError: no comparison has this key.
        """
        return Path(self._owners[key].source_root) / self.comparisons[key].file

    def to_json(self) -> dict[str, Any]:
        """The merged document: the units, and the TPCs that follow from them."""
        return {
            "schema": SCHEMA_VERSION,
            "units": [unit.to_json() for unit in self.units],
            "copies": dict(self.copies),
            "tpcs": [tpc.to_json() for tpc in self.tpcs],
            "left_out": [asdict(unit) for unit in self.left_out],
            "doubled": [asdict(source) for source in self.doubled],
            **({"sources": dict(self.sources)} if self.sources else {}),
        }

    @classmethod
    def from_json(cls, data: object, path: Path) -> StaticInfo:
        """The reverse of ``to_json``; ``path`` is for messages.

        Older documents lack ``copies``, ``tpcs``, ``left_out``, ``doubled`` or ``sources``; the
        TPCs follow from the rest.

        Raises:
            InputError: the document is not one of ours, with the JSON pointer of the fault.
        """
        if not isinstance(data, dict) or not isinstance(data.get("units"), list):
            raise InputError(
                '/: not merged static information, "units" is missing; give the static.json that'
                " `pytpc build` or `pytpc collect` wrote",
                path,
            )
        version = data.get("schema")
        check_version(version, path)
        units = [
            LinkUnit.from_json(unit, path, f"/units/{index}")
            for index, unit in enumerate(data["units"])
        ]
        # The units have just been checked, each by the same schema.
        check_schema({**data, "units": []}, path, MERGED_SCHEMA)
        left_out = [LeftOut(**unit) for unit in data.get("left_out", ())]
        doubled = [Doubled(**source) for source in data.get("doubled", ())]
        merged = cls.of(units, path, data.get("copies"), left_out, doubled)
        return replace(merged, sources=tuple(sorted(data.get("sources", {}).items())))

    def save(self, path: Path) -> None:
        """Write the document atomically.

        Raises:
            TpcError: the file cannot be written.
        """
        write_atomic(path, dump_json(self.to_json()))

    @classmethod
    def load(cls, path: Path) -> StaticInfo:
        """Read a document that ``save`` wrote, or the file of a single link unit.

        Raises:
            InputError: the file cannot be read, is not JSON (with the line), or breaks the schema
                (with the JSON pointer).
        """
        with without_collector():
            data = parse_json(path, most=_LARGEST)
            if isinstance(data, dict) and "link_unit" in data:
                return cls.of([load_link_unit(path)], path)
            return cls.from_json(_rooted(data, path.absolute().parent), path)


def _rooted(data: object, folder: Path) -> object:
    """The document with absolute paths of sources, where they were relative to its ``folder``.

    Static information that is passed on together with its sources has relative paths.
    """
    if not isinstance(data, dict) or not isinstance(data.get("units"), list):
        return data
    units = [
        {**unit, "source_root": os.path.normpath(folder / unit["source_root"])}
        if isinstance(unit, dict) and isinstance(unit.get("source_root"), str)
        else unit
        for unit in data["units"]
    ]
    return {**data, "units": units}


def load_link_unit(path: Path) -> LinkUnit:
    """Read the file of one link unit; below a build folder, the unit knows that folder.

    Raises:
        InputError: the file cannot be read, is not JSON (with the line), or breaks the schema
            (with the JSON pointer).
    """
    with without_collector():
        unit = LinkUnit.from_json(parse_json(path, most=_LARGEST), path)
    if path.parent.name != "tpc":
        return unit
    return replace(unit, build_folder=str(_build_folder(path.absolute().parent.parent)))


def _build_folder(folder: Path) -> Path:
    """CMake's build folder: under catkin_make it is above that of the package."""
    above = (up for up in (folder, *folder.parents) if (up / "CMakeCache.txt").is_file())
    return next(above, folder)


# What a link needs, beside the findings of its unit (passes/plan/Manifest.h).
_MANIFEST_END = ".link.json"


def unit_files(build_base: Path) -> list[Path]:
    """The files ``<build folder>/tpc/<link unit>.json`` below ``build_base``, sorted.

    A build folder may itself be called ``tpc`` (a package of that name); its JSON files are CMake's
    and colcon's, so a folder with a CMakeCache.txt is not taken for ours.

    Raises:
        InputError: ``build_base`` is no folder.
    """
    if not build_base.is_dir():
        raise InputError("no such build folder", build_base)
    found: list[Path] = []
    for folder, below, files in os.walk(build_base):
        below[:] = sorted(name for name in below if name != "CMakeFiles")
        here = Path(folder)
        if here.name == "tpc" and here != build_base and "CMakeCache.txt" not in files:
            found += [
                here / name
                for name in files
                if name.endswith(".json") and not name.endswith(_MANIFEST_END)
            ]
    return sorted(found)


def manifest_of(unit_file: Path) -> Path:
    """What the linker wrote of the link, beside the file of its unit."""
    return unit_file.with_name(f"{unit_file.stem}{_MANIFEST_END}")


# A quarter of a million comparisons.
_LARGEST = 1 << 27
_PYTHON_END = "@python.json"
# A name in a folder has at most 255 bytes, and atomic writing adds some.
_LONGEST_NAME = 180


def python_unit_file(build_folder: Path, link_unit: str) -> Path:
    """The file of a Python unit, which no target of CMake's can have: their names have no ``@``."""
    name = quote(link_unit, safe="")
    if len(name) > _LONGEST_NAME:
        name = hashlib.sha256(link_unit.encode()).hexdigest()
    return build_folder / "tpc" / f"{name}{_PYTHON_END}"


def is_python_file(path: Path) -> bool:
    """Whether a file of ``unit_files`` is that of a Python unit."""
    return path.name.endswith(_PYTHON_END)


def collect(build_base: Path, on_progress: Callable[[int, int], None] | None = None) -> StaticInfo:
    """Read and merge the files of all link units below ``build_base``.

    Args:
        build_base: colcon's build base, or the build folder of one package.
        on_progress: called with (files read, files in all).

    Raises:
        InputError: no such folder, a file that is broken, or a unit that occurs twice.
    """
    files = unit_files(build_base)
    units = []
    for number, path in enumerate(files, start=1):
        units.append(load_link_unit(path))
        if on_progress is not None:
            on_progress(number, len(files))
    return StaticInfo.of(units, build_base)


def not_built(workspace: Path) -> str:
    """What is wrong with a folder without static information, and what to type."""
    return f"no static information here; run `pytpc build {shlex.quote(str(workspace))}`"


def read_static(source: Path, on_progress: Callable[[int, int], None] | None = None) -> StaticInfo:
    """Static information from wherever it is.

    Args:
        source: a merged document, the file of one link unit, a build base, or a workspace that
            ``pytpc build`` built.
        on_progress: as for ``collect``.

    Raises:
        InputError: the file, or one below the folder, is broken.
        WorkspaceError: the folder has no static information in it.
    """
    if not source.exists():
        hint = path_hint(source) or "; give a built workspace or a static.json"
        raise InputError(f"no such file or folder{hint}", source)
    if not source.is_dir():
        return StaticInfo.load(source)
    merged = source / OWN_FOLDER / MERGED_FILE
    if merged.is_file():
        return StaticInfo.load(merged)
    static = collect(source, on_progress)
    if not static.units:
        raise WorkspaceError(not_built(source), source)
    return static
