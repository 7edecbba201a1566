"""The SOURCE arguments of commands, and the static information they name."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pytpc.base.paths import MERGED_FILE, OWN_FOLDER
from pytpc.base.wording import many
from pytpc.cli.arguments import PATH, Command
from pytpc.cli.completion_commands import offer_parameters
from pytpc.cli.console import progress, warn
from pytpc.static.static_info import StaticInfo, read_static

if TYPE_CHECKING:
    from pytpc.build.stale import Stale

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
            return read_static(chosen[0], advance)
        # Its import takes longer than to read a file, and needs the analysis of Python.
        from pytpc.build.collect import collect_sources  # noqa: PLC0415

        collected = collect_sources(chosen, advance)
    tell_dropped(collected.dropped)
    return collected.static


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
