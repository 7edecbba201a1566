"""The command ``record``."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import click
from rich.console import Console

from pytpc.api.missions import convert
from pytpc.api.record import (
    DEFAULT_TOPICS,
    MissionRun,
    Progress,
    RecordOptions,
    record_launch,
    record_running,
)
from pytpc.base.errors import InputError
from pytpc.base.signals import stop_on_signals
from pytpc.base.wording import many
from pytpc.cli.arguments import PATH, as_object
from pytpc.recording.faults import faults_of
from pytpc.recording.mission import REPORTS_FOLDER, RUN_FILE
from pytpc.ros.ros1.master import uri_of

_SILENT_S = 5.0
_LAUNCH_TIMEOUT_S = 300.0


@dataclass(frozen=True)
class _RecordArguments:
    workspace: Path | None
    launch: Path | None
    args: tuple[str, ...]
    output: Path
    timeout_s: float | None
    until: str | None
    topics: tuple[str, ...]
    launched: Path | None
    wall_time: bool
    no_python: bool
    parquet: bool

    def options(self, advance: Callable[[Progress], None]) -> RecordOptions:
        patience_s = None if self.workspace is None else _LAUNCH_TIMEOUT_S
        return RecordOptions(
            self.output,
            self.launched if self.workspace is None else self.launch,
            _launch_arguments(self.args),
            self.timeout_s or patience_s,
            until=self.until,
            topics=self.topics,
            on_progress=advance,
        )


@click.command("record")
@click.argument("workspace", type=PATH, required=False)
@click.argument("launch", type=PATH, required=False)
@click.argument("args", nargs=-1, metavar="[NAME:=VALUE]...")
@click.option(
    "-o",
    "--output",
    type=PATH,
    required=True,
    help="Folder for the bag and what describes the run.",
)
@click.option(
    "--timeout",
    "timeout_s",
    type=click.FloatRange(min=1.0),
    metavar="SECONDS",
    help="Stop after this time. [default: 300 with LAUNCH, else none]",
)
@click.option(
    "--until",
    metavar="TOPIC",
    help="Stop when this topic (std_msgs/Bool) says that the mission is done.",
)
@click.option(
    "--topic",
    "topics",
    multiple=True,
    help=f"Record this topic, too, besides {', '.join(DEFAULT_TOPICS)}; may be repeated.",
)
@click.option(
    "--launch",
    "launched",
    type=PATH,
    help="Launch file that started the running graph; it tells where parameter values came from.",
)
@click.option("--wall-time", is_flag=True, help="Run in real time, without a /clock.")
@click.option("--no-python", is_flag=True, help="Run Python nodes without reports.")
@click.option("--parquet", is_flag=True, help="Convert the bag afterwards, as `convert` does.")
@as_object(_RecordArguments)
def record_command(given: _RecordArguments) -> None:
    """Record a mission: the running graph, or a LAUNCH file of a built WORKSPACE.

    Without WORKSPACE and LAUNCH, the graph at ROS_MASTER_URI is recorded until Ctrl-C. With them,
    the launch file runs on a ROS graph of its own. Its Python nodes report, and TPC_SINK,
    TPC_POLICY and so on apply to all nodes. Marks of all observers are recorded as they appear.
    """
    if given.workspace is None:
        run = _record_running(given)
    elif given.launched is not None:
        raise click.UsageError("--launch is only for a running graph; here LAUNCH names the file")
    elif given.launch is None:
        raise click.UsageError("give both WORKSPACE and LAUNCH, or neither of them")
    else:
        unit = "s of it" if given.wall_time else "s simulated"
        with mission_progress(given.launch.stem, unit) as advance:
            run = record_launch(
                given.workspace,
                given.options(advance),
                python=not given.no_python,
                use_sim_time=not given.wall_time,
            )
    _show_run(run, given)
    if given.parquet:
        output = given.output
        outcome = convert([output], output)
        for fault in faults_of(outcome.recording):
            click.echo(f"warning: {fault}", err=True)
        click.echo(f"{many(outcome.events, 'report')} in Parquet: {output}")


def _record_running(given: _RecordArguments) -> MissionRun:
    if given.launched is not None and not given.launched.is_file():
        raise InputError("no such launch file", given.launched)
    stop = stop_on_signals()
    click.echo(f"recording {uri_of(os.environ)}; press Ctrl-C to stop", err=True)
    with mission_progress("recording", "s of it") as advance:
        return record_running(given.options(advance), stop=stop)


def _show_run(run: MissionRun, given: _RecordArguments) -> None:
    lost = sum(run.lost.values())
    if lost:
        click.echo(f"warning: {many(lost, 'log message')} lost by the recorder", err=True)
    before = sum(run.missed_before.values())
    if before and given.workspace is None:
        click.echo(f"{many(before, 'log message')} from before the recording", err=True)
    dropped = sum(each.count for each in run.dropped)
    if dropped:
        places = len({each.key for each in run.dropped})
        click.echo(
            f"warning: {many(dropped, 'report')} of {many(places, 'comparison')} never left"
            f" {many(len({each.node for each in run.dropped}), 'node')}:"
            f" {given.output / RUN_FILE} has them",
            err=True,
        )
    folder = given.output / REPORTS_FOLDER
    files = len(list(folder.glob("*.tpc")))
    if files:
        click.echo(f"more reports in {many(files, 'file')}: {folder}", err=True)
    click.echo(
        f"{many(run.reports, 'report')} and {many(run.marks, 'mark')} in {run.sim_s:.1f} s"
        f" ({run.ended}): {run.bag}"
    )


def _launch_arguments(texts: tuple[str, ...]) -> dict[str, str]:
    pairs = [text.partition(":=") for text in texts]
    for text, (name, separator, _) in zip(texts, pairs, strict=True):
        if not name or not separator:
            raise click.BadParameter(f"{text!r} is not NAME:=VALUE", param_hint="ARGS")
    return {name: value for name, _, value in pairs}


@contextmanager
def mission_progress(what: str, unit: str = "s simulated") -> Iterator[Callable[[Progress], None]]:
    """Show a mission's progress: one moving line on a terminal, or a line every 5 s if piped."""
    console = Console(stderr=True)
    status = console.status(what)
    told = time.monotonic()

    def advance(progress: Progress) -> None:
        nonlocal told
        line = (
            f"{what}: {progress.sim_s:.0f} {unit}, {progress.reports:,} reports,"
            f" {many(progress.marks, 'mark')}"
        )
        status.update(line)
        if not console.is_terminal and time.monotonic() - told > _SILENT_S:
            told = time.monotonic()
            click.echo(line, err=True)

    if console.is_terminal:
        status.start()
    try:
        yield advance
    finally:
        status.stop()


COMMANDS: list[click.Command] = [record_command]
