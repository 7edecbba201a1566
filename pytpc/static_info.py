"""What the static analysis found: the files of the link units, read, checked and merged.

Every link unit has one JSON file (docs/formats.md). ``load_link_unit`` reads one, ``collect`` all
of a build base, and ``StaticInfo`` is the merged document ``{"schema": 1, "units": [...]}`` that
the rest of pytpc works with. Field names of the classes are the names in the JSON.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pytpc.arithmetic import Tree, from_json
from pytpc.atomic import write_atomic
from pytpc.errors import InputError, WorkspaceError
from pytpc.paths import MERGED_FILE, OWN_FOLDER
from pytpc.static_json import SCHEMA_VERSION, check_unit, dump_json, parse_json

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Default = int | float | bool | str | None


@dataclass(frozen=True, slots=True)
class Place:
    """A line of a source file; ``file`` is relative to the unit's ``source_root`` or absolute."""

    file: str
    lineno: int


@dataclass(frozen=True, slots=True)
class Transform:
    """How a derived threshold comes from its parameter.

    ``affine``: threshold = scale * parameter + offset. ``expression``: ``tree`` says it (see
    ``pytpc.arithmetic``; None in files of before), and ``scale`` and ``offset`` are None.
    """

    kind: Literal["affine", "expression"]
    scale: float | None = None
    offset: float | None = None
    text: str = ""
    tree: Tree | None = None


@dataclass(frozen=True, slots=True)
class ParameterRead:
    """A call that reads a parameter; ``name`` has ``<dynamic>`` for what no constant gives."""

    name: str
    api: str
    type: str
    default: Default
    file: str
    lineno: int
    column: int
    function: str


@dataclass(frozen=True, slots=True)
class Exposing:
    """An exposing statement; ``topic`` is None where no constant names it."""

    api: str
    topic: str | None
    file: str
    lineno: int
    column: int
    function: str


@dataclass(frozen=True, slots=True)
class PathStep:
    """What happens on one line on the way from a parameter's read to what exposes it.

    ``step`` is the most telling thing that happens there, ``what`` says all of it. A place is
    empty and 0 where steps were left out or no debug information names it.
    """

    step: str
    file: str
    lineno: int
    column: int
    function: str
    what: str
    source_code: str | None


@dataclass(frozen=True, slots=True)
class NotExposed:
    """A comparison with a parameter (``source``) on which nothing exposed depends."""

    source: str
    file: str
    lineno: int
    column: int
    function: str
    source_code: str | None


@dataclass(frozen=True, slots=True)
class BlindSpot:
    """A place behind which the analysis does not see; ``parameter`` is None where none is meant."""

    kind: str
    parameter: str | None
    file: str
    lineno: int
    column: int
    function: str
    what: str
    source_code: str | None


@dataclass(frozen=True, slots=True)
class Comparison:
    """One threshold predicate comparison; the fields are those of docs/formats.md."""

    key: str
    type: Literal["parameter", "flag", "derived", "constant"]
    name: str | None
    source: str | None
    file: str
    lineno: int
    column: int
    function: str
    distance: int
    relation: str
    topic: str | None
    source_code: str | None
    other_thresholds: int
    param_reads: tuple[Place, ...]
    publishes: tuple[Place, ...]
    transform: Transform | None
    default: Default
    read_at: Place | None
    exposed_at: Place
    path: tuple[PathStep, ...] = ()


@dataclass(frozen=True, slots=True)
class Tool:
    """What made the file."""

    name: str
    version: str
    llvm: str
    profile: str


@dataclass(frozen=True, slots=True)
class Counts:
    """How much of a link unit there is of each thing, and how much could not be resolved."""

    functions: int
    predicates: int
    predicates_in_slice: int
    parameter_reads: int
    exposing_statements: int
    comparisons: int
    dynamic_names: int
    indirect_calls: int
    without_debug_info: int
    outside_sources: int
    lost_values: int
    not_instrumented: int
    not_exposed: int = 0
    blind_spots: int = 0
    constants: int = 0
    given_up: int = 0


