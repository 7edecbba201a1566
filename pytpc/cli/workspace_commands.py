"""Commands about a workspace: ``patch`` and ``build``."""

from __future__ import annotations

import re
import shlex
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import click
from rich.text import Text

from pytpc.api.building import BuildOptions, BuildResult, WholeBuild, build
from pytpc.cli.arguments import CONSTANTS, NO_PYTHON, PATH, PYTHON_RULES, RULES, as_object
from pytpc.cli.console import (
    Advance,
    found_text,
    progress,
    show_units,
    tell_inner_loops,
    tell_next,
    warn,
)
from pytpc.cli.lines import progress_console, say
from pytpc.workspace import patch
from pytpc.workspace.colcon import PLAIN_BUILD, Bases, BuildError
from pytpc.workspace.ros2 import how_to_source

_JOB_LINE = re.compile(r"^(Starting >>>|Finished <<<|Failed +<<<|Aborted +<<<) (?P<name>\S+)")


@click.command("patch")
@click.argument("workspace", type=PATH)
@click.option("--restore", is_flag=True, help="Remove the lines again.")
@click.option("--dry-run", is_flag=True, help="Show the changes without writing them.")
@click.option(
    "--package",
    "packages",
    multiple=True,
    metavar="NAME",
    help="Change only this package; may be repeated.",
)
def patch_command(workspace: Path, restore: bool, dry_run: bool, packages: tuple[str, ...]) -> None:
    """Add TPC's three lines to the top of each CMakeLists.txt, so that your own builds use TPC."""
    patch.run(workspace, restore=restore, dry_run=dry_run, packages=packages)


@dataclass(frozen=True)
class _BuildArguments:
    workspace: Path
    packages: tuple[str, ...]
    build_type: str
    base: Path | None
    rules: Path | None
    no_python: bool
    python_rules: Path | None
    constants: bool
    tests: bool
    no_processes: bool
    process_seconds: int
    no_fallback: bool
    retry: bool
    colcon_args: tuple[str, ...]

    def options(self) -> BuildOptions:
        return BuildOptions(
            packages=self.packages,
            build_type=self.build_type,
            rules=self.rules,
            colcon_args=self.colcon_args,
            constants=self.constants,
            tests=self.tests,
            fallback=not self.no_fallback,
            retry=self.retry,
            python=not self.no_python,
            python_rules=self.python_rules,
            processes=not self.no_processes,
            process_seconds=self.process_seconds,
            bases=None if self.base is None else Bases(self.base.absolute()),
        )


@click.command("build")
@click.argument("workspace", type=PATH)
@click.option(
    "--package",
    "packages",
    multiple=True,
    metavar="NAME",
    help="Build only this package and what it depends on; may be repeated.",
)
@click.option(
    "--build-type",
    default="RelWithDebInfo",
    show_default=True,
    help="CMAKE_BUILD_TYPE of all packages.",
)
@click.option("--base", type=PATH, help="Build in this folder. [default: WORKSPACE/.tpc]")
@RULES
@NO_PYTHON
@PYTHON_RULES
@CONSTANTS
@click.option("--tests", is_flag=True, help="Instrument test programs, too.")
@click.option(
    "--no-processes",
    is_flag=True,
    help="Analyse each program and library alone, instead of processes with all that they load.",
)
@click.option(
    "--process-seconds",
    type=click.IntRange(min=1),
    default=PLAIN_BUILD.process_seconds,
    show_default=True,
    help="Processor time for the analysis of one process. Beyond it, its units are analysed alone.",
)
@click.option(
    "--no-fallback",
    is_flag=True,
    help="Stop if a package does not build with TPC, instead of building it without.",
)
@click.option(
    "--retry", is_flag=True, help="Try TPC again on packages that an earlier build left without it."
)
@click.argument("colcon_args", nargs=-1, type=click.UNPROCESSED, metavar="[-- COLCON_ARGS]...")
@as_object(_BuildArguments)
def build_command(given: _BuildArguments) -> None:
    """Build WORKSPACE with analysis and instrumentation, without changing its files.

    A parameter that is read in one library and compared in another is found: each process is
    analysed with the libraries and plugins that it loads, see `pytpc processes`.

    Python nodes are analysed, too. They report when `pytpc record` starts them, or when they are
    started from a shell in which you evaluated the output of `pytpc env`.
    """
    try:
        with _Progress() as shown:
            result = build(
                given.workspace,
                given.options(),
                on_output=shown.show,
                on_scripts=shown.show_scripts,
                on_process=shown.show_process,
            )
    except BuildError as error:
        for line in error.tail:
            say(line)
        raise
    _show_build(result, given.workspace)


