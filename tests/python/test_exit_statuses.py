"""The exit statuses of docs/reference/command-line.md, for every command and for wrong input.

A command that is in the list of commands and not in the tables here makes a test fail.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result
from mission_samples import comparison, static_info

from pytpc.cli.main import main, summaries
from terminals import pytpc

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples/recorded_mission"
STATIC = EXAMPLE / "static.json"

# What a command is given; INPUT stands for the file or folder that is wrong.
INPUT = "INPUT"
RECORDINGS: Mapping[str, Sequence[str]] = {
    "compare": (str(EXAMPLE), INPUT, "--static", str(STATIC)),
    "convert": (INPUT, "-o", "out"),
    "diff": (str(EXAMPLE), INPUT, "--static", str(STATIC)),
    "fix": (INPUT, "--static", str(STATIC)),
    "fleet": ("add", "fleet", INPUT, "--static", str(STATIC)),
    "learn": (INPUT, "-o", "good"),
    "live": (INPUT, "--static", str(STATIC), "--no-browser"),
    "margins": (INPUT, "--static", str(STATIC)),
    "mark": (INPUT,),
    "marks": (INPUT,),
    "rank": (INPUT, "--static", str(STATIC)),
    "report": (INPUT, "--static", str(STATIC), "-o", "out.html"),
    "stats": (INPUT, "--static", str(STATIC)),
    "stream": (INPUT, "--static", str(STATIC), "--rerun"),
    "suggest": (INPUT, "--static", str(STATIC)),
    "watch": (INPUT, "--static", str(STATIC), "--once"),
}
STATICS: Mapping[str, Sequence[str]] = {
    "blind-spots": (INPUT,),
    "compare": (str(STATIC), INPUT),
    "coverage": (INPUT,),
    "fleet": ("add", "fleet", str(EXAMPLE), "--static", INPUT),
    "diff": (str(EXAMPLE), str(EXAMPLE), "--static", INPUT),
    "explain": (INPUT, "~limit"),
    "export": (INPUT, "--html", "out.html"),
    "fix": (str(EXAMPLE), "--static", INPUT),
    "keep": ("--folder", ".", "--static", INPUT),
    "list": (INPUT,),
    "live": (str(EXAMPLE), "--static", INPUT, "--no-browser"),
    "margins": (str(EXAMPLE), "--static", INPUT),
    "rank": (str(EXAMPLE), "--static", INPUT),
    "report": (str(EXAMPLE), "--static", INPUT, "-o", "out.html"),
    "show": (INPUT, "~limit"),
    "stats": (str(EXAMPLE), "--static", INPUT),
    "stream": (str(EXAMPLE), "--static", INPUT, "--rerun"),
    "suggest": (str(EXAMPLE), "--static", INPUT),
    "watch": (str(EXAMPLE), "--static", INPUT, "--once"),
}
FOLDERS: Mapping[str, Sequence[str]] = {
    "analyse": (INPUT, "-o", "out.json"),
    "apply": (INPUT, "~limit", "1"),
    "build": (INPUT,),
    "collect": (INPUT,),
    "doctor": (INPUT,),
    "env": (INPUT,),
    "fleet": ("list", INPUT),
    "origin": (INPUT,),
    "patch": (INPUT,),
    "processes": (INPUT,),
    "lint": (INPUT,),
    "record": (INPUT, "robot.launch", "-o", "out"),
    "run": (INPUT,),
    "study": ("suggested", INPUT),
    "survey": (INPUT,),
}
GRAPHS: Mapping[str, Sequence[str]] = {
    "keep": ("--on-marks", "-o", "out"),
    "record": ("-o", "out"),
    "relay": (),
    "sink": (),
    "watch": ("--static", str(STATIC), "--once", "--seconds", "0.1"),
}
# These read nothing that a user could give them wrongly but their own words.
WORDS = {"completion", "toolchain"}
ERROR = re.compile(r"pytpc: error: .+\n")


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A folder to write to, and no master."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:9")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


def given(words: Sequence[str], path: Path) -> list[str]:
    return [str(path) if word == INPUT else word for word in words]


def call(*words: str) -> Result:
    return CliRunner().invoke(main, words)


def last_error(result: Result) -> str:
    """The one line of the error; warnings may stand before it, a traceback may not."""
    assert isinstance(result.exception, SystemExit), result.exception
    assert result.exit_code == 1, result.output
    *before, line = result.stderr.splitlines(keepends=True)
    assert ERROR.fullmatch(line), result.stderr
    assert "Traceback" not in "".join(before)
    return line


def test_every_command_is_looked_at():
    assert set(summaries()) == {*RECORDINGS, *STATICS, *FOLDERS, *GRAPHS, *WORDS}


@pytest.mark.parametrize("name", summaries())
def test_2_for_what_was_typed_wrongly_and_0_for_help(name: str):
    # A remapping or a negative value of theirs may look like an option.
    if name not in {"apply", "relay"}:
        result = call(name, "--no-such-option")
        assert result.exit_code == 2
        assert "no-such-option" in result.stderr
    helped = call(name, "--help")
    assert (helped.exit_code, helped.stderr) == (0, "")
    assert f"Usage: main {name}" in helped.stdout


@pytest.mark.parametrize("name", summaries())
def test_130_when_interrupted(name: str, monkeypatch: pytest.MonkeyPatch):
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    command = main.get_command(click.Context(main), name)
    monkeypatch.setattr(command, "invoke", interrupted)
    tables = (RECORDINGS, STATICS, FOLDERS, GRAPHS)
    words = next((table[name] for table in tables if name in table), ())
    result = call(name, *(words or (("bash",) if name == "completion" else ())))
    assert (result.exit_code, result.stderr.strip()) == (130, "pytpc: interrupted")


EVERY = [(name, words) for table in (RECORDINGS, STATICS, FOLDERS) for name, words in table.items()]


@pytest.mark.parametrize(("name", "words"), EVERY, ids=[name for name, _ in EVERY])
def test_1_for_a_file_that_is_not_there(name: str, words: Sequence[str]):
    line = last_error(call(name, *given(words, Path("gone"))))
    assert "gone" in line
    assert not Path("out").exists()
    assert not Path("out.html").exists()


@pytest.mark.parametrize("name", GRAPHS)
def test_1_without_a_master(name: str):
    assert "http://127.0.0.1:9" in last_error(call(name, *GRAPHS[name]))


# A bag begins with its version in 13 bytes; then a record that 2,000 bytes cut off.
@pytest.mark.parametrize("name", RECORDINGS)
@pytest.mark.parametrize(
    "content", [b"#ROSBAG V2.0\n\x45\x00\x00\x00" + b"\0" * 40, b"", b"\x00\xff"]
)
def test_1_for_a_bag_that_is_cut_off_or_none(name: str, content: bytes, tmp_path: Path):
    bag = tmp_path / "cut.bag"
    bag.write_bytes(content)
    assert "cut.bag" in last_error(call(name, *given(RECORDINGS[name], bag)))


@pytest.mark.parametrize("name", RECORDINGS)
def test_1_for_a_folder_whose_table_is_broken(name: str, tmp_path: Path):
    folder = shutil.copytree(EXAMPLE, tmp_path / "mission")
    table = folder / "events.parquet"
    table.write_bytes(table.read_bytes()[:1000])
    assert "events.parquet" in last_error(call(name, *given(RECORDINGS[name], folder)))


@pytest.mark.parametrize("name", STATICS)
@pytest.mark.parametrize(
    ("content", "place"),
    [
        ('{"units": [\n', "bad.json:2:"),
        ("[]", "bad.json:"),
        ('{"schema": 1, "units": [{}]}', "/units/0"),
    ],
)
def test_1_for_broken_static_information(name: str, content: str, place: str, tmp_path: Path):
    path = tmp_path / "bad.json"
    path.write_text(content)
    line = last_error(call(name, *given(STATICS[name], path)))
    assert "bad.json" in line
    assert place in line


# Every report is of a key that this static information does not have.
@pytest.mark.parametrize("name", ["fix", "rank", "report", "suggest", "stats", "watch"])
def test_static_information_of_another_build(name: str, tmp_path: Path):
    path = tmp_path / "other.json"
    static_info(comparison(0, "~limit")).save(path)
    line = last_error(call(name, *given(STATICS[name], path)))
    assert "other build" in line


# One of the link units is missing: its reports are left out with a warning, the rest is ranked.
@pytest.mark.parametrize("name", ["rank", "suggest", "watch"])
def test_0_with_a_warning_where_a_part_does_not_fit(name: str, tmp_path: Path):
    document = json.loads(STATIC.read_text())
    units = [unit for unit in document["units"] if unit["link_unit"] != "radio_link"]
    document["units"] = [{**unit, "source_root": "/nowhere"} for unit in units]
    path = tmp_path / "part.json"
    path.write_text(json.dumps(document))
    result = call(name, *given(STATICS[name], path))
    assert result.exit_code == 0
    assert "not in the static information" in result.stderr + result.stdout
    assert "~min_coverage_limit" in result.stdout


def wait_until_it_waits(process: subprocess.Popen[str]) -> None:
    """Return once the process has slept for a second without using its processor.

    Before that it imports modules. If the signal comes in an ``exec`` of an import, Python ends the
    process by the signal, whoever catches KeyboardInterrupt.
    """
    quiet, used = 0, ""
    while quiet < 10:
        time.sleep(0.1)
        state, *fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(") ")[2].split()
        now = " ".join(fields[10:12])
        quiet = quiet + 1 if state == "S" and now == used else 0
        used = now


def test_interrupting_the_real_command():
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = pytpc("watch", "--static", str(STATIC), "--once", "--seconds", "60")
    with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True) as process:
        try:
            wait_until_it_waits(process)
            process.send_signal(signal.SIGINT)
            said = process.communicate(timeout=20)[1]
        finally:
            process.kill()
    assert (process.returncode, said.strip()) == (130, "pytpc: interrupted")
