"""What is known of a robot before it runs: the values that are set, and what its nodes read."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, NamedTuple

from pytpc.lint.finding import Spot
from pytpc.recording.declaration import Declared
from pytpc.recording.parameter_values import ValueChange
from pytpc.static.parameters import DYNAMIC

Angle = Literal["", "degrees", "radians"]
Needed = Literal["", "fails", "reports"]
# Stand for what is not known, while the rest of a name is escaped.
_ANY_FOLDER, _ANY = "\0", "\1"
_PATTERNS = {_ANY_FOLDER: "/(?:.*/)?", _ANY: ".*"}
_PLACES = re.compile("([\0\1])")
_WORD = re.compile(r"[A-Za-z][\w.-]*")


@dataclass(frozen=True, slots=True)
class Earlier:
    """A value that another one has replaced; ``is_known`` is false where only its place is known.

    ``is_same_text`` says that it stands in the same YAML map: one of the two lines is a mistake.
    """

    spot: Spot
    value: object = None
    is_known: bool = False
    is_same_map: bool = False


@dataclass(frozen=True, slots=True)
class Setting:
    """A value that is set: the full name, the line that counts, and those that it replaces."""

    name: str
    value: object
    spot: Spot
    earlier: tuple[Earlier, ...] = ()


@dataclass(frozen=True, slots=True)
class NodeRead:
    """A call in one node that reads a parameter.

    ``name`` is the full name, with ``<dynamic>`` for what only the running node knows; ``api`` the
    function, ``type`` that of the variable or empty, ``default`` None where it is not known.
    ``is_table`` says that all values below the name are read. ``needed`` says what the node does
    without a value, if it has no default: ``fails``, or ``reports`` an error. ``deprecation`` is
    the line beside the call that calls the name deprecated. ``at_start`` says that the call can
    only be made while the node starts. ``angle`` is the unit in which the code takes the value.
    ``is_converted`` says that the code takes it of any type.
    """

    name: str
    api: str
    type: str
    default: object
    spot: Spot
    is_table: bool = False
    needed: Needed = ""
    deprecation: Spot | None = None
    at_start: bool = False
    angle: Angle = ""
    is_converted: bool = False

    @property
    def is_exact(self) -> bool:
        """Whether the whole name is known."""
        return DYNAMIC not in self.name

    @property
    def is_reconfigured(self) -> bool:
        """Whether dynamic_reconfigure hands it over."""
        return "dynamic_reconfigure" in self.api

    @property
    def is_ros2(self) -> bool:
        """Whether a node of ROS 2 reads it."""
        return self.api.startswith(("rclcpp", "rclpy"))


class Renamed(NamedTuple):
    """The new name of a parameter, where code says so, and the file with the code that reads it.

    ``namespace`` is the last part of the namespace in which it is read, if that is known.
    """

    new: str
    spot: Spot
    reader: str
    namespace: str = ""


@dataclass(frozen=True)
class Node:
    """A node that is started.

    ``unjudged`` says why its reads are not all known; empty where they are. ``texts`` are texts in
    its sources and libraries that may be names of parameters, though no read of them is known.
    ``pieces`` are texts with which its code puts names together, ``words`` those of its arguments.
    ``renamed`` has the last parts of names that its code calls old.
    """

    name: str
    program: str
    reads: Sequence[NodeRead] = ()
    unjudged: str = ""
    texts: frozenset[str] = frozenset()
    renamed: Mapping[str, Renamed] = field(default_factory=dict)
    pieces: frozenset[str] = frozenset()
    words: frozenset[str] = frozenset()

    @cached_property
    def _by_end(self) -> Mapping[str, list[tuple[re.Pattern[str], NodeRead]]]:
        found = defaultdict(list)
        for read in self.reads:
            end = last_part(read.name)
            key = "" if read.is_table or DYNAMIC in end else end
            found[key].append((_pattern(read), read))
        return found

    def reads_of(self, name: str) -> list[NodeRead]:
        """The reads that may be of the parameter with this full name."""
        near = (*self._by_end.get(last_part(name), ()), *self._by_end.get("", ()))
        return [read for pattern, read in near if pattern.fullmatch(name)]

    def has(self, name: str) -> bool:
        """Whether a parameter is in the node's own namespace."""
        return name.startswith(f"{self.name}/")


@dataclass(frozen=True, slots=True)
class Crossing:
    """How a comparison with a parameter came out in all recordings of a mission.

    ``nearest`` is the smallest distance of the compared value from the threshold, NaN where it is
    not known; ``seconds`` the time from the first to the last evaluation, added up.
    """

    parameter: str
    spot: Spot
    source_code: str
    threshold: float
    evaluations: int
    seconds: float
    nearest: float
    result: bool
    recordings: int


