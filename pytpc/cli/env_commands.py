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
from pytpc.python_runtime.config import variable_of
from pytpc.ros.node_start import has_python, with_python, without_python
from pytpc.workspace.colcon import Bases

_RING, _RING_BUDGET = variable_of("ring"), variable_of("ring_budget")


@click.command("env")
@click.argument("source", type=PATH, required=False)
@click.option("--off", is_flag=True, help="Print the commands that undo it; needs no SOURCE.")
@click.option("--setup", is_flag=True, help="Include what the workspace's setup.bash sets.")
@click.option(
    "--ring",
    type=click.FloatRange(0.05, 10080),
    metavar="MINUTES",
    help="Let nodes keep the last MINUTES on the disk, for `pytpc keep`.",
)
@click.option(
    "--ring-budget",
    type=click.IntRange(4, 1 << 24),
    metavar="MIB",
    help="Most MiB that the ring of a process takes. [default: 64]",
)
@click.option(
    "--shell",
    type=click.Choice(SHELLS),
    default=SHELLS[0],
    show_default=True,
    help="Shell to print for; sh is for bash, zsh and the like.",
)
@JSON
def env_command(  # noqa: PLR0913
    *,
    source: Path | None,
    off: bool,
    setup: bool,
    ring: float | None,
    ring_budget: int | None,
    shell: str,
    as_json: bool,
) -> None:
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
    if ring_budget is not None and ring is None:
        raise click.UsageError("--ring-budget needs --ring MINUTES")
    if off and ring is not None:
        raise click.UsageError("--off ends the ring as well; leave out --ring")
    before = dict(os.environ)
    if off:
        after = without_devel_space(without_python(before))
        after = {name: text for name, text in after.items() if name not in (_RING, _RING_BUDGET)}
    else:
        after = _on(source, before, setup=setup, has_more=ring is not None)
    if ring is not None:
        after = {**after, _RING: f"{ring:g}"}
    if ring_budget is not None:
        after = {**after, _RING_BUDGET: str(ring_budget)}
    change = EnvChange.between(before, after)
    click.echo(change.json() if as_json else change.text(shell), nl=False)


def _on(
    source: Path | None, before: dict[str, str], *, setup: bool, has_more: bool
) -> dict[str, str]:
    static = static_file(source)
    after = before
    if setup:
        after = {**before, **nodes_env(source or Path(), before)}
    after = with_devel_space(after, Bases(static.parent).devel)
    if has_python(static):
        return with_python(after, static)
    if after == before and not has_more:
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
