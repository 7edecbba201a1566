"""Shows TPC at work: builds the image capture mission with its passes, flies it, names the culprit.

    .venv/bin/python examples/image_capture/demo.py --out out/demo

Three missions: a clean one, one with a threshold that is too low (type I) and one with a threshold
that is too high (type II). A scripted observer, who sees only what the UAV does, says when it does
wrong. Status 1 if a mission does not go as its treatment demands, or if the changed parameter is
not among the first three suspects at a mark of the right type.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click
from rich.console import Console

from pytpc.build import BuildResult, build_workspace, workspace_env
from pytpc.cli.event_commands import progress
from pytpc.cli.mission_commands import mission_progress
from pytpc.colcon import Bases, BuildError
from pytpc.demo import TreatedMission, failures, result_table, run_treatment
from pytpc.errors import TpcError, WorkspaceError
from pytpc.report.html import write_report
from pytpc.treatment import Treatment, load_treatment
from pytpc.words import many

PACKAGE = Path(__file__).resolve().parent
TREATMENTS = ("clean", "type1_face_detection_threshold", "type2_min_coverage_limit")
TIMEOUT_S = 150.0
_PIPED_WIDTH = 160


@click.command()
@click.option("--out", type=click.Path(path_type=Path), default=Path("out/demo"), show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True)
def main(out: Path, seed: int) -> None:
    """Build, fly, rank and report the image capture mission."""
    console = Console(width=None if sys.stdout.isatty() else _PIPED_WIDTH)
    try:
        wrong = run_demo(console, out, seed)
    except BuildError as error:
        for line in error.tail:
            click.echo(line, err=True)
        raise SystemExit(f"demo: error: {error}") from None
    except TpcError as error:
        raise SystemExit(f"demo: error: {error}") from None
    except KeyboardInterrupt:
        click.echo("demo: interrupted", err=True)
        raise SystemExit(130) from None
    for sentence in wrong:
        console.print(f"FAILED  {sentence}", style="bold red", highlight=False)
    raise SystemExit(1 if wrong else 0)


def run_demo(console: Console, out: Path, seed: int) -> list[str]:
    """All of it; returns what went wrong, in sentences."""
    treatments = [load_treatment(PACKAGE / "treatments" / name) for name in TREATMENTS]
    with step(console, "Build the mission's nodes with TPC's passes"):
        built = build(out / "ws")
        console.print(
            f"   {many(len(built.static.thresholds), 'comparison')} of parameters found in"
            f" {many(len(built.units), 'link unit')}"
        )
    missions = [fly(console, treatment, seed, built, out) for treatment in treatments]
    page = out / "report.html"
    with step(console, "Write the report"), progress("drawing") as advance:
        reports = [mission.report(built.static) for mission in missions]
        title = "Image capture: suspected parameters"
        write_report(page, reports, title=title, on_progress=advance)
    console.print()
    console.print(result_table(missions, built.static), highlight=False)
    console.print(f"Report: {page}", highlight=False, soft_wrap=True)
    return [sentence for mission in missions for sentence in failures(mission)]


def build(workspace: Path) -> BuildResult:
    """Build a workspace that holds a link to this package."""
    link = workspace / "src" / PACKAGE.name
    if link.resolve() != PACKAGE:
        # What stands there is the link of an earlier checkout.
        try:
            link.parent.mkdir(parents=True, exist_ok=True)
            link.unlink(missing_ok=True)
            link.symlink_to(PACKAGE)
        except OSError as error:
            raise WorkspaceError(f"cannot be made: {error.strerror}", link) from error
    with Console(stderr=True).status("colcon build"):
        return build_workspace(workspace)


def fly(
    console: Console, treatment: Treatment, seed: int, built: BuildResult, out: Path
) -> TreatedMission:
    """Run one mission and say in a line what happened."""
    bases: Bases = built.bases
    with step(console, f"Mission {treatment.name}: {treatment.effect}"):
        with mission_progress(treatment.name) as advance:
            mission = run_treatment(
                treatment,
                seed=seed,
                launch=PACKAGE / "launch" / "image_capture.launch",
                install_env=workspace_env(bases.install),
                static_info=built.static,
                out_dir=out / treatment.name,
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


if __name__ == "__main__":
    main()
