"""The command ``pytpc``: gathers the commands, and shows each error as one line."""

from __future__ import annotations

import contextlib
import errno
import os
import sys
from functools import cache
from importlib import import_module
from typing import Any

import click
from click.shell_completion import CompletionItem

from pytpc.base.closest import did_you_mean
from pytpc.base.errors import TpcError
from pytpc.base.wording import plain
from pytpc.cli.lines import say

INTERRUPTED = 130
EVERY_DAY, WORKSPACE, RECORDINGS = "Every day", "Workspace", "Recordings"
RESEARCH = "Research"
"""The group of commands that other packages add, unless they name another one."""
GROUPS = (EVERY_DAY, WORKSPACE, RECORDINGS, RESEARCH)

# The module and the summary of each command by its group, in the order of the help. Modules that
# draw, build or read bags take a second to import; neither the help nor another command should wait
# for that.
_GROUPED = {
    EVERY_DAY: {
        "doctor": ("machine_commands", "Check your setup and print the fix for each problem."),
        "build": ("workspace_commands", "Build a workspace with analysis and instrumentation."),
        "record": (
            "mission_commands",
            "Record the running graph, or a launch file's mission.",
        ),
        "keep": ("keep_commands", "Keep the last minutes of a robot that runs, as a recording."),
        "run": ("run_commands", "Run a mission up to its verdict, or one Python node."),
        "mark": ("mark_commands", "Mark errors of the robot by pressing a key."),
        "watch": ("watch_commands", "Show the suspected parameters while the robot runs; mark."),
        "live": ("live_commands", "Serve a page that shows what decides now, and takes marks."),
        "stream": ("stream_commands", "Pass on what a robot decides to Rerun and /diagnostics."),
        "rank": ("rank_commands", "Rank the suspected parameters, from all marks."),
        "suggest": ("suggest_commands", "Suggest a value to try, and show what it would change."),
        "report": ("report_commands", "Write a page with the suspects at each mark, and why."),
        "fix": ("fix_commands", "Try values in turn until the robot is right, or none is left."),
        "margins": ("margins_commands", "Show how near each comparison came to turning."),
        "diff": ("diff_commands", "Show what differs between a good recording and a bad one."),
        "origin": ("value_commands", "Show where the values of parameters came from."),
        "apply": ("value_commands", "Change a value in the file that set it, or on the robot."),
    },
    WORKSPACE: {
        "lint": ("lint_commands", "Show what is wrong with parameters before the robot runs."),
        "processes": ("process_commands", "Show which code runs in one process."),
        "list": ("list_commands", "List the comparisons that were found."),
        "show": ("static_commands", "Show everything known about a comparison."),
        "explain": ("explain_commands", "Show how a parameter reaches what the robot exposes."),
        "coverage": ("explain_commands", "Show what became of each parameter that is read."),
        "blind-spots": ("explain_commands", "List the places that the analysis cannot see past."),
        "compare": ("compare_commands", "Show what differs between two builds or recordings."),
        "export": (
            "static_commands",
            "Write comparisons as SARIF or HTML, recordings for viewers.",
        ),
        "analyse": ("python_commands", "Find the comparisons of Python nodes."),
        "collect": ("static_commands", "Merge the static information of link units into one file."),
        "patch": ("workspace_commands", "Add TPC's three lines to each CMakeLists.txt."),
        "toolchain": ("machine_commands", "Print how to build with TPC by another tool."),
        "env": ("env_commands", "Print shell commands that make Python nodes report."),
        "completion": ("completion_commands", "Print the shell's completion script for pytpc."),
    },
    RECORDINGS: {
        "marks": ("marks_commands", "List the marks of a recording, or add and remove some."),
        "learn": ("learn_commands", "Learn what is normal for a robot from its good runs."),
        "fleet": ("fleet_commands", "Keep the missions of many robots, and ask them together."),
        "convert": ("convert_commands", "Convert bags, binary files, logs or CSV to Parquet."),
        "sink": ("graph_commands", "Show or change where running nodes report to."),
        "relay": ("graph_commands", "Forward reports from /rosout to /threshold_information."),
    },
}
SUMMARIES = {
    name: (module, summary, group)
    for group, commands in _GROUPED.items()
    for name, (module, summary) in commands.items()
}
RENAMED = {"ingest": "convert"}
"""Old and new names of commands."""

_EVALUATION = frozenset({"stats", "study", "survey"})


