"""The commands about a workspace, as a user meets them."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import click
import pytest
from click.testing import CliRunner, Result
from packages import add_package, install_prefix
from static_units import KEYS, comparison, failed_unit, unit

from pytpc.build import BuildResult
from pytpc.cli import workspace_commands
from pytpc.cli.main import main
from pytpc.colcon import Bases, BuildError
from pytpc.errors import InputError
from pytpc.link_units import UnitState
from pytpc.static_info import LinkUnit, StaticInfo


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture
def build_base(tmp_path: Path) -> Path:
    base = tmp_path / "build"
    units = {
        "face/tpc/detector.json": unit(
            comparisons=[comparison(source_code="if (x[red] > limit_)  // [/red]")]
        ),
        "arm/tpc/mover.json": unit(
            package="arm",
            link_unit="mover",
            comparisons=[
                comparison(key=KEYS[1], source_code=None, topic=None, source="min_height")
            ],
        ),
        "arm/tpc/broken.json": failed_unit(package="arm"),
    }
    for place, data in units.items():
        (base / place).parent.mkdir(parents=True, exist_ok=True)
        (base / place).write_text(json.dumps(data), encoding="utf-8")
    return base


def test_collect_writes_one_file_and_warns(build_base: Path, tmp_path: Path) -> None:
    output = tmp_path / "out/static.json"
    result = run("collect", build_base, "-o", output)
    assert (result.exit_code, result.stderr) == (
        0,
        "pytpc: warning: broken of package arm was left as it was and reports nothing:"
        " the instrumented module does not verify\n",
    )
    assert result.stdout.splitlines()[-1] == f"2 comparisons in 3 link units: {output}"
    assert len(json.loads(output.read_text(encoding="utf-8"))["units"]) == 3


def test_collect_shows_the_numbers_of_each_unit(build_base: Path, tmp_path: Path) -> None:
    data = unit()
    data["counts"].update(comparisons=31, parameter_reads=47, exposing_statements=59)
    (build_base / "face/tpc/detector.json").write_text(json.dumps(data), encoding="utf-8")
    result = run("collect", build_base, "-o", tmp_path / "static.json")
    (row,) = (line for line in result.stdout.splitlines() if "detector" in line)
    assert [cell.strip() for cell in row.strip("│").split("│")] == [
        "face", "detector", "31", "47", "59", "ok",
    ]  # fmt: skip


def test_collect_of_a_folder_without_any_writes_nothing(tmp_path: Path) -> None:
    result = run("collect", tmp_path, "-o", tmp_path / "static.json")
    assert result.exit_code == 1
    assert result.stderr == (
        f"pytpc: error: {tmp_path}: no static information here; build with `pytpc build`\n"
    )
    assert list(tmp_path.iterdir()) == []


def test_list_shows_source_lines_as_they_are(build_base: Path) -> None:
    result = run("list", build_base)
    assert result.exit_code == 0
    assert "if (x[red] > limit_)  // [/red]" in result.stdout
    assert "face/src/detector.cpp:40" in result.stdout
    assert "> min_coverage_limit_" in result.stdout
    assert result.stdout.splitlines()[-1] == "2 comparisons in 3 link units"


def test_list_as_json_holds_every_field(build_base: Path) -> None:
    listed = json.loads(run("list", build_base, "--json").stdout)
    expected: list[dict[str, Any]] = [
        {
            "package": "arm",
            "link_unit": "mover",
            **comparison(key=KEYS[1], source_code=None, topic=None, source="min_height"),
        },
        {
            "package": "face",
            "link_unit": "detector",
            **comparison(source_code="if (x[red] > limit_)  // [/red]"),
        },
    ]
    assert listed == expected


CONSTANT = comparison(
    key=KEYS[2], type="constant", source=None, name="7", read_at=None, param_reads=[], default=None
)


def test_constants_are_listed_where_that_is_asked_for(tmp_path: Path) -> None:
    source = tmp_path / "static.json"
    source.write_text(json.dumps(unit(comparisons=[comparison(), CONSTANT])), encoding="utf-8")
    assert run("list", source).stdout.splitlines()[-1] == "1 comparison in 1 link unit"
    assert "constant" not in run("list", source).stdout
    assert "constant" in run("list", source, "--constants").stdout
    assert len(json.loads(run("list", source, "--json").stdout)) == 1
    assert json.loads(run("list", source, "--json", "--constants").stdout)[1]["name"] == "7"


def test_list_finds_what_is_here(
    build_base: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("list").stdout.splitlines()[-1] == "2 comparisons in 3 link units"
    StaticInfo.of([LinkUnit.from_json(unit(), tmp_path)]).save(tmp_path / "static.json")
    assert run("list").stdout.splitlines()[-1] == "1 comparison in 1 link unit"


def test_a_broken_file_is_one_line_with_its_place(tmp_path: Path) -> None:
    path = tmp_path / "static.json"
    path.write_text('{"schema": 1,\n"units": [', encoding="utf-8")
    result = run("list", path)
    assert result.exit_code == 1
    assert result.stdout == ""
    assert result.stderr == f"pytpc: error: {path}:2: not JSON: Expecting value, column 11\n"


def test_an_output_that_cannot_be_written_is_one_line(build_base: Path) -> None:
    result = run("collect", build_base, "-o", build_base / "face/tpc/detector.json/static.json")
    assert result.exit_code == 1
    assert result.stderr.startswith(f"pytpc: error: {build_base}/face/tpc/detector.json/static")
    assert result.stderr.count("\n") == 1


def test_patch_goes_there_and_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install_prefix(tmp_path / "prefix")
    monkeypatch.setenv("TPC_PREFIX", str(tmp_path / "prefix"))
    folder = add_package(tmp_path / "ws/arm")
    path = folder / "CMakeLists.txt"
    path.write_bytes(b"project(arm)\r\n")
    shown = run("patch", tmp_path / "ws", "--dry-run")
    assert shown.stdout_bytes.count(b"\r\n") == 4
    assert path.read_bytes() == b"project(arm)\r\n"
    assert run("patch", tmp_path / "ws", "--package", "arm").stdout.endswith("1 patched\n")
    assert path.read_bytes().count(b"\r\n") == 4
    assert run("patch", tmp_path / "ws", "--restore").stdout.endswith("1 restored\n")
    assert path.read_bytes() == b"project(arm)\r\n"
    path.write_bytes(b"project(arm\n")
    result = run("patch", tmp_path / "ws")
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr.startswith(f"pytpc: error: {path}:1: CMake cannot parse this file")


def test_build_hands_over_its_options_and_shows_the_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: dict[str, Any] = {}

    def fake(workspace: Path, **options: Any) -> BuildResult:
        given.update(options, workspace=workspace)
        options["on_output"]("Starting >>> face")
        options["on_output"]("[ 50%] Building CXX object")
        static = StaticInfo.of(
            LinkUnit.from_json(data, tmp_path) for data in (unit(), failed_unit())
        )
        left_out = (
            UnitState("face", "thin", tmp_path / "thin", "it is a test"),
            UnitState("leg", "node", tmp_path / "node", "its package does not build with TPC"),
        )
        alone = {"leg": "a.cpp:1: error: no"}
        return BuildResult(options["bases"], (), static, left_out, alone, 12.34)

    monkeypatch.setattr(workspace_commands, "build_workspace", fake)
    result = run(
        *("build", tmp_path, "--package", "face", "--package", "arm", "--build-type", "Debug"),
        *("--constants", "--base", tmp_path / "own", "--tests", "--no-fallback", "--retry"),
        *("--", "--merge-install", "--cmake-args", "-DX=1"),
    )
    assert result.exit_code == 0, result.output
    assert given["workspace"] == tmp_path
    assert given["packages"] == ("face", "arm")
    assert given["build_type"] == "Debug"
    assert given["bases"] == Bases(tmp_path / "own")
    assert (given["constants"], given["tests"], given["retry"]) == (True, True, True)
    assert given["fallback"] is False
    assert given["colcon_args"] == ("--merge-install", "--cmake-args", "-DX=1")
    assert result.stdout.splitlines()[-1] == (
        f"1 comparison in 2 link units, built in 12.3 s: {tmp_path}/own/static.json"
    )
    assert result.stderr.splitlines() == [
        "Starting >>> face",
        "pytpc: warning: broken of package face was left as it was and reports nothing:"
        " the instrumented module does not verify",
        "pytpc: warning: package leg is built without TPC, with which it does not build:"
        " a.cpp:1: error: no",
        "face/thin reports nothing: it is a test",
        "pytpc build --retry tries again with TPC",
    ]


def test_build_shows_the_tail_and_then_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fake(*_: object, **__: object) -> BuildResult:
        raise BuildError("does not build", tmp_path / "log", "face", ["a.cpp:1: [b] error", "stop"])

    monkeypatch.setattr(workspace_commands, "build_workspace", fake)
    result = run("build", tmp_path)
    assert result.exit_code == 1
    assert result.stderr == (
        f"a.cpp:1: [b] error\nstop\npytpc: error: {tmp_path}/log: does not build\n"
    )


@pytest.mark.parametrize(
    ("error", "status", "shown"),
    [
        (InputError("two\nlines", "a.bag", 3), 1, "pytpc: error: a.bag:3: two lines\n"),
        (
            PermissionError(13, "Permission denied", "/x"),
            1,
            "pytpc: error: /x: Permission denied\n",
        ),
        (KeyboardInterrupt(), 130, "pytpc: interrupted\n"),
    ],
)
def test_any_error_of_any_command_is_one_line(
    monkeypatch: pytest.MonkeyPatch, error: BaseException, status: int, shown: str
) -> None:
    def fail() -> None:
        raise error

    monkeypatch.setitem(main.commands, "fail", click.Command("fail", callback=fail))
    result = run("fail")
    assert (result.exit_code, result.stderr, result.stdout) == (status, shown, "")


def test_a_fault_of_ours_is_not_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> None:
        raise ZeroDivisionError

    monkeypatch.setitem(main.commands, "fail", click.Command("fail", callback=fail))
    assert isinstance(run("fail").exception, ZeroDivisionError)


def test_the_module_runs_and_knows_its_version() -> None:
    ran = subprocess.run(
        [sys.executable, "-m", "pytpc", "--version"],
        env={**os.environ, "PYTHONWARNINGS": "error"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, "pytpc, version 0.1.0\n", "")


def test_every_command_has_help() -> None:
    for name in ("patch", "build", "collect", "list"):
        result = run(name, "--help")
        assert result.exit_code == 0
        assert result.stdout.startswith(f"Usage: main {name} ")
