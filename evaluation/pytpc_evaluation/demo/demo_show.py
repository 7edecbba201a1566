"""Shows an example on the terminal: builds it, flies its missions, ranks, writes the report.

The demonstrations in ``examples/*/demo.py`` are this with an ``Example``, and with what builds it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

import click
from rich.console import Console

from pytpc.api.report import write_missions
from pytpc.base.errors import TpcError
from pytpc.base.wording import many
from pytpc.build.build import build_workspace, workspace_env
from pytpc.cli.console import console as table_console
from pytpc.cli.console import progress
from pytpc.cli.lines import progress_console, say
from pytpc.cli.mission_commands import mission_progress
from pytpc.present.ranking_tables import print_diagnosis
from pytpc.ros.mission_run import Progress
from pytpc.ros.node_start import mission_env
from pytpc.static.static_info import StaticInfo
from pytpc.workspace.colcon import BuildError
from pytpc_evaluation.demo.demo import (
    TreatedMission,
    gone_wrong,
    not_named,
    result_table,
    run_treatment,
)
from pytpc_evaluation.demo.demo_examples import Example, link_package
from pytpc_evaluation.treatment import Treatment

TIMEOUT_S = 150.0


class Flight(Protocol):
    """Flies one mission of a robot; ``out_dir`` is the mission's."""

    def __call__(
        self,
        treatment: Treatment,
        out_dir: Path,
        *,
        seed: int,
        timeout_s: float,
        on_progress: Callable[[Progress], None],
    ) -> TreatedMission:
        """Fly it.

        Raises:
            TpcError: it cannot be flown.
        """
        ...


@dataclass(frozen=True)
class Ready:
    """What flies: the static information of all nodes, and how a mission is flown."""

    static: StaticInfo
    flight: Flight


Maker = Callable[[Example, Console, Path], AbstractContextManager[Ready]]
"""Makes a robot ready below a folder, for as long as its missions are flown."""


@dataclass(frozen=True)
class Built:
    """A robot of ROS 1, the static information of all its nodes, their environment."""

    example: Example
    static: StaticInfo
    env: Mapping[str, str]


def demonstration(example: Example, about: str, make: Maker | None = None) -> click.Command:
    """The command line of a demonstration.

    Args:
        example: the robot.
        about: the command's help.
        make: how the robot is built; None: as a workspace of catkin.
    """

    @click.command(help=about)
    @click.option(
        "--out",
        type=click.Path(path_type=Path),
        default=Path("out") / example.name,
        show_default=True,
    )
    @click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True)
    @click.option("--treatment", "names", multiple=True, help="Fly this one; may be repeated.")
    def main(out: Path, seed: int, names: tuple[str, ...]) -> None:
        console = table_console()
        try:
            wrong = run_demo(
                example, console, out, seed=seed, names=names, make=make or built_workspace
            )
        except BuildError as error:
            for line in error.tail:
                say(line)
            raise SystemExit(f"demo: error: {error}") from None
        except TpcError as error:
            raise SystemExit(f"demo: error: {error}") from None
        except KeyboardInterrupt:
            say("demo: interrupted")
            raise SystemExit(130) from None
        for sentence in wrong:
            console.print(f"FAILED  {sentence}", style="bold red", highlight=False)
        raise SystemExit(1 if wrong else 0)

    return main


