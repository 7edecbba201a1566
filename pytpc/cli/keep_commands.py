"""The command ``keep``: the last minutes of a robot that runs, as a recording."""

from __future__ import annotations

import os
import shlex
import time
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

import click

from pytpc.api.keeping import Keeper, KeepOptions, Kept, keep, remove_ended
from pytpc.api.record import RecordOptions, files_folder
from pytpc.api.static_of_mission import GIVE, NONE_FOUND, static_to_keep
from pytpc.base.errors import InputError, RunError
from pytpc.base.signals import Stop, signals_end
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import print_json, progress, tell_next, telling, warn
from pytpc.cli.lines import say
from pytpc.cli.running_graph import ROS, ros2_here, tell
from pytpc.ros.ros1.master import Master, uri_of

_CALLER = "/tpc_keep"
_OUT = Path("out")


@dataclass(frozen=True)
class _KeepArguments:
    output: Path | None
    minutes: float | None
    folder: Path | None
    static_source: Path | None
    launched: Path | None
    on_marks: bool
    after_s: float
    most: int
    most_mib: int
    remove_hours: float | None
    as_json: bool


@click.command("keep")
@click.option(
    "-o",
    "--output",
    type=PATH,
    metavar="FOLDER",
    help="Folder of the recording; with --on-marks, of all of them. [default: a new one in out/]",
)
@click.option(
    "--minutes",
    type=click.FloatRange(min=0.0, min_open=True),
    help="Keep the last MINUTES. [default: as many as the longest ring has, at least 10]",
    metavar="MINUTES",
)
@click.option(
    "--folder",
    type=PATH,
    metavar="FOLDER",
    help="Where the nodes write their files. [default: TPC_FOLDER, or else ~/.ros/tpc]",
)
@click.option(
    "--static",
    "static_source",
    type=PATH,
    metavar="FILE_OR_FOLDER",
    help="Static information of the nodes, which the recording keeps. [default: the one found in"
    " this folder or a sourced workspace]",
)
@click.option(
    "--launch",
    "launched",
    type=PATH,
    help="Launch file that started the graph; it tells where parameter values came from.",
)
@click.option("--on-marks", is_flag=True, help="Stay, and keep the last minutes after each mark.")
@click.option(
    "--after",
    "after_s",
    type=click.FloatRange(min=0.0),
    default=10.0,
    show_default=True,
    metavar="SECONDS",
    help="Keep so long after a mark (--on-marks). Marks that come meanwhile share a recording.",
)
@click.option(
    "--most",
    type=click.IntRange(min=1),
    default=20,
    show_default=True,
    help="Make at most so many recordings (--on-marks).",
)
@click.option(
    "--most-mib",
    type=click.IntRange(min=1),
    default=4096,
    show_default=True,
    help="Begin no recording once they have so many MiB together (--on-marks).",
)
@click.option(
    "--remove-ended",
    "remove_hours",
    type=click.FloatRange(min=0.0),
    metavar="HOURS",
    help="Keep nothing, but remove the files of rings whose process ended so many HOURS ago. Nodes"
    " remove only their own files.",
)
@ROS
@JSON
@as_object(_KeepArguments)
def keep_command(given: _KeepArguments) -> None:
    """Make a recording of the last minutes, which nodes with a ring have on the disk.

    \b
    export TPC_RING=10                       before the robot is started: a ring of 10 minutes
    pytpc keep                               now
    pytpc keep --on-marks -o FOLDER          after each mark, until Ctrl-C

    The recording has the files of all nodes, also of those that were killed meanwhile, and from the
    graph the marks, the values of parameters and where they came from. `rank`, `report`, `diff` and
    `convert` take it like one of `record`. Without a graph, the files alone are kept. It appears
    when it is complete. No recording is ever removed.
    """
    if given.launched is not None and not given.launched.is_file():
        raise InputError("no such launch file", given.launched)
    folder = files_folder(os.environ) if given.folder is None else given.folder
    if given.remove_hours is not None:
        _remove_ended(folder, given.remove_hours, as_json=given.as_json)
        return
    ros = _graph_here()
    record = _with_static(given)
    options = KeepOptions(folder, given.minutes, ros, dict(os.environ), record)
    if given.on_marks:
        _keep_on_marks(given, options)
        return
    out = given.output or _OUT / time.strftime("keep-%Y%m%d-%H%M%S")
    with signals_end(), telling("keeping the last minutes"):
        kept = keep(options, out)
    if given.as_json:
        print_json(_document(kept))
        return
    _tell(kept)
    tell_next(_next(kept))


def _remove_ended(folder: Path, hours: float, *, as_json: bool) -> None:
    count, size = remove_ended(folder, hours)
    if as_json:
        print_json({"folder": str(folder), "files": count, "bytes": size})
        return
    click.echo(f"removed {many(count, 'file')}, {-(-size >> 20):,} MiB, from {plain(str(folder))}")


def _keep_on_marks(given: _KeepArguments, options: KeepOptions) -> None:
    if options.ros is None:
        raise RunError(
            f"no ROS master answers at {uri_of(os.environ)}, and marks come from a graph. Start the"
            " robot, or `export ROS_MASTER_URI=http://HOST:11311`; for a robot with ROS 2: --ros 2"
        )
    into = given.output or _OUT
    stop = Stop()
    keeper = Keeper(options, into, given.after_s, given.most, given.most_mib << 20)
    tell(f"keeping the last minutes after each mark, in {into}; press Ctrl-C to stop")

    def told(kept: Kept) -> None:
        # A terminal that was closed must not end it.
        with suppress(OSError):
            if given.as_json:
                print_json(_document(kept))
            else:
                _tell(kept)

    def fault(text: str) -> None:
        with suppress(OSError):
            warn(plain(text))

    with stop.on_signals():
        keeper.run(stop, told, fault)


def _graph_here() -> Literal[1, 2] | None:
    """The ROS of the graph that this shell names; None where nobody answers."""
    if ros2_here() is not None:
        return 2
    try:
        Master(uri_of(os.environ), _CALLER).call("getPid")
    except RunError:
        return None
    return 1


def _with_static(given: _KeepArguments) -> RecordOptions:
    with progress("looking for static information"):
        found = static_to_keep(given.static_source)
    options = RecordOptions(Path(), launch=given.launched)
    if found is None:
        tell(f"{NONE_FOUND}, so the recording keeps none; {GIVE}")
        return options
    if given.static_source is None:
        tell(f"{found.words}; the recording keeps a copy")
    return RecordOptions(
        Path(),
        launch=given.launched,
        static=found.path,
        static_info=found.static,
        is_static_guessed=given.static_source is None,
    )


def _tell(kept: Kept) -> None:
    for clause in kept.missing:
        say(f"warning: {plain(clause)}")
    processes = "1 process" if kept.processes == 1 else f"{kept.processes:,} processes"
    click.echo(
        f"{many(kept.reports, 'report')}, {kept.summaries:,} summaries and"
        f" {many(kept.marks, 'mark')} of {processes} in the last {_span(kept.seconds)}:"
        f" {plain(str(kept.folder))}"
    )


def _span(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.1f} min"


def _next(kept: Kept) -> str:
    folder = shlex.quote(str(kept.folder))
    if kept.marks:
        return f"pytpc rank {folder}"
    return f"pytpc mark {folder}, to mark what went wrong, and then: pytpc rank {folder}"


def _document(kept: Kept) -> dict[str, object]:
    return {**asdict(kept), "folder": str(kept.folder), "missing": list(kept.missing)}


COMMANDS: list[click.Command] = [keep_command]
