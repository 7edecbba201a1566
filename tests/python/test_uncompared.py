"""Suspects that no comparison reports: what differs from a good run, and is compared nowhere."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from mission_samples import comparison, link_unit
from test_differences import (
    FACES,
    GOOD,
    MARKS,
    READS,
    STATIC,
    asked,
    flight,
    ns,
    recorded,
    values,
)

import pytpc
from pytpc.diagnosis.diagnose import diagnose_mission
from pytpc.diagnosis.differences import RunValues, changes_of, differences
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.results.suspects import Uncompared
from pytpc.recording.parameter_values import SetValue
from pytpc.static.static_info import StaticInfo


def told(bad, *good):
    found = differences(bad, good or [GOOD], STATIC)
    references = [one.recording for one in good or [GOOD]]
    asked = Question(references=references, differences=found, changes=changes_of(found))
    return diagnose_mission(bad.recording, STATIC, asked)


def bad_run(faces=5, recorded=(), **own):
    kept = {"faces": faces, "coverage": 0.6, "radius": 0.17, "extra": 1}
    flown = replace(flight(faces, marks=MARKS), values=tuple(recorded))
    return RunValues("bad", flown, values(**{**kept, **own}))


def odds(found):
    return {one.parameter: one.probability for one in found.blame.suspects}


def test_what_alone_differs_is_likeliest_and_not_blamed():
    found = told(bad_run(radius=0.42))
    first = found.blame.suspects[0]
    assert isinstance(first, Uncompared)
    assert first.parameter == "~radius"
    assert first.probability > 0.5
    assert found.accused is None
    assert sum(odds(found).values()) + found.blame.none == pytest.approx(1.0)
    assert [one.position for one in found.blame.suspects] == [1, 2, 3]
    assert found.action == "lower ~radius from 0.42 to 0.17 (the value of the good run)"


def test_a_comparison_that_fits_to_the_marks_goes_before():
    found = told(bad_run(faces=12, radius=0.42))
    assert [one.parameter for one in found.blame.suspects[:2]] == ["~faces", "~radius"]


def test_what_no_analysed_node_reads_is_less_likely_than_what_one_reads():
    found = odds(told(bad_run(radius=0.42, extra=2)))
    assert found["~radius"] > 10 * found["/uav/extra"] > 0


GAINS = StaticInfo.of(
    [link_unit([FACES], [replace(READS[2], name=name) for name in ("~a", "~b", "~c")])]
)


def gains(good, bad):
    """The probabilities of ~a, ~b and ~c, in this order, that differ from the good runs."""
    flown = replace(flight(5), marks=MARKS)
    runs = [RunValues("good", flight(5), values(faces=5, **one)) for one in good]
    found = differences(RunValues("bad", flown, values(faces=5, **bad)), runs, GAINS)
    references = [one.recording for one in runs]
    question = Question(references=references, differences=found, changes=changes_of(found))
    now = odds(diagnose_mission(flown, GAINS, question))
    return [now[name] for name in ("~a", "~b", "~c")]


# A factor of 1.2, one of 8, and one of more than ten, as a change of the sign is.
def test_of_those_that_no_comparison_reports_the_larger_difference_is_likelier():
    small, large, most = gains([{"a": 5, "b": 5, "c": 500}], {"a": 6, "b": 40, "c": 5})
    assert small < large < most
    assert gains([{"a": 5, "b": 5, "c": 500}], {"a": 6, "b": 40, "c": -5})[2] == most


# The nearest of the good values counts; and what lies between two is likely to be right, too.
def test_how_far_it_is_from_the_good_runs_counts():
    good = [{"a": 4, "b": 8, "c": 1}, {"a": 1, "b": 1, "c": 10}]
    between, beyond, far = gains(good, {"a": 2, "b": 9, "c": 100})
    assert between < beyond < far


# A gain of 6 for 5 is a smaller difference than another frame, one of 500 a larger one.
def test_another_text_or_flag_is_a_difference_of_the_middle():
    small, text, large = gains([{"a": 5, "b": "map", "c": 5}], {"a": 6, "b": "odom", "c": 500})
    flag = gains([{"a": 5, "b": True, "c": 5}], {"a": 6, "b": False, "c": 500})[1]
    assert small < text == flag < large


# The source has a part of the name only; the robot's is the one that can be set.
def test_it_has_its_full_name_where_the_source_does_not_say_it():
    reads = [replace(READS[2], name="~<dynamic>/radius")]
    static = StaticInfo.of([link_unit([FACES], reads)])
    good = RunValues("good", flight(5), {"/uav/planner/radius": 0.17})
    bad = RunValues("bad", flight(5), {"/uav/planner/radius": 0.42})
    (one,) = differences(bad, [good], static).found
    assert (one.name, one.state) == ("/uav/planner/radius", "used")


# Thousands of parameters of a robot that is not analysed do not silence a verdict.
def test_what_nobody_reads_has_one_share_together():
    more = {f"p{number}": 2 for number in range(500)}
    good = replace(GOOD, values={**GOOD.values, **{f"/uav/{name}": 1 for name in more}})
    found = odds(told(bad_run(faces=12, **more), good))
    assert found["~faces"] > 0.8
    assert sum(found[f"/uav/{name}"] for name in more) < 0.1


# ~radius has its default, as it was set under a name that nobody reads.
def test_a_misspelt_name_is_as_likely_as_what_is_read():
    good = replace(GOOD, values=values(faces=5, coverage=0.6, extra=1))
    bad = bad_run(radus=0.42)
    bad = replace(bad, values={k: v for k, v in bad.values.items() if k != "/uav/radius"})
    found = told(bad, good)
    assert found.blame.suspects[0].parameter == "/uav/radus"
    assert found.advice[0].remedy.reason == "it was not set in the good run"


# The marks are at 8 to 10 s: it was set a moment before them, or long after.
def test_what_was_set_anew_before_the_marks_is_likelier():
    def set_at(second):
        history = [SetValue(0, "/uav/radius", 0.17), SetValue(ns(second), "/uav/radius", 0.42)]
        return odds(told(bad_run(radius=0.42, recorded=history)))["~radius"]

    assert set_at(3) > set_at(15) == odds(told(bad_run(radius=0.42)))["~radius"]


# All that differs is a text: what it was is said, and there is no number to try.
def test_a_text_is_a_suspect_without_a_value_to_try():
    good = replace(GOOD, values=values(faces=5, coverage=0.6, radius="map", extra=1))
    found = told(bad_run(radius="odom"), good)
    advice = found.advice[0]
    assert (advice.accused.parameter, advice.current) == ("~radius", "odom")
    assert advice.remedy.value is None
    assert advice.remedy.reason == "it was map in the good run"
    assert found.action == ""


# Its comparison reports its length, 5 in both runs; the text is another one.
def test_a_text_of_the_same_length_is_no_text_that_was_kept():
    compared = StaticInfo.of([link_unit([FACES, comparison(1, "~frame")], READS)])
    good = RunValues("good", flight(5, 5.0), values(faces=5, frame="odoms"))
    recording = replace(flight(12, 5.0), marks=MARKS)
    bad = RunValues("bad", recording, values(faces=12, frame="world"))
    found = differences(bad, [good], compared)
    changes = changes_of(found)
    asked = Question(references=[good.recording], differences=found, changes=changes)
    frame = odds(diagnose_mission(recording, compared, asked))["~frame"]
    asked = replace(asked, changes=[one for one in changes if one.parameter != "/uav/frame"])
    kept = odds(diagnose_mission(recording, compared, asked))["~frame"]
    assert frame > 100 * kept


def test_the_value_of_a_text_is_not_what_its_comparison_reports():
    compared = StaticInfo.of([link_unit([FACES, comparison(1, "~frame")], READS)])
    good = RunValues("good", flight(5, 5.0), values(faces=5))
    bad = RunValues("bad", flight(5, 5.0), values(faces=5, frame="world"))
    (one,) = differences(bad, [good], compared).found
    assert (one.name, one.good.value, one.bad.value) == ("~frame", None, "world")


def test_every_output_shows_it(tmp_path):
    good, bad, static = recorded(tmp_path)
    words = ("--static", static, "--reference", good)
    answer, *_ = json.loads(asked("rank", bad, *words, "--json").stdout)
    shown = answer["diagnosis"]["suspects"][0]
    assert (shown["position"], shown["parameter"], shown["key"]) == (1, "~radius", None)
    assert shown["uncompared"] == "read at src/node.cpp:5, compared nowhere"
    assert shown["remedy"]["value"] == 0.17
    for command in ("rank", "suggest"):
        text = " ".join(asked(command, bad, *words).stdout.split())
        assert "read at src/node.cpp:5, compared nowhere" in text, text
    found = pytpc.diagnose(bad, static, reference=good)
    assert found.rows()[0]["place"] == "read at src/node.cpp:5, compared nowhere"
    assert "~radius" in found._repr_html_()
    page = tmp_path / "report.html"
    result = asked("report", bad, *words, "-o", page)
    assert result.exit_code == 0, result.output
    assert "~radius" in page.read_text()


def test_fix_takes_the_value_of_the_good_run(tmp_path):
    good, bad, static = recorded(tmp_path)
    state = tmp_path / "fix.json"
    result = asked("fix", bad, "--static", static, "--reference", good, "-o", state)
    assert "~radius" in result.stdout, result.output
    assert "/uav/radius 0.42 -> 0.17" in result.stdout
    assert "  read at src/node.cpp:5, compared nowhere" in result.stdout.splitlines()
    words = ("-o", state, "--static", static, "--reference", good)
    assert asked("fix", bad, *words, "--yes").exit_code == 0
    # Nothing says how much further it may go.
    assert "~radius" not in asked("fix", bad, *words, "--say", "better").stdout.split("try:")[-1]


def test_without_a_good_run_nothing_is_added():
    found = diagnose_mission(bad_run(radius=0.42).recording, STATIC)
    assert [one.parameter for one in found.blame.suspects] == ["~faces", "~coverage"]
