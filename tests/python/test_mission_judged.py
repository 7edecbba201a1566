"""The treatments of missions, and the judgement of a mission that was flown with one."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from mission_samples import comparison, events, key, mission_run, ns, static_info
from rich.console import Console

from pytpc.base.errors import InputError
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.differences import RunDifferences
from pytpc.diagnosis.results.suspects import Accused, Blame, Evaluation
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.ros.mission_run import (
    MissionRun,
)
from pytpc_evaluation.demo.demo import TreatedMission, gone_wrong, not_named, result_table
from pytpc_evaluation.demo.demo_examples import IMAGE_CAPTURE, WATER_SAMPLER, Example
from pytpc_evaluation.treatment import Treatment, load_treatment

TREATMENTS = [
    (example, path.name)
    for example in (IMAGE_CAPTURE, WATER_SAMPLER)
    for path in sorted((example.folder / "treatments").iterdir())
]


# --- treatments


@pytest.mark.parametrize(
    ("example", "name"), TREATMENTS, ids=lambda each: getattr(each, "name", each)
)
def test_treatments_of_the_examples_change_what_they_say(example, name):
    treatment = example.treatment(name)
    own = yaml.safe_load((example.folder / "config/params.yaml").read_text())
    overlay = yaml.safe_load(treatment.overlay.read_text())
    changed = {
        (node, parameter, own[node][parameter], value)
        for node, parameters in overlay.items()
        for parameter, value in parameters.items()
        if own[node][parameter] != value
    }
    assert treatment.name == name
    if treatment.parameter is None:
        assert changed == set()
    else:
        assert treatment.node is not None
        node = treatment.node.removeprefix("/")
        parameter = treatment.parameter.removeprefix("~")
        assert changed == {(node, parameter, treatment.old, treatment.new)}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "params.yaml").write_text("mission: {limit: 3}\n")
    (tmp_path / "treatment.json").write_text(json.dumps(GOOD))
    return tmp_path


GOOD = {
    "name": "low",
    "type": "type1",
    "parameter": "limit",
    "node": "/mission",
    "old": 20,
    "new": 3,
    "launch": {},
    "effect": "It lands.",
}


def test_treatment_is_read(folder):
    treatment = load_treatment(folder)
    assert treatment.mark_type == "I"
    assert treatment.change == "limit 20 -> 3"
    assert treatment.overlay == folder / "params.yaml"
    assert treatment.tipping is None


def test_where_the_behaviour_tips_may_be_said(folder):
    (folder / "treatment.json").write_text(json.dumps({**GOOD, "tipping": 12}))
    assert load_treatment(folder).tipping == 12


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"type": "bad"}, "type is 'bad', not one of clean, type1, type2, fault"),
        ({"old": None}, "old is not a number"),
        ({"new": True}, "new is not a number"),
        ({"node": None}, "node is not a text"),
        ({"type": "clean"}, "type clean has no changed parameter"),
        ({"parameter": None, "node": None}, "type type1 has a changed parameter"),
        ({"launch": {"fault": True}}, "launch is not an object of texts"),
        ({"extra": 1}, "exactly the fields"),
        ({"tipping": "7"}, "tipping is not a number or null"),
        ({"tipping": True}, "tipping is not a number or null"),
        ({"round": 0}, "round is not a whole number from 1"),
        ({"round": True}, "round is not a whole number from 1"),
        ({"round": 1.5}, "round is not a whole number from 1"),
    ],
)
def test_wrong_treatments_say_what_is_wrong(folder, change, what):
    (folder / "treatment.json").write_text(json.dumps({**GOOD, **change}))
    with pytest.raises(InputError, match=what) as caught:
        load_treatment(folder)
    assert str(caught.value).startswith(f"{folder}/treatment.json: ")


@pytest.mark.parametrize("tipping", [7, 6.5, None])
def test_a_treatment_may_say_where_the_behaviour_tips(folder, tipping):
    assert load_treatment(folder).tipping is None
    (folder / "treatment.json").write_text(json.dumps({**GOOD, "tipping": tipping}))
    assert load_treatment(folder).tipping == tipping


def test_nothing_tips_where_no_parameter_is_changed(folder):
    nothing = dict.fromkeys(("parameter", "node", "old", "new"))
    clean = {**GOOD, **nothing, "type": "clean", "tipping": 7}
    (folder / "treatment.json").write_text(json.dumps(clean))
    with pytest.raises(InputError, match="tipping is not null"):
        load_treatment(folder)


def test_broken_json_says_the_line(folder):
    (folder / "treatment.json").write_text('{\n  "name": "low",\n  "type"\n}\n')
    with pytest.raises(InputError, match=r"treatment\.json:4: not JSON"):
        load_treatment(folder)


def test_treatment_without_its_parameters_is_an_error(folder):
    (folder / "params.yaml").unlink()
    with pytest.raises(InputError, match=r"params\.yaml: no such file"):
        load_treatment(folder)


# --- the judgement


LIMIT = comparison(1, "limit")
OTHERS = [comparison(number, f"other{number}") for number in range(2, 6)]
STATIC = static_info(LIMIT, *OTHERS)
TYPE1 = Treatment("low", "type1", "limit", "/m", 20, 3, {}, "It lands.", Path("params.yaml"))
CLEAN = Treatment("clean", "clean", None, None, None, None, {}, "It works.", Path("params.yaml"))


def flown(
    treatment: Treatment,
    run: MissionRun,
    marks: list[Mark],
    rows: list,
    example: Example = IMAGE_CAPTURE,
) -> TreatedMission:
    """A mission with the given evaluations: (seconds, number of the key, result, cmp, thresh)."""
    recording = Recording(treatment.name, events(rows), tuple(marks), 0, ns(40.0))
    rankings = rank_marks(recording, STATIC)
    return TreatedMission(example, treatment, 1, run, recording, rankings)


LIMIT_ROWS = [(8.0, 1, 0, 2.0, 3.0), (9.0, 1, 1, 4.0, 3.0)]


NO_DIFFERENCES = RunDifferences(("good",), "bad", (), is_complete=True)


def diagnosis(*shares: tuple[str, float], good: RunDifferences | None = None) -> Diagnosis:
    """A diagnosis with the given parameters and probabilities; the rest is that it is none."""
    last = Evaluation(ns(9.0), True, 4.0, 3.0, True, "/m")
    suspects = tuple(
        Accused(place, False, name, share, "I", key(1), LIMIT, last)
        for place, (name, share) in enumerate(shares, start=1)
    )
    none = 1.0 - sum(share for _, share in shares)
    return Diagnosis(Blame(suspects, none, len(suspects), (), ()), (), good)


def marked(tmp_path, *marks: Mark) -> TreatedMission:
    return flown(TYPE1, mission_run(tmp_path), list(marks or [Mark(ns(10.0), "I")]), LIMIT_ROWS)


def test_without_good_runs_the_culprit_has_to_be_among_the_first_three(tmp_path):
    shares = [("~a", 0.4), ("~b", 0.2), ("~limit", 0.1), ("~c", 0.05)]
    assert not_named(marked(tmp_path), diagnosis(*shares)) == []
    shares[2], shares[3] = shares[3], shares[2]
    assert not_named(marked(tmp_path), diagnosis(*shares)) == [
        "low: limit is not named, but not sure:"
        " ~a is likeliest (40 %); none of the parameters: 25 %"
    ]


def test_beside_good_runs_the_culprit_has_to_be_the_first(tmp_path):
    assert not_named(marked(tmp_path), diagnosis(("~limit", 0.6), good=NO_DIFFERENCES)) == []
    for shares in ([("~a", 0.6), ("~limit", 0.3)], []):
        assert not_named(marked(tmp_path), diagnosis(*shares, good=NO_DIFFERENCES)) != []


def test_where_no_mark_has_the_right_type_nothing_can_be_named(tmp_path):
    # That the observer set none is a failure of the mission.
    mission = marked(tmp_path, Mark(ns(30.0), "II"))
    assert mission.judged == []
    assert not_named(mission, diagnosis()) == []
    assert gone_wrong(mission) == ["low: the observer set no mark of type I"]


def test_a_mission_that_did_not_go_as_demanded_is_a_failure(tmp_path):
    assert gone_wrong(flown(TYPE1, mission_run(tmp_path), [], LIMIT_ROWS)) == [
        "low: the observer set no mark of type I"
    ]
    late = mission_run(tmp_path, ended="timeout", messages={}, lost={"/a": 2, "/b": 1})
    assert gone_wrong(flown(CLEAN, late, [Mark(ns(9.5), "I")], LIMIT_ROWS)) == [
        "clean: the mission did not end in 10 s",
        "clean: the observer set 1 marks",
        "clean: no picture was taken",
        "clean: 3 log messages were lost by the recorder",
    ]
    type2 = replace(TYPE1, name="high", type="type2")
    assert gone_wrong(flown(type2, mission_run(tmp_path), [Mark(ns(9.5), "II")], LIMIT_ROWS)) == [
        "high: a picture was taken"
    ]


def test_a_filled_vial_is_a_failure_under_each_treatment_that_changes_something(tmp_path):
    filled = mission_run(tmp_path, messages={"/truth/vial_filled": 1})
    empty = mission_run(tmp_path, messages={"/camera/picture": 1})
    mark = [Mark(ns(10.0), "I")]
    assert gone_wrong(flown(TYPE1, filled, mark, LIMIT_ROWS, WATER_SAMPLER)) == [
        "low: the vial was filled"
    ]
    assert gone_wrong(flown(TYPE1, empty, mark, LIMIT_ROWS, WATER_SAMPLER)) == []
    assert gone_wrong(flown(CLEAN, filled, [], LIMIT_ROWS, WATER_SAMPLER)) == []
    assert gone_wrong(flown(CLEAN, empty, [], LIMIT_ROWS, WATER_SAMPLER)) == [
        "clean: the vial was not filled"
    ]


def test_table_has_a_row_for_each_mark(tmp_path):
    marks = [Mark(ns(10.0), "I"), Mark(ns(11.0), "II")]
    missions = [
        flown(CLEAN, mission_run(tmp_path), [], LIMIT_ROWS),
        flown(TYPE1, mission_run(tmp_path), marks, LIMIT_ROWS),
    ]
    console = Console(width=200, record=True, file=(tmp_path / "out").open("w"))
    console.print(result_table(missions, STATIC))
    console.file.close()
    rows = [line.split("│") for line in console.export_text().splitlines() if "│" in line]
    cells = [[cell.strip() for cell in row[1:-1]] for row in rows]
    assert cells[0][:3] == ["clean", "-", "none"]
    # The smallest change: with a limit of 4 the last flop, 4 > limit, would not have been.
    first = ["low", "limit 20 -> 3", "10.0 s", "I", "1 of 5", "1.00"]
    assert cells[1][:6] == first
    assert "raise limit from 3 to 4" in cells[1][6]
    assert cells[1][7] == "yes"
    assert cells[2][2:4] == ["11.0 s", "II (wrong type)"]
    assert cells[2][6:] == ["", ""]


def test_a_treatment_may_say_in_which_round_of_the_study_it_was_added(folder):
    assert load_treatment(folder).round == 1
    (folder / "treatment.json").write_text(json.dumps({**GOOD, "round": 2}))
    assert load_treatment(folder).round == 2
