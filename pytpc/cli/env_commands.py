"""The command ``env``, for your own shell."""

from __future__ import annotations

import os
import shlex
from pathlib import Path

import click

from pytpc.base.errors import InputError, WorkspaceError
from pytpc.base.paths import MERGED_FILE, OWN_FOLDER
from pytpc.base.shell_words import SHELLS, EnvChange
from pytpc.build.nodes_env import nodes_env, with_devel_space, without_devel_space
from pytpc.cli.arguments import JSON, PATH
from pytpc.cli.console import warn
from pytpc.ros.node_start import has_python, with_python, without_python
from pytpc.workspace.colcon import Bases


@click.command("env")
@click.argument("source", type=PATH, required=False)
@click.option("--off", is_flag=True, help="Print the commands that undo it; needs no SOURCE.")
@click.option("--setup", is_flag=True, help="Include what the workspace's setup.bash sets.")
@click.option(
    "--shell",
    type=click.Choice(SHELLS),
    default=SHELLS[0],
    show_default=True,
    help="Shell to print for; sh is for bash, zsh and the like.",
)
@JSON
def env_command(*, source: Path | None, off: bool, setup: bool, shell: str, as_json: bool) -> None:
    """Print shell commands; nodes started from this shell are those of the build, and report.

    \b
    eval "$(pytpc env WORKSPACE)"; roslaunch ...      bash, zsh
    pytpc env WORKSPACE --shell fish | source         fish

    Source the workspace's setup.bash before, or give --setup. After `pytpc build`, packages are
    their folders in src, as in a devel space: what you edit there is used without a build, and no
    install() rules are needed. Python nodes report.

    SOURCE is a workspace or its static.json. Without SOURCE, static.json in this folder is used, or
    else this folder as a workspace. Any build of the workspace will do; nothing is rebuilt.
    """
    if off and setup:
        raise click.UsageError("--off cannot be used with --setup: it does not undo setup.bash")
    before = dict(os.environ)
    after = without_devel_space(without_python(before)) if off else _on(source, before, setup=setup)
    change = EnvChange.between(before, after)
    click.echo(change.json() if as_json else change.text(shell), nl=False)


def _on(source: Path | None, before: dict[str, str], *, setup: bool) -> dict[str, str]:
    static = static_file(source)
    after = before
    if setup:
        after = {**before, **nodes_env(source or Path(), before)}
    after = with_devel_space(after, Bases(static.parent).devel)
    if has_python(static):
        return with_python(after, static)
    if after == before:
        warn(f"{static}: no comparisons in Python, so there is nothing to set")
    return after


def static_file(source: Path | None) -> Path:
    """The file of static information that SOURCE names.

    Raises:
        InputError: there is no such file or folder.
        WorkspaceError: the folder has none; the message says how to make it.
    """
    here = Path(MERGED_FILE)
    if source is None:
        source = here if here.is_file() else Path()
    if source.is_file():
        return source
    if not source.is_dir():
        raise InputError("no such file or folder", source)
    static = source / OWN_FOLDER / MERGED_FILE
    if not static.is_file():
        raise WorkspaceError(
            f"no {OWN_FOLDER}/{MERGED_FILE} here; build with `pytpc build`, or take it from another"
            f" build: pytpc collect {shlex.quote(str(source))} -o {shlex.quote(str(static))}",
            source,
        )
    return static


COMMANDS: list[click.Command] = [env_command]
