"""The command ``pytpc``: gathers the commands, and shows each error as one line."""

from __future__ import annotations

import click

from pytpc.cli import (
    event_commands,
    explain_commands,
    machine_commands,
    mission_commands,
    static_commands,
    survey_commands,
    workspace_commands,
)
from pytpc.errors import TpcError

INTERRUPTED = 130


class _Commands(click.Group):
    """A group that ends with status 1 and one line after an error, 130 when interrupted."""

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


for command in (
    *workspace_commands.COMMANDS,
    *machine_commands.COMMANDS,
    *static_commands.COMMANDS,
    *explain_commands.COMMANDS,
    *survey_commands.COMMANDS,
    *event_commands.COMMANDS,
    *mission_commands.COMMANDS,
):
    main.add_command(command)
