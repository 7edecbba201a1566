"""Static information: built, analysed or collected."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.base.wording import many
from pytpc.build.build import BuildResult
from pytpc.build.build import build_workspace as build
from pytpc.build.collect import Collected, collect_sources
from pytpc.build.python_units import (
    PythonUnits,
    analyse_scripts,
    analyse_workspaces,
    joined,
    named_beside,
    scripts_at,
)
from pytpc.processes.corrections import FILE, Corrections, read_corrections, write_corrections
from pytpc.processes.process import Processes
from pytpc.processes.processes import find_processes
from pytpc.python_analysis.budget import SECONDS
from pytpc.python_analysis.rules_file import Rules
from pytpc.static.sources import with_source_digests
from pytpc.static.static_info import StaticInfo
from pytpc.workspace.colcon import Bases, BuildOptions

__all__ = [
    "BuildOptions",
    "BuildResult",
    "Collected",
    "Processes",
    "analyse",
    "build",
    "collect",
    "processes",
    "write_corrections",
]

Progress = Callable[[int, int], None]


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
    if corrections is None and (workspace / FILE).is_file():
        corrections = workspace / FILE
    known = Corrections() if corrections is None else read_corrections(corrections)
    bases = None if base is None else Bases(base.absolute())
    return find_processes(workspace, bases, known, on_progress)
