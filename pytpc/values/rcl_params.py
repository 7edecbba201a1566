"""Reads params files of ROS 2 as rcl does, and keeps for each value where it is written.

rcl (rcl_yaml_param_parser) reads the events of YAML with a small machine that knows namespaces by
counting names. ``ParamsStore`` follows this machine step by step, because some of what it does
cannot be seen in the file: all files and rules of one command line fill one store, whose nodes
stand in the order of their first mention. A node takes the values of all entries that match its
name, in this order, so `/**` of a later file does not override a node's own entry of an earlier
one. A value of another type does not replace the one that the same entry has already.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from pytpc.values.rcl_scalars import rcl_value
from pytpc.values.scalars import type_of
from pytpc.values.yaml_tree import YamlNode, read_yaml

PARAMS_KEY = "ros__parameters"
ANY_NODE = "/**"
# rclcpp and rclpy take the first of these that a parameter has.
_ORDER = ("bool", "int", "double", "string", "bool[]", "int[]", "double[]", "string[]")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)
_LONGEST_NAME = 255


class ParamsError(ValueError):
    """A params file that rcl refuses; ``lineno`` is the line, counted from 1."""

    def __init__(self, message: str, lineno: int | None = None) -> None:
        super().__init__(message)
        self.lineno = lineno


@dataclass(frozen=True, slots=True)
class Written:
    """A value and the place where it is written.

    ``step`` is the number of the file or rule among all of the command line, from 0. ``keys`` are
    those of the YAML file from the top, ``node`` and ``lineno`` its text there; a rule has neither.
    """

    value: object
    step: int
    lineno: int | None = None
    keys: tuple[str, ...] = ()
    node: YamlNode | None = None


@dataclass(slots=True)
class Slot:
    """A parameter of an entry: one value of each type, and all values in the order of reading."""

    name: str
    by_type: dict[str, Written] = field(default_factory=dict)
    all: list[Written] = field(default_factory=list)

    @property
    def holds(self) -> Written | None:
        """The value that a node gets; None where it has none, as from ``[]``."""
        return next((self.by_type[kind] for kind in _ORDER if kind in self.by_type), None)

    @property
    def is_stale(self) -> bool:
        """Whether a later value does not count, because it is of another type."""
        return bool(self.all) and self.holds is not self.all[-1]


@dataclass(slots=True)
class NodeEntry:
    """An entry of a params file: the name or pattern as written, and its parameters.

    ``maps`` are the values of its ``ros__parameters``, of which there may be several.
    """

    written: str
    slots: list[Slot] = field(default_factory=list)
    maps: list[YamlNode] = field(default_factory=list)

    @property
    def pattern(self) -> str:
        """The name with a slash in front."""
        return self.written if self.written.startswith("/") else f"/{self.written}"

    @property
    def is_wildcard(self) -> bool:
        """Whether it may be for several nodes."""
        return "*" in self.written

    def fits(self, node: str) -> bool:
        """Whether a node of this full name takes the parameters of the entry."""
        return re.fullmatch(self.pattern.replace("/*", r"(/\w+)"), node) is not None

    def slot(self, name: str) -> Slot:
        """The first parameter of this name; it is added where there is none."""
        for slot in self.slots:
            if slot.name == name:
                return slot
        self.slots.append(Slot(name))
        return self.slots[-1]


@dataclass(slots=True)
class Held:
    """What a node gets for one parameter, the entry that it is from, and all others that set it."""

    entry: NodeEntry
    slot: Slot
    overridden: list[Written] = field(default_factory=list)


class ParamsStore:
    """The parameters that the files and rules of one command line set."""

    def __init__(self) -> None:
        self.entries: list[NodeEntry] = []
        self.steps = 0

    def entry(self, written: str) -> NodeEntry:
        """The entry of this name as written; it is added where there is none."""
        for one in self.entries:
            if one.written == written:
                return one
        self.entries.append(NodeEntry(written))
        return self.entries[-1]

    def load(self, text: str) -> None:
        """Read a params file.

        Raises:
            ParamsError: rcl refuses it, or it is not YAML.
        """
        try:
            documents = read_yaml(text)
        except ValueError as error:
            raise ParamsError(*_split_line(str(error))) from error
        reader = _Reader(self, self.steps)
        self.steps += 1
        for document in documents:
            reader.read(document)

    def set_rule(self, rule: str) -> None:
        """Take a rule ``name:=value`` or ``node:name:=value`` of a command line.

        Raises:
            ParamsError: rcl refuses it.
        """
        name, assigned, text = rule.partition(":=")
        node, colon, own = name.rpartition(":")
        if not assigned or not own or not text:
            raise ParamsError(f"{rule!r} is not NAME:=VALUE")
        if colon and not _NAME.fullmatch(node):
            raise ParamsError(f"{rule!r}: {node!r} is no name of a node without its namespace")
        try:
            documents = read_yaml(text)
        except ValueError as error:
            raise ParamsError(f"{rule!r}: {error}") from error
        slot = self.entry(node if colon else ANY_NODE).slot(own)
        for document in documents:
            _put(slot, document, self.steps)
        self.steps += 1

    def all_written(self) -> Iterator[tuple[NodeEntry, Slot, Written]]:
        """All values, those that do not count too."""
        for entry in self.entries:
            for slot in entry.slots:
                for written in slot.all:
                    yield entry, slot, written

    def of_node(self, node: str) -> dict[str, Held]:
        """What a node of this full name gets, by the names of the parameters."""
        found: dict[str, Held] = {}
        for entry in self.entries:
            if not entry.fits(node):
                continue
            for slot in entry.slots:
                before = found.get(slot.name)
                earlier = [] if before is None else [*before.overridden, *before.slot.all]
                found[slot.name] = Held(entry, slot, earlier)
        for held in found.values():
            held.overridden += [one for one in held.slot.all if one is not held.slot.holds]
        return found


def _split_line(message: str) -> tuple[str, int | None]:
    """The line that a message of ``read_yaml`` has, apart."""
    found = re.search(r" in line (\d+)|^(?:not YAML: )?line (\d+): ", message)
    if found is None:
        return message, None
    return message.replace(found[0], "", 1), int(found[1] or found[2])


def _put(slot: Slot, node: YamlNode, step: int, keys: tuple[str, ...] = ()) -> None:
    """Give a parameter a value; without keys it is that of a rule.

    Raises:
        ParamsError: rcl refuses the value.
    """
    value: object
    if node.kind == "list":
        value = _list(node)
        if not value:
            return
        kind = f"{type_of(value[0])}[]"
    else:
        value = _scalar(node)
        kind = type_of(value)
    written = Written(value, step, node.lineno, keys, node) if keys else Written(value, step)
    slot.by_type[kind] = written
    slot.all.append(written)


def _scalar(node: YamlNode) -> bool | int | float | str:
    if node.kind == "alias":
        raise ParamsError("rcl does not read aliases (*name)", node.lineno)
    if node.kind != "scalar":
        raise ParamsError("rcl does not read maps in lists", node.lineno)
    quoted = node.style in ("'", '"')
    if not node.text and not quoted:
        raise ParamsError("no value, which rcl refuses", node.lineno)
    return rcl_value(node.text, node.tag, quoted=quoted)


def _list(node: YamlNode) -> list[bool | int | float | str]:
    values: list[bool | int | float | str] = []
    for item in node.items:
        if item.kind == "list":
            raise ParamsError("rcl does not read lists in lists", item.lineno)
        values.append(_scalar(item))
        first, last = type_of(values[0]), type_of(values[-1])
        if first != last:
            raise ParamsError(
                f"the list has values of the types {first} and {last}, which rcl refuses",
                item.lineno,
            )
    return values


class _Names:
    """The name that rcl joins of keys, and how many keys it counts."""

    def __init__(self, separator: str) -> None:
        self.text = ""
        self.count = 0
        self._separator = separator

    def add(self, name: str) -> None:
        separator = "" if not self.count or self.text.endswith(self._separator) else self._separator
        self.text = f"{self.text}{separator}{name}" if self.count else name
        self.count += 1

    def remove(self) -> None:
        """Cut the text at its last separator, wherever a key began."""
        if self.count == 1:
            self.text = ""
        elif self._separator in self.text:
            self.text = self.text.rpartition(self._separator)[0]
        self.count = max(self.count - 1, 0)


class _Reader:
    """The machine of rcl_yaml_param_parser, for one file."""

    def __init__(self, store: ParamsStore, step: int) -> None:
        self._store = store
        self._step = step
        self._nodes, self._params = _Names("/"), _Names(".")
        self._in_params = False
        self._depth = 0
        self._is_new_map = False
        self._entry: NodeEntry | None = None
        self._slot: Slot | None = None

    def read(self, node: YamlNode, keys: tuple[str, ...] = ()) -> None:
        """Read a document, or the value of a key."""
        if node.kind == "map":
            self._map(node, keys)
        elif not keys:
            self._check_key(node)
        elif not self._in_params or self._entry is None or self._slot is None:
            raise ParamsError(
                f"a value that is not below {PARAMS_KEY}, which rcl refuses", node.lineno
            )
        else:
            _put(self._slot, node, self._step, keys)

    def _map(self, node: YamlNode, keys: tuple[str, ...]) -> None:
        self._depth += 1
        self._is_new_map = not (self._in_params and self._depth - self._nodes.count == 3)
        for key, value in node.pairs:
            self._check_key(key)
            was_in_params = self._in_params
            self._key(key)
            if self._in_params and not was_in_params and self._entry is not None:
                self._entry.maps.append(value)
            self.read(value, (*keys, key.text))
        if self._in_params and self._params.count:
            self._params.remove()
        elif self._in_params:
            self._in_params = False
        elif self._depth == self._nodes.count + 1:
            self._nodes.remove()
        self._depth -= 1

    @staticmethod
    def _check_key(key: YamlNode) -> None:
        if key.kind == "alias":
            raise ParamsError("rcl does not read aliases (*name)", key.lineno)
        if key.kind != "scalar" or not key.text:
            raise ParamsError("a key that is no text, which rcl refuses", key.lineno)

    def _key(self, key: YamlNode) -> None:
        if not self._in_params:
            if not key.text.startswith(PARAMS_KEY):
                self._nodes.add(key.text)
                return
            if not self._nodes.count:
                raise ParamsError(f"no name of a node before {PARAMS_KEY}", key.lineno)
            check_node_name(self._nodes.text, key.lineno)
            self._entry, self._slot = self._store.entry(self._nodes.text), None
            self._nodes.remove()
            self._in_params = True
            return
        if self._entry is None:
            raise ParamsError(f"a parameter that is not below {PARAMS_KEY}", key.lineno)
        if self._is_new_map:
            if self._slot is None:
                raise ParamsError("a map that has no name", key.lineno)
            self._params.text, self._params.count = self._slot.name, self._params.count + 1
            self._is_new_map = False
        if not self._params.count:
            self._slot = self._entry.slot(key.text)
            return
        # rcl gives the parameter that stands for the map the name of its value.
        self._slot = self._entry.slot(self._params.text)
        self._slot.name = f"{self._params.text}.{key.text}"


def check_node_name(name: str, lineno: int | None = None) -> None:
    """Check the name or pattern of a node in a params file.

    Raises:
        ParamsError: rcl refuses it.
    """
    parts = name.removeprefix("/").split("/")
    for part in parts:
        if part not in ("*", "**") and not _NAME.fullmatch(part):
            raise ParamsError(f"{name!r} is no name of a node, which rcl refuses", lineno)
    if len(name) > _LONGEST_NAME:
        raise ParamsError(f"the name of a node has {len(name)} characters", lineno)


def is_params_text(text: str) -> bool:
    """Whether a YAML text is a params file of ROS 2: some map in it is ``ros__parameters``."""
    if PARAMS_KEY not in text:
        return False
    try:
        documents = read_yaml(text)
    except ValueError:
        return True
    return any(key.text == PARAMS_KEY for document in documents for key in _keys(document))


def _keys(node: YamlNode) -> Iterator[YamlNode]:
    for key, value in node.pairs:
        yield key
        if value.kind == "map":
            yield from _keys(value)
