"""What became of the parameters between two builds: new, gone, renamed, not compared any more."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from typing import Literal, NamedTuple

from pytpc.base.wording import Number, exact, listed, tidy
from pytpc.static.builds import program_name
from pytpc.static.coverage import STATES, Covered, State, coverage
from pytpc.static.link_unit import Default, LinkUnit, ParameterRead
from pytpc.static.matching import Site, function_name
from pytpc.static.static_info import StaticInfo

Kind = Literal["new", "gone", "renamed", "uncompared", "default", "declared"]
KINDS: dict[Kind, str] = {
    "new": "read only now",
    "gone": "not read any more",
    "renamed": "likely renamed",
    "uncompared": "compared nowhere any more",
    "default": "another default",
    "declared": "declared otherwise",
}
"""What may have become of a parameter, and how it is called."""

_ALIKE = 0.75
_NAMED = 3
_RECONFIGURE = "dynamic_reconfigure"
# Calls that take a default, which need not be constant; and those that tell ROS 2 of a parameter.
_WITH_DEFAULT = ("::param", "get_parameter_or", "declare_parameter", "declare_parameters")


class DeclaredAs(NamedTuple):
    """What a ``.cfg`` file of a package says about a parameter; ``place`` is its file and line."""

    package: str
    parameter: str
    type: str
    default: Number | str | None
    low: Number | None
    high: Number | None
    choices: tuple[tuple[str, Number | str], ...]
    place: str

    @property
    def identity(self) -> tuple[str, str, str]:
        """Two files of a package may declare the same name."""
        return self.package, self.place.rpartition(":")[0], self.parameter

    def words(self) -> str:
        """``double, default 0.55, 0 to 50``."""
        words = [self.type]
        if self.default is not None:
            words.append(f"default {shown_default(self.default)}")
        if self.low is not None or self.high is not None:
            ends = ["any" if end is None else shown_default(end) for end in (self.low, self.high)]
            words.append(f"{ends[0]} to {ends[1]}")
        if self.choices:
            words.append(f"one of {listed([name for name, _ in self.choices], _NAMED)}")
        return ", ".join(words)


@dataclass(frozen=True, slots=True)
class ParameterChange:
    """What became of one parameter of a package.

    ``parameter`` is its name in the newer build that has it, ``old`` and ``new`` are what differs
    in words: names, defaults, states or declarations. ``why`` is the reason of the analysis if it
    is not compared any more, and what hints at a new name. ``places`` are those that read it now,
    or did. ``is_unbuilt``: all that read it are link units that the new build does not have.
    """

    kind: Kind
    package: str
    parameter: str
    old: str
    new: str
    why: str = ""
    places: tuple[str, ...] = ()
    is_unbuilt: bool = False


@dataclass(slots=True)
class _Read:
    """A parameter of a package, in all its link units."""

    state: State
    reads: list[tuple[str, ParameterRead]] = field(default_factory=list)
    covered: list[Covered] = field(default_factory=list)
    units: set[str] = field(default_factory=set)

    @property
    def places(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(place for one in self.covered for place in one.reads))

    def defaults(self, units: Collection[str] = ()) -> tuple[Default, ...]:
        """Those of its reads in these link units, or of all if none of them reads it."""
        reads = [read for unit, read in self.reads if unit in units]
        reads = reads or [read for _, read in self.reads]
        return tuple(sorted({repr(o.default): o.default for o in reads}.values(), key=repr))

    @property
    def ways(self) -> set[tuple[str, str, str]]:
        """How it is read: type, default and function."""
        return {(r.type, repr(r.default), function_name(r.function)) for _, r in self.reads}


_Names = Mapping[tuple[str, str], _Read]


def parameter_changes(
    old: StaticInfo,
    new: StaticInfo,
    pairs: Sequence[tuple[Site, Site]],
    declarations: tuple[Iterable[DeclaredAs], Iterable[DeclaredAs]] = ((), ()),
    unbuilt: Collection[str] = (),
) -> tuple[ParameterChange, ...]:
    """What became of the parameters, sorted by kind, package and name.

    Args:
        old: the older build.
        new: the newer one.
        pairs: the comparisons that both have; if another parameter is compared, it may have
            another name.
        declarations: what ``.cfg`` files say in both.
        unbuilt: link units that the newer build does not have, or did not analyse.
    """
    before, after = _read(old), _read(new)
    gone = {name: one for name, one in before.items() if name not in after}
    fresh = {name: one for name, one in after.items() if name not in before}
    found = list(_renamed(gone, fresh, pairs))
    renamed = {(one.package, name) for one in found for name in (one.old, one.new)}
    for kind, names in (("gone", gone), ("new", fresh)):
        found += [
            _come_or_gone(kind, name, one, unbuilt)  # type: ignore[arg-type]
            for name, one in names.items()
            if name not in renamed
        ]
    moved_to = {
        (one.package, one.new): (one.package, one.old) for one in found if one.kind == "renamed"
    }
    for name, one in after.items():
        there = before.get(moved_to.get(name, name))
        if there is not None:
            found += _kept(name, there, one)
    found += _declared(*declarations)
    order = list(KINDS)
    return tuple(sorted(found, key=lambda o: (order.index(o.kind), o.package, o.parameter)))


def declared_in_code(
    units: Iterable[LinkUnit],
) -> tuple[Mapping[tuple[str, int, str], bool], Collection[str]]:
    """Which reads declare their parameter, by (absolute file, line, name), and these names.

    A read declares it with a default, with ``declare_parameter`` of ROS 2, or as a field of
    dynamic_reconfigure, which comes from a ``.cfg`` file.
    """
    places: dict[tuple[str, int, str], bool] = {}
    names = set()
    for unit in units:
        for read in unit.parameters:
            is_declared = (
                read.default is not None
                or _RECONFIGURE in read.api
                or read.api.endswith(_WITH_DEFAULT)
            )
            at = unit.absolute(read.file), read.lineno, read.name
            places[at] = places.get(at, False) or is_declared
            if is_declared:
                names.add(read.name)
    return places, names


def _read(static: StaticInfo) -> _Names:
    """Each parameter that is read, by package and name; the most telling of its states."""
    order = list(STATES)
    found: dict[tuple[str, str], _Read] = {}
    reads: defaultdict[tuple[str, str], list[tuple[str, ParameterRead]]] = defaultdict(list)
    for unit in static.units:
        for read in unit.parameters:
            reads[unit.package, read.name].append((program_name(unit), read))
    for one in coverage(static):
        name = one.package, one.parameter
        known = found.setdefault(name, _Read(one.state, reads[name]))
        known.state = min(known.state, one.state, key=order.index)
        known.covered.append(one)
        known.units.add(f"{one.package}/{one.link_unit}")
    # What a unit only compares was read by another one, and changes with that.
    return {name: one for name, one in found.items() if one.places}


def _come_or_gone(
    kind: Literal["new", "gone"], name: tuple[str, str], one: _Read, unbuilt: Collection[str]
) -> ParameterChange:
    package, parameter = name
    said = f"{STATES[one.state]}; default {shown_defaults(one.defaults())}"
    is_unbuilt = kind == "gone" and one.units <= set(unbuilt)
    ends = (said, "") if kind == "gone" else ("", said)
    return ParameterChange(
        kind, package, parameter, *ends, places=one.places, is_unbuilt=is_unbuilt
    )


def _kept(name: tuple[str, str], old: _Read, new: _Read) -> Iterator[ParameterChange]:
    package, parameter = name
    if old.state == "compared" and new.state != "compared":
        lost = [lost for one in new.covered for lost in (*one.lost, *one.unread)]
        hidden = [place for one in new.covered for place in one.hidden]
        why = [f"{one.place}: {one.why}" for one in lost] or hidden
        yield ParameterChange(
            "uncompared",
            package,
            parameter,
            STATES[old.state],
            STATES[new.state],
            listed(list(dict.fromkeys(why)), _NAMED),
            new.places,
        )
    shared = old.units & new.units
    told = other_defaults(old.defaults(shared), new.defaults(shared))
    if told is not None:
        yield ParameterChange("default", package, parameter, *told, places=new.places)


def _renamed(
    gone: _Names, fresh: _Names, pairs: Sequence[tuple[Site, Site]]
) -> Iterator[ParameterChange]:
    """Parameters that are likely the same under another name.

    Either the same comparisons are with the other one, or it is read in the same function with the
    same type and default, and the names are alike.
    """
    compared: Counter[tuple[str, str, str]] = Counter()
    for one, other in pairs:
        if one.tpc.parameter != other.tpc.parameter:
            for package in {one.unit.package, one.tpc.package}:
                compared[package, one.threshold, other.threshold] += 1
    taken = set[tuple[str, str]]()
    scored = []
    for (package, name), old in gone.items():
        for (its, called), new in fresh.items():
            if package == its:
                known = compared[package, name, called]
                alike, why = _likeness(name, called, (old, new), known)
                scored.append((-alike, package, name, called, why))
    for alike, package, name, called, why in sorted(scored):
        if alike < 0 and not taken & {(package, name), (package, called)}:
            taken |= {(package, name), (package, called)}
            places = fresh[package, called].places
            yield ParameterChange("renamed", package, called, name, called, why, places)


def _likeness(
    name: str, other: str, reads: tuple[_Read, _Read], compared: int
) -> tuple[float, str]:
    """How sure it is that a parameter has another name, and why; 0 if it is not."""
    ratio = SequenceMatcher(None, name, other, autojunk=False).ratio()
    if compared:
        return 1 + compared + ratio, "the same comparisons are with it"
    one, it = reads
    if ratio >= _ALIKE and one.ways & it.ways:
        return ratio, "read in the same function with the same type and default"
    return 0.0, ""


def _declared(old: Iterable[DeclaredAs], new: Iterable[DeclaredAs]) -> Iterator[ParameterChange]:
    before, after = ({o.identity: o for o in every} for every in (old, new))
    if not before or not after:
        return
    for name in sorted({*before, *after}):
        one, other = before.get(name), after.get(name)
        was, now = ("" if each is None else each.words() for each in (one, other))
        if was != now:
            place = other or one
            places = () if place is None else (place.place,)
            yield ParameterChange("declared", name[0], name[2], was, now, places=places)


def other_defaults(old: Sequence[Default], new: Sequence[Default]) -> tuple[str, str] | None:
    """What the defaults were and are; None if they are the same. 1 is not 1.0, nor true."""
    if list(map(repr, old)) == list(map(repr, new)):
        return None
    was, now = shown_defaults(old), shown_defaults(new)
    if was == now:
        was, now = (", ".join(map(str, defaults)) for defaults in (old, new))
    return was, now


def shown_defaults(defaults: Sequence[Default]) -> str:
    """Defaults as they are printed; ``none`` of a read without one."""
    return ", ".join(map(shown_default, defaults)) or "none"


def shown_default(default: Default) -> str:
    """One default; a text stands in quotes."""
    if default is None:
        return "none"
    return f'"{default}"' if isinstance(default, str) else exact(tidy(default))
