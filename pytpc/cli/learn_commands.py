"""The command ``learn``: good runs into a profile."""

from __future__ import annotations

import shlex
from dataclasses import asdict, dataclass
from pathlib import Path

import click
from rich.table import Table
from rich.text import Text

from pytpc.api.learning import forget, learn
from pytpc.base.errors import InputError
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import console, print_json, tell_person
from pytpc.cli.options import recording_of, warn_about, warn_of_marks
from pytpc.recording.profile import LearnedRun, is_profile, runs_in


@dataclass(frozen=True)
class _LearnArguments:
    recordings: tuple[Path, ...]
    profile: Path
    remove: str | None
    as_json: bool


@click.command("learn")
@click.argument("recordings", type=PATH, nargs=-1, metavar="RECORDING...")
@click.option(
    "-o",
    "--output",
    "profile",
    type=PATH,
    default=Path("good"),
    show_default=True,
    metavar="PROFILE",
    help="Folder of the profile.",
)
@click.option("--remove", metavar="NAME", help="Remove a run from the profile.")
@JSON
@as_object(_LearnArguments)
def learn_command(given: _LearnArguments) -> None:
    """Learn what is normal for a robot from recordings in which it went right.

    Their settings, missions and lengths may differ. Of each RECORDING a small part is kept in
    PROFILE, to which later runs can be added; `rank --reference PROFILE` and all other commands
    with --reference compare a mission with all of them. Without RECORDING, the runs are listed.
    """
    if given.remove is not None:
        gone = forget(given.profile, given.remove)
        tell_person(f"removed {plain(gone.folder)}")
    elif not given.recordings and not is_profile(given.profile):
        raise InputError("no profile of good runs here; give recordings to learn", given.profile)
    for source in given.recordings:
        recording = recording_of(source)
        warn_about(recording)
        warn_of_marks(source, recording)
        run = learn(recording, source, given.profile)
        tell_person(f"learned {plain(run.name)}: {many(run.reports, 'report')}")
    _show(runs_in(given.profile), given)


def _show(runs: list[LearnedRun], given: _LearnArguments) -> None:
    if given.as_json:
        print_json([asdict(run) for run in runs])
        return
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for heading in ("Run", "Seconds", "Reports", "Learned from"):
        table.add_column(heading, justify="right" if heading in ("Seconds", "Reports") else "left")
    for run in runs:
        seconds = (run.end_ns - run.start_ns) / 1e9
        named, source = Text(plain(run.folder)), Text(plain(run.source))
        table.add_row(named, f"{seconds:.1f}", f"{run.reports:,}", source)
    console().print(table, highlight=False)
    if runs:
        profile = shlex.quote(plain(str(given.profile)))
        tell_person(f"compare a mission with them: pytpc rank MISSION --reference {profile}")


COMMANDS: list[click.Command] = [learn_command]