@dataclass(frozen=True)
class Facts:
    """All that is known.

    ``set_by_code`` are the last parts of names that code sets. ``elsewhere`` are nodes that other
    launch files start. ``changes`` were made while a recorded robot ran.
    """

    settings: Sequence[Setting]
    nodes: Sequence[Node]
    declared: Sequence[Declared] = ()
    set_by_code: frozenset[str] = frozenset()
    elsewhere: frozenset[str] = frozenset()
    changes: Sequence[ValueChange] = ()
    crossings: Sequence[Crossing] = ()

    @cached_property
    def by_name(self) -> Mapping[str, Setting]:
        """The settings by full name."""
        return {setting.name: setting for setting in self.settings}

    @cached_property
    def _tables(self) -> frozenset[str]:
        return frozenset(one for name in self.by_name for one in above(name))

    @cached_property
    def words(self) -> frozenset[str]:
        """The words of all values: one may be a list of the names of others."""
        return frozenset(word for one in self.settings for word in words_in(one.value))

    @cached_property
    def read_one_by_one(self) -> frozenset[str]:
        """The namespaces of values that a node reads by their own names."""
        return frozenset(
            namespace(one.name)
            for one in self.settings
            if any(not is_anything(read) for _, read in self.readers(one.name))
        )

    @cached_property
    def declared_by_name(self) -> Mapping[str, Sequence[Declared]]:
        """The declarations by their names."""
        found = defaultdict(list)
        for one in self.declared:
            found[one.parameter].append(one)
        return found

    @cached_property
    def reads_by_end(self) -> Mapping[str, Sequence[tuple[Node, NodeRead]]]:
        """All reads by the last part of their names, with their nodes."""
        found = defaultdict(list)
        for node in self.nodes:
            for read in node.reads:
                found[last_part(read.name)].append((node, read))
        return found

    def is_set(self, name: str) -> bool:
        """Whether a parameter, or one below it, is set."""
        return name in self.by_name or name in self._tables

    @cached_property
    def _readers(self) -> dict[str, tuple[tuple[Node, NodeRead], ...]]:
        """What ``readers`` has looked up: most kinds of findings ask for the same names."""
        return {}

    def readers(self, name: str) -> tuple[tuple[Node, NodeRead], ...]:
        """All reads that may be of a parameter, with their nodes."""
        found = self._readers.get(name)
        if found is None:
            found = tuple((node, read) for node in self.nodes for read in node.reads_of(name))
            self._readers[name] = found
        return found

    def owners(self, name: str) -> list[Node]:
        """The nodes in whose own namespace a parameter is; of nested ones the innermost."""
        owners = [node for node in self.nodes if node.has(name)]
        longest = max((len(node.name) for node in owners), default=0)
        return [node for node in owners if len(node.name) == longest]


@dataclass(frozen=True, slots=True)
class Unjudged:
    """Parameters of which it is not known whether a node reads them, by the reason."""

    reasons: Mapping[str, frozenset[str]] = field(default_factory=dict)


def last_part(name: str) -> str:
    """The part of a name behind the last slash.

    >>> last_part("/move_base/planner/limits.max"), last_part("/a")
    ('limits.max', 'a')
    """
    return name.rpartition("/")[2]


def namespace(name: str) -> str:
    """What stands before the last part of a name.

    >>> namespace("/move_base/rate"), namespace("/guard/limits.max"), namespace("/a")
    ('/move_base', '/guard/limits', '')
    """
    before, _, last = name.rpartition("/")
    group, dot, _ = last.rpartition(".")
    return f"{before}/{group}" if dot else before


def own_part(name: str) -> str:
    """The part of a name that its namespace does not have.

    >>> own_part("/move_base/rate"), own_part("/guard/limits.max")
    ('rate', 'max')
    """
    return last_part(name).rpartition(".")[2]


def is_anything(read: NodeRead) -> bool:
    """Whether the last part of its name is not known, so that it may be of any parameter."""
    return DYNAMIC in last_part(read.name)


def words_in(value: object) -> Iterator[str]:
    """The words of a value, or of those in a list or map, that may be names of parameters.

    >>> sorted(words_in(["front_laser back/laser, {a}", {"name": 5}]))
    ['a', 'back', 'front_laser', 'laser', 'name']
    """
    if isinstance(value, str):
        yield from _WORD.findall(value)
    elif isinstance(value, Mapping):
        for key, below in value.items():
            yield from words_in(key)
            yield from words_in(below)
    elif isinstance(value, list | tuple):
        for one in value:
            yield from words_in(one)


def above(name: str) -> Iterator[str]:
    """The namespaces that a name is in, from the inside.

    >>> list(above("/arm/pid/p"))
    ['/arm/pid', '/arm']
    """
    while (name := name.rpartition("/")[0]) != "":
        yield name


def _pattern(read: NodeRead) -> re.Pattern[str]:
    """What the full names of a read look like; a part that is not known may be empty."""
    name = read.name.rstrip("/")
    places = name.replace(f"/{DYNAMIC}/", _ANY_FOLDER).replace(DYNAMIC, _ANY)
    known = "".join(_PATTERNS.get(part) or re.escape(part) for part in _PLACES.split(places))
    below = r"(?:[/.].+)?" if read.is_table else ""
    return re.compile(known + below)
