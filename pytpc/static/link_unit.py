"""One link unit of the static analysis: JSON to dataclasses, and back.

Field names of the classes are the names in the JSON (docs/reference/formats.md#static-information).
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pytpc.base.checked_json import SCHEMA_VERSION, check_unit
from pytpc.static.arithmetic import Tree, from_json

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
    """How a derived threshold is computed from its parameter.

    ``affine``: threshold = scale * parameter + offset. ``expression``: ``tree`` says it (see
    ``pytpc.static.arithmetic``; None in older files), and ``scale`` and ``offset`` are None.
    """

    kind: Literal["affine", "expression"]
    scale: float | None = None
    offset: float | None = None
    text: str = ""
    tree: Tree | None = None

    def to_json(self) -> dict[str, Any]:
        """The fields that its kind has."""
        return _object(self)


@dataclass(frozen=True, slots=True)
class ParameterRead:
    """A call that reads a parameter; ``<dynamic>`` in ``name`` stands for an unknown part.

    Under its ``key``, a running node reports the full name; None if it does not.
    """

    name: str
    api: str
    type: str
    default: Default
    file: str
    lineno: int
    column: int
    function: str
    key: str | None = None


@dataclass(frozen=True, slots=True)
class Exposing:
    """An exposing statement; ``topic`` is None if no constant names it."""

    api: str
    topic: str | None
    file: str
    lineno: int
    column: int
    function: str


@dataclass(frozen=True, slots=True)
class PathStep:
    """One line on the way from a parameter's read to what exposes it.

    ``step`` is the most telling thing that happens there, ``what`` says all of it. A place is
    empty and 0 where steps were left out or no debug information names it. ``unit`` is the link
    unit (``package/name``) of the line; None if its own unit was analysed alone.
    """

    step: str
    file: str
    lineno: int
    column: int
    function: str
    what: str
    source_code: str | None
    unit: str | None = None

    def to_json(self) -> dict[str, Any]:
        """The step as JSON (docs/reference/formats.md#path)."""
        return _object(self)


@dataclass(frozen=True, slots=True)
class Received:
    """A subscription whose messages a comparison depends on.

    ``topic`` and ``type`` are None where no constant names them. ``by`` is ``value`` if the
    compared value depends on the messages, ``control`` if only that it is evaluated does.
    """

    topic: str | None
    type: str | None
    by: Literal["value", "control"]
    file: str
    lineno: int


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A link unit that was not analysed, and so reports nothing; and the reason."""

    package: str
    link_unit: str
    reason: str


@dataclass(frozen=True, slots=True)
class Doubled:
    """A source file that is also linked into ``runs``, which ``link_unit`` or a program needs.

    ``comparisons`` of ``link_unit`` in ``file`` (absolute) do not report in a process that has
    loaded ``runs`` before.
    """

    package: str
    link_unit: str
    runs: str
    file: str
    comparisons: int


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
    """A blind spot of the analysis; ``parameter`` is None if it does not concern a certain one."""

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
    """One threshold predicate comparison (docs/reference/formats.md#a-comparison).

    ``loop_depth`` is known for C++ only, and not from older files; the three before it are known
    for Python only. ``processes`` are those in whose analysis it was found; None if that was the
    analysis of its link unit alone.
    """

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
    end_lineno: int | None = None
    end_column: int | None = None
    operand: str | None = None
    loop_depth: int | None = None
    processes: tuple[str, ...] | None = None
    message: str | None = None
    received: tuple[Received, ...] | None = None

    def to_json(self) -> dict[str, Any]:
        """The comparison as JSON (docs/reference/formats.md#a-comparison)."""
        return _object(self)


@dataclass(frozen=True, slots=True)
class Tool:
    """What made the file; ``analysis`` is ``python`` where Python was analysed (no ``llvm``)."""

    name: str
    version: str
    llvm: str
    profile: str
    analysis: str | None = None


@dataclass(frozen=True, slots=True)
class Counts:
    """The counts of a link unit: how many of each thing, and how many could not be resolved."""

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

    If the analysis or the instrumentation failed, ``status`` is ``failed``, ``failure`` says why
    and the lists are empty; such a unit runs as its author wrote it and reports nothing. If the
    analysis ended early, ``incomplete`` says why, and the lists have what it found. ``script``
    is the script of a Python unit, relative to ``source_root``; None for all others.
    ``build_folder`` is CMake's, absolute; None if the unit was not read from there. ``processes``
    are those that it was analysed in; None if it was analysed alone.
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
    script: str | None = None
    build_folder: str | None = None
    incomplete: str | None = None
    processes: tuple[str, ...] | None = None

    @property
    def trouble(self) -> str | None:
        """What the analysis could not do, and why; None if nothing."""
        name = f"{self.package}/{self.link_unit}"
        if self.failure is not None:
            return f"{name} was not analysed and reports nothing: {self.failure}"
        if self.incomplete is not None:
            return (
                f"{name} was not analysed to the end, comparisons may be missing: {self.incomplete}"
            )
        return None

    @property
    def is_python(self) -> bool:
        """Whether it is a Python script with its modules, not a CMake target."""
        return self.tool.analysis == "python"

    @property
    def script_path(self) -> str | None:
        """The absolute path of the script; None if there is none, or it is not known."""
        return None if self.script is None else self.absolute(self.script)

    def to_json(self) -> dict[str, Any]:
        """The unit as JSON (docs/reference/formats.md#static-information)."""
        return {"schema": SCHEMA_VERSION, **_object(self)}

    def absolute(self, file: str) -> str:
        """A ``file`` field of this unit as an absolute path without ``.`` and ``..``."""
        return os.path.normpath(Path(self.source_root) / file)

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
        return cls.from_checked(check_unit(data, path, pointer))

    @classmethod
    def from_checked(cls, data: Mapping[str, Any]) -> LinkUnit:
        """Build a unit from JSON that the schema has checked."""
        unit = dict(data)
        del unit["schema"]
        unit["tool"] = Tool(**unit["tool"])
        unit["counts"] = Counts(**unit["counts"])
        unit["parameters"] = tuple(ParameterRead(**read) for read in unit["parameters"])
        unit["exposing"] = tuple(Exposing(**statement) for statement in unit["exposing"])
        unit["comparisons"] = tuple(_comparison(found) for found in unit["comparisons"])
        unit["not_exposed"] = tuple(NotExposed(**found) for found in unit.get("not_exposed", ()))
        unit["blind_spots"] = tuple(BlindSpot(**spot) for spot in unit.get("blind_spots", ()))
        if "processes" in unit:
            unit["processes"] = tuple(unit["processes"])
        return cls(**unit)


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
    if "processes" in found:
        found["processes"] = tuple(found["processes"])
    if "received" in found:
        found["received"] = tuple(Received(**each) for each in found["received"])
    return Comparison(**found)


# Fields that only one half of TPC writes, or only one kind of transform has.
_OPTIONAL = frozenset(
    {"analysis", "end_lineno", "end_column", "key", "operand", "script", "build_folder"}
    | {"incomplete", "loop_depth", "message", "processes", "received"}
    | {"scale", "offset", "tree", "unit"}
)


def _object(value: DataclassInstance) -> dict[str, Any]:
    """A dataclass as a JSON object, without optional fields that are not known."""
    found = ((field.name, getattr(value, field.name)) for field in fields(value))
    return {name: _plain(item) for name, item in found if item is not None or name not in _OPTIONAL}


def _plain(value: object) -> object:
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return _object(value) if is_dataclass(value) and not isinstance(value, type) else value
