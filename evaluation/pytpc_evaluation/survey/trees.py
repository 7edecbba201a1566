"""A survey of source trees: what was measured of each, and the order in which they are built.

A *tree* is a folder with ROS packages, or with one plain CMake project. Everything in this module
is data to data; ``pytpc_evaluation.survey.measured_build`` builds,
``pytpc_evaluation.survey.static_tables`` makes tables of the results.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pytpc.base.checked_json import check_schema
from pytpc.base.errors import InputError
from pytpc.static.link_unit import LinkUnit
from pytpc_evaluation.survey.source_lines import LineCount, SourceLines

RESULT_VERSION = 2


@dataclass(frozen=True, slots=True)
class TreePackage:
    """A package of a tree: its folder, its manifest's build type, and the names that it needs."""

    name: str
    path: Path
    build_type: str
    needs: frozenset[str]


@dataclass(frozen=True, slots=True)
class Tree:
    """A folder that is surveyed as one row; ``unreadable`` are packages that no build can take."""

    name: str
    path: Path
    packages: tuple[TreePackage, ...]
    unreadable: tuple[NotBuilt, ...] = ()


@dataclass(frozen=True, slots=True)
class NotBuilt:
    """A package that was not built: why, and what the machine lacks for it as far as it is said."""

    package: str
    reason: str
    missing: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Build:
    """One measured build of a tree, all times in seconds.

    ``wall`` is what a clock shows; ``processor`` the processor time of colcon and all below it;
    ``compile`` the part of it that compilers and linkers took in building targets, without
    configuring and without generating messages.
    """

    wall: float
    processor: float
    compile: float
    not_built: tuple[NotBuilt, ...]


@dataclass(frozen=True, slots=True)
class TreeCounts:
    """What the analysis found in a tree.

    ``comparisons`` counts places in the tree's own files in C++ (file, line, column and parameter),
    each once, in however many link units it is, ``python`` those in Python. ``parameters`` are
    distinct names, ``files`` distinct files, ``units`` link units, all of both.
    ``failed`` and ``without`` name link units, as ``package/target``: those that the analysis left
    as they were (with its reason), and those that were linked without it.
    """

    comparisons: int
    python: int
    parameters: int
    files: int
    units: int
    failed: tuple[str, ...]
    without: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TreeResult:
    """All that is known of one tree.

    ``key`` stands for the sources and the tools that gave the result. ``plain`` is None where no
    plain build was asked for, ``first`` says which build came first.
    """

    name: str
    path: str
    key: str
    packages: int
    first: str
    plain: Build | None
    tpc: Build
    found: TreeCounts
    lines: SourceLines

    @property
    def broken(self) -> tuple[NotBuilt, ...]:
        """Packages that are built without TPC and not with it: faults of TPC."""
        if self.plain is None:
            return ()
        also = {fault.package for fault in self.plain.not_built}
        return tuple(fault for fault in self.tpc.not_built if fault.package not in also)

    @property
    def partial(self) -> bool:
        """Whether a package is missing from the figures."""
        return bool(self.tpc.not_built or (self.plain is not None and self.plain.not_built))

    @property
    def comparable(self) -> bool:
        """Whether both builds built the same packages, and at least one."""
        if self.plain is None or len(self.tpc.not_built) >= self.packages:
            return False
        names = [{fault.package for fault in build.not_built} for build in (self.plain, self.tpc)]
        return names[0] == names[1]

    def factor(self, which: str) -> float | None:
        """The time with TPC over that without; None where they cannot be compared.

        Args:
            which: ``wall``, ``processor`` or ``compile``.
        """
        if self.plain is None or not self.comparable:
            return None
        without: float = getattr(self.plain, which)
        with_tpc: float = getattr(self.tpc, which)
        return with_tpc / without if without > 0 else None

    def to_json(self) -> dict[str, Any]:
        """The result as JSON; ``from_json`` reads it."""
        data: dict[str, Any] = {"version": RESULT_VERSION, **asdict(self)}
        for which in ("wall", "processor", "compile"):
            data[f"{which}_factor"] = self.factor(which)
        return data

    @classmethod
    def from_json(cls, data: object, path: Path) -> TreeResult:
        """Build a result from parsed JSON; ``path`` is for messages.

        Raises:
            InputError: it is not one that ``to_json`` of this version made.
        """
        if not isinstance(data, dict) or data.get("version") != RESULT_VERSION:
            raise InputError("not a survey's result of this version", path)
        check_schema(data, path, "survey_result.schema.json", package="pytpc_evaluation.survey")
        found, lines = data["found"], data["lines"]
        return cls(
            name=data["name"],
            path=data["path"],
            key=data["key"],
            packages=data["packages"],
            first=data["first"],
            plain=None if data["plain"] is None else _build(data["plain"]),
            tpc=_build(data["tpc"]),
            found=TreeCounts(
                **{
                    **found,
                    "failed": tuple(found["failed"]),
                    "without": tuple(found["without"]),
                }
            ),
            lines=SourceLines(
                {name: LineCount(**count) for name, count in lines["languages"].items()},
                dict(lines["left_out"]),
            ),
        )


