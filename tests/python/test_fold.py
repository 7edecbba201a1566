"""Suspects below 1 % have no row of their own in tables for people."""

from __future__ import annotations

import json
from dataclasses import replace
from io import StringIO

import pytest
from mission_samples import comparison, key, ns
from rich.console import Console

from pytpc.diagnosis.results.advice import BlamedAdvice, Remedy, WhatIf
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.differences import Difference, RunDifferences, SetValue
from pytpc.diagnosis.results.suspects import Accused, Blame, Evaluation
from pytpc.diagnosis.suggestion.advise import stopping_last
from pytpc.present.answers import Diagnosed
from pytpc.present.as_json import diagnosis_json, differences_json
from pytpc.present.ranking_tables import print_diagnosis
from pytpc.recording.marks import Mark


def accused(*probabilities):
    last = Evaluation(0, True, 0.1, 0.2, True, "/node")
    return tuple(
        Accused(n + 1, False, f"~p{n}", probability, "I", key(n), comparison(n, f"~p{n}"), last)
        for n, probability in enumerate(probabilities)
    )


def folded(top, *probabilities):
    blame, advice = advised(*probabilities)
    found = Diagnosis(blame, advice[:top])
    return len(found.shown), found.folded_text


@pytest.mark.parametrize(
    ("probabilities", "rows", "more"),
    [
        ([], 0, ""),
        ([0.7, 0.2, 0.01], 3, ""),
        ([0.7, 0.2, 0.0099, 0.0], 2, "2 more parameters below 1 %"),
        # The first one is always shown.
        ([0.009, 0.008], 1, "1 more parameter below 1 %"),
        ([0.5, *[0.0001] * 1200], 1, "1,200 more parameters below 1 %"),
    ],
)
def test_unlikely_suspects_are_counted(probabilities, rows, more):
    assert folded(5, *probabilities) == (rows, more)


def test_what_top_cuts_off_is_told_apart():
    assert folded(2, 0.5, 0.3, 0.1, 0.005) == (2, "2 more parameters, 1 of them below 1 %")
    assert folded(3, 0.5, 0.3, 0.1) == (3, "")
    assert folded(1, 0.5, 0.3) == (1, "1 more parameter")


SAME = RunDifferences(("good",), "bad", (), True)


# Beside a good run, what kept its value has a row only if it is likely all the same.
def test_beside_a_good_run_nobody_has_to_be_shown():
    blame, advice = advised(0.004, 0.003, none=0.993)
    found = Diagnosis(blame, advice, SAME)
    assert (found.shown, found.folded_text) == ((), "2 compared parameters below 1 %")


# Of hundreds that differ alike each is unlikely; the verdict names the first one, and so does the
# table.
def test_whom_the_verdict_names_is_shown():
    blame, advice = advised(0.004, 0.003, none=0.002)
    found = Diagnosis(blame, advice, SAME)
    assert found.headline.startswith("not sure: ~p0 is likeliest")
    assert (found.shown, found.to_try) == (advice[:1], advice[0])


def advised(*probabilities, none=0.0):
    found = accused(*probabilities)
    blame = Blame(found, none, len(found), (Mark(ns(1), "I"),), ())
    nothing = [
        Remedy(one.parameter, 0.2, None, None, None, "why", "why", None, None, None)
        for one in found
    ]
    return blame, tuple(map(BlamedAdvice, found, nothing, [None] * len(found)))


def test_the_tables_count_them():
    blame, advice = advised(0.7, 0.2, 0.005, 0.004)
    found = Diagnosed(blame, advice)
    console = Console(file=StringIO(), width=120)
    print_diagnosis(console, found)
    for shown in (str(found), found._repr_html_(), console.file.getvalue()):
        assert "~p1" in shown
        assert "~p2" not in shown
        assert "2 more parameters below 1 %" in shown
    # What a program reads has all of them.
    assert len(found.rows()) == 4
    # One that is asked for is shown, however unlikely.
    alone = blame.only("~p3")
    assert "~p3" in str(Diagnosed(alone, advice[3:]))
    assert "below 1 %" not in str(Diagnosed(alone, advice[3:]))


# It answers every complaint about an action, so that it does is no evidence. A good run has some.
@pytest.mark.parametrize(("basis", "name"), [("lasting", None), ("reference", "~p0")])
def test_a_value_that_only_stops_the_robot_accuses_nobody(basis, name):
    blame, advice = advised(0.8, 0.1)
    then = WhatIf("~p0", 1, 1, 1, 9, 1, 3, "", (), stops=True)
    first = replace(advice[0], remedy=replace(advice[0].remedy, basis=basis), what_if=then)
    found = Diagnosis(blame, (first, advice[1]))
    assert found.accused == name
    assert found.headline == (
        "blame ~p0: 80 %; none of the parameters: 0 %"
        if name
        else "not sure: ~p0 is likeliest (80 %), but the log only shows that another value would"
        " stop all that it decides"
    )
    assert diagnosis_json(found)["accused"] == name


def differing(number):
    good, bad = (SetValue([value, float("nan")], "<b>") for value in (1, 2))
    return Difference(f"/a{number}", good, bad, "used", ("a.cpp:1",), (), ())


def test_of_many_that_differ_the_first_ones_are_shown():
    blame, advice = advised(0.7)
    differs = replace(SAME, found=tuple(map(differing, range(10))))
    found = Diagnosed(blame, advice, differs)
    for shown in (str(found), found._repr_html_()):
        assert "/a7" in shown
        assert "/a8" not in shown
        assert "and 2 more parameters that differ" in shown
    assert "<b>" not in found._repr_html_()
    none = Diagnosed(blame, advice, SAME)
    assert str(none).startswith("No parameter differs from the good run good\n")


# A reader of strict JSON takes no NaN, wherever it stands.
def test_lists_of_parameters_are_strict_json():
    text = json.dumps(differences_json(replace(SAME, found=(differing(0),))), allow_nan=False)
    assert json.loads(text)["parameters"][0]["good"]["value"] == [1, None]


# Two share the second position; the first of them would only stop the robot.
def test_of_tied_suspects_one_that_stops_the_robot_comes_last():
    _, advice = advised(0.6, 0.2, 0.2)
    then = WhatIf("~p", 1, 1, 1, 9, 1, 3, "", (), stops=True)
    first, second, third = (
        replace(one, accused=replace(one.accused, position=position), what_if=what_if)
        for one, position, what_if in zip(advice, (1, 2, 2), (then, then, None), strict=True)
    )
    assert stopping_last([first, second, third]) == [first, third, second]
