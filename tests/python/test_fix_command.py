"""``pytpc fix``: it changes one value after the other, until the robot is right or none is left."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest
from click.testing import CliRunner
from fix_samples import (
    PARAMS,
    SPEED,
    STATIC,
    TILT,
    alone,
    begun,
    file_of,
    fix,
    recorded,
    robot_environment,
    state,
)
from mission_samples import comparison, link_unit, static_info

from pytpc.cli.fix_session import alone_with
from pytpc.cli.main import main
from pytpc.static.link_unit import ParameterRead
from pytpc.static.static_info import StaticInfo
from terminals import pytpc

TILTED = PARAMS.replace("max_tilt: 2.0", "max_tilt: 4.0")
FASTER = PARAMS.replace("max_speed: 1.0 ", "max_speed: 4.0 ")


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Today the speed was limited to 1 and the tilt to 2, in a good run both to 4.

    Both were exceeded before each mark, so each has about one half; the tilt is a little likelier.
    """
    return robot_environment(tmp_path, monkeypatch)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Somebody sits at a terminal."""
    monkeypatch.setattr("pytpc.cli.fix_session.is_terminal", lambda: True)
    monkeypatch.setattr("pytpc.cli.value_commands.is_terminal", lambda: True)


def document(*words):
    return json.loads(fix(*words, "--json").stdout)


def test_it_shows_the_suspect_the_value_and_the_diff_and_changes_nothing_unasked(robot):
    shown = begun().stdout
    assert "try: /node/max_tilt 2 -> 4" in shown
    assert re.search(r"\d\d % that it is ~max_tilt", shown)
    assert "raise ~max_tilt from 2 to 4 (the value of the good run)" in shown
    assert "-  max_tilt: 2.0\n+  max_tilt: 4.0\n" in shown
    assert "nothing was changed; to try it: pytpc fix --yes" in shown
    assert file_of(robot) == PARAMS


def test_its_suspects_are_those_of_rank(robot):
    begun()
    words = ("rank", "today", "--static", "static.json", "--reference", "yesterday", "--json")
    ranked = json.loads(CliRunner().invoke(main, words).stdout)[0]["diagnosis"]
    of_rank = {one["parameter"]: one["probability"] for one in ranked["suspects"]}
    found = document()
    told = {one["parameter"]: one["probability"] for one in found["suspects"]}
    assert told == pytest.approx(of_rank)
    assert found["none"] == pytest.approx(ranked["none"])


@pytest.mark.usefixtures("asked")
@pytest.mark.parametrize(
    ("answers", "text"),
    [("y", TILTED), ("q", PARAMS), ("", PARAMS), ("ny", FASTER), ("nn", PARAMS)],
)
def test_a_person_is_asked_suspect_by_suspect(robot, answers, text):
    shown = begun(answer="".join(f"{answer}\n" for answer in answers) or "\n").stdout
    assert file_of(robot) == text
    assert len(state()["tries"]) == answers.endswith("y")
    assert ("try: /node/max_speed 1 -> 4" in shown) == answers.startswith("n")


def test_with_yes_it_changes_the_file_and_says_how_to_go_on(robot):
    shown = begun("--yes").stdout
    assert file_of(robot) == TILTED
    assert "next: run the mission again" in shown
    assert "pytpc fix --say better|same|worse|other|fixed" in shown


def test_the_command_that_flies_again_is_that_of_the_recording(robot):
    run = {"launch": "robot.launch", "args": {"rate": 8}, "static": {"path": "/ws/.tpc/s.json"}}
    (robot / "today/run.json").write_text(json.dumps(run))
    assert "pytpc run /ws robot.launch rate:=8" in begun("--yes").stdout


def test_what_did_not_help_goes_back_and_the_next_suspect_follows(robot):
    begun("--yes")
    fix("--say", "same", "--yes")
    assert file_of(robot) == FASTER
    first, second = state()["tries"]
    assert (first["parameter"], first["verdict"], first["undone"]) == ("~max_tilt", "same", True)
    assert (second["parameter"], second["old"], second["new"]) == ("~max_speed", 1.0, 4.0)


# A good run's value was tried: 0.02 of what it was.
def test_a_good_value_that_did_not_help_excludes_the_parameter(robot):
    before = {one["parameter"]: one["probability"] for one in json.loads(
        begun("--yes", "--json").stdout)["suspects"]}  # fmt: skip
    found = document("--say", "same")
    after = {one["parameter"]: one["probability"] for one in found["suspects"]}
    whole = 1 - 0.98 * before["~max_tilt"]
    assert after["~max_tilt"] == pytest.approx(0.02 * before["~max_tilt"] / whole)
    assert after["~max_speed"] == pytest.approx(before["~max_speed"] / whole)
    assert found["none"] + sum(after.values()) == pytest.approx(1)
    assert "excluded: this value is known to be good" in fix().stdout


def test_fixed_ends_it_with_what_was_changed_and_how_to_take_it_back(robot):
    begun("--yes")
    shown = fix("--say", "fixed").stdout
    assert "today: fixed" in shown
    assert f"changed: {robot}/src/robot/params.yaml: /node/max_tilt 2 -> 4" in shown
    assert "to take back all: pytpc fix --undo" in shown
    assert (state()["state"], file_of(robot)) == ("fixed", TILTED)


def test_what_is_fixed_is_not_changed_again(robot):
    begun("--yes")
    fix("--say", "fixed")
    assert document("--yes")["proposal"] is None
    assert len(state()["tries"]) == 1


def test_undo_takes_back_all_changes_byte_for_byte(robot):
    alone("--yes")
    recorded(robot, "again", speed=1.0, tilt=3.11, at=2000)
    fix("--say", "better", "--mission", "again", "--yes")
    assert len(state()["tries"]) == 2
    fix("--undo")
    assert file_of(robot) == PARAMS
    assert [one["undone"] for one in state()["tries"]] == [True, True]
    listed = CliRunner().invoke(main, ["apply", "--list", "--json"]).stdout
    assert json.loads(listed) == []


def test_undo_works_when_the_missions_are_gone(robot):
    begun("--yes")
    (robot / "today").rename(robot / "elsewhere")
    fix("--undo")
    assert file_of(robot) == PARAMS


# The log alone: four peaks of 2.6 above 2; (2.6 - 2) * 3 ** (1 / 4) beyond, and a little more.
def test_what_helped_stays_and_the_next_value_is_further(robot):
    alone("--yes")
    first = state()["tries"][0]["new"]
    assert first == pytest.approx(2 + 0.6 * 3**0.25 + 0.2, abs=0.15)
    fix("--say", "better", "--yes")
    second = state()["tries"][1]
    assert (second["parameter"], second["old"]) == ("~max_tilt", first)
    assert second["new"] > first
    assert f"max_tilt: {second['new']}" in file_of(robot)


# The log offers nothing beyond the good run's 4: 4 * (4 / 2).
def test_after_a_good_value_that_helped_it_goes_as_far_again(robot):
    begun("--yes")
    fix("--say", "better", "--yes")
    second = state()["tries"][1]
    assert (second["parameter"], second["old"], second["new"]) == ("~max_tilt", 4.0, 8.0)
    assert "max_tilt: 8.0" in file_of(robot)


def test_worse_goes_back_and_that_direction_is_left(robot):
    begun("--yes")
    fix("--say", "worse")
    assert file_of(robot) == PARAMS
    assert document()["proposal"]["parameter"] == "~max_speed"


# Only a default is known in the other direction; 0.5 of one half is left of the parameter.
def test_after_worse_a_known_value_in_the_other_direction_is_tried(robot):
    static = static_info(
        comparison(SPEED, "~max_speed"), comparison(TILT, "~max_tilt", default=1.5)
    )
    static.save(robot / "static.json")
    recorded(robot, "yesterday", tilt=4.0, marks=(), at=1000)
    begun("--yes")
    proposal = document("--say", "worse")["proposal"]
    assert (proposal["parameter"], proposal["new"]) == ("~max_tilt", 1.5)
    assert proposal["basis"] == "default"


# The geometric mean of 2 and 4, with three digits.
def test_after_another_error_the_next_value_is_between(robot):
    begun("--yes")
    fix("--say", "other", "--yes")
    second = state()["tries"][1]
    assert (second["parameter"], second["old"], second["new"]) == ("~max_tilt", 2.0, 2.83)
    assert second["basis"] == "between"
    assert "max_tilt: 2.83" in file_of(robot)


def test_the_marks_of_the_new_mission_count(robot):
    begun("--yes")
    # The tilt has the good value now, and the error is still there.
    recorded(robot, "again", tilt=4.0, at=2000)
    by_word = document("--say", "same", "--mission", "again")
    suspects = {one["parameter"]: one["probability"] for one in by_word["suspects"]}
    assert suspects["~max_speed"] > 0.7
    assert state()["tries"][0]["mission"] == str(robot / "again")


def test_it_ends_when_the_tries_are_used_up_and_goes_on_with_more(robot):
    begun("--yes", "--tries", 1)
    shown = fix("--say", "same").stdout
    assert "today: not fixed: 1 try is used up" in shown
    assert "none of the parameters" in shown
    assert state()["state"] == "exhausted"
    assert document("--tries", 2)["proposal"]["parameter"] == "~max_speed"


# Of the log alone: 0.70, and 0.79 after the first try.
def test_it_ends_when_it_is_likely_none_of_them(robot):
    alone("--yes")
    fix("--say", "same", "--yes")
    shown = fix("--say", "same").stdout
    assert "not fixed: it is now likely that it is none of the parameters" in shown
    assert "to go on all the same: pytpc fix --go-on" in shown
    assert (state()["state"], file_of(robot)) == ("exhausted", PARAMS)


def test_whoever_wants_to_goes_on_though_it_is_likely_none_of_them(robot):
    alone("--yes")
    fix("--say", "same", "--yes")
    fix("--say", "same")
    assert document()["proposal"] is None
    assert document("--go-on")["proposal"]["parameter"] == "~max_tilt"
    # It is written down.
    fix("--yes")
    assert [one["parameter"] for one in state()["tries"]] == [
        "~max_tilt",
        "~max_speed",
        "~max_tilt",
    ]


def test_a_state_file_is_one_call_s_at_a_time(robot):
    begun("--yes")
    with alone_with(robot / "fix.json"):
        result = fix("--say", "same", status=1)
        assert "another `pytpc fix` works with fix.json" in result.stderr
        # Another file is another conversation.
        fix("-o", "other.json", status=1)
        assert "other.json" in fix("-o", "other.json", status=1).stderr
    assert state()["tries"][0]["verdict"] is None
    fix("--say", "same")
    assert not list(robot.glob(".*.lock"))


def test_a_parameter_whose_file_is_not_known_is_set_by_hand(robot):
    (robot / "today/origins.json").unlink()
    shown = begun("--yes").stdout
    assert "the file that set it is not known" in shown
    assert "for example: rosparam set /node/max_tilt 4" in shown
    assert file_of(robot) == PARAMS
    assert state()["tries"][0]["path"] is None
    assert "set it back yourself: /node/max_tilt 4 -> 2" in fix("--say", "same").stdout


# The value of the file is a whole number, and 2.83 is none.
def test_what_apply_refuses_is_set_by_hand(robot):
    (robot / "src/robot/params.yaml").write_text(PARAMS.replace("tilt: 2.0", "tilt: 2"))
    recorded(robot, "today")
    begun("--yes")
    assert "max_tilt: 4\n" in file_of(robot)
    shown = fix("--say", "other", "--yes").stdout
    assert "set /node/max_tilt to 2.83 yourself" in shown
    assert "max_tilt: 2\n" in file_of(robot)


def test_at_the_end_it_names_what_differs_and_could_not_be_tried(robot):
    for mission, gain in (("today", 1), ("yesterday", 2)):
        values = json.loads((robot / mission / "params.yaml").read_text())
        values["node"]["gain"] = gain
        (robot / mission / "params.yaml").write_text(json.dumps(values))
    read = ParameterRead("~gain", "param", "double", None, "src/node.cpp", 30, 1, "")
    StaticInfo.of([link_unit(STATIC.comparisons.values(), [read])]).save(robot / "static.json")
    begun("--yes", "--tries", 1)
    shown = fix("--say", "same").stdout
    assert "not tried, as no comparison reports it: ~gain 2 -> 1" in shown


# Of two recordings with the error, the second alone would blame the tilt: its speed is good.
def test_several_missions_with_the_error_count_alike(robot):
    begun("--yes")
    recorded(robot, "again", speed=4.0, at=2000)
    found = document("--say", "worse", "--mission", "again")
    suspects = {one["parameter"]: one["probability"] for one in found["suspects"]}
    assert suspects["~max_tilt"] > suspects["~max_speed"]


def test_on_ros_2_a_parameter_is_set_by_its_node(robot):
    (robot / "today/origins.json").unlink()
    (robot / "today/mission.mcap").touch()
    shown = alone("--yes").stdout
    assert "ros2 param set /node max_tilt" in shown


def test_the_state_is_the_same_for_another_process(robot):
    begun("--yes")
    done = subprocess.run(
        pytpc("fix", "--say", "same", "--yes"), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert [one["parameter"] for one in state()["tries"]] == ["~max_tilt", "~max_speed"]
    assert file_of(robot) == FASTER


def test_the_state_may_have_another_name(robot):
    shown = begun("-o", "tilt.json", "--yes").stdout
    assert "pytpc fix -o tilt.json --say" in shown
    fix("-o", "tilt.json", "--undo")
    assert file_of(robot) == PARAMS
    assert not (robot / "fix.json").exists()


@pytest.fixture
def crawling(robot):
    """The speed was limited to 0.1; the peaks are at 1.6, so a factor of more than 16 is needed."""
    return recorded(robot, "today", speed=0.1, tilt=9.0, calm=0.05)


@pytest.mark.usefixtures("crawling")
def test_yes_does_not_allow_a_value_beyond_the_known_range(robot):
    result = alone("--yes")
    assert "passed over: raise ~max_speed from 0.1 to" in result.stderr
    assert "--beyond allows it" in result.stderr
    assert "max_speed: 1.0" in file_of(robot)
    assert all(one["parameter"] != "~max_speed" for one in state()["tries"])


@pytest.mark.usefixtures("crawling")
def test_beyond_allows_it(robot):
    # The file has 1.0, and the mission 0.1: the file was changed since.
    alone("--yes", "--beyond")
    (one,) = state()["tries"]
    assert (one["parameter"], one["old"]) == ("~max_speed", 0.1)
    assert one["new"] > 1.6
    assert f"max_speed: {one['new']}" in file_of(robot)


@pytest.mark.usefixtures("crawling", "asked")
@pytest.mark.parametrize("answer", ["", "n"])
def test_a_person_is_asked_first_and_the_default_is_no(robot, answer):
    result = alone(answer=f"{answer}\nq\n")
    assert "Try it all the same? [y/N]" in result.stderr
    assert (state()["tries"], file_of(robot)) == ([], PARAMS)


@pytest.mark.usefixtures("crawling", "asked")
def test_a_person_may_say_yes_to_it(robot):
    alone(answer="y\n")
    assert state()["tries"][0]["parameter"] == "~max_speed"
    assert file_of(robot) != PARAMS
