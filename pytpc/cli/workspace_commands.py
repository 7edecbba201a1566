"""Commands about a workspace: ``patch``, ``build``, ``collect`` and ``list``."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click
from rich.console import Console
from rich.progress import Progress
from rich.table import Table
from rich.text import Text

from pytpc import patch
from pytpc.build import BuildResult, build_workspace
from pytpc.colcon import Bases, BuildError
from pytpc.errors import WorkspaceError
from pytpc.link_units import remark
from pytpc.static_info import Comparison, LinkUnit, StaticInfo, collect, read_static

_FOLDER = click.Path(path_type=Path, file_okay=True)
_JOB_LINE = re.compile(r"^(Starting >>>|Finished <<<|Failed +<<<|Aborted +<<<) (?P<name>\S+)")
# Piped output has no width of its own; at the usual 80 columns a table would be folded to shreds.
_PIPED_WIDTH = 160


@click.command("patch")
@click.argument("workspace", type=_FOLDER)
@click.option("--restore", is_flag=True, help="Take the lines out again.")
@click.option("--dry-run", is_flag=True, help="Only show the difference.")
@click.option("--package", "packages", multiple=True, metavar="NAME", help="Only this one.")
def patch_command(workspace: Path, restore: bool, dry_run: bool, packages: tuple[str, ...]) -> None:
    """Put TPC's three lines at the top of each CMakeLists.txt, for builds of your own."""
    patch.run(workspace, restore=restore, dry_run=dry_run, packages=packages)


@click.command("build")
@click.argument("workspace", type=_FOLDER)
@click.option("--package", "packages", multiple=True, metavar="NAME", help="It and what it needs.")
@click.option("--build-type", default="RelWithDebInfo", show_default=True)
@click.option("--base", type=_FOLDER, help="Where to build; WORKSPACE/.tpc by default.")
@click.option(
    "--rules",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Your own rules (JSON): what else reads a parameter or exposes.",
)
@click.option("--constants", is_flag=True, help="Report comparisons with constants, too.")
@click.option("--tests", is_flag=True, help="Have test programs report, too.")
@click.option("--no-fallback", is_flag=True, help="End where a package does not build with TPC.")
@click.option("--retry", is_flag=True, help="Try packages that were built without TPC again.")
@click.argument("colcon_args", nargs=-1, type=click.UNPROCESSED, metavar="[-- COLCON_ARGS]...")
def build_command(
    *,
    workspace: Path,
    packages: tuple[str, ...],
    build_type: str,
    base: Path | None,
    rules: Path | None,
    colcon_args: tuple[str, ...],
    constants: bool,
    tests: bool,
    no_fallback: bool,
    retry: bool,
) -> None:
    """Build a workspace with analysis and instrumentation; its files stay as they are."""
    bases = Bases(base.absolute()) if base is not None else None
    try:
        with _Progress() as progress:
            result = build_workspace(
                workspace,
                packages=packages,
                build_type=build_type,
                rules=rules,
                colcon_args=colcon_args,
                constants=constants,
                tests=tests,
                fallback=not no_fallback,
                retry=retry,
                bases=bases,
                on_output=progress.show,
            )
    except BuildError as error:
        for line in error.tail:
            click.echo(line, err=True)
        raise
    _show_build(result)


@click.command("collect")
@click.argument("build_base", type=_FOLDER)
@click.option("-o", "--output", type=_FOLDER, default=Path("static.json"), show_default=True)
def collect_command(build_base: Path, output: Path) -> None:
    """Merge the static information of all link units below BUILD_BASE into one file."""
    with _file_progress() as advance:
        static = collect(build_base, advance)
    if not static.units:
        raise WorkspaceError("no static information here; build with `pytpc build`", build_base)
    static.save(output)
    _show_units(static)
    click.echo(f"{_found(static)}: {output}")


@click.command("list")
@click.argument("source", type=_FOLDER, required=False)
@click.option("--json", "as_json", is_flag=True, help="Print a JSON list.")
@click.option("--constants", is_flag=True, help="Those with constants, too.")
def list_command(source: Path | None, *, as_json: bool, constants: bool) -> None:
    """List the comparisons in SOURCE: a static.json, a build base or a workspace.

    Without SOURCE: static.json in this folder, else what `pytpc build` left below it.
    """
    with _file_progress() as advance:
        static = read_static(source if source is not None else _default_source(), advance)
    if as_json:
        found = [
            {"package": unit["package"], "link_unit": unit["link_unit"], **comparison}
            for unit in static.to_json()["units"]
            for comparison in unit["comparisons"]
            if constants or comparison["type"] != "constant"
        ]
        click.echo(json.dumps(found, indent=1, ensure_ascii=False))
        return
    _console().print(_comparisons_table(static, constants=constants), highlight=False)
    _warn_of_failed(static)
    click.echo(_found(static))


