"""A process: its executable, the link units that it loads, and its plugins."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.build.reconcile import Recorded
from pytpc.processes.plugins import Plugin
from pytpc.processes.starts import Start
from pytpc.static.static_info import manifest_of


@dataclass(frozen=True, slots=True)
class Unit:
    """A link unit of the workspace.

    ``functions`` is None where it was not analysed. ``recorded`` says where its static information
    is, and what was found for it.
    """

    package: str
    name: str
    path: Path
    recorded: Recorded
    functions: int | None = None

    @property
    def full_name(self) -> str:
        """Its package and name."""
        return f"{self.package}/{self.name}"

    @property
    def manifest(self) -> Path:
        """What it was linked from, where that is known: beside its static information."""
        return manifest_of(self.recorded.static_info)

    @property
    def is_known(self) -> bool:
        """Whether its code can be read: it was compiled to bitcode."""
        return self.functions is not None or self.manifest.is_file()


@dataclass(frozen=True, slots=True)
class Choice:
    """Which plugins of a base class a process loads, and how that is known.

    ``why`` is ``launch``, ``parameters``, ``code`` (a default or a text in the program), ``all``
    (nothing names one, so it may be any) or ``corrected``. ``others`` are those that it does not
    load.
    """

    base: str
    plugins: tuple[Plugin, ...]
    why: str
    others: tuple[Plugin, ...] = ()


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of the analysis of a process, in the last build that had to do it.

    ``functions`` are those that it can reach. ``seconds`` are of processor time. ``failure`` says
    why its units were analysed alone, or is None.
    """

    functions: int
    comparisons: int
    seconds: float
    memory_mib: int
    failure: str | None = None


@dataclass(frozen=True, slots=True)
class Process:
    """An executable with the units of the workspace that it loads, in the order of the linker.

    ``program`` is its package and name; ``host`` the file, which may be one of the system that
    loads plugins of the workspace, and is None if it is not installed here. ``scopes`` are the
    units in which the dynamic linker looks symbols up: first those that all units use, then those
    of each library that is opened later and that itself alone uses. ``starts`` are the
    nodes of launch files that run so. ``outcome`` is None where it was not analysed as a whole.
    """

    name: str
    program: str
    host: Path | None
    units: tuple[Unit, ...]
    choices: tuple[Choice, ...] = ()
    scopes: tuple[tuple[Unit, ...], ...] = ()
    starts: tuple[Start, ...] = ()
    outcome: Outcome | None = None

    @property
    def functions(self) -> int:
        """How many functions its analysed units have; those of headers count in each unit."""
        return sum(unit.functions or 0 for unit in self.units)

    @property
    def plugins(self) -> tuple[Plugin, ...]:
        """The plugins that it loads."""
        return tuple(plugin for choice in self.choices for plugin in choice.plugins)

    @property
    def named_scopes(self) -> list[list[str]]:
        """The full names of the units in each of its scopes."""
        return [[unit.full_name for unit in scope] for scope in self.scopes]

    @property
    def is_joined(self) -> bool:
        """Whether code of several units meets in it."""
        return sum(unit.is_known for unit in self.units) > 1


@dataclass(frozen=True, slots=True)
class Processes:
    """The processes of a workspace; ``faults`` and ``unread`` say what was left out, and why."""

    found: tuple[Process, ...]
    faults: tuple[str, ...] = ()
    unread: Mapping[Path, str] = field(default_factory=dict)


NONE = Processes(())
"""No processes at all."""
