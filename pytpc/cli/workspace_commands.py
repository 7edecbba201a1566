"""Commands about a workspace: ``patch`` and ``build``."""

from __future__ import annotations

import re
from contextlib import ExitStack
from pathlib import Path

import click
from rich.console import Console
from rich.text import Text

from pytpc.build.build import BuildResult, build_workspace
from pytpc.cli.console import Advance, found_text, progress, show_units, warn
from pytpc.workspace import patch
from pytpc.workspace.colcon import Bases, BuildError

_FOLDER = click.Path(path_type=Path, file_okay=True)
_JOB_LINE = re.compile(r"^(Starting >>>|Finished <<<|Failed +<<<|Aborted +<<<) (?P<name>\S+)")


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
@click.option("--no-python", is_flag=True, help="Leave Python nodes out.")
@click.option(
    "--python-rules",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Your own rules for Python (JSON).",
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
    no_python: bool,
    python_rules: Path | None,
) -> None:
    """Build a workspace with analysis and instrumentation; its files stay as they are.

    Its Python nodes are analysed, too; they report when `pytpc record` starts them, or a shell that
    did what `pytpc env` prints.
    """
    bases = Bases(base.absolute()) if base is not None else None
    try:
        with _Progress() as shown:
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
                python=not no_python,
                python_rules=python_rules,
                bases=bases,
                on_output=shown.show,
                on_scripts=shown.show_scripts,
            )
    except BuildError as error:
        for line in error.tail:
            click.echo(line, err=True)
        raise
    _show_build(result)


COMMANDS: list[click.Command] = [patch_command, build_command]


class _Progress:
    """Colcon's output as one moving line on a terminal, and as its own start and end lines else.

    Behind it stands how many scripts are analysed.
    """

    def __init__(self) -> None:
        self._stack = ExitStack()
        self._scripts: Advance | None = None
        self._console = Console(stderr=True)
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
        """Say how many scripts are analysed, when colcon is through."""
        if self._scripts is None:
            self._status.stop()
            self._scripts = self._stack.enter_context(progress("analysing Python scripts"))
        self._scripts(done, total)

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


def _show_build(result: BuildResult) -> None:
    show_units(result.static)
    for package, why in result.left_alone.items():
        warn(f"package {package} is built without TPC, with which it does not build: {why}")
    if result.left_alone:
        click.echo("pytpc build --retry tries again with TPC", err=True)
    click.echo(
        f"{found_text(result.static)}, built in {result.seconds:.1f} s: {result.bases.static_info}"
    )