COMMANDS: list[click.Command] = [patch_command, build_command, collect_command, list_command]


class _Progress:
    """Colcon's output as one moving line on a terminal, and as its own start and end lines else."""

    def __init__(self) -> None:
        self._console = Console(stderr=True)
        self._status = self._console.status("finding packages")
        self._running: list[str] = []

    def __enter__(self) -> _Progress:
        if self._console.is_terminal:
            self._status.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._status.stop()

    def show(self, line: str) -> None:
        """Take one line of colcon's output."""
        job = _JOB_LINE.match(line)
        if job is not None:
            if line.startswith("Starting"):
                self._running.append(job["name"])
            elif job["name"] in self._running:
                self._running.remove(job["name"])
        if not self._console.is_terminal:
            if job is not None:
                click.echo(line, err=True)
            return
        running = f"building {', '.join(self._running)}: " if self._running else ""
        text = running + line.strip()
        self._status.update(Text(text[: max(20, self._console.width - 4)], no_wrap=True))


@contextmanager
def _file_progress() -> Iterator[_Advance]:
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        yield _Advance(progress)


class _Advance:
    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._task = progress.add_task("reading static information", total=None)

    def __call__(self, done: int, total: int) -> None:
        self._progress.update(self._task, completed=done, total=total)


def _show_build(result: BuildResult) -> None:
    _show_units(result.static)
    for package, why in result.left_alone.items():
        _warn(f"package {package} is built without TPC, with which it does not build: {why}")
    for unit in result.left_out:
        if unit.package not in result.left_alone:
            click.echo(f"{unit.package}/{unit.name} reports nothing: {unit.reason}", err=True)
    if result.left_alone:
        click.echo("pytpc build --retry tries again with TPC", err=True)
    click.echo(
        f"{_found(result.static)}, built in {result.seconds:.1f} s: {result.bases.static_info}"
    )


def _show_units(static: StaticInfo) -> None:
    if static.units:
        _console().print(_units_table(static), highlight=False)
    _warn_of_failed(static)


def _units_table(static: StaticInfo) -> Table:
    table = Table()
    for heading in ("Package", "Link unit"):
        table.add_column(heading, overflow="fold")
    for heading in ("Comparisons", "Parameter reads", "Exposing statements"):
        table.add_column(heading, justify="right")
    table.add_column("Status")
    for unit in static.units:
        table.add_row(Text(unit.package), Text(unit.link_unit), *_numbers(unit), remark(unit))
    return table


def _numbers(unit: LinkUnit) -> list[str]:
    counts = unit.counts
    return [
        str(number)
        for number in (counts.comparisons, counts.parameter_reads, counts.exposing_statements)
    ]


def _comparisons_table(static: StaticInfo, *, constants: bool) -> Table:
    table = Table()
    for heading in ("Parameter", "Type", "Place", "Distance", "Exposed as", "Source line"):
        table.add_column(heading, overflow="fold")
    for unit in static.units:
        for found in unit.comparisons:
            if found.type == "constant" and not constants:
                continue
            place = f"{unit.package}/{found.file}:{found.lineno}"
            cells = (found.source or "", found.type, place, str(found.distance), found.topic or "?")
            table.add_row(*(Text(cell) for cell in cells), Text(_shown(found)))
    return table


def _shown(found: Comparison) -> str:
    return found.source_code or f"{found.relation} {found.name or found.source}"


def _warn_of_failed(static: StaticInfo) -> None:
    for unit in static.failed:
        _warn(
            f"{unit.link_unit} of package {unit.package} was left as it was and reports nothing:"
            f" {unit.failure}"
        )


def _warn(text: str) -> None:
    click.echo(f"pytpc: warning: {' '.join(text.split())}", err=True)


def _found(static: StaticInfo) -> str:
    """How much there is, in words."""
    comparisons, units = len(static.thresholds), len(static.units)
    return (
        f"{comparisons} comparison{'' if comparisons == 1 else 's'}"
        f" in {units} link unit{'' if units == 1 else 's'}"
    )


def _default_source() -> Path:
    here = Path("static.json")
    return here if here.is_file() else Path()


def _console() -> Console:
    return Console(width=None if sys.stdout.isatty() else _PIPED_WIDTH)
