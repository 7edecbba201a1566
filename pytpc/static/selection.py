"""Which TPCs are shown, and in which order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from pytpc.base.closest import did_you_mean
from pytpc.base.errors import InputError
from pytpc.base.wording import plain
from pytpc.static.across import check_processes, is_in_process
from pytpc.static.explanations import same_file
from pytpc.static.places import Tpc
from pytpc.static.static_info import StaticInfo

_WILD = frozenset("*?[")

ORDERS: dict[str, Callable[[Tpc], tuple[object, ...]]] = {
    "place": lambda tpc: (tpc.package, tpc.place, tpc.lineno, tpc.column),
    "parameter": lambda tpc: ((tpc.parameter or tpc.name or "").lstrip("~/"), tpc.distance),
    "distance": lambda tpc: (tpc.distance,),
    "type": lambda tpc: (tpc.type, (tpc.parameter or "").lstrip("~/")),
    "units": lambda tpc: (-len(tpc.keys),),
}
"""How TPCs can be sorted; those that are equal stay in the order of their places."""


@dataclass(frozen=True, slots=True)
class Selection:
    """A selection; an empty field selects everything.

    ``packages`` own the source file, or a program that contains it. ``parameters`` and ``files``
    may have wildcards; a name's namespace and a path's first folders may be left out. ``processes``
    are those in whose analysis a comparison was found.
    """

    packages: tuple[str, ...] = ()
    parameters: tuple[str, ...] = ()
    types: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    constants: bool = False
    processes: tuple[str, ...] = ()
    order: str = "place"


def select(static: StaticInfo, wanted: Selection) -> list[Tpc]:
    """The selected TPCs, sorted.

    Raises:
        InputError: no package, no process, or no parameter that is compared has one of the names.
    """
    _check_packages(static, wanted.packages)
    _check_parameters(static, wanted.parameters)
    check_processes(static, wanted.processes)
    found = [tpc for tpc in static.tpcs if _is_wanted(tpc, wanted)]
    if wanted.processes:
        found = [tpc for tpc in found if is_in_process(static, tpc, wanted.processes)]
    return sorted(found, key=ORDERS[wanted.order])


def _check_packages(static: StaticInfo, names: Sequence[str]) -> None:
    known = {unit.package for unit in static.units}
    for name in names:
        if name not in known:
            there = ", ".join(sorted(known)) or "none"
            hint = did_you_mean(name, known) or f"; there are: {there}"
            raise InputError(f"no package {name} in this static information{hint}")


def _check_parameters(static: StaticInfo, patterns: Sequence[str]) -> None:
    """A pattern may fit nothing; a name that does is most likely a typing mistake."""
    for name in patterns:
        if _WILD.isdisjoint(name) and not any(_is_named(tpc, name) for tpc in static.tpcs):
            hint = did_you_mean(name, {tpc.parameter for tpc in static.tpcs if tpc.parameter})
            raise InputError(
                f"no comparison with a parameter {plain(name)} in this static information"
                f"{hint or '; `pytpc coverage` shows what became of each parameter'}"
            )


def _is_wanted(tpc: Tpc, wanted: Selection) -> bool:
    if tpc.type == "constant" and not (wanted.constants or "constant" in wanted.types):
        return False
    packages = {tpc.package, *(each.package for each in tpc.keys)}
    return (
        (not wanted.packages or not packages.isdisjoint(wanted.packages))
        and (not wanted.types or tpc.type in wanted.types)
        and (not wanted.parameters or any(_is_named(tpc, each) for each in wanted.parameters))
        and (not wanted.files or any(_is_in(tpc, each) for each in wanted.files))
    )


def _is_named(tpc: Tpc, pattern: str) -> bool:
    name = tpc.parameter
    if name is None:
        return False
    return any(fnmatchcase(each, pattern) for each in (name, name.lstrip("~/"), _last(name)))


def _last(name: str) -> str:
    return name.replace("~", "/").rpartition("/")[2]


def _is_in(tpc: Tpc, pattern: str) -> bool:
    if _WILD.isdisjoint(pattern):
        return same_file(tpc.file, pattern)
    known = (tpc.file, tpc.place, f"{tpc.package}/{tpc.place}", _last(tpc.place))
    return any(fnmatchcase(each, pattern) for each in known)
