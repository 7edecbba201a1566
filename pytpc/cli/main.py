"""The command ``pytpc``: gathers the commands, and shows each error as one line."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from importlib.metadata import entry_points

import click
from click.shell_completion import CompletionItem

from pytpc.base.errors import TpcError
from pytpc.cli.completion_commands import completing

INTERRUPTED = 130
# Where each command is and what the list of commands says of it: what draws, builds or reads bags
# takes a second to import, which asking for help, or another command, must not wait for.
SUMMARIES = {
    "analyse": ("python_commands", "Find the comparisons of Python nodes."),
    "apply": ("value_commands", "Write a value into the file that set it, or onto the robot."),
    "blind-spots": ("explain_commands", "List the places behind which the analysis does not see."),
    "build": ("workspace_commands", "Build a workspace with analysis and instrumentation."),
    "collect": ("static_commands", "Merge the static information of link units into one file."),
    "completion": ("completion_commands", "Print what makes bash, zsh or fish complete pytpc."),
    "convert": ("event_commands", "Read bags, binary files, logs or CSV into Parquet."),
    "doctor": ("machine_commands", "Say what is wrong with this machine, or with a workspace."),
    "env": ("env_commands", "Print what lets Python nodes report that a shell starts."),
    "explain": ("explain_commands", "Show the way from a parameter to what is exposed."),
    "export": ("static_commands", "Write what was found as SARIF or as an HTML page."),
    "ingest": ("event_commands", "The same as convert (its older name)."),
    "list": ("static_commands", "List the comparisons that were found."),
    "mark": ("mark_commands", "Mark by one key each when the robot does wrong."),
    "marks": ("mark_commands", "List the marks of a recording; add or remove some."),
    "origin": ("value_commands", "Say where the values of parameters came from."),
    "patch": ("workspace_commands", "Put TPC's three lines into each CMakeLists.txt."),
    "rank": ("rank_commands", "Name the suspected parameters, from all marks."),
    "record": ("mission_commands", "Record the running graph, or a launch file's mission."),
    "relay": ("graph_commands", "Pass reports on from /rosout to /threshold_information."),
    "report": ("report_commands", "Write a page with the suspects at each mark, and why."),
    "run": ("run_commands", "Run a Python node whose comparisons report."),
    "show": ("static_commands", "Show all that is known about a comparison."),
    "sink": ("graph_commands", "Show and change where running nodes report to."),
    "suggest": ("suggest_commands", "Say what to do with the suspects, and what it would change."),
    "toolchain": ("machine_commands", "Print what to type to build with TPC by another tool."),
    "watch": ("watch_commands", "Show the suspected parameters while the robot runs; mark."),
}

_EVALUATION = frozenset({"stats", "study", "survey"})


@cache
def summaries() -> dict[str, tuple[str, str]]:
    """Module and summary of each command, ours and those of other packages, by name.

    A package adds commands by an entry point of the group ``pytpc.commands``: a dictionary as this
    one.
    """
    found = {name: (f"pytpc.cli.{module}", text) for name, (module, text) in SUMMARIES.items()}
    for point in entry_points(group="pytpc.commands"):
        found.update({name: said for name, said in point.load().items() if name not in found})
    return dict(sorted(found.items()))


class _Commands(click.Group):
    """A group that ends with status 1 and one line after an error, 130 when interrupted.

    A command is imported when it is asked for.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(summaries())

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name in SUMMARIES:
            # Asking what is installed takes longer than many a command.
            module = f"pytpc.cli.{SUMMARIES[cmd_name][0]}"
        elif cmd_name in summaries():
            module = summaries()[cmd_name][0]
        elif cmd_name in _EVALUATION:
            raise TpcError(
                f"`{cmd_name}` is in the package pytpc-evaluation; in a checkout of TPC:"
                " pip install ./evaluation"
            )
        else:
            return super().get_command(ctx, cmd_name)
        commands: list[click.Command] = import_module(module).COMMANDS
        return completing(next(command for command in commands if command.name == cmd_name))

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """The commands that begin so; none is imported for it."""
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
