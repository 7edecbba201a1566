"""``pytpc fix`` where something is wrong: one line, and the state and the files stay."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from fix_samples import PARAMS, alone, begun, file_of, fix, recorded, robot_environment, state
from mission_samples import comparison, static_info

from pytpc.cli.main import main


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    return robot_environment(tmp_path, monkeypatch)


def refused(*words, ask=fix) -> str:
    result = ask(*words, status=1)
    (line,) = [one for one in result.stderr.splitlines() if one.startswith("pytpc: error: ")]
    return line.removeprefix("pytpc: error: ")


@pytest.mark.usefixtures("robot")
@pytest.mark.parametrize("words", [(), ("--say", "same"), ("--undo",)])
def test_nothing_was_begun(words):
    assert refused(*words) == "fix.json: no fix was begun here; begin one with `pytpc fix MISSION`"


@pytest.mark.usefixtures("robot")
def test_a_state_file_of_another_version():
    Path("fix.json").write_text('{"schema": 2}')
    line = refused()
    assert "fix.json: written by another TPC (format 2; this one reads 1)" in line
    assert "begin anew with -o FILE" in line


@pytest.mark.usefixtures("robot")
@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("{", "fix.json:1: not JSON"),
        ("[]", "fix.json: not a file of `pytpc fix`"),
        ('{"schema": 1}', "fix.json: broken: state is missing"),
    ],
)
def test_a_broken_state_file(text, why):
    Path("fix.json").write_text(text)
    assert refused().startswith(why)


@pytest.mark.usefixtures("robot")
@pytest.mark.parametrize(
    ("field", "value", "why"),
    [("verdict", "good", "the verdict 'good'"), ("new", "much", "'much' is no number")],
)
def test_a_broken_try(field, value, why):
    begun("--yes")
    document = state()
    document["tries"][0][field] = value
    Path("fix.json").write_text(json.dumps(document))
    assert f"fix.json: broken: {why}" in refused()


def test_a_mission_without_marks(robot):
    line = refused("yesterday", "--static", "static.json")
    assert "no marks: add some with `pytpc mark" in line
    assert not (robot / "fix.json").exists()


def test_a_mission_of_another_robot(robot):
    static_info(comparison(77, "~limit")).save(robot / "static.json")
    assert "the static information knows none of its reports" in refused(ask=alone)
    assert not (robot / "fix.json").exists()


@pytest.mark.usefixtures("robot")
def test_the_state_is_about_another_mission():
    begun()
    line = refused("yesterday")
    assert line.startswith("fix.json: is about ")
    assert "give another -o FILE" in line


@pytest.mark.usefixtures("robot")
def test_no_try_is_open():
    begun()
    assert "no try is open" in refused("--say", "same")


def test_the_recording_of_the_try_is_not_the_first_mission(robot):
    begun("--yes")
    line = refused("--say", "same", "--mission", "today")
    assert f"has the same reports as {robot}/today" in line
    assert state()["tries"][0]["verdict"] is None


def test_the_recording_of_the_try_is_of_another_robot(robot):
    begun("--yes")
    recorded(robot, "again", at=2000)
    static_info(comparison(77, "~limit")).save(robot / "other.json")
    line = refused("--say", "same", "--mission", "again", "--static", "other.json")
    assert "knows none of its reports" in line
    assert state()["tries"][0]["verdict"] is None


def test_the_file_was_changed_before_the_try(robot):
    (robot / "src/robot/params.yaml").write_text(PARAMS.replace("9.0", "8.0"))
    line = refused("--yes", ask=begun)
    assert "differs from the file that was recorded" in line
    assert state()["tries"] == []
    assert file_of(robot) == PARAMS.replace("9.0", "8.0")


def test_the_file_was_changed_after_the_try(robot):
    begun("--yes")
    by_somebody = file_of(robot).replace("9.0", "8.0")
    (robot / "src/robot/params.yaml").write_text(by_somebody)
    assert "has changed since: change 1 is not undone" in refused("--say", "same")
    assert state()["tries"][0]["verdict"] is None
    assert file_of(robot) == by_somebody


def test_a_value_that_was_taken_back_by_apply_is_left_alone(robot):
    begun("--yes")
    assert main.main(["apply", "--undo"], standalone_mode=False) is None
    fix("--say", "same")
    assert file_of(robot) == PARAMS
    assert state()["tries"][0]["undone"]


@pytest.mark.usefixtures("robot")
def test_a_recording_of_a_try_that_is_gone_counts_no_longer():
    begun("--yes")
    recorded(Path.cwd(), "again", tilt=4.0, at=2000)
    fix("--say", "same", "--mission", "again")
    Path("again").rename("elsewhere")
    assert "this recording of a try is gone" in fix().stderr


@pytest.mark.usefixtures("robot")
@pytest.mark.parametrize(
    "words",
    [
        ("--mission", "again"),
        ("--undo", "--say", "same"),
        ("today", "--say", "same"),
        ("--timeout", "3"),
        ("--say", "good"),
        ("--tries", "0"),
    ],
)
def test_wrong_usage(words):
    fix(*words, status=2)
