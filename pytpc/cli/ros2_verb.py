"""The command ``ros2 tpc``: its words are those of ``pytpc``.

ros2cli loads this module by the entry point ``tpc`` of the group ``ros2cli.command``. Nothing else
does, because it imports ros2cli, which only ROS 2 has.
"""

from __future__ import annotations

from argparse import REMAINDER, ArgumentParser, Namespace

from ros2cli.command import CommandExtension


class TpcCommand(CommandExtension):  # type: ignore[misc]
    """Find the parameter that makes a robot misbehave (pytpc)."""

    def add_arguments(self, parser: ArgumentParser, cli_name: str) -> None:
        """Take every word, options and ``--help`` among them."""
        del cli_name
        # Words that begin with a dash are options of pytpc's commands, and not of this parser.
        parser.prefix_chars = "\0"
        parser.add_argument("words", nargs=REMAINDER)

    def main(self, *, parser: ArgumentParser, args: Namespace) -> int:
        """Run the command of pytpc; it ends the process with its own exit status."""
        del parser
        # It takes longer than the help of `ros2`, which loads this module, too.
        from pytpc.cli.main import main  # noqa: PLC0415

        main(args=args.words, prog_name="ros2 tpc")
        return 0
