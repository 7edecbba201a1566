"""What a change of the code does to the comparisons: those that are new, gone or changed.

``changes_between`` compares the static information of two builds. It knows no files: whether a
parameter is declared in a ``.cfg`` file is told by the caller.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import PurePosixPath
from typing import Literal

from pytpc.base.wording import listed, many
from pytpc.static.builds import program_name
from pytpc.static.edits import Edit, edits_of, topic_edit
from pytpc.static.link_unit import BlindSpot, LinkUnit
from pytpc.static.matching import Site, function_name, matched, sites_of
from pytpc.static.parameter_changes import (
    DeclaredAs,
    ParameterChange,
    declared_in_code,
    parameter_changes,
)
from pytpc.static.static_info import StaticInfo

Status = Literal["new", "gone", "changed", "moved", "same"]
STATUSES: tuple[Status, ...] = ("new", "gone", "changed", "moved", "same")
_NAMED = 4


@dataclass(frozen=True)
class ComparisonChange:
    """What became of one comparison in the source.

    ``old`` is None of a new one, ``new`` of one that is gone. ``edits`` are those of a changed one;
    one that is not changed has at most another topic. A ``moved`` one says the same on another
    line, in another function or file. The ``missing``
    link units of one that is gone are those that held it and that the new build does not have: if
    these are all, it may only not have been built. ``is_declared`` is about the parameter of a new
    or changed one.
    """

    status: Status
    old: Site | None
    new: Site | None
    edits: tuple[Edit, ...] = ()
    missing: tuple[str, ...] = ()
    is_declared: bool = True

    @property
    def site(self) -> Site:
        """The newer of both."""
        found = self.new or self.old
        assert found is not None
        return found

    @property
    def distances(self) -> tuple[int, int] | None:
        """The distances, if they differ; None if not, or if there are not two."""
        if self.old is None or self.new is None:
            return None
        both = self.old.distance, self.new.distance
        return both if both[0] != both[1] else None

    @property
    def is_unbuilt(self) -> bool:
        """Whether it is gone and no link unit that held it was built."""
        return self.status == "gone" and bool(self.missing)

    @property
    def has_new_parameter(self) -> bool:
        """Whether a parameter decides here that did not before."""
        return self.status == "new" or any(edit.what == "parameter" for edit in self.edits)


@dataclass(frozen=True)
class SpotChange:
    """A blind spot that the old build did not have, and its link unit."""

    unit: str
    spot: BlindSpot


@dataclass(frozen=True)
class BuildChanges:
    """What differs between two builds.

    ``missing`` and ``added`` are the link units (``package/name``) that only one of them has,
    ``renamed`` pairs of such units with the same sources; ``unanalysed`` says why units of the new
    build report nothing that did in the old one. ``comparisons`` are all of both builds, in the
    order of the new one's places, with those that are gone behind. ``spots`` are the new blind
    spots, ``closed`` counts those that are gone. ``notes`` say what makes the answer less certain.
    """

    missing: tuple[str, ...]
    added: tuple[str, ...]
    renamed: tuple[tuple[str, str], ...]
    unanalysed: tuple[str, ...]
    comparisons: tuple[ComparisonChange, ...]
    parameters: tuple[ParameterChange, ...]
    spots: tuple[SpotChange, ...]
    closed: int
    notes: tuple[str, ...] = ()

    def of(self, status: Status) -> list[ComparisonChange]:
        """The comparisons with a status, in their order."""
        return [one for one in self.comparisons if one.status == status]

    @cached_property
    def counts(self) -> Mapping[Status, int]:
        """How many comparisons have each status."""
        counted = Counter(one.status for one in self.comparisons)
        return {status: counted[status] for status in STATUSES}

    @property
    def farther(self) -> list[ComparisonChange]:
        """Those that are as they were, but nearer to what is exposed or farther from it."""
        return [o for o in self.comparisons if o.status in ("moved", "same") and o.distances]

    @property
    def rerouted(self) -> Mapping[Edit, list[ComparisonChange]]:
        """Those that are as they were, but whose outcome shows first on another topic."""
        found: dict[Edit, list[ComparisonChange]] = {}
        for one in self.comparisons:
            if one.status in ("moved", "same"):
                for edit in one.edits:
                    found.setdefault(edit, []).append(one)
        return found

    @property
    def is_same(self) -> bool:
        """Whether nothing is to be said."""
        some = any(self.counts[status] for status in ("new", "gone", "changed"))
        units = self.missing or self.added or self.renamed or self.unanalysed
        return not (some or units or self.rerouted or self.parameters or self.spots)


def changes_between(
    old: StaticInfo,
    new: StaticInfo,
    *,
    constants: bool = False,
    declared: Collection[str] = (),
    declarations: tuple[Iterable[DeclaredAs], Iterable[DeclaredAs]] = ((), ()),
) -> BuildChanges:
    """Compare two builds.

    Args:
        old: the older one.
        new: the newer one.
        constants: whether comparisons with constants count, too.
        declared: the last parts of the names of parameters that the new build declares outside of
            its code, in ``.cfg`` files.
        declarations: what these files say in the old and in the new build; empty if they are not
            both known.
    """
    missing, added, renamed = _units(old, new)
    names = {program_name(unit) for unit in old.units}, {program_name(unit) for unit in new.units}
    shared = names[0] & names[1]
    before, after = (sites_of(one, constants=constants, shared=shared) for one in (old, new))
    pairs = matched(before, after)
    is_declared = _declarer(new, declared)
    paired = {id(one) for pair in pairs for one in pair}
    found = [_pair(one, other, is_declared) for one, other in pairs]
    found += [
        ComparisonChange("new", None, one, is_declared=is_declared(one))
        for one in after
        if id(one) not in paired
    ]
    found.sort(key=_place)
    failed = {program_name(unit) for unit in new.units if unit.failure is not None}
    unbuilt = {*missing, *failed}
    gone = [one for one in before if id(one) not in paired]
    found += [ComparisonChange("gone", one, None, missing=_missing(one, unbuilt)) for one in gone]
    spots, closed = _spots(old, new)
    return BuildChanges(
        missing,
        added,
        renamed,
        _unanalysed(old, new),
        tuple(found),
        parameter_changes(old, new, pairs, declarations, unbuilt),
        spots,
        closed,
        _notes(old, new),
    )


def _place(one: ComparisonChange) -> tuple[object, ...]:
    tpc = one.site.tpc
    return tpc.package, tpc.place, tpc.lineno, tpc.column, one.site.threshold


def _units(
    old: StaticInfo, new: StaticInfo
) -> tuple[tuple[str, ...], tuple[str, ...], tuple[tuple[str, str], ...]]:
    """The link units that only the old build has, only the new one, and those that were renamed."""
    before = {program_name(unit): unit for unit in old.units}
    after = {program_name(unit): unit for unit in new.units}
    missing = [name for name in before if name not in after]
    added = [name for name in after if name not in before]
    renamed = []
    for name in list(missing):
        files = _files(before[name])
        same = [other for other in added if files and _files(after[other]) == files]
        same = [o for o in same if after[o].package == before[name].package] or same
        if len(same) == 1:
            renamed.append((name, same[0]))
            missing.remove(name)
            added.remove(same[0])
    return tuple(missing), tuple(added), tuple(renamed)


def _files(unit: LinkUnit) -> frozenset[str]:
    lists = (unit.comparisons, unit.parameters, unit.exposing)
    return frozenset(one.file for every in lists for one in every)


def _missing(one: Site, unbuilt: Collection[str]) -> tuple[str, ...]:
    """The link units of a site, if none of them was built."""
    units = one.tpc.link_units
    return units if all(name in unbuilt for name in units) else ()


def _unanalysed(old: StaticInfo, new: StaticInfo) -> tuple[str, ...]:
    before = {program_name(unit) for unit in old.units if unit.trouble is not None}
    return tuple(
        unit.trouble
        for unit in new.units
        if unit.trouble is not None and program_name(unit) not in before
    )


def _notes(old: StaticInfo, new: StaticInfo) -> tuple[str, ...]:
    """What else than the code may make the difference."""
    notes = []
    for what in ("version", "profile", "llvm"):
        before, after = ({getattr(u.tool, what) for u in s.units} - {""} for s in (old, new))
        if before and after and before != after:
            said = [listed(sorted(one), _NAMED) for one in (before, after)]
            name = {"version": "TPC", "profile": "the profile", "llvm": "LLVM"}[what]
            notes.append(f"{name} was {said[0]} and is {said[1]}: the analysis may differ")
    before_whole, after_whole = (_is_whole(static) for static in (old, new))
    if before_whole != after_whole and old.units and new.units:
        which = "OLD" if before_whole else "NEW"
        notes.append(
            f"only {which} was analysed in whole processes: what is read in one library and"
            " compared in another is missing in the other one; build both alike"
        )
    return tuple(notes)


def _is_whole(static: StaticInfo) -> bool:
    return any(unit.processes for unit in static.units)


def _declarer(static: StaticInfo, declared: Collection[str]) -> Callable[[Site], bool]:
    """Tells whether the parameter of a site is declared in the code, or among ``declared``."""
    places, names = declared_in_code(static.units)

    def is_declared(one: Site) -> bool:
        name = one.tpc.parameter
        if name is None or any(default is not None for default in one.defaults):
            return True
        if name.rpartition("/")[2].lstrip("~") in declared:
            return True
        reads = [
            (static.unit_of(key.key).absolute(at.file), at.lineno, name)
            for key in one.tpc.keys
            for at in static.comparisons[key.key].param_reads
        ]
        # Its reads are known, unless another link unit read it.
        known = [places[at] for at in reads if at in places]
        return any(known) if known else name in names

    return is_declared


def _pair(old: Site, new: Site, is_declared: Callable[[Site], bool]) -> ComparisonChange:
    edits, topics = tuple(edits_of(old, new)), topic_edit(old, new)
    if edits:
        edits = (*edits, *topics)
        return ComparisonChange("changed", old, new, edits, is_declared=is_declared(new))
    return ComparisonChange("moved" if _has_moved(old, new) else "same", old, new, topics)


def _has_moved(old: Site, new: Site) -> bool:
    return _where(old) != _where(new)


def _where(one: Site) -> tuple[str, str, int, str]:
    """The place in its package; outside of all packages, a workspace has paths of its own."""
    place = one.tpc.place
    file = PurePosixPath(place).name if place.startswith("/") else place
    return one.tpc.package, file, one.tpc.lineno, one.function


_SpotIdentity = tuple[str, str, str, str | None, str | None, str]


def _spots(old: StaticInfo, new: StaticInfo) -> tuple[tuple[SpotChange, ...], int]:
    """The new blind spots, those of a parameter first, and how many are gone.

    Of a spot that several link units have, one counts; lines do not.
    """
    before, after = (_by_identity(static) for static in (old, new))
    fresh = [
        spot for identity, every in after.items() for spot in every[len(before.get(identity, ())) :]
    ]
    fresh.sort(
        key=lambda one: (one.spot.parameter is None, one.unit, one.spot.file, one.spot.lineno)
    )
    closed = sum(
        max(0, len(every) - len(after.get(identity, ()))) for identity, every in before.items()
    )
    return tuple(fresh), closed


def _by_identity(static: StaticInfo) -> dict[_SpotIdentity, list[SpotChange]]:
    packages = {unit.source_root.rstrip("/"): unit.package for unit in static.units}
    found: dict[_SpotIdentity, list[SpotChange]] = {}
    seen = set()
    for unit in static.units:
        for spot in unit.blind_spots:
            file = unit.absolute(spot.file)
            place = file, spot.lineno, spot.column, spot.kind, spot.parameter
            if place in seen:
                continue
            seen.add(place)
            identity = (
                *_in_package(file, packages),
                function_name(spot.function),
                spot.kind,
                spot.parameter,
                spot.source_code or spot.what,
            )
            found.setdefault(identity, []).append(SpotChange(program_name(unit), spot))
    return found


def _in_package(file: str, packages: Mapping[str, str]) -> tuple[str, str]:
    """The package whose folder has a file, and the file in it; else only the file's name."""
    path = PurePosixPath(file)
    for root in path.parents:
        if str(root) in packages:
            return packages[str(root)], str(path.relative_to(root))
    return "", path.name


def spots_by_kind(spots: Iterable[SpotChange]) -> list[str]:
    """``3 lost_value``, the most first."""
    counted = Counter(one.spot.kind for one in spots)
    return [f"{count:,} {kind}" for kind, count in counted.most_common()]


def words_of(counts: Mapping[Status, int]) -> str:
    """``2 comparisons are new, 1 gone, ...``."""
    some = [f"{counts[status]:,} {status}" for status in ("new", "gone", "changed")]
    rest = counts["moved"] + counts["same"]
    return f"{', '.join(some)}; {many(rest, 'comparison')} as before ({counts['moved']:,} moved)"
