"""The command ``survey``: the tables of any number of source trees."""

from __future__ import annotations

import os
import re
import time
from pathlib import Path

import click
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.text import Text

from pytpc.base.atomic import write_atomic
from pytpc.base.errors import WorkspaceError
from pytpc.base.wording import many, plain
from pytpc.cli.console import console, print_json, warn
from pytpc.cli.lines import progress_console, say
from pytpc_evaluation.survey.static_tables import tables
from pytpc_evaluation.survey.survey_documents import FORMATS, documents, faults
from pytpc_evaluation.survey.surveying import Options, SurveyProgress, survey
from pytpc_evaluation.survey.trees import TreeResult
from pytpc_evaluation.tables import as_rich

_FOLDER = click.Path(path_type=Path, file_okay=True)
_JOB_LINE = re.compile(r"^(Starting >>>|Finished <<<|Failed +<<<|Aborted +<<<) (?P<name>\S+)")
_SILENT_S = 2.0


def _formats(_context: click.Context, _option: click.Parameter, value: str) -> tuple[str, ...]:
    chosen = tuple(dict.fromkeys(part.strip() for part in value.split(",")))
    for name in chosen:
        if name not in FORMATS:
            raise click.BadParameter(f"{name!r} is none of {', '.join(FORMATS)}")
    return chosen


@click.command("survey")
@click.argument("trees", nargs=-1, required=True, type=_FOLDER, metavar="DIR...")
@click.option(
    "-o",
    "--output",
    type=_FOLDER,
    default=Path("tpc-survey"),
    show_default=True,
    help="Folder for tables, results and builds.",
)
@click.option(
    "--format",
    "formats",
    default=",".join(FORMATS),
    show_default=True,
    callback=_formats,
    metavar="LIST",
    help="Which tables to write.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the results as a JSON list.")
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    default=os.cpu_count() or 1,
    show_default="processors",
    help="How many packages build at once, and compilers in each.",
)
@click.option(
    "--underlay",
    type=click.Path(path_type=Path),
    multiple=True,
    metavar="SETUP",
    help="Source this set-up script before each build; may be repeated.",
)
@click.option(
    "--cmake-arg",
    "cmake_args",
    multiple=True,
    metavar="ARG",
    help="Pass this to each package's CMake, as -DNAME=VALUE; may be repeated.",
)
@click.option(
    "--no-plain", is_flag=True, help="Skip the builds without TPC, and with them the time factors."
)
@click.option("--rerun", is_flag=True, help="Measure again what an earlier run measured.")
def survey_command(
    *,
    trees: tuple[Path, ...],
    output: Path,
    formats: tuple[str, ...],
    as_json: bool,
    jobs: int,
    underlay: tuple[Path, ...],
    cmake_args: tuple[str, ...],
    no_plain: bool,
    rerun: bool,
) -> None:
    """Build source trees with and without TPC; compare times, comparisons and lines of code.

    A DIR is a folder with ROS packages, or a CMake project; each is a row. A DIR that needs
    packages of another one is built on top of it. An interrupted survey continues where it stopped.
    """
    for folder in trees:
        if not folder.is_dir():
            raise WorkspaceError("no such folder", folder)
    options = Options(output, jobs, underlay, cmake_args, plain=not no_plain, rerun=rerun)
    with _Progress() as progress:
        results = survey(trees, options, progress.show)
    written = documents(results, formats)
    for name, text in written.items():
        write_atomic(output / name, text.encode())
    if as_json:
        print_json([result.to_json() for result in results])
    else:
        _print(results)
    _warn(results)
    if not as_json:
        click.echo(
            f"{many(len(results), 'tree')}: {', '.join(str(output / one) for one in written)}"
        )


COMMANDS: list[click.Command] = [survey_command]


class _Progress:
    """A bar over the trees with the packages in work; without a terminal a line for each step."""

    def __init__(self) -> None:
        self._console = progress_console()
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            console=self._console,
            transient=True,
            disable=not self._console.is_terminal,
        )
        self._task = self._bar.add_task("", total=None)
        self._running: list[str] = []
        self._said: tuple[int, str] | None = None
        self._began = self._told = time.monotonic()

    def __enter__(self) -> _Progress:
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    def show(self, step: SurveyProgress) -> None:
        """Take one step of the survey."""
        at = (step.number, step.what)
        if at != self._said:
            self._said, self._running = at, []
            self._told = time.monotonic()
            if not self._console.is_terminal:
                seconds = time.monotonic() - self._began
                where = f"{step.number}/{step.total} {plain(step.tree)}"
                say(f"[{seconds:.0f} s] {where}: {step.what}")
        self._say_how_far(step)
        job = _JOB_LINE.match(step.line)
        if job is not None and step.line.startswith("Starting"):
            self._running.append(job["name"])
        elif job is not None and job["name"] in self._running:
            self._running.remove(job["name"])
        running = f": {step.far or ', '.join(self._running)}" if self._running or step.far else ""
        self._bar.update(
            self._task,
            total=step.total,
            completed=step.number - 1,
            description=Text(plain(f"{step.tree}: {step.what}{running}")).markup,
        )

    def _say_how_far(self, step: SurveyProgress) -> None:
        """A line every two seconds, where there is no bar."""
        if step.far and not self._console.is_terminal and time.monotonic() - self._told > _SILENT_S:
            self._told = time.monotonic()
            say(f"{plain(step.tree)}: {step.what}: {step.far}")


def _print(results: list[TreeResult]) -> None:
    out = console()
    for table in tables(results):
        out.print(Text(table.title, style="bold"))
        for part in as_rich(table, out.width):
            out.print(part, highlight=False)


def _warn(results: list[TreeResult]) -> None:
    for tree, what, name, reason in faults(results):
        about = f"{tree}: {name} {what}" if name else f"{tree}: {what}"
        warn(plain(f"{about}: {reason}"))
