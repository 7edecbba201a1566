"""Which missions the study has, their halves, and what is set in each."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import replace

import pytest
from study_flights import robot, treatment

from pytpc.base.errors import InputError
from pytpc.recording.parameter_change import Change
from pytpc.values.recording import read_parameters
from pytpc_evaluation.demo.demo_examples import EXAMPLES, Example
from pytpc_evaluation.study.changes import DECOYS, drawn_changes, harmless_changes, save_changes
from pytpc_evaluation.study.plan import (
    Flight,
    FlightSelection,
    Setting,
    check_treatments,
    flights_of,
    halves,
    overlay_text,
)

AMONG = {Change(f"~{name}", "/pump", 2.0, 5.0): frozenset[str]() for name in "abcdefghijk"}


def test_halves_are_dealt_by_the_sorted_hashes_of_the_names():
    # sha256sum of robot/type1_c 1ef9..., _d 2e2d..., _b 51a4..., _a 5abd...;
    # of robot/type2_z 038f..., _y 9305..., _x a385...
    names = ("type1_a", "type1_b", "type1_c", "type1_d", "type2_x", "type2_y", "type2_z", "clean")
    found = halves("robot", [treatment(name) for name in names])
    assert {name: found[name, 1] for name in names if name != "clean"} == {
        "type1_c": "tuning",
        "type1_d": "held-back",
        "type1_b": "tuning",
        "type1_a": "held-back",
        "type2_z": "tuning",
        "type2_y": "held-back",
        "type2_x": "tuning",
    }
    # Both seeds of a treatment are in one half; of the clean missions it goes by the seed.
    assert all(found[name, 1] == found[name, 2] for name in names if name != "clean")
    assert (found["clean", 1], found["clean", 2]) == ("tuning", "held-back")


def test_halves_depend_on_the_system_and_not_on_the_order_in_which_treatments_come():
    these = [treatment(f"type1_{letter}") for letter in "abcd"]
    assert halves("robot", these) == halves("robot", these[::-1])
    assert halves("robot", these) != halves("other", these)


def test_treatments_of_a_later_round_are_held_back_and_move_no_other():
    first = [treatment(f"type1_{letter}") for letter in "abcd"]
    later = [replace(treatment(f"type1_{letter}"), round=2) for letter in "wxyz"]
    found = halves("robot", [*later, *first])
    assert {found[one.name, seed] for one in later for seed in (1, 2)} == {"held-back"}
    assert {key: found[key] for key in halves("robot", first)} == halves("robot", first)


def test_decoys_and_their_order_are_drawn_by_hashes():
    # The first eight by sha256sum of robot/clean/1/pump~NAME, in the order of those of
    # robot/clean/1/order/pump~NAME.
    found = drawn_changes("robot", treatment("clean"), 1, AMONG)
    assert found == tuple(Change(f"~{name}", "/pump", 2.0, 5.0) for name in "daifhkge")


def test_the_changed_parameter_is_no_decoy_and_has_its_place_in_the_history():
    places = set()
    for seed in range(60):
        found = drawn_changes("robot", treatment("type1_b"), seed, AMONG)
        mine = [change for change in found if change.parameter == "~b"]
        assert mine == [Change("~b", "/pump", 2.0, 0.5)]
        assert len(found) == 9
        places.add(found.index(mine[0]))
    # Neither the first nor the last is a giveaway.
    assert places == set(range(9))


def test_no_decoy_is_called_like_the_changed_parameter():
    among = {Change("~b", "/arm", 1.0, 2.0): (), Change("~c", "/arm", 1.0, 2.0): ()}
    found = drawn_changes("robot", treatment("type1_b"), 1, among)
    assert sorted((one.node, one.parameter) for one in found) == [("/arm", "~c"), ("/pump", "~b")]


def test_what_hides_a_treatments_error_is_not_drawn_with_it():
    hidden = {one: {"type1_b"} if one.parameter in ("~a", "~c") else set() for one in AMONG}
    for seed in range(20):
        found = drawn_changes("robot", treatment("type1_b"), seed, hidden)
        assert not {"~a", "~c"} & {one.parameter for one in found}
        assert len(found) == 9
        # Others are drawn as they were.
        other = treatment("type2_b")
        assert drawn_changes("robot", other, seed, hidden) == drawn_changes(
            "robot", other, seed, AMONG
        )


def listed(example: Example, *entries: object) -> dict[Change, frozenset[str]]:
    (example.folder / "study.json").write_text(json.dumps({"decoys": entries}))
    return harmless_changes(example)


def test_harmless_changes_are_those_that_the_robot_lists(tmp_path, monkeypatch):
    example = robot(tmp_path, monkeypatch)
    assert list(harmless_changes(example)) == [
        Change("~a", "/pump", 1.0, 1.5),
        Change("~c", "/pump", 0.004, 0.008),
    ]
    (example.folder / "study.json").unlink()
    assert harmless_changes(example) == {}
    assert listed(
        example,
        {"parameter": "~c", "node": "/pump", "new": 1},
        {"parameter": "~count", "node": "/pump", "new": 9},
        {"parameter": "~deep/er", "node": "/mission", "new": 0.5, "not_with": ["clean"]},
    ) == {
        Change("~c", "/pump", 0.004, 1.0): frozenset(),
        Change("~count", "/pump", 3.0, 9.0): frozenset(),
        Change("~deep/er", "/mission", 4.0, 0.5): {"clean"},
    }


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"parameter": "~typo"}, "/pump/typo None -> 5.0 changes no number of this robot"),
        ({"parameter": "~on"}, "/pump/on True -> 5.0 changes no number of this robot"),
        ({"parameter": "b"}, "parameter is ~name, and node a text"),
        ({"node": 3}, "parameter is ~name, and node a text"),
        ({"new": "7"}, "/pump/b 2.0 -> '7' changes no number of this robot"),
        ({"new": 2}, "/pump/b 2.0 -> 2 changes no number of this robot"),
        ({"old": 2}, "an object with parameter, node, new is expected"),
        ({"parameter": "~wind", "node": "/world"}, "/world is the world"),
        ({"parameter": "~a"}, "~a is there twice"),
        ({"not_with": "clean"}, "not_with is no list of treatments"),
        ({"not_with": ["type9"]}, "there is no treatment type9"),
    ],
)
def test_a_wrong_decoy_is_an_error(tmp_path, monkeypatch, change, what):
    example = robot(tmp_path, monkeypatch)
    first = {"parameter": "~a", "node": "/pump", "new": 5.0}
    with pytest.raises(InputError, match=f"decoys, entry 2: {re.escape(what)}") as caught:
        listed(example, first, {"parameter": "~b", "node": "/pump", "new": 5.0, **change})
    assert str(caught.value).startswith(f"{example.folder}/study.json:")


@pytest.mark.parametrize(
    ("text", "what"),
    [('{"decoys": "~a"}', "decoys is not a list"), ("[]", "decoys is not a list"), ("{", "JSON")],
)
def test_a_list_of_decoys_that_is_none_is_an_error(tmp_path, monkeypatch, text, what):
    example = robot(tmp_path, monkeypatch)
    (example.folder / "study.json").write_text(text)
    with pytest.raises(InputError, match=what) as caught:
        harmless_changes(example)
    assert str(caught.value).startswith(f"{example.folder}/study.json:")


def test_changes_are_written_newest_last(tmp_path):
    save_changes((Change("~a", "/pump", 1.0, 1.03), Change("~b", "/pump", 2.0, 0.5)), tmp_path)
    assert json.loads((tmp_path / "changes.json").read_text()) == [
        {"parameter": "~a", "node": "/pump", "old": 1.0, "new": 1.03},
        {"parameter": "~b", "node": "/pump", "old": 2.0, "new": 0.5},
    ]


def flight(example, name: str = "type1_b", **changes: object) -> Flight:
    own = {"suggested": (), "changes": (), **changes}
    return Flight("mission", example, example.treatment(name), 1, "tuning", **own)


def test_settings_are_the_decoys_and_over_them_what_is_suggested(tmp_path, monkeypatch):
    example = robot(tmp_path, monkeypatch, "type1_b")
    changes = (Change("~a", "/pump", 1.0, 1.03), Change("~b", "/pump", 2.0, 0.5))
    # The treatment sets its own.
    assert flight(example, changes=changes).settings() == {"/pump/a": 1.03}
    tried = flight(example, changes=changes, suggested=(Setting("~b", "", 1.9),))
    assert tried.settings() == {"/pump/a": 1.03, "/pump/b": 1.9}
    again = flight(example, changes=changes, suggested=(Setting("~a", "/pump", 1.5),))
    assert again.settings() == {"/pump/a": 1.5}


def test_a_suggested_value_has_the_type_of_the_robots_own(tmp_path, monkeypatch):
    example = robot(tmp_path, monkeypatch, "type1_b")

    def set_to(name: str, value: float) -> object:
        (found,) = flight(example, suggested=(Setting(name, "", value),)).settings().values()
        return found, type(found)

    assert set_to("~count", 4.0) == (4, int)
    assert set_to("~count", 4.5) == (4.5, float)
    assert set_to("~on", 0.0) == (False, bool)
    assert set_to("~b", 3.0) == (3.0, float)
    assert set_to("/mission/pace", 1.0) == (1.0, float)


@pytest.mark.parametrize("node", ["", "/mission"])
def test_a_suggestion_for_no_parameter_is_an_error(tmp_path, monkeypatch, node):
    example = robot(tmp_path, monkeypatch, "type1_b")
    with pytest.raises(InputError, match="~gone: no parameter of this robot"):
        flight(example, suggested=(Setting("~gone", node, 1.0),)).settings()


def test_overlay_is_read_back_as_it_was_set(tmp_path):
    settings = {"/b/x": 1e-7, "/a/d/z": True, "/a/c": 3, "/a/d/y": 0.5, "/b/w": 1e22}
    path = tmp_path / "overlay.yaml"
    path.write_text(overlay_text(settings))
    assert read_parameters(path) == settings
    # And by ROS's own reader, for which 1e-07 without a point is a text.
    read = "import sys, yaml, json; print(json.dumps(yaml.safe_load(sys.stdin)))"
    ran = subprocess.run(
        ["/usr/bin/python3", "-c", read],
        input=path.read_text(),
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(ran.stdout) == {
        "a": {"c": 3, "d": {"y": 0.5, "z": True}},
        "b": {"w": 1e22, "x": 1e-7},
    }


def test_flights_are_the_reference_and_each_treatment_with_both_seeds(tmp_path, monkeypatch):
    example = robot(tmp_path, monkeypatch, "type1_b", "fault_x")
    found = flights_of(example)
    assert [one.label for one in found] == [
        "reference/robot",
        "good/robot/seed-11",
        "good/robot/seed-12",
        "good/robot/seed-13",
        "good/robot/seed-14",
        "missions/robot/clean/seed-1",
        "missions/robot/clean/seed-2",
        "missions/robot/fault_x/seed-1",
        "missions/robot/fault_x/seed-2",
        "missions/robot/type1_b/seed-1",
        "missions/robot/type1_b/seed-2",
    ]
    reference, missions = found[0], found[5:]
    assert (reference.seed, reference.half, reference.settings()) == (0, None, {})
    # Nobody looks on twice with the same eyes.
    assert len({one.people for one in found}) == len(found)
    assert all(one.half for one in missions)


def test_a_part_of_it_may_be_chosen(tmp_path, monkeypatch):
    example = robot(tmp_path, monkeypatch, "type1_b")
    chosen = FlightSelection(treatments=["type1_b"], seeds=[2])
    assert [one.name for one in flights_of(example, chosen)] == [
        "robot",
        "robot/type1_b/seed-2",
    ]
    with pytest.raises(InputError, match="there is no treatment type9; there are clean, type1_b"):
        check_treatments(FlightSelection(treatments=["type9"]), [example])
    with pytest.raises(InputError, match="there is no system ship, but robot"):
        FlightSelection(systems=["ship"]).examples([example])


def test_the_quick_part_is_one_robot_with_an_error_of_each_type():
    quick = FlightSelection(quick=True)
    (example,) = quick.examples()
    found = flights_of(example, quick)
    assert [one.treatment.type for one in found] == ["clean", "clean", "type1", "type2"]
    assert [one.seed for one in found] == [0, 1, 1, 1]


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda one: one.name)
def test_the_examples_can_be_planned(example):
    assert example.observer.is_file()
    assert f"{example.simulator}/" in " ".join(read_parameters(example.parameters))
    words = {"rate", "seed", "treatment", "overlay2", "fault", "observer"}
    launch = example.launch.read_text()
    assert [word for word in sorted(words) if f'<arg name="{word}"' not in launch] == []
    assert {one.type for one in example.all_treatments()} == {"clean", "type1", "type2", "fault"}
    assert len(harmless_changes(example)) >= 2 * DECOYS
