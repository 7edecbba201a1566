"""The list of commands, which is shown without importing them."""

import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

import click
import pytest
from click.testing import CliRunner

import pytpc.cli
from pytpc.cli.main import GROUPS, SUMMARIES, main

ROOT = Path(__file__).parents[2]


def test_all_commands_are_in_the_list_each_with_its_module() -> None:
    modules = [found.name for found in iter_modules(pytpc.cli.__path__) if "_comm" in found.name]
    there = {
        command.name: module
        for module in modules
        for command in import_module(f"pytpc.cli.{module}").COMMANDS
    }
    assert {name: module for name, (module, _, _) in SUMMARIES.items()} == there
    assert list(dict.fromkeys(group for _, _, group in SUMMARIES.values())) == list(GROUPS[:3])


def test_help_names_every_command_and_says_all_of_it_in_80_columns() -> None:
    text = CliRunner().invoke(main, ["--help"], terminal_width=80).output
    for name, (_, summary, _) in SUMMARIES.items():
        assert f"  {name:<13}{summary}\n" in text
        assert main.get_command(click.Context(main), name) is not None
    assert CliRunner().invoke(main, ["nothing"]).exit_code == 2


def test_help_has_the_commands_in_groups() -> None:
    lines = CliRunner().invoke(main, ["--help"], terminal_width=80).output.splitlines()
    headings = [line[:-1] for line in lines if line.endswith(":") and line != "Options:"]
    assert headings[:3] == ["Every day", "Workspace", "Recordings"]
    assert lines[lines.index("Every day:") + 1].split()[0] == "doctor"
    # A command of another package is research, unless it says otherwise.
    assert "rank" in "".join(lines[lines.index("Every day:") : lines.index("Workspace:")])


@pytest.mark.parametrize(
    ("said", "group"),
    [
        (("extra_module", "Does more."), "Research"),
        (("extra_module", "Does more.", "Recordings"), "Recordings"),
        (("extra_module", "Does more.", "No such group"), "Research"),
    ],
)
def test_a_command_of_another_package_is_in_a_group(
    said: tuple[str, ...], group: str, tmp_path: Path
) -> None:
    env = installed(tmp_path, "extra_module:COMMANDS", f"COMMANDS = {{'extra': {said!r}}}")
    done = subprocess.run(
        [sys.executable, "-m", "pytpc", "--help"],
        env=env,
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    )
    of_group = done.stdout.partition(f"{group}:\n")[2].partition("\n\n")[0]
    assert "  extra        Does more." in of_group


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        ("rnk", "no command 'rnk'; did you mean rank?"),
        ("Suggest", "no command 'Suggest'; did you mean suggest?"),
        ("zzz", "no command 'zzz'; see `pytpc --help`"),
        ("ingest", "ingest is now called convert: pytpc convert"),
    ],
)
def test_a_command_that_does_not_exist(typed: str, said: str) -> None:
    result = CliRunner().invoke(main, [typed, "x"])
    assert result.exit_code == 2
    assert result.stderr.splitlines()[-1] == f"Error: {said}"


def test_what_takes_long_to_import_is_imported_by_those_that_need_it() -> None:
    """Drawing, Parquet and bags take a second together; help and lists do without."""
    slow = {"matplotlib", "pyarrow", "rosbags", "scipy"}
    for module in (
        "main",
        "list_commands",
        "static_commands",
        "explain_commands",
        "machine_commands",
    ):
        code = f"import sys, pytpc.cli.{module}; print(*sys.modules)"
        done = subprocess.run(
            [sys.executable, "-c", code], check=False, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        assert slow.isdisjoint(done.stdout.split()), module


def installed(folder: Path, entry_point: str, module: str) -> dict[str, str]:
    """The environment in which a package is installed that adds commands by an entry point."""
    info = folder / "extra_commands-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: extra-commands\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[pytpc.commands]\nextra = {entry_point}\n")
    (folder / "extra_module.py").write_text(module)
    return {**os.environ, "PYTHONPATH": f"{folder}:{os.environ.get('PYTHONPATH', '')}"}


@pytest.mark.parametrize(
    ("entry_point", "module", "why"),
    [
        ("gone:COMMANDS", "", "ModuleNotFoundError: No module named 'gone'"),
        (
            "extra_module:COMMANDS",
            "",
            "AttributeError: module 'extra_module' has no attribute 'COMMANDS'",
        ),
        (
            "extra_module:COMMANDS",
            "raise OSError('no\\ndisk')",
            "OSError: no disk",
        ),
        (
            "extra_module:COMMANDS",
            "COMMANDS = 3",
            "AttributeError: 'int' object has no attribute 'items'",
        ),
    ],
)
def test_a_broken_entry_point_is_one_line_and_the_other_commands_work(
    entry_point: str, module: str, why: str, tmp_path: Path
) -> None:
    env = installed(tmp_path, entry_point, module)
    done = subprocess.run(
        [sys.executable, "-m", "pytpc", "--help"],
        env=env,
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    )
    assert done.stderr == (
        "pytpc: warning: the package extra-commands has commands that cannot be loaded"
        f" ({why}); reinstall or remove it\n"
    )
    assert all(
        f"  {name:<13}{summary}\n" in done.stdout for name, (_, summary, _) in SUMMARIES.items()
    )
    # A command of ours does not even look at them.
    ours = subprocess.run(
        [sys.executable, "-m", "pytpc", "completion", "bash"],
        env=env,
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    )
    assert ours.stderr == ""
