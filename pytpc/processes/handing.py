"""Hands to each link unit what its processes found, and says which have to be linked again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.build.reconcile import Recorded, recorded_units
from pytpc.processes.analysis import Analysed
from pytpc.processes.processes import Read

_CHANGED = "changed"
# What of a plan is in a function: a link takes it if it has the function.
_LISTS = ("reports", "names", "comparisons", "parameters", "exposing", "not_exposed", "blind_spots")


def delay(folders: Iterable[Path], base: Path) -> None:
    """Let units that are linked from now on wait until their processes are analysed.

    Args:
        folders: the build folders of packages.
        base: programs that use libraries below this folder wait, too.
    """
    for unit in units_of(folders):
        write_atomic(unit.waits, f"{base}\n".encode())


def end_delay(folders: Iterable[Path]) -> bool:
    """Let units wait no longer; whether any did."""
    waiting = [unit.waits for unit in units_of(folders) if unit.waits.is_file()]
    for path in waiting:
        path.unlink()
    return bool(waiting)


def forget(folders: Iterable[Path]) -> list[str]:
    """Let units be analysed alone; the packages of those that have to be linked for that."""
    return _hand_all(units_of(folders), {})


def hand_out(parts: Iterable[Parts], folders: Iterable[Path]) -> list[str]:
    """Give each unit the plans of its processes; those without are analysed alone.

    Args:
        parts: the plans of the processes.
        folders: the build folders of all packages.

    Returns:
        The packages with units that have to be linked again.
    """
    of_units: dict[tuple[str, str], list[Parts]] = {}
    for one in parts:
        for unit in one.analysed.process.units:
            # What is not part of the module is analysed alone.
            if one.analysed.functions.get(unit.full_name):
                of_units.setdefault((unit.package, unit.name), []).append(one)
    return _hand_all(units_of(folders), of_units)


def units_of(folders: Iterable[Path]) -> list[Recorded]:
    """The units in these build folders that may get plans."""
    return [
        unit
        for folder in folders
        for unit in recorded_units(folder) or ()
        if not unit.left_out and unit.plans.is_dir()
    ]


def _hand_all(
    units: Iterable[Recorded], of_units: Mapping[tuple[str, str], Sequence[Parts]]
) -> list[str]:
    changed = [
        unit.package for unit in units if _hand(unit, of_units.get((unit.package, unit.name), ()))
    ]
    return list(dict.fromkeys(changed))


def _hand(unit: Recorded, parts: Sequence[Parts]) -> bool:
    """Link the plans into the folder of a unit; whether it has to be linked again."""
    wanted = {f"{one.plan.parent.name}.json": one.plan for one in parts}
    for path in unit.plans.glob("*.json"):
        if path.name not in wanted:
            path.unlink()
    for name, plan in wanted.items():
        link = unit.plans / name
        if not link.is_symlink() or link.readlink() != plan:
            link.unlink(missing_ok=True)
            link.symlink_to(plan)
    name = f"{unit.package}/{unit.name}"
    text = "".join(f"{one.digest_for(name)}\n" for one in parts).encode()
    unit.waits.unlink(missing_ok=True)
    stamp = unit.plans / _CHANGED
    known = stamp.read_bytes() if stamp.is_file() else None
    if known == text and not unit.was_delayed:
        return False
    # The unit is older than this file: its link is out of date.
    write_atomic(stamp, text)
    return True


@dataclass(frozen=True, slots=True)
class Parts:
    """What a plan says of each function, by the name that linkers know."""

    analysed: Analysed
    plan: Path
    of_functions: Mapping[str, Sequence[Any]]

    @classmethod
    def read(cls, analysed: Analysed) -> Parts:
        """Read the plan of a process that has one."""
        assert analysed.plan is not None
        plan: Any = parse_json(analysed.plan)
        functions = plan["functions"]
        found: dict[str, list[Any]] = {}
        for kind in _LISTS:
            for entry in plan[kind]:
                # Its number may change with other code.
                said = {**entry, "function": _described(functions, entry["function"])}
                name = _name_of(functions, entry["function"])
                found.setdefault(name, []).append([kind, said])
        return cls(analysed, analysed.plan, found)

    def digest_for(self, unit: str) -> str:
        """A text that differs when what is said of the functions of a unit does."""
        text = json.dumps([self.analysed.process.name, self._said_of(unit)])
        return hashlib.sha256(text.encode()).hexdigest()

    def defaults_in(self, unit: str) -> list[Read]:
        """The parameters that a unit reads with a text as default."""
        infos = [
            entry["info"]
            for said in self._said_of(unit)
            for kind, entry in said
            if kind == "parameters"
        ]
        return [(one["name"], one["default"]) for one in infos if isinstance(one["default"], str)]

    def _said_of(self, unit: str) -> list[Sequence[Any]]:
        """What is said of each function of a unit, in the order of their names."""
        names = self.analysed.functions.get(unit, frozenset()) & self.of_functions.keys()
        return [self.of_functions[name] for name in sorted(names)]


def _described(functions: Sequence[Any], number: int) -> Any:  # noqa: ANN401
    """A function of a plan, with those that it names by number."""
    entry = functions[number]
    return {
        name: _described(functions, value) if name in ("of", "in") else value
        for name, value in entry.items()
    }


def _name_of(functions: Sequence[Any], number: int) -> str:
    entry = functions[number]
    while "of" in entry:
        entry = functions[entry["of"]]
    return str(entry["name"])