def _build(data: Mapping[str, Any]) -> Build:
    faults = (
        NotBuilt(fault["package"], fault["reason"], tuple(fault["missing"]))
        for fault in data["not_built"]
    )
    return Build(data["wall"], data["processor"], data["compile"], tuple(faults))


def found_in(
    units: Iterable[LinkUnit],
    tree: Path,
    without: Iterable[str] = (),
    unreadable: Iterable[str] = (),
) -> TreeCounts:
    """Count what the link units of a tree have.

    Args:
        units: of all packages of the tree, and of its scripts.
        tree: the folder; what is outside of it (headers of another tree) is not counted.
        without: link units that have no static information, as ``package/target``.
        unreadable: what cannot be read, as ``package/target: why``: static information, scripts.
    """
    root = os.path.realpath(tree)
    places: dict[bool, set[tuple[str, int, int, str | None]]] = {False: set(), True: set()}
    failed = list(unreadable)
    number = 0
    for unit in units:
        number += 1
        if unit.status == "failed":
            why = " ".join((unit.failure or "").split())
            failed.append(f"{unit.package}/{unit.link_unit}: {why}")
        for one in unit.comparisons:
            # Joined with an absolute path the root is dropped, as it should be.
            file = os.path.realpath(Path(unit.source_root, one.file))
            if one.type != "constant" and Path(file).is_relative_to(root):
                places[unit.is_python].add((file, one.lineno, one.column, one.source))
    every = places[False] | places[True]
    return TreeCounts(
        comparisons=len(places[False]),
        python=len(places[True]),
        parameters=len({source for _, _, _, source in every}),
        files=len({file for file, _, _, _ in every}),
        units=number,
        failed=tuple(sorted(failed)),
        without=tuple(sorted(without)),
    )


def needed_trees(trees: Sequence[Tree]) -> dict[str, tuple[str, ...]]:
    """For each tree, by path, the other given trees that it needs, directly or not.

    The needed ones stand in the order in which they are built. Where two trees have a package of
    one name, the first one given is taken; a tree's own packages come before both. In a ring of
    trees each one needs only those of the ring that ``build_order`` builds before it.
    """
    order = [str(tree.path) for tree in build_order(trees)]
    direct = _direct_needs(trees)
    every: dict[str, set[str]] = {}
    for number, path in enumerate(order):
        before = direct[path].intersection(order[:number])
        every[path] = before.union(*(every[other] for other in before))
    return {
        path: tuple(other for other in order if other in wanted) for path, wanted in every.items()
    }


def build_order(trees: Sequence[Tree]) -> list[Tree]:
    """The trees, each after those that it needs, else in the order given.

    In a ring of trees the first one given comes first: what it needs of the others it does not get.
    """
    direct = _direct_needs(trees)
    left = list(trees)
    ordered: list[Tree] = []
    while left:
        paths = {str(tree.path) for tree in left}
        ready = next((tree for tree in left if not direct[str(tree.path)] & paths), left[0])
        if ready is left[0] and direct[str(ready.path)] & paths:
            ready = _first_of_a_ring(left, direct)
        left.remove(ready)
        ordered.append(ready)
    return ordered


def _first_of_a_ring(left: Sequence[Tree], direct: Mapping[str, set[str]]) -> Tree:
    """The first tree that needs, in the end, itself: not one that only needs such a tree."""
    paths = {str(tree.path) for tree in left}
    for tree in left:
        reached: set[str] = set()
        front = direct[str(tree.path)] & paths
        while front:
            reached |= front
            front = set().union(*(direct[path] for path in front)) & paths - reached
        if str(tree.path) in reached:
            return tree
    raise AssertionError("no tree is ready and no tree needs itself")


def _direct_needs(trees: Sequence[Tree]) -> dict[str, set[str]]:
    provider: dict[str, str] = {}
    for tree in trees:
        for package in tree.packages:
            provider.setdefault(package.name, str(tree.path))
    needs: dict[str, set[str]] = {}
    for tree in trees:
        own = {package.name for package in tree.packages}
        wanted = frozenset[str]().union(*(package.needs for package in tree.packages)) - own
        needs[str(tree.path)] = {provider[name] for name in wanted if name in provider}
    return needs
