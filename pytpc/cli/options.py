"""Options and functions that the commands about recordings share."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import click

from pytpc.api.missions import check_reports, read_named
from pytpc.base.wording import plain
from pytpc.cli.arguments import PATH, Command
from pytpc.cli.console import progress, warn
from pytpc.diagnosis.question import WINDOW_S, Types
from pytpc.recording.faults import faults_of
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo


@dataclass(frozen=True)
class AskArguments:
    """The options that all commands about recordings have."""

    static_source: Path
    types: Types
    window_s: float
    top: int
    as_json: bool


class Seconds(click.FloatRange):
    """A number of seconds; unlike click's float range it rejects "nan"."""

    name = "seconds"

    def convert(
        self, value: float, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Convert the text, or fail with a usage error."""
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
    help="Static information: a static.json, a build base or a built workspace.",
)
TOP = click.option(
    "--top",
    type=click.IntRange(min=1),
    default=5,
    show_default=True,
    metavar="N",
    help="Show this many suspects.",
)
WINDOW = click.option(
    "--window",
    "window_s",
    type=Seconds(min=0.0, min_open=True, max=86400.0),
    default=WINDOW_S,
    show_default=True,
    metavar="SECONDS",
    help="Length of the window before a mark in which type II looks.",
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
    help="How far to believe the types of the marks.",
)
# The old name of `--types ignore`.
_OLDER = click.option(
    "--untyped",
    is_flag=True,
    hidden=True,
    expose_value=False,
    is_eager=True,
    callback=_note_untyped,
)


def TYPES(command: Command) -> Command:
    """Add the option ``--types``; the command gets ``types``."""
    return _BELIEVED(_OLDER(command))


def recording_of(source: Path) -> Recording:
    """Read a recording and show the progress.

    Raises:
        InputError: it cannot be read.
    """
    with progress(f"reading {source.name}") as advance:
        return read_named(source, advance)


def check(recording: Recording, static: StaticInfo, source: Path) -> None:
    """Check that a recording is of this build, and warn of its faults.

    Raises:
        InputError: it is of another build, or has no report.
    """
    check_reports(recording, static, source)
    warn_about(recording, static)


def checked_recording(source: Path, static: StaticInfo) -> Recording:
    """Read a recording of this build, and warn of its faults.

    Raises:
        InputError: it cannot be read, is of another build, or has no report.
    """
    found = recording_of(source)
    check(found, static, source)
    return found


def warn_about(recording: Recording, static: StaticInfo | None = None) -> None:
    """Warn of each fault of a recording, in a line."""
    for fault in faults_of(recording, static):
        warn(f"{plain(recording.name)}: {plain(fault)}")


def reference_of(source: Path | None, static: StaticInfo) -> Recording | None:
    """Read the good run that ``--reference`` names, if there is one.

    Raises:
        InputError: it cannot be read, or is of another build.
    """
    if source is None:
        return None
    found = recording_of(source)
    check_reports(found, static, source)
    return found


def warn_plainly(line: str) -> None:
    """Warn in a line that may contain any text from a robot."""
    warn(plain(line))