@cache
def summaries() -> dict[str, tuple[str, str, str]]:
    """Module, summary and group of each command, ours and those of other packages, by name.

    A package adds commands by an entry point of the group ``pytpc.commands``, a dictionary like
    ``SUMMARIES``, in which the group may be left out. One that cannot be loaded is warned of, and
    the others still work.
    """
    # Its import takes as long as the rest of this module, and most commands do without it.
    from importlib.metadata import entry_points  # noqa: PLC0415

    found = {
        name: (f"pytpc.cli.{module}", text, group)
        for name, (module, text, group) in SUMMARIES.items()
    }
    for point in entry_points(group="pytpc.commands"):
        try:
            added = {name: _with_group(*said) for name, said in point.load().items()}
        except Exception as error:  # whatever another package raises
            package = point.dist.name if point.dist is not None else point.value
            why = f"{type(error).__name__}: {' '.join(str(error).split())}"
            say(
                f"pytpc: warning: the package {package} has commands that cannot be loaded"
                f" ({why}); reinstall or remove it",
            )
            continue
        found.update({name: said for name, said in added.items() if name not in found})
    return found


def _with_group(module: str, summary: str, group: str = RESEARCH) -> tuple[str, str, str]:
    """An entry of another package; a group that we do not have is research, too."""
    return module, summary, group if group in GROUPS else RESEARCH


class _Commands(click.Group):
    """A group that ends with status 1 and one line after an error, 130 when interrupted.

    A command is imported when it is used.
    """

    def make_context(self, *args: Any, **extra: Any) -> click.Context:  # noqa: ANN401
        """``--help`` and ``--version`` are printed here."""
        try:
            return super().make_context(*args, **extra)
        except BrokenPipeError:
            raise
        except OSError as error:
            _tell(error)
            sys.exit(1)

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted(summaries())

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name in RENAMED and not ctx.resilient_parsing:
            ctx.fail(f"{cmd_name} is now called {RENAMED[cmd_name]}: pytpc {RENAMED[cmd_name]}")
        if cmd_name in SUMMARIES:
            # Looking for installed packages takes longer than many commands.
            module = f"pytpc.cli.{SUMMARIES[cmd_name][0]}"
        elif cmd_name in summaries():
            module = summaries()[cmd_name][0]
        elif cmd_name in _EVALUATION and not ctx.resilient_parsing:
            raise TpcError(
                f"`{cmd_name}` is in the package pytpc-evaluation; in a checkout of TPC:"
                " pip install ./evaluation"
            )
        else:
            return super().get_command(ctx, cmd_name)
        commands: list[click.Command] = import_module(module).COMMANDS
        return next(command for command in commands if command.name == cmd_name)

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """The commands that begin like this, without importing them."""
        found = [
            CompletionItem(name, help=summary)
            for name, (_, summary, _) in sorted(summaries().items())
            if name.startswith(incomplete)
        ]
        return [*found, *click.Command.shell_complete(self, ctx, incomplete)]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        width = max(map(len, summaries()))
        for group in GROUPS:
            rows = [
                (name.ljust(width), summary)
                for name, (_, summary, its) in summaries().items()
                if its == group
            ]
            if rows:
                with formatter.section(group):
                    formatter.write_dl(rows)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command; for one that does not exist, say which was most likely meant."""
        if args and not ctx.resilient_parsing and not args[0].startswith("-"):
            name = args[0]
            if name not in RENAMED and name not in _EVALUATION and name not in SUMMARIES:
                known = summaries()
                if name not in known and name not in self.commands:
                    hint = did_you_mean(name, known)
                    ctx.fail(f"no command {plain(name)!r}{hint or '; see `pytpc --help`'}")
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: click.Context) -> object:
        try:
            return super().invoke(ctx)
        except TpcError as error:
            say(f"pytpc: error: {error}")
            ctx.exit(1)
        except KeyboardInterrupt:
            say("pytpc: interrupted")
            ctx.exit(INTERRUPTED)
        except MemoryError:
            say("pytpc: error: out of memory; end other programs, or give less at once")
            ctx.exit(1)
        except BrokenPipeError:
            raise
        except OSError as error:
            _tell(error)
            ctx.exit(1)


def _tell(error: OSError) -> None:
    """Print an error of the system as one line."""
    place = ""
    if isinstance(error.filename, str | bytes):
        place = f"{os.fsdecode(error.filename)}: "
    elif error.errno in {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO}:
        place = "the output cannot be written: "
        _throw_away_output()
    say(plain(f"pytpc: error: {place}{error.strerror or error}"))


def _throw_away_output() -> None:
    """Python would try at its end to write what is left, and print a traceback."""
    with contextlib.suppress(OSError, ValueError):
        output = sys.stdout.fileno()
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, output)
        os.close(nowhere)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="pytpc", prog_name="pytpc")
def main() -> None:
    """Find the parameter that makes a robot misbehave."""
