"""The list of commands, which is shown without importing them."""

import subprocess
import sys
from importlib import import_module
from pkgutil import iter_modules

import click
from click.testing import CliRunner

import pytpc.cli
from pytpc.cli.main import SUMMARIES, main


def test_all_commands_are_in_the_list_each_with_its_module() -> None:
    modules = [found.name for found in iter_modules(pytpc.cli.__path__) if "_comm" in found.name]
    there = {
        command.name: module
        for module in modules
        for command in import_module(f"pytpc.cli.{module}").COMMANDS
    }
    assert {name: module for name, (module, _) in SUMMARIES.items()} == there
    assert list(SUMMARIES) == sorted(SUMMARIES)


def test_help_names_every_command_and_says_all_of_it_in_80_columns() -> None:
    text = CliRunner().invoke(main, ["--help"], terminal_width=80).output
    for name, (_, summary) in SUMMARIES.items():
        assert f"  {name:<13}{summary}\n" in text
        assert main.get_command(click.Context(main), name) is not None
    assert CliRunner().invoke(main, ["nothing"]).exit_code == 2


def test_what_takes_long_to_import_is_imported_by_those_that_need_it() -> None:
    """Drawing, Parquet and bags take a second together; help and lists do without."""
    slow = {"matplotlib", "pyarrow", "rosbags", "scipy"}
    for module in ("main", "static_commands", "explain_commands", "machine_commands"):
        code = f"import sys, pytpc.cli.{module}; print(*sys.modules)"
        done = subprocess.run(
            [sys.executable, "-c", code], check=False, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        assert slow.isdisjoint(done.stdout.split()), module