COMMANDS: list[click.Command] = [patch_command, build_command]


class _Progress:
    """Shows colcon's output: one moving line on a terminal, or its start and end lines if piped.

    After it, shows how many Python scripts are analysed.
    """

    def __init__(self) -> None:
        self._stack = ExitStack()
        self._scripts: Advance | None = None
        self._console = progress_console()
        self._status = self._console.status("finding packages")
        self._running: list[str] = []

    def __enter__(self) -> _Progress:
        if self._console.is_terminal:
            self._status.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._status.stop()
        self._stack.close()

    def show_scripts(self, done: int, total: int) -> None:
        """Show how many scripts are analysed, after colcon has finished."""
        if self._scripts is None:
            self._status.stop()
            self._scripts = self._stack.enter_context(progress("analysing Python scripts"))
        self._scripts(done, total)

    def show_process(self, name: str, done: int, total: int) -> None:
        """Show which process is analysed, between the two links."""
        text = f"analysing {name}, {done} of {total} processes done"
        if self._console.is_terminal:
            self._status.update(Text(text, no_wrap=True))
        else:
            say(text)

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
                say(line)
            return
        running = f"building {', '.join(self._running)}: " if self._running else ""
        text = running + line.strip()
        self._status.update(Text(text[: max(20, self._console.width - 4)], no_wrap=True))


def _show_build(whole: WholeBuild, given: Path) -> None:
    result = whole.build
    show_units(result.static)
    _tell_processes(whole)
    for package, why in result.left_alone.items():
        warn(f"package {package} was built without TPC, because it does not build with it: {why}")
    if result.left_alone:
        say("run `pytpc build --retry` to try TPC again")
    click.echo(
        f"{found_text(result.static)}, built in {result.seconds:.1f} s: {result.bases.static_info}"
    )
    tell_inner_loops(result.static)
    _tell_python(result)
    workspace = shlex.quote(str(given))
    if any(each.type != "constant" for each in result.static.comparisons.values()):
        tell_next(f"pytpc run {workspace} LAUNCH, or PACKAGE and LAUNCH")
    else:
        tell_next(f"pytpc doctor {workspace}")


def _tell_processes(whole: WholeBuild) -> None:
    """Say what was left out of the processes."""
    if whole.failure is not None:
        warn(f"each link unit was analysed alone: {whole.failure}")
    for text in whole.processes.faults:
        warn(text)
    for text in dict.fromkeys(text for one in whole.analysed for text in one.left_out):
        warn(text)
    for one in whole.analysed:
        if one.failure is not None:
            units = ", ".join(unit.name for unit in one.process.units)
            warn(f"process {one.process.name}: {one.failure}; analysed alone: {units}")
    done = [one for one in whole.analysed if one.plan is not None]
    if done:
        count = f"{len(done)} process{'' if len(done) == 1 else 'es'}"
        say(f"{count} analysed as a whole; `pytpc processes` shows what belongs to them")


def _tell_python(result: BuildResult) -> None:
    """Say under which Python the nodes of ROS 2 run."""
    scripted = {unit.package for unit in result.units if unit.is_python}
    if not any(
        package.ros == "2" and (package.build_type == "ament_python" or package.name in scripted)
        for package in result.packages
    ):
        return
    if result.ros2 is not None:
        say(f"nodes of ROS 2 in Python run under {result.ros2.words}")
    else:
        warn(
            "no ROS 2 was sourced: its nodes in Python would run under /usr/bin/python3, which has"
            f" no rclpy; type this, and build again: {how_to_source()}"
        )