def run_demo(
    example: Example,
    console: Console,
    out: Path,
    *,
    seed: int,
    names: tuple[str, ...],
    make: Maker,
) -> list[str]:
    """All of it; returns what went wrong, in sentences.

    Args:
        example: the robot.
        console: where it is told.
        out: for the workspace, the recordings and the report.
        seed: see ``run_treatment``.
        names: the treatments; those of the demonstration where empty.
        make: builds the robot.

    Raises:
        TpcError: it does not build, or a mission cannot be run.
    """
    treatments = example.treatments(names)
    with make(example, console, out) as robot:
        if not names:
            for treatment in treatments:
                if not can_be_named(treatment, robot.static):
                    console.print(
                        f"=> {treatment.name} is left out: nothing compares its parameter"
                    )
            treatments = [one for one in treatments if can_be_named(one, robot.static)]
        missions = [fly(console, treatment, seed, robot, out) for treatment in treatments]
    page = out / "report.html"
    with step(console, "Write the report"), progress("drawing") as advance:
        good = [mission for mission in missions if mission.treatment.type == "clean"]
        reports = [mission.report(robot.static, good) for mission in missions]
        title = f"{example.title}: suspected parameters"
        write_missions(page, reports, title=title, on_progress=advance)
    wrong = []
    for mission in missions:
        wrong += gone_wrong(mission)
        if mission.rankings:
            diagnosis = mission.diagnosis(robot.static, good)
            wrong += not_named(mission, diagnosis)
            console.print(f"\n=> What pytpc says of {mission.treatment.name}", style="bold")
            print_diagnosis(console, diagnosis)
            console.print(f"   In truth: {mission.treatment.change or 'nothing was changed'}")
    console.print()
    console.print(result_table(missions, robot.static), highlight=False)
    console.print(f"Report: {page}", highlight=False, soft_wrap=True)
    return wrong


def can_be_named(treatment: Treatment, static: StaticInfo) -> bool:
    """Whether a comparison of the changed parameter, if one was changed, was found."""
    compared = {found.source for found in static.thresholds.values()}
    return treatment.parameter is None or treatment.parameter in compared


@contextmanager
def built_workspace(example: Example, console: Console, out: Path) -> Iterator[Ready]:
    """A robot of ROS 1, built."""
    built = build(example, console, out)
    flight = partial(run_treatment, example, install_env=built.env, static_info=built.static)
    yield Ready(built.static, flight)


def build(example: Example, console: Console, out: Path) -> Built:
    """Build a workspace that holds a link to the example; its nodes in Python are analysed, too."""
    workspace = out / "ws"
    link_package(example, workspace)
    with step(console, "Build the mission's nodes with TPC"):
        with progress_console().status("colcon build"):
            result = build_workspace(workspace)
        tell_found(console, result.static)
    env = mission_env(workspace_env(result.bases.install), result.bases.static_info)
    return Built(example, result.static, env)


def tell_found(console: Console, static: StaticInfo) -> None:
    """Say in a line what the analysis found, and in which language; one place is one comparison."""
    places = [tpc for tpc in static.tpcs if tpc.type != "constant"]
    in_python = sum(static.unit_of(tpc.key).is_python for tpc in places)
    in_cpp = len(places) - in_python
    some = f": {in_cpp:,} in C++, {in_python:,} in Python" if in_cpp and in_python else ""
    console.print(
        f"   {many(len(places), 'comparison')} of parameters found{some}", highlight=False
    )


def fly(
    console: Console, treatment: Treatment, seed: int, robot: Ready, out: Path
) -> TreatedMission:
    """Run one mission and say in a line what happened."""
    with step(console, f"Mission {treatment.name}: {treatment.effect}"):
        with mission_progress(treatment.name) as advance:
            mission = robot.flight(
                treatment,
                out / treatment.name,
                seed=seed,
                timeout_s=TIMEOUT_S,
                on_progress=advance,
            )
        run = mission.run
        console.print(
            f"   {run.sim_s:.0f} s of flight, {many(run.reports, 'report')},"
            f" {many(run.marks, 'mark')}",
            highlight=False,
        )
    return mission


@contextmanager
def step(console: Console, what: str) -> Iterator[None]:
    """Print what is done, and at the end how long it took."""
    console.print(f"=> {what}", style="bold", highlight=False)
    began = time.monotonic()
    yield
    console.print(f"   {time.monotonic() - began:.1f} s", style="dim", highlight=False)
