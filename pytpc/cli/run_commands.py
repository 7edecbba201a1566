"""The command ``run``: a mission from its start to the verdict, or a Python node with reports."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from pytpc.base.errors import InputError, WorkspaceError
from pytpc.base.paths import OWN_FOLDER
from pytpc.cli.arguments import PATH, REFERENCE, as_object
from pytpc.cli.launch_words import LaunchWords, MissionCommand, node_args
from pytpc.cli.mission_options import MISSION_OPTIONS, MissionArguments
from pytpc.cli.running_graph import ROS
from pytpc.ros.node_start import command_of
from pytpc.workspace.ros2 import MARKERS


@dataclass(frozen=True)
class _RunArguments(MissionArguments):
    static: tuple[Path, ...]
    verbose: bool
    observer: str
    references: tuple[Path, ...]
    no_keys: bool
    node: Path
    arguments: tuple[str, ...]


class _Run(MissionCommand):
    """Options may follow a workspace, but what follows a node is the node's own."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ctx.allow_interspersed_args = _is_mission(args)
        if ctx.allow_interspersed_args:
            return super().parse_args(ctx, args)
        return click.Command.parse_args(self, ctx, args)


def _is_mission(words: Sequence[str]) -> bool:
    """Whether the first word that is no option, and no option's value, is a workspace."""
    rest = iter(words)
    for word in rest:
        if word in ("--static", "--ros"):
            next(rest, None)
        elif not word.startswith("-"):
            return Path(word).is_dir()
        elif word != "--verbose" and not word.startswith(("--static=", "--ros=")):
            return True
    return False


@click.command("run", cls=_Run)
@MISSION_OPTIONS
@click.option(
    "--observer",
    default="",
    metavar="NAME",
    help="Name of the observer of a mission, used as a topic namespace.",
)
@REFERENCE
@ROS
@click.option("--no-keys", is_flag=True, help="Record and diagnose a mission without marking.")
@click.option(
    "--static",
    type=PATH,
    multiple=True,
    metavar="PATH",
    help="For a NODE: static information, or a folder that contains it; may be repeated. [default:"
    " TPC_STATIC, or else that of the workspace of NODE or of this folder]",
)
@click.option(
    "--verbose",
    is_flag=True,
    help="For a NODE: print which comparisons report, and the static information used.",
)
@click.argument("node", type=PATH, metavar="WORKSPACE|NODE")
@click.argument(
    "arguments",
    nargs=-1,
    type=click.UNPROCESSED,
    metavar="[[PACKAGE] LAUNCH [NAME:=VALUE]...]|[PACKAGE EXECUTABLE...]|[ARGUMENT]...",
)
@as_object(_RunArguments)
def run_command(given: _RunArguments) -> None:
    """Run a mission and find the parameter to blame, or run one Python node with reports.

    \b
    pytpc run WORKSPACE LAUNCH               a file, or PACKAGE and FILE as to roslaunch
    pytpc run WORKSPACE PACKAGE EXECUTABLE... [-- ARGUMENT...]     ROS 2, without launch
    pytpc run NODE [ARGUMENT]...             a Python script, by its own interpreter

    A mission is recorded as `record` does, with the suspects of `watch` on the screen, which takes
    the keys of `mark`. When it ends, or at `q` or Ctrl-C, the verdict of `rank` is printed and the
    page of `report` is written to the folder. Without a terminal, nothing is shown and no keys are
    taken. On ROS 2, the mission runs in the domain of the shell (ROS_DOMAIN_ID).

    A NODE replaces this process. Anything that is not a Python script runs unchanged, so
    launch-prefix="pytpc run" can be used in a whole launch file.
    """
    if given.node.is_dir():
        _run_mission(given)
    else:
        _run_node(given)


def _run_node(given: _RunArguments) -> None:
    command = command_of(given.node, given.arguments, given.static, verbose=given.verbose)
    env = _env_of(given.node.absolute())
    sys.stdout.flush()
    sys.stderr.flush()
    try:
        os.execve(command[0], command, env)
    except OSError as error:
        raise InputError(f"cannot be run: {error.strerror or error}", command[0]) from error


def _env_of(node: Path) -> dict[str, str]:
    """The caller's environment, and that of the build for a node of ROS 2 which it installed.

    The script of an entry point imports a module that is nowhere else.
    """
    env = dict(os.environ)
    prefix = node.parents[min(2, len(node.parents) - 1)]
    own = next((each for each in prefix.parents if each.name == OWN_FOLDER), None)
    if own is None or not (prefix / MARKERS / node.parent.name).is_file():
        return env
    if str(prefix) in env.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        return env
    # What other nodes do without.
    from pytpc.build.nodes_env import nodes_env  # noqa: PLC0415

    return {**env, **nodes_env(own.parent, env)}


def _run_mission(given: _RunArguments) -> None:
    workspace = given.node
    if not (workspace / OWN_FOLDER).is_dir():
        raise WorkspaceError(
            f"is neither a node nor a built workspace; build it: pytpc build"
            f" {shlex.quote(str(workspace))}",
            workspace,
        )
    words = LaunchWords.of([str(workspace), *given.arguments], node_args())
    # What a node does without, as it takes a second to import.
    from pytpc.cli.run_mission import run_mission  # noqa: PLC0415

    has_keys = not given.no_keys and sys.stdin.isatty() and sys.stdout.isatty()
    run_mission(words, given, given.observer if has_keys else None, given.references)


COMMANDS: list[click.Command] = [run_command]
