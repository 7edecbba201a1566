"""Control and bidirectional characters of a robot never reach a terminal or a JSON reader raw."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from pytpc.base.errors import TpcError
from pytpc.base.wording import plain_json
from pytpc.cli.main import main

# Escape, DEL, C1, reversal of direction, isolate, line separator, half a surrogate pair.
HOSTILE = "\x1b[2J\x7f\x9b2J\u202e\u2066\u2028\ud800"


def test_a_document_in_printable_ascii() -> None:
    text = plain_json({HOSTILE: [HOSTILE, "Größe"]}, indent=None)
    assert text.isascii()
    assert text.isprintable()
    assert json.loads(text) == {HOSTILE: [HOSTILE, "Größe"]}


def test_only_one_function_prints_json() -> None:
    """A command that calls ``json.dumps`` by itself would print what is escaped nowhere."""
    folders = ("pytpc/cli", "evaluation/pytpc_evaluation/commands")
    root = Path(__file__).parents[2]
    files = [path for folder in folders for path in (root / folder).glob("*.py")]
    assert len(files) > 20
    assert [path.name for path in files if "json.dumps" in path.read_text()] == []


def test_marks_with_such_notes(tmp_path: Path) -> None:
    folder = tmp_path / "m"
    path = folder / "marks.csv"
    folder.mkdir()
    note = "\x1b[2J\x7f\x9b2J\u202e\u2066\u2028"
    path.write_text(f"time_ns,type,observer,note\n1000000000,I,,{note}\n", encoding="utf-8")
    done = CliRunner().invoke(main, ["marks", str(path), "--json"])
    assert done.exit_code == 0, done.output
    assert all(line.isprintable() and line.isascii() for line in done.stdout.splitlines())
    assert json.loads(done.stdout)[0]["note"] == note


def test_halves_of_characters_in_json(tmp_path: Path) -> None:
    """A note in marks.json may be half a surrogate pair; no encoding can hold it."""
    folder = tmp_path / "m"
    example = Path(__file__).parents[2] / "examples/recorded_mission"
    folder.mkdir()
    (folder / "events.parquet").write_bytes((example / "events.parquet").read_bytes())
    document = json.loads((example / "marks.json").read_text())
    document["marks"][0]["note"] = HOSTILE
    (folder / "marks.json").write_text(json.dumps(document))
    for more in (["--json"], ["--csv"], []):
        done = CliRunner().invoke(main, ["marks", str(folder), *more])
        assert done.exit_code == 0, done.output
    static = str(example / "static.json")
    for command in ("rank", "suggest", "watch"):
        done = CliRunner().invoke(main, [command, str(folder), "--static", static, "--json"])
        assert done.exit_code == 0, (command, done.output)
        assert done.stdout.isascii()


def test_an_error_is_one_printable_line() -> None:
    assert str(TpcError(f"a{HOSTILE}\nb", f"/x{HOSTILE}\n", 3)).isprintable()


@pytest.mark.parametrize(
    ("variable", "words"),
    [
        ("ROS_MASTER_URI", ["sink"]),
        ("ROS_MASTER_URI", ["watch", "--once"]),
        ("ROS_MASTER_URI", ["apply", "--live", "/a/b", "1"]),
        ("ROS_MASTER_URI", ["record", "-o", "out", "--duration", "1"]),
        ("TPC_PREFIX", ["build", "."]),
        ("TPC_PREFIX", ["toolchain"]),
        ("TPC_PREFIX", ["doctor"]),
        ("XDG_STATE_HOME", ["apply", "p.yaml", "a", "1"]),
    ],
)
def test_variables_of_the_environment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, variable: str, words: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("p.yaml").write_text("a: 2\n")
    Path("taken").write_text("")
    hostile = "\x1b]0;x\x07\x9b2J\u202e"
    value = f"http://127.0.0.1:9/{hostile}" if "URI" in variable else f"{tmp_path}/taken/{hostile}"
    monkeypatch.setenv(variable, value)
    done = CliRunner().invoke(main, words)
    for line in done.output.splitlines():
        assert line.isprintable(), (words, line)
