"""Gives parameters the full names that a mission tells, where the source alone does not have them.

A node reports the full name of each parameter that it reads (`Recording.names`). Recordings made
before, and nodes that report none, leave the values on the parameter server: the parameter is the
one whose name fits, whose value was compared, and whose namespace is named after the class that
reads it, if these leave only one.

Where several objects of a class evaluate a comparison, each has a key of its own (`KEY#2`) and so a
comparison of its own here, with the name that it has read.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import count

import numpy as np

from pytpc.diagnosis.thresholds.units import threshold_of
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Comparison, LinkUnit, ParameterRead
from pytpc.static.parameters import (
    DYNAMIC,
    INSTANCE,
    base_key,
    instance_number,
    of_instance,
    resolved,
    same_parameter,
    without_object,
)
from pytpc.static.static_info import StaticInfo

_CLOSE = 1e-9
NodesOf = Mapping[str, AbstractSet[str]]
_OF_ROS2 = ("rclpy", "rclcpp")
"""How the names of ROS 2's calls begin: each parameter is one of the node that reads it."""


def with_full_names(
    static_info: StaticInfo,
    recording: Recording,
    values: Mapping[str, object],
    nodes_of: NodesOf | None = None,
) -> StaticInfo:
    """The static information with the full names of this mission as sources.

    A name that the node's own name completes stays in ROS 1 (``~limit``). What a node of ROS 2
    reads as ``limit`` gets its full name, ``/ns/node/limit``; it becomes ``~limit`` if several
    nodes share the comparison, or if none has reported it. A name that several objects read under
    different full names stays if it is not known which of them evaluated the comparison. A
    comparison with a parameter that is not set is left out if the same comparison is also known
    under one that is: an older name of it. Names with an unknown part that mean the same parameters
    of the server, as they are read on several ways, become one of them.

    Args:
        static_info: of the build.
        recording: the mission.
        values: the parameter server, by full names; empty if it is not known.
        nodes_of: the nodes that evaluated each comparison, by key; those of the recording if it
            is not given.
    """
    names = _Names(recording, values, recording.nodes_of if nodes_of is None else nodes_of)
    units = _one_name_each([_renamed(unit, names) for unit in static_info.units], values)
    if all(new is old for new, old in zip(units, static_info.units, strict=True)):
        return static_info
    new = replace(static_info, units=units)
    return replace(new, set_aside=frozenset(static_info.comparisons) - frozenset(new.comparisons))


def _one_name_each(units: Sequence[LinkUnit], values: Mapping[str, object]) -> tuple[LinkUnit, ...]:
    """The units, in which names that mean the same parameters of the server are the same."""
    sources = {one.source for unit in units for one in unit.comparisons if one.source is not None}
    alike = defaultdict(list)
    by_end = defaultdict(list)
    for name in values:
        by_end[name.rpartition("/")[2]].append(name)
    # The most exact one first.
    for source in sorted(sources, key=lambda name: (-len(name.replace(f"{DYNAMIC}/", "")), name)):
        end = source.rpartition("/")[2]
        if DYNAMIC in source and DYNAMIC not in end and without_object(source) == source:
            meant = frozenset(name for name in by_end[end] if same_parameter(name, source))
            # One alone may be another parameter of that name, and this one have its default.
            if len(meant) > 1:
                alike[meant].append(source)
    names = {source: first for first, *rest in alike.values() for source in rest}
    if not names:
        return tuple(units)
    return tuple(
        replace(
            unit,
            comparisons=tuple(
                replace(one, source=names[one.source]) if one.source in names else one
                for one in unit.comparisons
            ),
            parameters=tuple(
                replace(one, name=names.get(one.name, one.name)) for one in unit.parameters
            ),
        )
        for unit in units
    )


