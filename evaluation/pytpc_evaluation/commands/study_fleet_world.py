"""The command ``study fleet-world``."""

from __future__ import annotations

import os
from pathlib import Path

import click

from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH
from pytpc.cli.console import print_json, progress
from pytpc_evaluation.fleet.generating import TRUTH_FILE, generate
from pytpc_evaluation.fleet.world import WorldSettings

_PLAIN = WorldSettings()
_ONE = click.IntRange(min=1)


@click.command("fleet-world")
@click.argument("out", type=PATH, metavar="DIR")
@click.option(
    "--missions",
    type=_ONE,
    default=_PLAIN.missions,
    show_default=True,
    help="How many missions the fleet flew.",
)
@click.option(
    "--robots",
    type=_ONE,
    default=_PLAIN.robots,
    show_default=True,
    help="How many robots flew them, by turns.",
)
@click.option("--days", type=_ONE, default=_PLAIN.days, show_default=True, help="On how many days.")
@click.option(
    "--reports",
    type=click.IntRange(min=60_000),
    default=_PLAIN.reports,
    show_default=True,
    help="About how many reports a mission has, 32 bytes each.",
)
@click.option(
    "--bad",
    type=click.FloatRange(0.0, 1.0),
    default=_PLAIN.bad,
    show_default=True,
    help="The share of missions with a wrong parameter.",
)
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=_PLAIN.seed,
    show_default=True,
    help="Another number makes another fleet.",
)
@click.option(
    "--without-namespaces",
    is_flag=True,
    help="Each robot has a graph of its own: names do not begin with that of the robot.",
)
@click.option(
    "--first",
    type=click.IntRange(min=0),
    default=0,
    metavar="N",
    help="Write the missions from number N on; the first one is 0.",
)
@click.option("--count", type=_ONE, metavar="N", help="Write only N of them.")
@click.option(
    "--jobs",
    type=click.IntRange(1, 64),
    default=os.cpu_count() or 1,
    show_default="cores of this machine",
    help="How many processes write.",
)
@JSON
def fleet_world_command(
    *,
    out: Path,
    missions: int,
    robots: int,
    days: int,
    reports: int,
    bad: float,
    seed: int,
    without_namespaces: bool,
    first: int,
    count: int | None,
    jobs: int,
    as_json: bool,
) -> None:
    """Write the missions of a made-up fleet, of which everything is known.

    Each mission is DIR/ROBOT/NAME, as `pytpc record` writes one with the sink `file`. What is
    wrong on which robot is in DIR/truth.json. The same options write the same bytes.
    """
    settings = WorldSettings(seed, robots, days, missions, reports, bad, not without_namespaces)
    end = missions if count is None else min(missions, first + count)
    if first >= end:
        raise click.UsageError(
            f"there is no mission {first}: the fleet has {many(missions, 'mission')}"
        )
    with progress("missions") as advance:
        truth = generate(settings, out, range(first, end), jobs=jobs, on_progress=advance)
    if as_json:
        print_json(truth)
        return
    made = sum(one["reports"] for one in truth["missions"])
    click.echo(
        f"{many(len(truth['missions']), 'mission')} of {many(robots, 'robot')},"
        f" {made:,} reports: {plain(str(out))}; the truth: {plain(str(out / TRUTH_FILE))}"
    )
