"""Between the two links of a build: which processes there are, and what is found in each."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.base.errors import TpcError
from pytpc.build.reconcile import build_folders
from pytpc.processes.analysis import Analysed, Budget, Progress, analyse_processes
from pytpc.processes.corrections import Corrections
from pytpc.processes.handing import Parts, delay, end_delay, forget, hand_out, units_of
from pytpc.processes.process import NONE, Processes
from pytpc.processes.processes import Read, Reads, Search, defaults_of
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo
from pytpc.workspace.colcon import Bases

# Each may find plugins that load others.
_ROUNDS = 4


@dataclass(slots=True)
class WholeProcesses:
    """Analyses the processes of a workspace while it is built; see `pytpc.build.build.Between`.

    Args:
        workspace: the folder of the workspace.
        bases: where it is built.
        corrections: what the user says of some programs.
        budget: for the analysis of each process.
        on_process: called with (name of a process that begins, processes done, all of them).

    ``found`` and ``analysed`` are what became of the processes. If they could not be found,
    ``failure`` says why; each unit is then analysed alone.
    """

    workspace: Path
    bases: Bases
    corrections: Corrections
    budget: Budget
    on_process: Progress | None = None
    found: Processes = NONE
    analysed: list[Analysed] = field(default_factory=list)
    failure: str | None = None

    def begin(self, folders: Sequence[Path]) -> None:
        """Let the units of these build folders wait."""
        delay(folders, self.bases.root)

    def at_once(self, folder: Path) -> bool:
        """Let the units of a build folder be analysed by their links; whether any waited."""
        return end_delay([folder])

    def link_again(self) -> Collection[str]:
        """Analyse the processes; the packages with units that have to be linked again."""
        folders = build_folders(self.bases.build) if self.bases.build.is_dir() else []
        if not units_of(folders):
            return ()
        try:
            return hand_out(self._analyse(), folders)
        except (TpcError, OSError, ValueError, KeyError, TypeError) as error:
            self.failure = str(error) if isinstance(error, TpcError) else repr(error)
            self.analysed = []
            return forget(folders)

    def _analyse(self) -> Sequence[Parts]:
        """Find and analyse the processes; the plans of those that have one."""
        known = self._known()
        search = Search.begin(self.workspace.absolute(), self.bases, known)
        reads: Reads = {(one.package, one.link_unit): defaults_of(one) for one in known}
        before, parts = NONE, list[Parts]()
        for _ in range(_ROUNDS):
            self.found = search.found(reads, self.corrections)
            if self.found == before:
                break
            self.analysed = analyse_processes(
                self.found.found, self.bases.root, self.budget, self.on_process
            )
            parts = [Parts.read(one) for one in self.analysed if one.plan is not None]
            # Defaults of parameters name plugins, and are known only now if the code is new.
            before, reads = self.found, {**reads, **_reads(parts)}
        return parts

    def _known(self) -> Sequence[LinkUnit]:
        """What an earlier build found."""
        try:
            return StaticInfo.load(self.bases.static_info).units
        except TpcError:
            return ()


def _reads(parts: Sequence[Parts]) -> Reads:
    """Of the units of all processes, the parameters with a text as default."""
    found: dict[tuple[str, str], list[Read]] = {}
    for one in parts:
        for unit in one.analysed.process.units:
            known = found.setdefault((unit.package, unit.name), [])
            known += one.defaults_in(unit.full_name)
    return found


@dataclass(frozen=True, slots=True)
class EachUnitAlone:
    """Forgets what processes found in an earlier build: each unit is analysed when it is linked."""

    bases: Bases

    def begin(self, folders: Sequence[Path]) -> None:
        """Take away the plans, before the first link."""
        forget(folders)

    def at_once(self, folder: Path) -> bool:
        """None waits."""
        return False

    def link_again(self) -> Collection[str]:
        """Nothing: all is done by the first link."""
        return ()
