"""A process: its executable, the link units that it loads, and its plugins."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.processes.plugins import Plugin
from pytpc.processes.starts import Start


@dataclass(frozen=True, slots=True)
class Unit:
    """A link unit of the workspace; ``functions`` is None where it was not analysed."""

    package: str
    name: str
    path: Path
    functions: int | None = None

    @property
    def is_analysed(self) -> bool:
        """Whether its code is known: it was compiled to bitcode and analysed."""
        return self.functions is not None


@dataclass(frozen=True, slots=True)
class Choice:
    """Which plugins of a base class a process loads, and how that is known.

    ``why`` is ``launch``, ``parameters``, ``code`` (a default or a text in the program), ``all``
    (nothing names one, so it may be any) or ``corrected``.
    """

    base: str
    plugins: tuple[Plugin, ...]
    why: str


@dataclass(frozen=True, slots=True)
class Process:
    """An executable with the units of the workspace that it loads, in the order of the linker.

    ``program`` is its package and name; ``host`` the file, which may be one of the system that
    loads plugins of the workspace, and is None if it is not installed here. ``starts`` are the
    nodes of launch files that run so.
    """

    name: str
    program: str
    host: Path | None
    units: tuple[Unit, ...]
    choices: tuple[Choice, ...] = ()
    starts: tuple[Start, ...] = ()

    @property
    def functions(self) -> int:
        """How many functions its analysed units have; those of headers count in each unit."""
        return sum(unit.functions or 0 for unit in self.units)

    @property
    def plugins(self) -> tuple[Plugin, ...]:
        """The plugins that it loads."""
        return tuple(plugin for choice in self.choices for plugin in choice.plugins)

    @property
    def is_joined(self) -> bool:
        """Whether code of several units meets in it."""
        return sum(unit.is_analysed for unit in self.units) > 1


@dataclass(frozen=True, slots=True)
class Processes:
    """The processes of a workspace; ``faults`` and ``unread`` say what was left out, and why."""

    found: tuple[Process, ...]
    faults: tuple[str, ...] = ()
    unread: Mapping[Path, str] = field(default_factory=dict)
