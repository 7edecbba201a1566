"""One comparison in the source, however many link units it was compiled into.

A header, or a source file that two targets share, is analysed once in each link unit and has a key
in each. ``merge_places`` puts the keys of one place together.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import PurePosixPath
from typing import Any

from pytpc.static.link_unit import Comparison, LinkUnit


@dataclass(frozen=True, slots=True)
class KeyIn:
    """A key of a TPC, with the link unit that reports by it."""

    key: str
    package: str
    link_unit: str
    distance: int


@dataclass(frozen=True, slots=True)
class Tpc:
    """A comparison in the source.

    ``file`` is absolute, ``package`` the one in whose folder it is, ``place`` the file relative to
    that folder (absolute where it is in none). For a constant ``parameter`` is None, and ``name``
    is its variable or number. ``keys`` begin with the nearest to its exposing statement;
    ``distance`` is its distance.
    """

    file: str
    lineno: int
    column: int
    parameter: str | None
    name: str | None
    type: str
    relation: str
    distance: int
    package: str
    place: str
    keys: tuple[KeyIn, ...]

    @property
    def key(self) -> str:
        """The key of the link unit in which the exposing statement is nearest."""
        return self.keys[0].key

    @property
    def link_units(self) -> tuple[str, ...]:
        """``package/link_unit`` of each unit that holds it, once, sorted."""
        return tuple(sorted({f"{each.package}/{each.link_unit}" for each in self.keys}))

    def to_json(self) -> dict[str, Any]:
        """The place as JSON (docs/reference/formats.md)."""
        found = asdict(self)
        return {**found, "keys": list(found["keys"])}


Identity = tuple[str, int, int, str, str, str, str]


def merge_places(
    units: Iterable[LinkUnit], copies: Mapping[str, str] | None = None
) -> tuple[Tpc, ...]:
    """The TPCs of ``units``, sorted by package, file, line, column and parameter.

    Two comparisons are one if file, line, column, parameter (for a constant its name), type and
    relation are the same.

    Args:
        units: of any number of packages.
        copies: absolute path of an installed header -> absolute path of the file it is a copy of.
    """
    units = list(units)
    packages: dict[str, set[str]] = {}
    for unit in units:
        packages.setdefault(unit.source_root.rstrip("/"), set()).add(unit.package)
    found: dict[Identity, list[KeyIn]] = {}
    for unit in units:
        names = {each.file for each in unit.comparisons}
        files = {name: unit.absolute(name) for name in names}
        for each in unit.comparisons:
            key = KeyIn(each.key, unit.package, unit.link_unit, each.distance)
            identity = _identity(files[each.file], each, copies or {})
            found.setdefault(identity, []).append(key)
    roots = {file: _root_of(file, packages) for file in {identity[0] for identity in found}}
    tpcs = [_tpc(identity, keys, packages, roots) for identity, keys in found.items()]
    return tuple(sorted(tpcs, key=_order))


def _identity(file: str, found: Comparison, copies: Mapping[str, str]) -> Identity:
    threshold = found.source if found.source is not None else found.name or ""
    return (
        copies.get(file, file),
        found.lineno,
        found.column,
        threshold,
        found.type,
        found.relation,
        # A parameter's comparison is known by the parameter; the variable may differ by unit.
        "" if found.source is not None else "constant",
    )


def _root_of(file: str, packages: Mapping[str, set[str]]) -> str | None:
    """The folder of ``packages`` that holds a file, the innermost one."""
    return next((str(up) for up in PurePosixPath(file).parents if str(up) in packages), None)


def _tpc(
    identity: Identity,
    keys: list[KeyIn],
    packages: Mapping[str, set[str]],
    roots: Mapping[str, str | None],
) -> Tpc:
    file, lineno, column, threshold, kind, relation, constant = identity
    keys = sorted(keys, key=lambda each: (each.distance, each.package, each.link_unit, each.key))
    root = roots[file]
    owners = packages[root] if root is not None else set()
    return Tpc(
        file=file,
        lineno=lineno,
        column=column,
        parameter=None if constant else threshold,
        name=threshold or None if constant else None,
        type=kind,
        relation=relation,
        distance=keys[0].distance,
        # Under catkin_make all packages have one source root; then the nearest unit's is meant.
        package=next(iter(owners)) if len(owners) == 1 else keys[0].package,
        place=file if root is None else file[len(root) :].lstrip("/"),
        keys=tuple(keys),
    )


def _order(tpc: Tpc) -> tuple[str, str, int, int, bool, str, str, str]:
    is_constant, threshold = tpc.parameter is None, tpc.parameter or tpc.name or ""
    place = (tpc.package, tpc.file, tpc.lineno, tpc.column)
    return *place, is_constant, threshold, tpc.type, tpc.relation
