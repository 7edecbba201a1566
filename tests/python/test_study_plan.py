"""Which missions the study has, their halves, and what is set in each."""

from __future__ import annotations

import json
import subprocess

import pytest
from mission_samples import comparison, static_info
from study_flights import robot, treatment

from pytpc.changes import Change
from pytpc.demo_examples import EXAMPLES
from pytpc.errors import InputError
from pytpc.study.changes import Candidate, candidates, drawn_changes, save_changes
from pytpc.study.plan import (
    Flight,
    Selection,
    Setting,
    check_treatments,
    flights_of,
    halves,
    overlay_text,
)
from pytpc.values.recording import read_parameters

AMONG = tuple(Candidate("/pump", name, 2.0) for name in "abcdefgh")


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


def test_decoys_and_their_order_are_drawn_by_hashes():
    # sha256sum of robot/clean/1/pump/NAME: b 0e92, e 13f7, f 1e9f, a 7479, h 94ab, c ae02, g bb47,
    # d da22: the first five. Of robot/clean/1/order/pump~NAME: a 3835, f 3e27, h 3f92, b 5eb4,
    # e b75f. Of robot/clean/1/sign/pump/NAME the last digit is odd, and so it is more, for e, h.
    found = drawn_changes("robot", treatment("clean"), 1, AMONG)
    assert found == tuple(
        Change(f"~{name}", "/pump", 2.0, new)
        for name, new in (("a", 1.94), ("f", 1.94), ("h", 2.06), ("b", 1.94), ("e", 2.06))
    )


def test_the_changed_parameter_is_no_decoy_and_has_its_place_in_the_history():
    places = set()
    for seed in range(40):
        found = drawn_changes("robot", treatment("type1_b"), seed, AMONG)
        mine = [change for change in found if change.parameter == "~b"]
        assert mine == [Change("~b", "/pump", 2.0, 0.5)]
        assert len(found) == 6
        places.add(found.index(mine[0]))
    # Neither the first nor the last is a giveaway.
    assert places == set(range(6))


def test_one_of_the_same_name_at_another_node_is_no_decoy_either():
    among = [Candidate("/arm", "b", 1.0), Candidate("/arm", "c", 1.0)]
    found = drawn_changes("robot", treatment("type1_b"), 1, among)
    assert sorted((one.node, one.parameter) for one in found) == [("/arm", "~c"), ("/pump", "~b")]


def test_candidates_are_fractions_that_are_compared_and_not_the_worlds(tmp_path, monkeypatch):
    example = robot(tmp_path, monkeypatch)
    names = ("~a", "~b", "~c", "~nothing", "~count", "~on", "~wind", "/mission/pace", "~deep/er")
    static = static_info(*(comparison(number, name) for number, name in enumerate(names)))
    # ~nothing is 0, ~count is an int, ~on a flag, ~wind the simulator's, ~unused not compared.
    assert [one.full for one in candidates(example, static)] == [
        "/mission/deep/er",
        "/mission/pace",
        "/pump/a",
        "/pump/b",
        "/pump/c",
    ]
    (example.folder / "study.json").write_text('{"never_decoys": ["~a", "deep/er", "/pump/b"]}')
    assert [one.full for one in candidates(example, static)] == ["/mission/pace", "/pump/c"]


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ('{"never_decoys": ["~typo"]}', "~typo is no parameter of this robot"),
        ('{"never_decoys": "~a"}', "never_decoys is not a list of texts"),
        ("[]", "never_decoys is not a list of texts"),
        ("{", "not JSON"),
    ],
)
def test_a_wrong_list_of_exceptions_is_an_error(tmp_path, monkeypatch, text, what):
    example = robot(tmp_path, monkeypatch)
    (example.folder / "study.json").write_text(text)
    with pytest.raises(InputError, match=what) as caught:
        candidates(example, static_info(comparison(1, "~a")))
    assert str(caught.value).startswith(f"{example.folder}/study.json:")


def test_changes_are_written_newest_last(tmp_path):
    save_changes((Change("~a", "/pump", 1.0, 1.03), Change("~b", "/pump", 2.0, 0.5)), tmp_path)
    assert json.loads((tmp_path / "changes.json").read_text()) == [
        {"parameter": "~a", "node": "/pump", "old": 1.0, "new": 1.03},
        {"parameter": "~b", "node": "/pump", "old": 2.0, "new": 0.5},
    ]


def flight(example, name: str = "type1_b", **changes: object) -> Flight:
    own = {"suggested": None, "changes": (), **changes}
    return Flight("mission", example, example.treatment(name), 1, "tuning", **own)


def test_settings_are_the_decoys_and_over_them_what_is_suggested(tmp_path, monkeypatch):
    example = robot(tmp_path, monkeypatch, "type1_b")
    changes = (Change("~a", "/pump", 1.0, 1.03), Change("~b", "/pump", 2.0, 0.5))
    # The treatment sets its own.
    assert flight(example, changes=changes).settings() == {"/pump/a": 1.03}
    tried = flight(example, changes=changes, suggested=Setting("~b", "", 1.9))
    assert tried.settings() == {"/pump/a": 1.03, "/pump/b": 1.9}
    again = flight(example, changes=changes, suggested=Setting("~a", "/pump", 1.5))
    assert again.settings() == {"/pump/a": 1.5}


def test_a_suggested_value_has_the_type_of_the_robots_own(tmp_path, monkeypatch):
    example = robot(tmp_path, monkeypatch, "type1_b")

    def set_to(name: str, value: float) -> object:
        (found,) = flight(example, suggested=Setting(name, "", value)).settings().values()
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
        flight(example, suggested=Setting("~gone", node, 1.0)).settings()


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
    found = flights_of(example, AMONG)
    assert [one.label for one in found] == [
        "reference/robot",
        "missions/robot/clean/seed-1",
        "missions/robot/clean/seed-2",
        "missions/robot/fault_x/seed-1",
        "missions/robot/fault_x/seed-2",
        "missions/robot/type1_b/seed-1",
        "missions/robot/type1_b/seed-2",
    ]
    reference, *missions = found
    assert (reference.seed, reference.half, reference.settings()) == (0, None, {})
    # Nobody looks on twice with the same eyes.
    assert len({one.people for one in found}) == len(found)
    assert all(one.half for one in missions)


def test_a_part_of_it_may_be_chosen(tmp_path, monkeypatch):
    example = robot(tmp_path, monkeypatch, "type1_b")
    chosen = Selection(treatments=["type1_b"], seeds=[2])
    assert [one.name for one in flights_of(example, (), chosen)] == [
        "robot",
        "robot/type1_b/seed-2",
    ]
    with pytest.raises(InputError, match="there is no treatment type9; there are clean, type1_b"):
        check_treatments(Selection(treatments=["type9"]), [example])
    with pytest.raises(InputError, match="there is no system ship, but robot"):
        Selection(systems=["ship"]).examples([example])


def test_the_quick_part_is_one_robot_with_an_error_of_each_type():
    quick = Selection(quick=True)
    (example,) = quick.examples()
    found = flights_of(example, (), quick)
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
