"""The command ``pytpc``: gathers the commands, and shows each error as one line."""

from __future__ import annotations

from functools import cache
from importlib import import_module

import click
from click.shell_completion import CompletionItem

from pytpc.base.errors import TpcError

INTERRUPTED = 130
# The module and the summary of each command. Modules that draw, build or read bags take a second to
# import; neither the help nor another command should wait for that.
SUMMARIES = {
    "analyse": ("python_commands", "Find the comparisons of Python nodes."),
    "apply": ("value_commands", "Change a value in the file that set it, or on the robot."),
    "blind-spots": ("explain_commands", "List the places that the analysis cannot see past."),
    "build": ("workspace_commands", "Build a workspace with analysis and instrumentation."),
    "collect": ("static_commands", "Merge the static information of link units into one file."),
    "completion": ("completion_commands", "Print the shell's completion script for pytpc."),
    "convert": ("convert_commands", "Convert bags, binary files, logs or CSV to Parquet."),
    "coverage": ("explain_commands", "Show what became of each parameter that is read."),
    "doctor": ("machine_commands", "Check your setup and print the fix for each problem."),
    "env": ("env_commands", "Print shell commands that make Python nodes report."),
    "explain": ("explain_commands", "Show how a parameter reaches what the robot exposes."),
    "export": ("static_commands", "Write the comparisons as SARIF or as an HTML page."),
    "list": ("list_commands", "List the comparisons that were found."),
    "mark": ("mark_commands", "Mark errors of the robot by pressing a key."),
    "marks": ("mark_commands", "List the marks of a recording, or add and remove some."),
    "origin": ("value_commands", "Show where the values of parameters came from."),
    "patch": ("workspace_commands", "Add TPC's three lines to each CMakeLists.txt."),
    "rank": ("rank_commands", "Rank the suspected parameters, from all marks."),
    "record": ("mission_commands", "Record the running graph, or the mission of a launch file."),
    "relay": ("graph_commands", "Forward reports from /rosout to /threshold_information."),
    "report": ("report_commands", "Write a page with the suspects at each mark, and why."),
    "run": ("run_commands", "Run a Python node with reports."),
    "show": ("static_commands", "Show everything known about a comparison."),
    "sink": ("graph_commands", "Show or change where running nodes report to."),
    "suggest": ("suggest_commands", "Suggest a value to try, and show what it would change."),
    "toolchain": ("machine_commands", "Print how to build with TPC by another tool."),
    "watch": ("watch_commands", "Show the suspected parameters while the robot runs; mark."),
}
RENAMED = {"ingest": "convert"}
"""Old and new names of commands."""

_EVALUATION = frozenset({"stats", "study", "survey"})


@cache
def summaries() -> dict[str, tuple[str, str]]:
    """Module and summary of each command, ours and those of other packages, by name.

    A package adds commands by an entry point of the group ``pytpc.commands``, a dictionary like
    ``SUMMARIES``. One that cannot be loaded is warned of, and the others still work.
    """
    # Its import takes as long as the rest of this module, and most commands do without it.
    from importlib.metadata import entry_points  # noqa: PLC0415

    found = {name: (f"pytpc.cli.{module}", text) for name, (module, text) in SUMMARIES.items()}
    for point in entry_points(group="pytpc.commands"):
        try:
            added = point.load().items()
        except Exception as error:  # whatever another package raises
            package = point.dist.name if point.dist is not None else point.value
            why = f"{type(error).__name__}: {' '.join(str(error).split())}"
            click.echo(
                f"pytpc: warning: the package {package} has commands that cannot be loaded"
                f" ({why}); reinstall or remove it",
                err=True,
            )
            continue
        found.update({name: said for name, said in added if name not in found})
    return dict(sorted(found.items()))


class _Commands(click.Group):
    """A group that ends with status 1 and one line after an error, 130 when interrupted.

    A command is imported when it is used.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(summaries())

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
            for name, (_, summary) in summaries().items()
            if name.startswith(incomplete)
        ]
        return [*found, *click.Command.shell_complete(self, ctx, incomplete)]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, summary) for name, (_, summary) in summaries().items()])

    def invoke(self, ctx: click.Context) -> object:
        try:
            return super().invoke(ctx)
        except TpcError as error:
            click.echo(f"pytpc: error: {error}", err=True)
            ctx.exit(1)
        except KeyboardInterrupt:
            click.echo("pytpc: interrupted", err=True)
            ctx.exit(INTERRUPTED)
        except MemoryError:
            click.echo(
                "pytpc: error: out of memory; end other programs, or give less at once", err=True
            )
            ctx.exit(1)
        except BrokenPipeError:
            raise
        except OSError as error:
            if error.filename is None:
                raise
            click.echo(f"pytpc: error: {error.filename}: {error.strerror}", err=True)
            ctx.exit(1)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="pytpc", prog_name="pytpc")
def main() -> None:
    """Find the parameter that makes a robot misbehave."""
