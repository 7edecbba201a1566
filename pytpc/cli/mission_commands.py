"""Commands about missions: ``record``."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click
from rich.console import Console

from pytpc.build import workspace_env
from pytpc.colcon import Bases
from pytpc.mission import DEFAULT_TOPICS, Progress, run_mission
from pytpc.words import many

_PATH = click.Path(path_type=Path)
_SILENT_S = 5.0


@click.command("record")
@click.argument("workspace", type=_PATH)
@click.argument("launch", type=_PATH)
@click.argument("args", nargs=-1, metavar="[NAME:=VALUE]...")
@click.option("-o", "--output", type=_PATH, required=True, help="Folder for bag and run.json.")
@click.option("--timeout", "timeout_s", type=click.FloatRange(min=1.0), default=300.0)
@click.option("--until", metavar="TOPIC", help="std_msgs/Bool that says when the mission is done.")
@click.option(
    "--topic", "topics", multiple=True, help=f"Record it besides {', '.join(DEFAULT_TOPICS)}."
)
@click.option("--wall-time", is_flag=True, help="There is no /clock: the nodes run in real time.")
def record_command(
    *,
    workspace: Path,
    launch: Path,
    args: tuple[str, ...],
    output: Path,
    timeout_s: float,
    until: str | None,
    topics: tuple[str, ...],
    wall_time: bool,
) -> None:
    """Run LAUNCH of a built WORKSPACE on a ROS graph of its own, and record it."""
    launch_arguments = _launch_arguments(args)
    with mission_progress(launch.stem) as advance:
        run = run_mission(
            workspace_env(Bases.of(workspace).install),
            launch,
            launch_arguments,
            output,
            timeout_s,
            until=until,
            topics=topics,
            use_sim_time=not wall_time,
            on_progress=advance,
        )
    lost = sum(run.lost.values())
    if lost:
        click.echo(f"warning: {many(lost, 'log message')} lost by the recorder", err=True)
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


COMMANDS: list[click.Command] = [record_command]


@contextmanager
def mission_progress(what: str) -> Iterator[Callable[[Progress], None]]:
    """Show how far a mission is: one moving line on a terminal, a line every 5 s where piped."""
    console = Console(stderr=True)
    status = console.status(what)
    told = time.monotonic()

    def advance(progress: Progress) -> None:
        nonlocal told
        line = (
            f"{what}: {progress.sim_s:.0f} s simulated, {progress.reports:,} reports,"
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
