"""Options and readings that the commands about recordings share."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import click

from pytpc.base.errors import InputError
from pytpc.base.wording import plain
from pytpc.cli.console import progress, warn
from pytpc.diagnosis.question import WINDOW_S
from pytpc.diagnosis.ranking.complaints import complaints
from pytpc.ingest import Recording, read
from pytpc.static.static_info import StaticInfo

PATH = click.Path(path_type=Path)
Command = TypeVar("Command", bound=Callable[..., object])


class Seconds(click.FloatRange):
    """A number of seconds; unlike a plain range of click's it does not take "nan"."""

    name = "seconds"

    def convert(
        self, value: float, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The number, or a usage error."""
        seconds = float(super().convert(value, param, ctx))
        if math.isnan(seconds):
            self.fail(f"{value!r} is not a number.", param, ctx)
        return seconds


STATIC = click.option(
    "--static",
    "static_source",
    type=PATH,
    required=True,
    metavar="FILE_OR_FOLDER",
    help="static.json, a build base or a built workspace.",
)
TOP = click.option(
    "--top",
    type=click.IntRange(min=1),
    default=5,
    show_default=True,
    metavar="N",
    help="How many suspects are shown.",
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print JSON, for programs.")
WINDOW = click.option(
    "--window",
    "window_s",
    type=Seconds(min=0.0, min_open=True, max=86400.0),
    default=WINDOW_S,
    show_default=True,
    metavar="SECONDS",
    help="How far before a mark type II looks.",
)

_UNTYPED = "pytpc.untyped"


def _note_untyped(ctx: click.Context, _: click.Parameter, value: bool) -> None:
    ctx.meta[_UNTYPED] = value


def _types(ctx: click.Context, _: click.Parameter, value: str) -> str:
    return "ignore" if ctx.meta.get(_UNTYPED) else value


_BELIEVED = click.option(
    "--types",
    type=click.Choice(["believe", "doubt", "ignore"]),
    default="believe",
    show_default=True,
    callback=_types,
    help="How far the marks' types are believed.",
)
# What `--types ignore` was called first.
_OLDER = click.option(
    "--untyped",
    is_flag=True,
    hidden=True,
    expose_value=False,
    is_eager=True,
    callback=_note_untyped,
)


def TYPES(command: Command) -> Command:
    """The option ``--types``, as the argument ``types`` of `rank_marks`."""
    return _BELIEVED(_OLDER(command))


def recording_of(source: Path) -> Recording:
    """Read a recording, with its progress shown; what is in a folder is called after the folder.

    The bags of all missions have the same name, their folders have not.

    Raises:
        InputError: it cannot be read.
    """
    with progress(f"reading {source.name}") as advance:
        found = read(source, advance)
    return replace(found, name=source.absolute().name) if source.is_dir() else found


def check_reports(recording: Recording, static: StaticInfo, source: Path) -> None:
    """See that the recording has a report that the static information knows.

    Without, it would be ranked as if nothing were suspicious.

    Raises:
        InputError: it has none.
    """
    reported = {*recording.events.keys, *recording.summaries.keys}
    if not reported:
        raise InputError(
            "no threshold reports: was /rosout recorded, and the workspace built with TPC? "
            " Files of the sink `file` have to be in the same folder, or in its tpc",
            source,
        )
    if reported.isdisjoint(static.comparisons):
        raise InputError(
            "none of its reports is known to the static information: it is of another build",
            source,
        )


def warn_about(recording: Recording, static: StaticInfo | None) -> None:
    """A line for each thing that is wrong with a recording, and for what was left out of it."""
    for complaint in complaints(recording, static):
        warn(f"{plain(recording.name)}: {plain(complaint)}")