@dataclass(frozen=True, slots=True)
class LinkUnit:
    """One executable or shared library as the analysis saw it.

    ``status`` is ``failed``, ``failure`` says why and the lists are empty where the analysis or
    the instrumentation broke down; such a unit runs as its author wrote it and reports nothing.
    """

    link_unit: str
    package: str
    source_root: str
    tool: Tool
    status: Literal["ok", "failed"]
    failure: str | None
    counts: Counts
    parameters: tuple[ParameterRead, ...]
    exposing: tuple[Exposing, ...]
    comparisons: tuple[Comparison, ...]
    not_exposed: tuple[NotExposed, ...] = ()
    blind_spots: tuple[BlindSpot, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """The unit as the JSON object of docs/formats.md."""
        return {"schema": SCHEMA_VERSION, **_fields(self)}

    @classmethod
    def from_json(cls, data: object, path: Path, pointer: str = "") -> LinkUnit:
        """Build a unit from parsed JSON.

        Args:
            data: the parsed object.
            path: the file it came from, for messages.
            pointer: JSON pointer of the unit within that file.

        Raises:
            InputError: the object breaks the schema; the message has the JSON pointer.
        """
        unit = dict(check_unit(data, path, pointer))
        del unit["schema"]
        unit["tool"] = Tool(**unit["tool"])
        unit["counts"] = Counts(**unit["counts"])
        unit["parameters"] = tuple(ParameterRead(**read) for read in unit["parameters"])
        unit["exposing"] = tuple(Exposing(**statement) for statement in unit["exposing"])
        unit["comparisons"] = tuple(_comparison(found) for found in unit["comparisons"])
        unit["not_exposed"] = tuple(NotExposed(**found) for found in unit.get("not_exposed", ()))
        unit["blind_spots"] = tuple(BlindSpot(**spot) for spot in unit.get("blind_spots", ()))
        return cls(**unit)


@dataclass(frozen=True)
class StaticInfo:
    """All link units of a workspace, sorted by package and name.

    Make one with ``of``, ``collect``, ``load`` or ``from_json``: they check that no unit and no
    key occurs twice.
    """

    units: tuple[LinkUnit, ...]

    @classmethod
    def of(cls, units: Iterable[LinkUnit], path: Path | None = None) -> StaticInfo:
        """Merge units.

        Args:
            units: in any order.
            path: where they came from, for messages.

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
        return cls(tuple(merged))

    @cached_property
    def comparisons(self) -> dict[str, Comparison]:
        """Every comparison by its key, in the order of the units and their lists."""
        return {found.key: found for unit in self.units for found in unit.comparisons}

    @cached_property
    def thresholds(self) -> dict[str, Comparison]:
        """The comparisons with parameters: those with constants left out."""
        return {key: found for key, found in self.comparisons.items() if found.type != "constant"}

    @cached_property
    def _owners(self) -> dict[str, LinkUnit]:
        return {found.key: unit for unit in self.units for found in unit.comparisons}

    @property
    def failed(self) -> tuple[LinkUnit, ...]:
        """The units that were left as they were."""
        return tuple(unit for unit in self.units if unit.status == "failed")

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
        """The document ``{"schema": 1, "units": [...]}``."""
        return {"schema": SCHEMA_VERSION, "units": [unit.to_json() for unit in self.units]}

    @classmethod
    def from_json(cls, data: object, path: Path) -> StaticInfo:
        """The reverse of ``to_json``; ``path`` is for messages.

        Raises:
            InputError: the document is not one of ours, with the JSON pointer of the fault.
        """
        if not isinstance(data, dict) or not isinstance(data.get("units"), list):
            raise InputError('/: not merged static information, "units" is missing', path)
        if data.get("schema") != SCHEMA_VERSION:
            raise InputError(
                f"/schema: {data.get('schema')!r} where {SCHEMA_VERSION} is read", path
            )
        units = [
            LinkUnit.from_json(unit, path, f"/units/{index}")
            for index, unit in enumerate(data["units"])
        ]
        return cls.of(units, path)

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
        data = parse_json(path)
        if isinstance(data, dict) and "link_unit" in data:
            return cls.of([LinkUnit.from_json(data, path)], path)
        return cls.from_json(data, path)


def load_link_unit(path: Path) -> LinkUnit:
    """Read the file of one link unit.

    Raises:
        InputError: the file cannot be read, is not JSON (with the line), or breaks the schema
            (with the JSON pointer).
    """
    return LinkUnit.from_json(parse_json(path), path)


def unit_files(build_base: Path) -> list[Path]:
    """The files ``<build folder>/tpc/<target>.json`` below ``build_base``, sorted.

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
            found += [here / name for name in files if name.endswith(".json")]
    return sorted(found)


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
    if not source.is_dir():
        return StaticInfo.load(source)
    merged = source / OWN_FOLDER / MERGED_FILE
    if merged.is_file():
        return StaticInfo.load(merged)
    static = collect(source, on_progress)
    if not static.units:
        raise WorkspaceError("no static information here; build with `pytpc build`", source)
    return static


def _comparison(data: dict[str, Any]) -> Comparison:
    found = dict(data)
    found["param_reads"] = tuple(Place(**place) for place in found["param_reads"])
    found["publishes"] = tuple(Place(**place) for place in found["publishes"])
    if found["transform"] is not None:
        how = found["transform"]
        found["transform"] = Transform(**how)
        if "tree" in how:
            found["transform"] = replace(found["transform"], tree=from_json(how["tree"]))
    if found["read_at"] is not None:
        found["read_at"] = Place(**found["read_at"])
    found["exposed_at"] = Place(**found["exposed_at"])
    found["path"] = tuple(PathStep(**step) for step in found.get("path", ()))
    return Comparison(**found)


def _fields(value: DataclassInstance) -> dict[str, object]:
    return {field.name: _plain(getattr(value, field.name)) for field in fields(value)}


def _plain(value: object) -> object:
    """Dataclasses as dicts and tuples as lists; of a transform what its kind has."""
    if isinstance(value, Transform):
        if value.kind == "affine":
            names = ["kind", "scale", "offset", "text"]
        else:
            names = ["kind", "text"] if value.tree is None else ["kind", "text", "tree"]
        return {name: _plain(getattr(value, name)) for name in names}
    if is_dataclass(value) and not isinstance(value, type):
        return _fields(value)
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return value
