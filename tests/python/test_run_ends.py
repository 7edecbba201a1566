"""What `run` and `record` say at the end of a mission, and where nothing more comes of it."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import NoReturn

import click
import pytest
from rich.console import Console

from pytpc.base.errors import InputError, RunError
from pytpc.cli import run_mission
from pytpc.cli.console import waiting
from pytpc.cli.launch_words import LaunchWords
from pytpc.cli.mission_commands import kept_if_it_fails, show_run
from pytpc.cli.mission_options import MissionArguments
from pytpc.ros.mission_run import DiedNode, MissionRun


def test_what_is_left_of_a_failed_mission_is_named(tmp_path, capsys):
    def fail(*, has_begun: bool = True) -> str:
        with pytest.raises(RunError), kept_if_it_fails(tmp_path, lambda: has_begun):
            raise RunError("the recorder died")
        return capsys.readouterr().err

    # Of an earlier mission, of which the folder has nothing any more.
    assert fail() == ""
    (tmp_path / "mission.bag.active").touch()
    active = f"{tmp_path}/mission.bag.active"
    assert f"is in {active}; recover it with rosbag reindex" in fail()
    (tmp_path / "run.json").touch()
    assert f"is in {tmp_path}; for the verdict: pytpc rank {tmp_path}" in fail()
    (tmp_path / "run.json").write_text('{"reports": 0, "reports_in_files": 0}')
    assert "pytpc rank" in fail()
    counts = ("reports", "reports_in_files", "summaries_in_files", "is_reporting")
    (tmp_path / "run.json").write_text(json.dumps(dict.fromkeys(counts, 0)))
    assert fail().endswith(f"is in {tmp_path}, without a report\n")
    # A mission that was refused, as another one goes on there, has recorded none of it.
    assert fail(has_begun=False) == ""


def flown(folder: Path, *died: DiedNode, **counts: int) -> MissionRun:
    bag, params = folder / "mission.bag", folder / "params.yaml"
    return MissionRun(bag, params, "ended", 1.0, 1.0, 0, {}, {}, {}, died=died, **counts)


def test_who_died_is_why_nothing_was_reported(tmp_path):
    died = DiedNode("camera-2", -11, (), Path("log"))
    with (
        click.Context(click.Command("run")),
        pytest.raises(InputError, match=r"-2 died .signal 11"),
    ):
        run_mission._read(flown(tmp_path, died), tmp_path, tmp_path)


# A comparison that never changes its result sends summaries alone.
def test_a_mission_with_summaries_alone_is_diagnosed(tmp_path, monkeypatch):
    asked: list[Path] = []

    def read(folder: Path) -> NoReturn:
        asked.append(folder)
        raise KeyboardInterrupt

    monkeypatch.setattr(run_mission, "recording_of", read)
    with click.Context(click.Command("run")):
        with pytest.raises(InputError, match="no reports arrived"):
            run_mission._read(flown(tmp_path), tmp_path, tmp_path)
        with pytest.raises(KeyboardInterrupt):
            run_mission._read(flown(tmp_path, summaries_in_files=5), tmp_path, tmp_path)
    assert asked == [tmp_path]


def test_ctrl_c_during_the_verdict_says_how_to_ask_for_it(tmp_path, monkeypatch, capsys):
    def interrupt(*_: object) -> NoReturn:
        raise KeyboardInterrupt

    monkeypatch.setattr(run_mission, "record_mission", lambda *_: flown(tmp_path))
    monkeypatch.setattr(run_mission, "_read", interrupt)
    words = LaunchWords(tmp_path, "", Path("x.launch"), {})
    given = MissionArguments(tmp_path / "my out", None, None, (), False, False)
    with pytest.raises(KeyboardInterrupt):
        run_mission.run_mission(words, given, None)
    assert f"for the verdict: pytpc rank '{tmp_path}/my out'" in capsys.readouterr().err


# A node with respawn="true" has no end, and the screen has.
def test_a_node_that_dies_again_and_again_does_not_fill_the_screen():
    notes = run_mission._Notes()
    notes.quiet("no reports yet", False)
    for status in range(1, 51):
        for name in ("camera-1", "arm-2"):
            notes.died(DiedNode(name, status, ("one", "no lens"), Path("roslaunch.log")))
    assert notes.shown == [
        f"the node {name} died (exit status {status}): no lens"
        for name, status in (("arm-2", 49), ("camera-1", 50), ("arm-2", 50))
    ]
    assert {name: node.status for name, node in notes.nodes.items()} == {
        "camera-1": 50, "arm-2": 50,
    }  # fmt: skip
    assert notes.reasons == ["no reports yet"]


# Of 250 deaths, the first is told with the last lines of output, the 10th and 100th are counted.
def test_a_node_that_dies_again_and_again_is_told_three_times(tmp_path, capsys):
    given = MissionArguments(None, None, None, (), False, False)
    words = LaunchWords(tmp_path, "", Path("a.launch"), {})
    tell = given.options(tmp_path, words).on_died
    assert tell is not None
    for _ in range(250):
        tell(DiedNode("camera-2", 1, ("no device",), Path("log")))
    assert capsys.readouterr().err.splitlines() == [
        "pytpc: warning: the node camera-2 died (exit status 1); the last lines of output are",
        "    no device",
        "  in log",
        "pytpc: warning: the node camera-2 died (exit status 1), 10 times so far",
        "pytpc: warning: the node camera-2 died (exit status 1), 100 times so far",
    ]


def test_why_there_are_no_parameters(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("PATH", str(tmp_path))
    show_run(flown(tmp_path), tmp_path, launched=False)
    assert "warning: no params.yaml: rosparam not found; install it" in capsys.readouterr().err
    (tmp_path / "rosparam").touch(mode=0o755)
    show_run(flown(tmp_path), tmp_path, launched=False)
    assert "warning: no params.yaml: the parameter server did not" in capsys.readouterr().err


# A terminal without UTF-8 got each part of a moving sign as its number.
@pytest.mark.parametrize("encoding", ["ascii", "latin-1"])
def test_a_simple_terminal_gets_simple_signs(encoding):
    shown = io.BytesIO()
    stream = io.TextIOWrapper(shown, encoding=encoding, errors="backslashreplace")
    with waiting(Console(file=stream, force_terminal=True), "[/x] working"):
        pass
    stream.flush()
    assert b"[/x] working" in shown.getvalue()
    assert b"\\u" not in shown.getvalue()
