"""Suggestions that are tried: what is flown, and what is made of it."""

from __future__ import annotations

import json

import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner
from mission_samples import comparison, static_info
from study_flights import FakeFlier, made, robot

from pytpc.base.errors import InputError
from pytpc.cli.main import main
from pytpc_evaluation.commands import study_commands
from pytpc_evaluation.study import flying
from pytpc_evaluation.study.dataset import Cause, StudyFile, save_done
from pytpc_evaluation.study.plan import FlightSelection, Setting, flights_of, setting_label
from pytpc_evaluation.study.suggested import (
    FAILED_FILE,
    Tried,
    WantedFlight,
    judged,
    load_failed,
    load_wanted,
    suggested_flight,
)
from pytpc_evaluation.study.system import BuiltSystem

LEAKS, STANDS = Cause("I", 20.0, 20.0, "it leaks"), Cause("II", 12.5, 40.0, "it stands there")
ROW = {
    "system": "robot",
    "treatment": "type1_b",
    "seed": 1,
    "parameter": "~b",
    "node": "/pump",
    "value": 1.9,
}


@pytest.fixture
def example(tmp_path, monkeypatch):
    return robot(tmp_path, monkeypatch, "type1_b", "type2_b")


# At other times, so that nothing but kind and reason can be compared.
@pytest.mark.parametrize(
    ("before", "after", "gone", "new"),
    [
        ([LEAKS], [], True, False),
        ([LEAKS], [Cause("I", 31.0, 31.0, "it leaks")], False, False),
        ([LEAKS], [STANDS], True, True),
        ([LEAKS], [STANDS, LEAKS], False, True),
        # STANDS is the first in time; what came of it may stay.
        ([LEAKS, STANDS], [LEAKS], True, False),
        ([LEAKS, STANDS], [Cause("II", 50.0, 70.0, "it stands there")], False, False),
        # The same words of another type are another error.
        ([LEAKS], [Cause("II", 20.0, 30.0, "it leaks")], True, True),
        ([], [], None, False),
        ([], [LEAKS], None, True),
    ],
)
def test_an_error_is_gone_where_nothing_of_its_kind_and_reason_is_seen(before, after, gone, new):
    tried = judged(before, after)
    assert (tried.gone, tried.new) == (gone, new)


def test_all_that_was_seen_is_told():
    assert judged([LEAKS], [LEAKS, STANDS]) == Tried(
        gone=False, new=True, errors=("I: it leaks", "II: it stands there")
    )


def test_the_list_is_read(tmp_path):
    path = tmp_path / "wanted.json"
    path.write_text(json.dumps([ROW, {**ROW, "seed": 2, "node": None, "value": 3}]))
    assert load_wanted(path) == [
        WantedFlight("robot", "type1_b", 1, (Setting("~b", "/pump", 1.9),)),
        WantedFlight("robot", "type1_b", 2, (Setting("~b", "", 3.0),)),
    ]


# The same mission with another value, beside one that stays.
def test_a_value_that_stays_is_set_too(tmp_path):
    path = tmp_path / "wanted.json"
    kept = {"parameter": "~a", "node": "/pump", "value": 2}
    path.write_text(json.dumps([ROW, {**ROW, "kept": [kept]}]))
    first, second = load_wanted(path)
    assert first.settings == (Setting("~b", "/pump", 1.9),)
    assert second.settings == (Setting("~a", "/pump", 2.0), Setting("~b", "/pump", 1.9))
    assert setting_label(second.settings) == "pump.a=2.0+pump.b=1.9"


@pytest.mark.parametrize(
    ("document", "what"),
    [
        ({}, "a list is expected"),
        ([1], "1 is no object"),
        ([{**ROW, "value": None}], "value None is not a number"),
        ([{**ROW, "value": True}], "value True is not a number"),
        ([{**ROW, "seed": "1"}], "seed '1'"),
        ([{**ROW, "system": 1}], "are not texts"),
        ([{name: ROW[name] for name in ROW if name != "value"}], "'value' is missing"),
        ([ROW, ROW], "robot/type1_b/1 is listed twice"),
    ],
)
def test_a_wrong_list_is_an_error(tmp_path, document, what):
    path = tmp_path / "wanted.json"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=what) as caught:
        load_wanted(path)
    assert str(caught.value).startswith(f"{path}: ")


def test_a_mission_has_to_be_there_before_it_is_flown_again(example, tmp_path):
    flights = flights_of(example)
    wanted = WantedFlight("robot", "type1_b", 1, (Setting("~b", "/pump", 1.9),))
    with pytest.raises(InputError, match="has not been flown"):
        suggested_flight(wanted, flights, tmp_path)
    save_done(made(), tmp_path / "missions/robot/type1_b/seed-1")
    flight = suggested_flight(wanted, flights, tmp_path)
    assert flight.label == "suggested/robot/type1_b/seed-1/pump.b=1.9"
    assert flight.settings() == {"/pump/a": 1.5, "/pump/b": 1.9, "/pump/c": 0.008}
    # The same people look on.
    (mission,) = [one for one in flights if one.label == "missions/robot/type1_b/seed-1"]
    assert flight.people == mission.people
    none = WantedFlight("robot", "type9", 1, wanted.settings)
    with pytest.raises(InputError, match="there is no mission robot/type9/seed-1"):
        suggested_flight(none, flights, tmp_path)


