"""The command ``diff``: which parameters differ between a good run and a bad one, and where."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path

import click

from pytpc.api.comparing import RecordedRun, diff
from pytpc.base.wording import plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import console, print_json, progress, warn
from pytpc.cli.options import STATIC, good_runs, recording_of, refuse_itself, warn_about
from pytpc.cli.sources import static_for
from pytpc.present.as_json import differences_json
from pytpc.present.ranking_tables import print_differences


@dataclass(frozen=True)
class _DiffArguments:
    good: tuple[Path, ...]
    bad: Path
    static_source: Path | None
    as_json: bool


@click.command("diff")
@click.argument("good", type=PATH, nargs=-1, required=True, metavar="GOOD...")
@click.argument("bad", type=PATH)
@STATIC
@JSON
@as_object(_DiffArguments)
def diff_command(given: _DiffArguments) -> None:
    """Show the parameters that differ between GOOD recordings and a BAD one.

    For each: its values, where it was set, the comparisons in which it acts, and how many recorded
    decisions would have come out otherwise with the good value. Parameters that are read and
    compared nowhere are listed, too. Marks are not needed. A parameter differs if it had a value in
    BAD, at the end or while it ran, that it had in none of the GOOD recordings.
    """
    recording = recording_of(given.bad)
    static = static_for(given.static_source, given.bad, recording)
    good = good_runs(given.good, static)
    refuse_itself(good, recording)
    warn_about(recording, static)
    if not recording.marks and len(good) == 1 and good[0].recording.marks:
        options = [] if given.static_source is None else ["--static", _plain(given.static_source)]
        words = ["pytpc", "diff", _plain(given.bad), _plain(given.good[0]), *options]
        warn(f"{_plain(given.bad)}: nobody marked it; is it the good run? {shlex.join(words)}")
    with progress("replaying the mission") as advance:
        advance(0, 1)
        found = diff(good, RecordedRun(recording, given.bad), static)
    if given.as_json:
        print_json(differences_json(found))
        return
    print_differences(console(), found, most=None, each=True)


def _plain(path: Path) -> str:
    return plain(str(path))


COMMANDS: list[click.Command] = [diff_command]