@dataclass(frozen=True)
class _Names:
    recording: Recording
    values: Mapping[str, object]
    nodes_of: NodesOf

    @cached_property
    def reported(self) -> Mapping[str, frozenset[tuple[str, str]]]:
        """The nodes and full names that were reported for each read."""
        found = defaultdict(set)
        for one in self.recording.names:
            if not one.object:
                found[one.key].add((one.node, one.name))
        return {key: frozenset(names) for key, names in found.items()}

    @cached_property
    def objects(self) -> Mapping[str, frozenset[tuple[str, int]]]:
        """The objects that evaluate each comparison, by node and number, where nodes said it."""
        found = defaultdict(set)
        for one in self.recording.names:
            if not one.name:
                found[one.key].add((one.node, one.object))
        return {key: frozenset(objects) for key, objects in found.items()}

    @cached_property
    def read_in(self) -> Mapping[str, frozenset[tuple[str, int, str]]]:
        """The nodes, objects and full names of each read that was made in an object."""
        found = defaultdict(set)
        for one in self.recording.names:
            if one.name and one.object:
                found[one.key].add((one.node, one.object, one.name))
        return {key: frozenset(names) for key, names in found.items()}

    @cached_property
    def instances(self) -> Mapping[str, tuple[str, ...]]:
        """The keys of the instances of each comparison, but for the first one's."""
        found = defaultdict(set)
        for table in (self.recording.events, self.recording.summaries):
            for key in table.keys:
                number = instance_number(key)
                if number is not None:
                    found[base_key(key)].add((number, key))
        return {base: tuple(key for _, key in sorted(keys)) for base, keys in found.items()}

    def said_of(self, key: str, reads: Iterable[str | None]) -> frozenset[tuple[str, str]]:
        """The nodes and full names that were reported for these reads, in the objects of ``key``.

        Those of all objects if it is not known which are those of ``key``.
        """
        known = [read for read in reads if read is not None]
        said = frozenset[tuple[str, str]]().union(*(self.reported.get(r, ()) for r in known))
        if len({name for _, name in said}) < 2:
            return said
        objects = self.objects.get(key, frozenset())
        own = {
            (node, name)
            for read in known
            for node, number, name in self.read_in.get(read, ())
            if (node, number) in objects
        }
        return frozenset(own) or self._of_nodes(key, said)

    def _of_nodes(self, key: str, said: frozenset[tuple[str, str]]) -> frozenset[tuple[str, str]]:
        """Those of the names that are parameters of the nodes which evaluated ``key``."""
        nodes = self.nodes_of.get(key, frozenset())
        own = {one for one in said if any(one[1].startswith(f"{node}/") for node in nodes)}
        return frozenset(own) or said

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
        reads = _reads_of(comparison, unit)
        said = self.said_of(comparison.key, {read.key for read in reads})
        if DYNAMIC not in source and _are_of_ros2(reads):
            return self._of_ros2(comparison.key, f"~{source.lstrip('~')}", said)
        if said:
            if DYNAMIC not in source and all(name == resolved(source, node) for node, name in said):
                return None
            names = {name for _, name in said}
            return names.pop() if len(names) == 1 else None
        return self._by_value(comparison) if DYNAMIC in source and source != DYNAMIC else None

    def _of_ros2(self, key: str, own: str, said: frozenset[tuple[str, str]]) -> str | None:
        """The full name of a node's ``own`` parameter (``~limit``), if it is one node's."""
        nodes = self.nodes_of.get(key, frozenset())
        # A forked child is `/node (PID)`.
        names = {name for _, name in said} or {resolved(own, n.partition(" ")[0]) for n in nodes}
        if len(names) == 1:
            return names.pop()
        return own if all(name == resolved(own, node) for node, name in said) else None

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


def is_of_ros2(comparison: Comparison, unit: LinkUnit) -> bool:
    """Whether a node of ROS 2 reads the comparison's parameter."""
    return _are_of_ros2(_reads_of(comparison, unit))


def _reads_of(comparison: Comparison, unit: LinkUnit) -> list[ParameterRead]:
    places = {(place.file, place.lineno) for place in comparison.param_reads}
    return [
        read
        for read in unit.parameters
        if read.name == comparison.source and (read.file, read.lineno) in places
    ]


