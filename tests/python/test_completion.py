"""Shell completion: commands, options, files, and the names of the robot's parameters."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import BashComplete
from click.testing import CliRunner

from pytpc.cli.completion_commands import parameter_names
from pytpc.cli.main import SUMMARIES, main, summaries

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples/recorded_mission"


def offered(*words: str, incomplete: str = "") -> list[str]:
    complete = BashComplete(main, {}, "pytpc", "_PYTPC_COMPLETE")
    found = complete.get_completions(list(words), incomplete)
    return [one.value for one in found if one.type == "plain"]


def test_commands_and_options():
    assert offered() == sorted(summaries())
    assert offered(incomplete="ra") == ["rank"]
    assert "--static" in offered("watch", incomplete="--")
    assert offered("rank", "--types", incomplete="d") == ["doubt"]
    assert offered("completion") == ["bash", "zsh", "fish"]


# As in a wheel of pytpc alone: the commands of the evaluation are not there, and nothing is said.
def test_completion_without_the_evaluation(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr("importlib.metadata.entry_points", lambda **_: ())
    summaries.cache_clear()
    try:
        assert offered() == sorted(SUMMARIES)
        assert offered("study") == sorted(SUMMARIES)
        assert offered("rank", "--types", incomplete="d") == ["doubt"]
        assert CliRunner().invoke(main, ["completion", "bash"]).exit_code == 0
    finally:
        summaries.cache_clear()
    assert capsys.readouterr() == ("", "")


def test_commands_are_offered_without_importing_them():
    code = (
        "import sys; from click.shell_completion import BashComplete as B;"
        "from pytpc.cli.main import main;"
        "B(main, {}, 'pytpc', '_PYTPC_COMPLETE').get_completions([], '');"
        "print('numpy' in sys.modules)"
    )
    said = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert said.stdout == "False\n"


# ~min_coverage_limit is the only parameter of the example that begins with min_cov.
def test_names_of_parameters(monkeypatch: pytest.MonkeyPatch):
    static = str(EXAMPLE / "static.json")
    assert offered("explain", static, incomplete="min_cov") == ["~min_coverage_limit"]
    assert offered("explain", static, incomplete="~min_cov") == ["~min_coverage_limit"]
    assert offered("show", str(EXAMPLE), incomplete="~min_cov") == ["~min_coverage_limit"]
    monkeypatch.setenv("COMP_WORDS", f"pytpc list {static} --parameter ~")
    assert len(offered("list", static, "--parameter", incomplete="~")) > 30


def test_nothing_is_offered_and_nothing_said_where_nothing_can_be_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    for content in (b"", b"{", b"[]", b'{"units": 3}', b"\xff", b'{"units": [{}]}', b"1"):
        (tmp_path / "static.json").write_bytes(content)
        assert offered("explain", incomplete="m") == []
    assert parameter_names([tmp_path / "gone", tmp_path]) == []
    unit = {"comparisons": [{"source": "~b"}, {"source": None}, {"source": "~a"}]}
    (tmp_path / "static.json").write_text(json.dumps(unit))
    assert offered("explain", incomplete="") == ["~a", "~b"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_scripts_are_the_shells_own(shell: str, tmp_path: Path):
    said = CliRunner().invoke(main, ["completion", shell])
    assert said.exit_code == 0
    assert f"_PYTPC_COMPLETE={shell}_complete" in said.stdout
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    script = tmp_path / "script"
    script.write_text(said.stdout)
    subprocess.run([shell, "-n", str(script)], check=True)


# The function that the script makes, called as bash does when Tab is pressed.
def test_bash_completes(tmp_path: Path):
    command = tmp_path / "pytpc"
    command.write_text(f'#!/bin/sh\nexec {sys.executable} -m pytpc "$@"\n')
    command.chmod(0o755)
    script = f"""
        eval "$(pytpc completion bash)"
        COMP_WORDS=(pytpc explain {EXAMPLE}/static.json min_cov); COMP_CWORD=3
        _pytpc_completion pytpc
        echo "${{COMPREPLY[@]}}"
    """
    path = f"{tmp_path}:{os.environ['PATH']}"
    said = subprocess.run(
        ["bash", "-c", script],
        env={**os.environ, "PATH": path, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    assert said.stdout == "~min_coverage_limit\n"
    assert said.stderr == ""
