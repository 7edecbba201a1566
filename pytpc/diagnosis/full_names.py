"""Gives parameters the full names that a mission tells, where the source alone does not have them.

A node reports the full name of each parameter that it reads (`Recording.names`). Recordings made
before, and nodes that report none, leave the values on the parameter server: the parameter is the
one whose name fits, whose value was compared, and whose namespace is named after the class that
reads it, if these leave only one.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pytpc.diagnosis.thresholds.units import threshold_of
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Comparison, LinkUnit
from pytpc.static.parameters import DYNAMIC, resolved, same_parameter
from pytpc.static.static_info import StaticInfo

_CLOSE = 1e-9


def with_full_names(
    static_info: StaticInfo, recording: Recording, values: Mapping[str, object]
) -> StaticInfo:
    """The static information with the full names of this mission as sources.

    A name that the node's own name completes stays (``~limit``). So does one that several objects
    read under different names. A comparison with a parameter that is not set is left out if the
    same comparison is also known under one that is: an older name of it.

    Args:
        static_info: of the build.
        recording: the mission.
        values: the parameter server, by full names; empty if it is not known.
    """
    names = _Names(recording, values)
    units = tuple(_renamed(unit, names) for unit in static_info.units)
    if all(new is old for new, old in zip(units, static_info.units, strict=True)):
        return static_info
    new = replace(static_info, units=units)
    return replace(new, set_aside=frozenset(static_info.comparisons) - frozenset(new.comparisons))


@dataclass(frozen=True)
class _Names:
    recording: Recording
    values: Mapping[str, object]

    @cached_property
    def reported(self) -> Mapping[str, frozenset[tuple[str, str]]]:
        """The nodes and full names that were reported for each read."""
        found = defaultdict(set)
        for one in self.recording.names:
            found[one.key].add((one.node, one.name))
        return {key: frozenset(names) for key, names in found.items()}

    @cached_property
    def nodes_of(self) -> Mapping[str, frozenset[str]]:
        """The nodes that evaluated each comparison."""
        found = defaultdict(set)
        for table in (self.recording.events, self.recording.summaries):
            seen = np.zeros((len(table.keys), len(table.nodes)), np.bool_)
            seen[table.key, table.node] = True
            for key, node in np.argwhere(seen).tolist():
                found[table.keys[key]].add(table.nodes[node])
        return {key: frozenset(nodes) for key, nodes in found.items()}

    def thresholds_of(self, key: str) -> tuple[float, ...]:
        """The different thresholds of a comparison, at most three."""
        found: set[float] = set()
        for table in (self.recording.events, self.recording.summaries):
            if key in table.keys:
                found |= set(np.unique(table.thresh[table.key == table.keys.index(key)]).tolist())
        return tuple(sorted(found)[:3])

    def of(self, comparison: Comparison, unit: LinkUnit) -> str | None:
        """The full name of a comparison's parameter, if the source's name must be replaced."""
        source = comparison.source
        if source is None or (source.startswith("/") and DYNAMIC not in source):
            return None
        reads = {(place.file, place.lineno) for place in comparison.param_reads}
        keys = {
            read.key
            for read in unit.parameters
            if read.name == source and (read.file, read.lineno) in reads and read.key is not None
        }
        said = frozenset[tuple[str, str]]().union(*(self.reported.get(key, ()) for key in keys))
        if said:
            if DYNAMIC not in source and all(name == resolved(source, node) for node, name in said):
                return None
            names = {name for _, name in said}
            return names.pop() if len(names) == 1 else None
        return self._by_value(comparison) if DYNAMIC in source and source != DYNAMIC else None

    def _by_value(self, comparison: Comparison) -> str | None:
        """The parameter of the server that has this comparison's name and value."""
        source = comparison.source
        assert source is not None
        nodes = self.nodes_of.get(comparison.key, frozenset())
        fitting = [name for name in self.values if same_parameter(name, source)]
        fitting = [n for n in fitting if any(n.startswith(f"{node}/") for node in nodes)] or fitting
        if len(fitting) > 1:
            seen = self.thresholds_of(comparison.key)
            fitting = [name for name in fitting if _gives(comparison, self.values[name], seen)]
        if len(fitting) > 1:
            own = comparison.function.partition("(")[0].split("::")[:-1]
            fitting = [name for name in fitting if set(name.split("/")[:-1]) & set(own)]
        return fitting[0] if len(fitting) == 1 else None

    def is_set(self, comparison: Comparison) -> bool:
        """Whether the parameter stands on the server, as far as that is known."""
        source = comparison.source
        if source is None:
            return True
        nodes = self.nodes_of.get(comparison.key, frozenset())
        if DYNAMIC not in source:
            return any(resolved(source, node) in self.values for node in nodes)
        return any(same_parameter(name, source) for name in self.values)


def _gives(comparison: Comparison, value: object, thresholds: Iterable[float]) -> bool:
    """Whether the value of a parameter is one of these thresholds."""
    if not isinstance(value, bool | int | float):
        return False
    wanted = threshold_of(comparison, float(value))
    return any(abs(wanted - seen) <= _CLOSE * max(1.0, abs(seen)) for seen in thresholds)


def _renamed(unit: LinkUnit, names: _Names) -> LinkUnit:
    comparisons: list[Comparison] = []
    reads: dict[tuple[str, int, str | None], str] = {}
    for one in unit.comparisons:
        name = names.of(one, unit)
        comparisons.append(one if name is None else replace(one, source=name))
        if name is not None:
            reads |= {(place.file, place.lineno, one.source): name for place in one.param_reads}
    kept = _without_aliases(comparisons, names)
    if not reads and len(kept) == len(unit.comparisons):
        return unit
    parameters = tuple(
        replace(read, name=reads.get((read.file, read.lineno, read.name), read.name))
        for read in unit.parameters
    )
    return replace(unit, comparisons=tuple(kept), parameters=parameters)


def _without_aliases(comparisons: list[Comparison], names: _Names) -> list[Comparison]:
    """Those that are left if an unset parameter is compared where one that is set is, too."""
    if not names.values:
        return comparisons
    together = defaultdict(list)
    for one in comparisons:
        if one.type != "constant":
            together[one.file, one.lineno, one.column, one.function, one.relation].append(one)
    left_out = set()
    for alike in together.values():
        unset = [one.key for one in alike if not names.is_set(one)]
        if len(unset) < len(alike):
            left_out.update(unset)
    return [one for one in comparisons if one.key not in left_out]
