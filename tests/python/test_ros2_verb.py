"""``ros2 tpc``, with a ros2cli of the test's own, and what makes TPC a package of ROS 2."""

import argparse
import sys
from importlib import import_module, metadata
from types import ModuleType

import pytest
from catkin_pkg.package import parse_package_string

from pytpc.base.paths import project_root


@pytest.fixture
def parser(monkeypatch: pytest.MonkeyPatch) -> argparse.ArgumentParser:
    """A parser as ros2cli makes it: one of its own for each command."""
    ros2cli, command = ModuleType("ros2cli"), ModuleType("ros2cli.command")
    command.CommandExtension = object  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "ros2cli", ros2cli)
    monkeypatch.setitem(sys.modules, "ros2cli.command", command)
    monkeypatch.delitem(sys.modules, "pytpc.cli.ros2_verb", raising=False)
    extension = import_module("pytpc.cli.ros2_verb").TpcCommand()
    monkeypatch.delitem(sys.modules, "pytpc.cli.ros2_verb")
    top = argparse.ArgumentParser(prog="ros2")
    of_command = top.add_subparsers().add_parser("tpc")
    of_command.set_defaults(extension=extension)
    extension.add_arguments(of_command, "ros2 tpc")
    return top


def run(parser: argparse.ArgumentParser, *words: str) -> int:
    args = parser.parse_args(["tpc", *words])
    with pytest.raises(SystemExit) as ended:
        args.extension.main(parser=parser, args=args)
    return int(ended.value.code or 0)


def test_words_and_options_are_those_of_pytpc(
    parser: argparse.ArgumentParser, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(parser, "list", "--help") == 0
    assert capsys.readouterr().out.startswith("Usage: ros2 tpc list [OPTIONS] [SOURCE]")
    assert run(parser, "--version") == 0
    assert "version" in capsys.readouterr().out


def test_an_error_has_the_exit_status_of_pytpc(
    parser: argparse.ArgumentParser, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(parser, "rank", "/nowhere", "--json") == 1
    assert "/nowhere: no such" in capsys.readouterr().err


def test_ros2cli_finds_the_command_by_its_entry_point() -> None:
    text = (project_root() / "pyproject.toml").read_text()
    section = text.partition('[project.entry-points."ros2cli.command"]\n')[2]
    name, _, value = section.partition("\n")[0].partition(" = ")
    point = metadata.EntryPoint(name, value.strip('"'), "ros2cli.command")
    assert (point.name, point.module, point.attr) == (
        "tpc",
        "pytpc.cli.ros2_verb",
        "TpcCommand",
    )


def test_the_installed_part_has_a_valid_manifest() -> None:
    version = (project_root() / "VERSION").read_text().strip()
    text = (project_root() / "cmake/ros2/package.xml.in").read_text()
    warnings: list[str] = []
    found = parse_package_string(text.replace("@TPC_VERSION@", version), warnings=warnings)
    assert (found.name, found.version, found.package_format) == ("tpc", version, 3)
    assert warnings == []