def _are_of_ros2(reads: Iterable[ParameterRead]) -> bool:
    return any(read.api.startswith(_OF_ROS2) for read in reads)


def _gives(comparison: Comparison, value: object, thresholds: Iterable[float]) -> bool:
    """Whether the value of a parameter is one of these thresholds."""
    if not isinstance(value, bool | int | float):
        return False
    wanted = threshold_of(comparison, float(value))
    return any(abs(wanted - seen) <= _CLOSE * max(1.0, abs(seen)) for seen in thresholds)


def _renamed(unit: LinkUnit, names: _Names) -> LinkUnit:
    comparisons: list[Comparison] = []
    reads = defaultdict(set)
    known = {one.key for one in unit.comparisons}
    for one in unit.comparisons:
        new = (key for key in names.instances.get(one.key, ()) if key not in known)
        for key in (one.key, *new):
            instance = one if key == one.key else replace(one, key=key)
            name = names.of(instance, unit)
            if name is not None:
                for place in one.param_reads:
                    reads[place.file, place.lineno, one.source].add(name)
            elif one.source is not None:
                name = of_instance(one.source, key)
            comparisons.append(instance if name == one.source else replace(instance, source=name))
    kept = _without_aliases(comparisons, names)
    if not reads and kept == list(unit.comparisons):
        return unit
    parameters = tuple(
        replace(read, name=name)
        for read in unit.parameters
        for name in sorted(reads.get((read.file, read.lineno, read.name), {read.name}))
    )
    return replace(unit, comparisons=tuple(kept), parameters=parameters)


def with_keys_of(reference: Recording, static_info: StaticInfo, named: StaticInfo) -> Recording:
    """A good run whose objects have the keys that they have in a mission.

    The objects of a class have their numbers by the order in which they compare, which may differ
    in the two runs. What tells them apart is the parameter that each has read.

    Args:
        reference: the good run.
        static_info: of the build.
        named: the same with the names of the mission, from ``with_full_names``.
    """
    in_mission = _sources(named)
    in_reference = _sources(with_full_names(static_info, reference, {}))
    keys: dict[str, str] = {}
    for base in sorted(in_mission.keys() | in_reference.keys()):
        here, own = in_mission.get(base, {}), in_reference.get(base, {})
        if not any(instance_number(key) is not None for key in (*here, *own)):
            continue
        free = [key for key in here if own.get(key) != here[key]]
        moved = [key for key in own if own[key] != here.get(key)]
        for key in moved:
            alike = [other for other in free if here[other] == own[key] and DYNAMIC not in own[key]]
            if len(alike) == 1:
                free.remove(alike[0])
                keys[key] = alike[0]
        # What the mission does not have gives way.
        taken = {*keys.values(), *(key for key in own if key not in moved)}
        numbers = (f"{base}{INSTANCE}{n}" for n in count(2))
        spare = (key for key in numbers if key not in here and key not in own)
        keys |= {key: next(spare) for key in moved if key not in keys and key in taken}
    if not keys:
        return reference
    # Asked again, its objects stay where they are.
    return reference.with_keys(lambda key: keys.get(key, key))


def _sources(static_info: StaticInfo) -> dict[str, dict[str, str]]:
    """The parameters of each comparison's instances, by the comparison's key and by theirs."""
    found = defaultdict[str, dict[str, str]](dict)
    for key, one in static_info.comparisons.items():
        if one.source is not None:
            found[base_key(key)][key] = one.source
    return dict(found)


def _without_aliases(comparisons: list[Comparison], names: _Names) -> list[Comparison]:
    """Those that are left if an unset parameter is compared where one that is set is, too."""
    if not names.values:
        return comparisons
    together = defaultdict(list)
    for one in comparisons:
        if one.type != "constant":
            place = one.file, one.lineno, one.column, one.function, one.relation
            together[place, instance_number(one.key)].append(one)
    left_out = set()
    for alike in together.values():
        unset = [one.key for one in alike if not names.is_set(one)]
        if len(unset) < len(alike):
            left_out.update(unset)
    return [one for one in comparisons if one.key not in left_out]
