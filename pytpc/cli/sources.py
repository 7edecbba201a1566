"""The SOURCE arguments of commands, and the static information they name."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pytpc.base.paths import MERGED_FILE, OWN_FOLDER
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import PATH, Command
from pytpc.cli.completion_commands import offer_parameters
from pytpc.cli.console import progress, warn
from pytpc.cli.lines import say
from pytpc.static.sources import changed_sources
from pytpc.static.static_info import StaticInfo, read_static

if TYPE_CHECKING:
    from pytpc.build.stale import Stale
    from pytpc.recording.mission import Recording

_READ = "pytpc.static"
_FILE = "pytpc.static.file."

SOURCES = click.argument("sources", type=PATH, nargs=-1, metavar="[SOURCE]...")


def SOURCES_AND_QUESTION(command: Command) -> Command:
    """The arguments ``sources`` and ``question``; either may be the word that is being typed."""
    sources = click.argument(
        "sources", type=PATH, nargs=-1, metavar="[SOURCE]...", shell_complete=offer_parameters
    )
    question = click.argument(
        "question", metavar="KEY|PARAMETER|FILE:LINE", shell_complete=offer_parameters
    )
    return sources(question(command))


def static_of(sources: Sequence[Path]) -> StaticInfo:
    """The static information of a static.json, a build base or a workspace, or of several folders.

    Without any: static.json in this folder, else what ``pytpc build`` left below it.
    """
    here = Path("static.json")
    chosen = list(sources) or [here if here.is_file() else Path()]
    with progress("reading static information") as advance:
        if len(chosen) == 1 and _is_merged(chosen[0]):
            static = read_static(chosen[0], advance)
            _note_file(static, chosen[0])
            return static
        # Its import takes longer than to read a file, and needs the analysis of Python.
        from pytpc.build.collect import collect_sources  # noqa: PLC0415

        collected = collect_sources(chosen, advance)
    tell_dropped(collected.dropped)
    return collected.static


def static_for(
    given: Path | None, mission: Path | None = None, recording: Recording | None = None
) -> StaticInfo:
    """The static information of a mission: what was given, the recording's own, or what fits.

    If it was found elsewhere, a line says where. Each file is read once, however many missions
    need it.

    Args:
        given: by ``--static``.
        mission: its path; None: a running robot.
        recording: what was read from it.

    Raises:
        InputError: there is none, or it is broken.
    """
    # Its import takes longer than that of the commands that need no recording.
    from pytpc.api.static_of_mission import find_static, own_static  # noqa: PLC0415

    read: dict[Path, StaticInfo] = click.get_current_context().meta.setdefault(_READ, {})
    known = given
    if known is None and mission is not None:
        known = own_static(mission)
    if known is not None:
        if known not in read:
            read[known] = static_of([known])
        return read[known]
    with progress("looking for static information"):
        found = find_static(mission, recording)
    if found.path not in read:
        read[found.path] = found.static
        _note_file(found.static, found.path)
        say(plain(found.words))
    return read[found.path]


def known_static_file(source: Path | None) -> Path | None:
    """The file with the static information of a built workspace, or ``source`` itself; or None."""
    if source is None:
        return None
    file = source / OWN_FOLDER / MERGED_FILE if source.is_dir() else source
    return file if file.is_file() else None


def _note_file(static: StaticInfo, source: Path) -> None:
    """Remember which file was read, for ``warn_of_changed``."""
    file = known_static_file(source)
    if file is not None:
        click.get_current_context().meta[f"{_FILE}{id(static)}"] = file


def warn_of_changed(static: StaticInfo, mission: Path | None = None) -> None:
    """Warn once of source files that are not as they were when they were analysed.

    Args:
        static: from ``static_of`` or ``static_for``.
        mission: whose own static information it may be; its lines stay those of the recorded build.
    """
    meta = click.get_current_context().meta
    file: Path | None = meta.pop(f"{_FILE}{id(static)}", None)
    if file is None:
        return
    changed = changed_sources(static, file.stat().st_mtime_ns)
    if not changed:
        return
    others = f" and {many(len(changed) - 1, 'other source file')}" if len(changed) > 1 else ""
    have = "have" if others else "has"
    if mission is not None and file.parent in (mission, mission.parent):
        what = f"{have} changed since this mission's build: lines are those of then"
    else:
        ours = file.parent.name == OWN_FOLDER
        workspace = shlex.quote(str(file.parent.parent)) if ours else "WORKSPACE"
        what = (
            f"{have} changed since the build: lines may have moved; run `pytpc build {workspace}`"
        )
    warn(plain(f"{changed[0]}{others} {what}"))


def _is_merged(source: Path) -> bool:
    return not source.is_dir() or (source / OWN_FOLDER / MERGED_FILE).is_file()


def tell_dropped(dropped: Sequence[Stale]) -> None:
    """Warn of each file that was left out."""
    for stale in dropped:
        unit = stale.file.unit
        keys = many(len(unit.comparisons), "key")
        warn(
            f"{unit.package}/{unit.link_unit} with {keys} left out:"
            f" {stale.reason} ({stale.file.path})"
        )