def test_a_parameter_that_the_robots_file_has_not(fleet):
    wanted = fleet.out / "results" / "suggestions-wanted.json"
    wanted.parent.mkdir()
    other = {**ROW, "treatment": "type2_b", "parameter": "~gone", "node": None, "value": 1.5}
    wanted.write_text(json.dumps([ROW, other]))
    result = CliRunner().invoke(main, ["study", "suggested", "--out", str(fleet.out)])
    # The other one is flown all the same.
    assert fleet.flown == ["suggested/robot/type1_b/seed-1/pump.b=1.9"]
    assert result.exit_code == 1
    assert "any node ~gone: no parameter of this robot" in result.stderr
    rows = pq.read_table(fleet.out / "results/suggestions-flown.parquet").to_pylist()
    assert [row["failure"].partition(": ")[2] for row in rows] == ["", "no parameter of this robot"]


# Each call flies it twice. When it goes well the failures are forgotten.
def test_failures_are_counted(fleet, tmp_path):
    wanted = tmp_path / "wanted.json"
    wanted.write_text(json.dumps([ROW]))
    words = ["study", "suggested", str(wanted), "--out", str(fleet.out)]
    for times in (1, 2):
        fleet.failures["suggested/robot/type1_b/seed-1/pump.b=1.9"] = 2
        assert CliRunner().invoke(main, words).exit_code == 1
        (found,) = load_failed(fleet.out)
        assert (found.mission, found.digest) == ("robot/type1_b/seed-1", "1-2")
        assert (found.parameter, found.node, found.value) == ("~b", "/pump", 1.9)
        assert (found.times, "pump died" in found.failure) == (times, True)
    assert CliRunner().invoke(main, words).exit_code == 0
    assert load_failed(fleet.out) == []


def test_failures_that_cannot_be_read(tmp_path):
    path = tmp_path / FAILED_FILE
    path.parent.mkdir()
    for text in ("{}", '[{"mission": 1}]', "[1]"):
        path.write_text(text)
        with pytest.raises(InputError, match="not a list of failed flights"):
            load_failed(tmp_path)


@pytest.fixture
def fleet(example, tmp_path, monkeypatch) -> FakeFlier:
    """The command flies the little robot, and only seems to; nothing is seen with a suggestion."""
    monkeypatch.setattr(FlightSelection, "examples", lambda *_: [example])
    save = StudyFile.save
    monkeypatch.setattr(StudyFile, "save", lambda self: save(self, (example,)))
    system = BuiltSystem(example, static_info(comparison(1, "~a")), {}, {}, "build")
    monkeypatch.setattr(flying, "prepare", lambda *_: (system, True))
    found = FakeFlier(tmp_path / "out")
    monkeypatch.setattr(flying, "Flier", lambda *_: found)
    assert study_commands.WANTED_FILE.name == "suggestions-wanted.json"
    for treatment, cause in (("type1_b", LEAKS), ("type2_b", STANDS)):
        folder = found.out / "missions/robot" / treatment / "seed-1"
        save_done(made(), folder)
        (folder / "causes.json").write_text(_of(cause))
        tried = "pump.b=1.9" if treatment == "type1_b" else "a=1.5"
        again = found.out / "suggested/robot" / treatment / "seed-1" / tried
        again.mkdir(parents=True)
        (again / "causes.json").write_text(_of(*([STANDS] if treatment == "type2_b" else [])))
    return found


def _of(*causes: Cause) -> str:
    fields = ("kind", "start", "end", "reason")
    return json.dumps([{name: getattr(one, name) for name in fields} for one in causes])


def test_suggestions_are_flown_and_judged(fleet):
    other = {**ROW, "treatment": "type2_b", "parameter": "~a", "node": None, "value": 1.5}
    wanted = fleet.out / "results" / "suggestions-wanted.json"
    wanted.parent.mkdir()
    wanted.write_text(json.dumps([ROW, other]))
    result = CliRunner().invoke(main, ["study", "suggested", "--out", str(fleet.out)])
    assert result.exit_code == 0, result.output
    assert fleet.flown == [
        "suggested/robot/type1_b/seed-1/pump.b=1.9",
        "suggested/robot/type2_b/seed-1/a=1.5",
    ]
    rows = pq.read_table(fleet.out / "results/suggestions-flown.parquet").to_pylist()
    # sha256sum: robot/type1_b and robot/type2_b are the only ones of their types.
    assert rows[0] == {**ROW, "type": "type1", "half": "tuning", "gone": True, "new": False} | {
        "reached": True,
        "failure": "",
    }
    assert (rows[1]["gone"], rows[1]["new"], rows[1]["node"]) == (False, False, "")
    suggestion = json.loads(
        (fleet.out / "suggested/robot/type1_b/seed-1/pump.b=1.9/suggestion.json").read_text()
    )
    assert suggestion == {
        "schema": 1,
        "mission": "1-2",
        "parameter": "~b",
        "node": "/pump",
        "value": 1.9,
        "gone": True,
        "new": False,
        "errors": [],
    }
    assert "2 suggestions" in result.stdout


def test_a_suggestion_whose_flight_fails_is_a_row_and_status_1(fleet, tmp_path):
    fleet.failures["suggested/robot/type1_b/seed-1/pump.b=1.9"] = 2
    wanted = tmp_path / "wanted.json"
    wanted.write_text(json.dumps([ROW]))
    words = ["study", "suggested", str(wanted), "--out", str(fleet.out), "--json"]
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 1
    (row,) = json.loads(result.stdout)
    assert (row["gone"], row["new"], row["reached"]) == (None, None, None)
    assert "pump died" in row["failure"]


def test_an_empty_list_is_nothing_to_fly(fleet, tmp_path):
    wanted = tmp_path / "wanted.json"
    wanted.write_text("[]")
    result = CliRunner().invoke(main, ["study", "suggested", str(wanted)])
    assert result.exit_code == 2
    assert "the list is empty" in result.output
