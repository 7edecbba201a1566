"""The commands about a workspace, as a user meets them."""

import os
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import click
import pytest
from click.testing import CliRunner, Result
from packages import add_package, install_prefix
from static_units import failed_unit, unit

from pytpc.api.building import WholeBuild
from pytpc.base.errors import InputError
from pytpc.build.build import BuildResult
from pytpc.build.reconcile import Recorded
from pytpc.cli import workspace_commands
from pytpc.cli.main import main
from pytpc.processes.analysis import Analysed
from pytpc.processes.process import Process, Processes, Unit
from pytpc.static.link_unit import LeftOut, LinkUnit
from pytpc.static.static_info import StaticInfo
from pytpc.workspace.colcon import Bases, BuildError, BuildOptions

VERSION = (Path(__file__).parents[2] / "VERSION").read_text().strip()


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


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

    def fake(workspace: Path, options: BuildOptions, **callbacks: Any) -> WholeBuild:
        given.update(asdict(options), bases=options.bases, workspace=workspace)
        callbacks["on_output"]("Starting >>> face")
        callbacks["on_output"]("[ 50%] Building CXX object")
        static = StaticInfo.of(
            [LinkUnit.from_json(data, tmp_path) for data in (unit(), failed_unit())],
            left_out=[LeftOut("face", "thin", "it is a test")],
        )
        alone = {"leg": "a.cpp:1: error: no"}
        callbacks["on_scripts"](1, 2)
        callbacks["on_process"]("arm/drive", 0, 2)
        result = BuildResult(options.bases, (), static, alone, 12.34)
        process = Process("arm/drive", "arm/drive", None, (Unit("arm", "drive", Path(), recorded),))
        analysed = (
            Analysed(process, tmp_path / "plan.json", {}, ("libown.so: has no bitcode",)),
            Analysed(process, None, {}, failure="it takes too long"),
        )
        return WholeBuild(result, Processes((), ("two plugins of one name",)), analysed)

    recorded = Recorded("arm", "drive", tmp_path, tmp_path, "")
    monkeypatch.setattr(workspace_commands, "build", fake)
    result = run(
        *("build", tmp_path, "--package", "face", "--package", "arm", "--build-type", "Debug"),
        *("--constants", "--base", tmp_path / "own", "--tests", "--no-fallback", "--retry"),
        *("--no-python", "--python-rules", tmp_path / "rules.json"),
        *("--no-processes", "--process-seconds", "7"),
        *("--", "--merge-install", "--cmake-args", "-DX=1"),
    )
    assert result.exit_code == 0, result.output
    assert given["workspace"] == tmp_path
    assert given["packages"] == ("face", "arm")
    assert given["build_type"] == "Debug"
    assert given["bases"] == Bases(tmp_path / "own")
    assert (given["constants"], given["tests"], given["retry"]) == (True, True, True)
    assert (given["fallback"], given["python"]) == (False, False)
    assert (given["processes"], given["process_seconds"]) == (False, 7)
    assert given["python_rules"] == tmp_path / "rules.json"
    assert given["colcon_args"] == ("--merge-install", "--cmake-args", "-DX=1")
    assert result.stdout.splitlines()[-1] == (
        f"1 comparison in 2 link units, built in 12.3 s: {tmp_path}/own/static.json"
    )
    assert result.stderr.splitlines() == [
        "Starting >>> face",
        "analysing arm/drive, 0 of 2 processes done",
        "pytpc: warning: face/broken was not analysed and reports nothing:"
        " the instrumented module does not verify",
        "face/thin reports nothing: it is a test",
        "pytpc: warning: two plugins of one name",
        "pytpc: warning: libown.so: has no bitcode",
        "pytpc: warning: process arm/drive: it takes too long; analysed alone: drive",
        "1 process analysed as a whole; `pytpc processes` shows what belongs to them",
        "pytpc: warning: package leg was built without TPC, because it does not build with it:"
        " a.cpp:1: error: no",
        "run `pytpc build --retry` to try TPC again",
    ]


def test_build_shows_the_tail_and_then_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fake(*_: object, **__: object) -> BuildResult:
        raise BuildError("does not build", tmp_path / "log", "face", ["a.cpp:1: [b] error", "stop"])

    monkeypatch.setattr(workspace_commands, "build", fake)
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
        (
            MemoryError(),
            1,
            "pytpc: error: out of memory; end other programs, or give less at once\n",
        ),
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
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, f"pytpc, version {VERSION}\n", "")


def test_every_command_has_help() -> None:
    for name in ("patch", "build"):
        result = run(name, "--help")
        assert result.exit_code == 0
        assert result.stdout.startswith(f"Usage: main {name} ")
