"""Commands about missions: ``record``."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import click
from rich.console import Console

from pytpc.base.errors import InputError
from pytpc.base.wording import many
from pytpc.build.build import installed, workspace_env
from pytpc.diagnosis.ranking.complaints import complaints
from pytpc.ingest.reading import opened
from pytpc.python_runtime.config import NAMES
from pytpc.recording.mission import REPORTS_FOLDER
from pytpc.ros.mission_run import DEFAULT_TOPICS, MissionRun, Progress
from pytpc.ros.python_env import mission_env
from pytpc.ros.ros1.launch_mission import run_mission
from pytpc.ros.ros1.master import uri_of
from pytpc.ros.ros1.record_graph import record_graph, stop_on_signals
from pytpc.workspace.colcon import Bases

_PATH = click.Path(path_type=Path)
_SILENT_S = 5.0
_LAUNCH_TIMEOUT_S = 300.0


@click.command("record")
@click.argument("workspace", type=_PATH, required=False)
@click.argument("launch", type=_PATH, required=False)
@click.argument("args", nargs=-1, metavar="[NAME:=VALUE]...")
@click.option("-o", "--output", type=_PATH, required=True, help="Folder for bag and run.json.")
@click.option(
    "--timeout",
    "timeout_s",
    type=click.FloatRange(min=1.0),
    metavar="SECONDS",
    help="End after this time. [default: 300 with LAUNCH, else none]",
)
@click.option("--until", metavar="TOPIC", help="std_msgs/Bool that says when the mission is done.")
@click.option(
    "--topic", "topics", multiple=True, help=f"Record it besides {', '.join(DEFAULT_TOPICS)}."
)
@click.option(
    "--launch",
    "launched",
    type=_PATH,
    help="The launch file that the running graph was started with: says where values came from.",
)
@click.option("--wall-time", is_flag=True, help="There is no /clock: the nodes run in real time.")
@click.option("--no-python", is_flag=True, help="Nodes in Python run without reports.")
@click.option("--parquet", is_flag=True, help="Convert the bag too, as `convert` does.")
def record_command(
    *,
    workspace: Path | None,
    launch: Path | None,
    args: tuple[str, ...],
    output: Path,
    timeout_s: float | None,
    until: str | None,
    topics: tuple[str, ...],
    launched: Path | None,
    wall_time: bool,
    no_python: bool,
    parquet: bool,
) -> None:
    """Record a mission: of the running graph, or of LAUNCH.

    Without WORKSPACE and LAUNCH the graph at ROS_MASTER_URI is recorded until Ctrl-C. With them the
    launch file of the built workspace is run on a ROS graph of its own, and recorded; its nodes in
    Python report, and TPC_SINK, TPC_POLICY and so on hold for all. The marks of all observers are
    recorded as they appear.
    """
    if workspace is None:
        run = _record_graph(output, until, timeout_s, topics, launched)
    elif launched is not None:
        raise click.UsageError("--launch is for a graph that runs; LAUNCH says it already")
    elif launch is None:
        raise click.UsageError("give both WORKSPACE and LAUNCH, or neither of them")
    else:
        launch_arguments = _launch_arguments(args)
        unit = "s of it" if wall_time else "s simulated"
        with mission_progress(launch.stem, unit) as advance:
            run = run_mission(
                _env_of(workspace, python=not no_python),
                launch,
                launch_arguments,
                output,
                timeout_s or _LAUNCH_TIMEOUT_S,
                until=until,
                topics=topics,
                use_sim_time=not wall_time,
                on_progress=advance,
            )
    lost = sum(run.lost.values())
    if lost:
        click.echo(f"warning: {many(lost, 'log message')} lost by the recorder", err=True)
    before = sum(run.missed_before.values())
    if before and workspace is None:
        click.echo(f"{many(before, 'log message')} from before the recording", err=True)
    files = len(list((output / REPORTS_FOLDER).glob("*.tpc")))
    if files:
        click.echo(f"more reports in {many(files, 'file')}: {output / REPORTS_FOLDER}", err=True)
    click.echo(
        f"{many(run.reports, 'report')} and {many(run.marks, 'mark')} in {run.sim_s:.1f} s"
        f" ({run.ended}): {run.bag}"
    )
    if parquet:
        with opened([output], output) as outcome:
            recording = outcome.save(output)
        for complaint in complaints(recording):
            click.echo(f"warning: {complaint}", err=True)
        click.echo(f"{many(outcome.events, 'report')} in Parquet: {output}")


def _env_of(workspace: Path, *, python: bool) -> dict[str, str]:
    env = {**workspace_env(installed(workspace)), **sink_settings(os.environ)}
    return mission_env(env, Bases.of(workspace).static_info) if python else env


def _record_graph(
    output: Path,
    until: str | None,
    timeout_s: float | None,
    topics: tuple[str, ...],
    launched: Path | None,
) -> MissionRun:
    if launched is not None and not launched.is_file():
        raise InputError("no such launch file", launched)
    stop = stop_on_signals()
    click.echo(f"recording {uri_of(os.environ)}; Ctrl-C ends it", err=True)
    with mission_progress("recording", "s of it") as advance:
        return record_graph(
            output,
            stop=stop,
            until=until,
            timeout_s=timeout_s,
            topics=topics,
            launch=launched,
            on_progress=advance,
        )


def sink_settings(env: Mapping[str, str]) -> dict[str, str]:
    """What ``env`` says of sinks: a mission's nodes get nothing else of the caller's environment.

    A relative folder is the caller's: the nodes run elsewhere.
    """
    names = (f"TPC_{name.upper()}" for name in NAMES)
    settings = {name: env[name] for name in names if env.get(name)}
    if "TPC_FOLDER" in settings:
        settings["TPC_FOLDER"] = str(Path(settings["TPC_FOLDER"]).absolute())
    return settings


def _launch_arguments(texts: tuple[str, ...]) -> dict[str, str]:
    pairs = [text.partition(":=") for text in texts]
    for text, (name, separator, _) in zip(texts, pairs, strict=True):
        if not name or not separator:
            raise click.BadParameter(f"{text!r} is not NAME:=VALUE", param_hint="ARGS")
    return {name: value for name, _, value in pairs}


COMMANDS: list[click.Command] = [record_command]


@contextmanager
def mission_progress(what: str, unit: str = "s simulated") -> Iterator[Callable[[Progress], None]]:
    """Show how far a mission is: one moving line on a terminal, a line every 5 s where piped."""
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
