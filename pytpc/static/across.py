"""Comparisons that were found in whole processes: which processes, and over which link units.

A process is analysed as one program, so a parameter may be read in one link unit, compared in a
second one and exposed by a third. The steps of such a comparison's path name their link units.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pytpc.base.closest import did_you_mean
from pytpc.base.errors import InputError
from pytpc.base.wording import plain
from pytpc.static.link_unit import PathStep
from pytpc.static.places import Tpc
from pytpc.static.static_info import StaticInfo

_COMPARED = frozenset({"compare", "decide"})


def units_of(path: Iterable[PathStep]) -> tuple[str, ...]:
    """The link units (``package/name``) that a path leads through, each once, in its order."""
    return tuple(dict.fromkeys(step.unit for step in path if step.unit is not None))


def changes(path: Sequence[PathStep]) -> list[str | None]:
    """For each step its link unit where the path enters it, else None.

    All are None if the path stays in one link unit, or does not name them.
    """
    if len(units_of(path)) < 2:
        return [None] * len(path)
    entered: list[str | None] = []
    here = None
    for step in path:
        entered.append(step.unit if step.unit != here else None)
        here = step.unit or here
    return entered


def across(path: Sequence[PathStep]) -> str:
    """Which link unit does what; empty if the path stays in one, or they are not known.

    For example ``read in nav/limits -> compared and exposed in robot/drive, through nav/map``.
    """
    named = [step for step in path if step.unit is not None]
    if not named or len(units_of(path)) < 2:
        return ""
    compared = next((step for step in named if step.step in _COMPARED), None)
    parts: list[tuple[list[str], str]] = []
    for what, step in (("read", named[0]), ("compared", compared), ("exposed", named[-1])):
        if step is None or step.unit is None:
            continue
        if parts and parts[-1][1] == step.unit:
            parts[-1][0].append(what)
        else:
            parts.append(([what], step.unit))
    ends = {unit for _, unit in parts}
    between = [unit for unit in units_of(path) if unit not in ends]
    text = " -> ".join(f"{_listed(done)} in {unit}" for done, unit in parts)
    return f"{text}, through {', '.join(between)}" if between else text


def _listed(words: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))


def processes_of(static: StaticInfo, tpc: Tpc) -> tuple[str, ...]:
    """The processes in whose analysis a comparison was found, sorted.

    Empty if all of its link units were analysed alone.
    """
    found = (static.comparisons[each.key].processes for each in tpc.keys)
    return tuple(sorted({name for names in found for name in names or ()}))


def is_in_process(static: StaticInfo, tpc: Tpc, names: Iterable[str]) -> bool:
    """Whether one of the processes has a comparison.

    A link unit that was analysed alone is a process of its own name.
    """
    return not set(names).isdisjoint(_all_of(static, tpc))


def _all_of(static: StaticInfo, tpc: Tpc) -> Iterable[str]:
    for each in tpc.keys:
        processes = static.comparisons[each.key].processes
        if processes is None:
            yield f"{each.package}/{each.link_unit}"
        else:
            yield from processes


def check_processes(static: StaticInfo, names: Iterable[str]) -> None:
    """Check names that a user gave.

    Raises:
        InputError: one is no process that was analysed; the message has the closest names.
    """
    known: dict[str, None] = {}
    for unit in static.units:
        if unit.processes is None:
            known[f"{unit.package}/{unit.link_unit}"] = None
        known.update(dict.fromkeys(unit.processes or ()))
    for name in names:
        if name not in known:
            hint = did_you_mean(name, known) or "; `pytpc processes` lists the processes"
            raise InputError(f"no process {plain(name)} in this static information{hint}")
