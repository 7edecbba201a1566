"""Static information: built, analysed or collected."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.base.wording import many
from pytpc.build.build import BuildResult, build_workspace
from pytpc.build.collect import Collected, collect_sources
from pytpc.build.python_units import (
    PythonUnits,
    analyse_scripts,
    analyse_workspaces,
    joined,
    named_beside,
    scripts_at,
)
from pytpc.processes.analysis import Analysed, Budget, with_outcomes
from pytpc.processes.corrections import FILE, Corrections, read_corrections, write_corrections
from pytpc.processes.process import NONE, Processes
from pytpc.processes.processes import find_processes
from pytpc.processes.whole import EachUnitAlone, WholeProcesses
from pytpc.python_analysis.budget import SECONDS
from pytpc.python_analysis.rules_file import Rules
from pytpc.static.sources import with_source_digests
from pytpc.static.static_info import StaticInfo
from pytpc.workspace.colcon import PLAIN_BUILD, Bases, BuildOptions

__all__ = [
    "BuildOptions",
    "BuildResult",
    "Collected",
    "Processes",
    "WholeBuild",
    "analyse",
    "build",
    "collect",
    "processes",
    "write_corrections",
]

Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class WholeBuild:
    """A build, and what became of each process in which code of several units meets.

    ``failure`` says why the processes are unknown; each unit was then analysed alone.
    """

    build: BuildResult
    processes: Processes = NONE
    analysed: tuple[Analysed, ...] = ()
    failure: str | None = None


def build(
    workspace: Path,
    options: BuildOptions = PLAIN_BUILD,
    *,
    on_output: Callable[[str], None] | None = None,
    on_scripts: Progress | None = None,
    on_process: Callable[[str, int, int], None] | None = None,
) -> WholeBuild:
    """Build a workspace, analyse its processes, and link again what they change.

    Args:
        workspace, options, on_output, on_scripts: as `build_workspace` has them.
        on_process: called with (name of a process that begins, processes analysed, all of them).

    Raises:
        TpcError: as `build_workspace`; or the file with corrections is broken.
    """
    bases = options.bases if options.bases is not None else Bases.of(workspace.resolve())
    if not options.processes:
        between = EachUnitAlone(bases)
        return WholeBuild(
            build_workspace(
                workspace, options, on_output=on_output, on_scripts=on_scripts, between=between
            )
        )
    budget = Budget(options.process_seconds)
    whole = WholeProcesses(workspace, bases, _corrections(workspace), budget, on_process)
    result = build_workspace(
        workspace, options, on_output=on_output, on_scripts=on_scripts, between=whole
    )
    return WholeBuild(result, whole.found, tuple(whole.analysed), whole.failure)


def analyse(
    sources: Sequence[Path],
    rules: Rules,
    *,
    max_seconds: float = SECONDS,
    on_progress: Progress | None = None,
) -> StaticInfo:
    """Find the comparisons of Python nodes; nothing is run, and ROS is not needed.

    Args:
        sources: scripts, packages or workspaces.
        rules: what reads a parameter, and what counts as exposing.
        max_seconds: how long the analysis of one script may take; 0 is no limit.
        on_progress: called with (scripts done, all scripts).

    Raises:
        InputError: there is no Python node, or none can be analysed.
    """
    scripts = joined(scripts_at(source, rules, sources) for source in sources)
    if not scripts.entries and not scripts.left_out:
        raise InputError("no Python node here: a script with a shebang, or a __main__", sources[0])
    analysed = analyse_scripts(scripts, rules, on_progress, max_seconds)
    if not analysed.units:
        others = len(analysed.left_out) - 1
        also = f" (and {many(others, 'other script')} that cannot be analysed)" if others else ""
        raise InputError(f"{analysed.left_out[0].reason}{also}")
    found = StaticInfo.of(named_beside(analysed.units, ()), left_out=analysed.left_out)
    # By these, a later recording is known to be of the same code, as after a build.
    return with_source_digests(found)


def collect(
    sources: Sequence[Path],
    rules: Rules | None = None,
    *,
    on_scripts: Progress | None = None,
    on_progress: Progress | None = None,
) -> Collected:
    """Merge the static information of all link units below each source.

    Args:
        sources: workspaces, build bases, build folders or files of static information.
        rules: for the Python nodes of workspaces; None: they are not analysed.
        on_scripts: called with (scripts analysed, all scripts).
        on_progress: called with (files read, all files).

    Raises:
        InputError: a source cannot be read.
    """
    python: PythonUnits | None = None
    if rules is not None:
        python = analyse_workspaces(sources, rules, on_scripts)
    return collect_sources(sources, on_progress, python)


def processes(
    workspace: Path,
    base: Path | None = None,
    corrections: Path | None = None,
    *,
    on_progress: Progress | None = None,
) -> Processes:
    """Which code of a built workspace runs in one process: programs, libraries and plugins.

    Args:
        workspace: built by `build`.
        base: where it was built; None: in its folder ``.tpc``.
        corrections: a file with what the user knows better; None: the one in the workspace, if any.
        on_progress: called with (launch files read, all launch files).

    Raises:
        WorkspaceError: it is not built, or has no packages.
        InputError: a file of the build or of corrections is broken, or names what is not there.
    """
    known = _corrections(workspace, corrections)
    bases = None if base is None else Bases(base.absolute())
    found = find_processes(workspace, bases, known, on_progress)
    root = Bases.of(workspace).root if bases is None else bases.root
    return replace(found, found=with_outcomes(found.found, root))


def _corrections(workspace: Path, given: Path | None = None) -> Corrections:
    """What the user says of programs; by default, in the file of the workspace, if it has one."""
    if given is None and (workspace / FILE).is_file():
        given = workspace / FILE
    return Corrections() if given is None else read_corrections(given)
