"""The file by which a user corrects what TPC takes for the processes of a workspace."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.closest import did_you_mean
from pytpc.base.errors import InputError
from pytpc.base.source_bytes import read_bytes
from pytpc.processes.plugins import Plugin
from pytpc.values.yaml_tree import YamlNode, read_yaml

FILE = "tpc-processes.yaml"
"""The name of the file, in the folder of a workspace."""
_LISTS = ("plugins", "libraries")


@dataclass(frozen=True, slots=True)
class Named:
    """A name, and the line on which it stands."""

    text: str
    line: int


@dataclass(frozen=True, slots=True)
class Corrected:
    """A process of a program: all plugins that it loads, and further libraries."""

    name: str = ""
    plugins: tuple[Named, ...] = ()
    libraries: tuple[Named, ...] = ()


@dataclass(frozen=True, slots=True)
class Corrections:
    """For some programs (PACKAGE/NAME) all of their processes; an empty list: it has none."""

    path: Path | None = None
    programs: Mapping[str, tuple[Corrected, ...]] = field(default_factory=dict)
    lines: Mapping[str, int] = field(default_factory=dict)

    def of(self, program: str) -> tuple[Corrected, ...] | None:
        """The processes of a program; None if the file says nothing of it."""
        return self.programs.get(program)

    def refuse_unknown(self, known: Iterable[str]) -> None:
        """Check that the workspace has all programs of the file.

        Raises:
            InputError: it has not, with the line.
        """
        there = list(known)
        for program in self.programs:
            if program not in there:
                hint = did_you_mean(program, there)
                raise InputError(
                    f"no program {program} was built{hint}", self.path, self.lines[program]
                )

    def plugin(self, given: Named, known: Sequence[Plugin]) -> Plugin:
        """The plugin of that name or class.

        Raises:
            InputError: there is none, with the line.
        """
        for plugin in known:
            if given.text in plugin.names:
                return plugin
        hint = did_you_mean(given.text, (plugin.name for plugin in known))
        raise InputError(f"no package declares a plugin {given.text}{hint}", self.path, given.line)

    def library(self, given: Named, known: Mapping[str, Path]) -> Path:
        """The library of the workspace whose file has that name.

        Raises:
            InputError: there is none, with the line.
        """
        if given.text not in known:
            hint = did_you_mean(given.text, known)
            raise InputError(f"no library {given.text} was built{hint}", self.path, given.line)
        return known[given.text]


def read_corrections(path: Path) -> Corrections:
    """Read the file.

    Raises:
        InputError: it cannot be read, is not YAML or has not the form that is described in
            docs/reference/formats.md; with the line.
    """
    try:
        documents = read_yaml(read_bytes(path).decode("utf-8"))
    except UnicodeDecodeError as error:
        raise InputError("not UTF-8", path) from error
    except ValueError as error:
        raise InputError(str(error), path) from error
    top = _pairs(documents[0] if documents else None, path)
    programs, lines = {}, {}
    for key, value in top:
        if key.text != "processes":
            raise InputError(f"unknown key {key.text}; processes is expected", path, key.lineno)
        for program, given in _pairs(value.behind, path):
            if given.behind.kind != "list":
                raise InputError("a list of processes is expected", path, given.lineno)
            processes = tuple(_corrected(one.behind, path) for one in given.behind.items)
            programs[program.text], lines[program.text] = processes, program.lineno
    return Corrections(path, programs, lines)


def _pairs(node: YamlNode | None, path: Path) -> list[tuple[YamlNode, YamlNode]]:
    if node is None or (node.is_plain and not node.text):
        return []
    if node.kind != "map":
        raise InputError("names with values are expected", path, node.lineno)
    return node.pairs


def _corrected(node: YamlNode, path: Path) -> Corrected:
    name = ""
    lists: dict[str, tuple[Named, ...]] = dict.fromkeys(_LISTS, ())
    for key, value in _pairs(node, path):
        if key.text == "name":
            if value.behind.kind != "scalar":
                raise InputError("a name is expected", path, value.lineno)
            name = value.behind.text
        elif key.text in lists:
            lists[key.text] = _texts(value.behind, path)
        else:
            known = ", ".join(("name", *_LISTS))
            raise InputError(f"unknown key {key.text}; there are: {known}", path, key.lineno)
    return Corrected(name, **lists)


def _texts(node: YamlNode, path: Path) -> tuple[Named, ...]:
    if node.kind != "list" or any(one.behind.kind != "scalar" for one in node.items):
        raise InputError("a list of names is expected", path, node.lineno)
    return tuple(Named(one.behind.text, one.lineno) for one in node.items)


def write_corrections(workspace: Path, text: str) -> Path:
    """Write the file of a workspace that has none.

    Raises:
        InputError: there is one, or it cannot be written.
    """
    path = workspace / FILE
    if path.exists():
        raise InputError("is there already; edit it, or remove it first", path)
    try:
        write_atomic(path, text.encode())
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror}", path) from error
    return path
