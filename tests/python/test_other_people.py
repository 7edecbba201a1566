"""Other people at a mission: what each crowd does otherwise than the thesis's four."""

from __future__ import annotations

import importlib.util
import json
import math
import statistics
import subprocess
import sys
from dataclasses import asdict

import pytest
from observer_scripts import shared_module

from pytpc_evaluation.demo.demo_examples import SHARED_PACKAGE
from pytpc_evaluation.study.data import user_marks
from pytpc_evaluation.study.report.sensitivity import CROWDS, PROGRAM

crowd = shared_module("crowd")
Cause = shared_module("rules").Cause

SEEDS = range(1000)
DEED = Cause("I", 100.0, 100.0, "it should not have")
WAIT = Cause("II", 100.0, 1000.0, "it should have")
END = 1000.0


@pytest.fixture(scope="module")
def crowds():
    spec = importlib.util.spec_from_file_location("crowds", PROGRAM)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def first_delays(marks: list) -> dict[str, float]:
    """Seconds from 100 s to each user's first mark."""
    found: dict[str, float] = {}
    for mark in marks:
        found.setdefault(mark.observer, mark.time_ns / 1e9 - 100.0)
    return found


# Times of marks are whole nanoseconds, here below 1000 s: doubles are that exact.
@pytest.mark.parametrize("cause", [DEED, WAIT], ids=["deed", "wait"])
@pytest.mark.parametrize(("name", "factor"), [("fast", 0.5), ("slow", 2.0)])
def test_first_marks_come_by_a_factor_sooner_or_later(crowds, cause, name, factor):
    for seed in range(50):
        own = first_delays(crowds.crowd_marks("thesis", [cause], 0.0, END, seed))
        others = first_delays(crowds.crowd_marks(name, [cause], 0.0, END, seed))
        assert others == pytest.approx({user: factor * s for user, s in own.items()}, abs=1e-6)


# User 3 has one delay for kind I, 11.45 s: all that varies is the factor.
@pytest.mark.parametrize(("name", "sigma"), [("thesis", 0.2), ("spread", 0.6)])
def test_how_much_a_delay_varies(crowds, name, sigma):
    logs = []
    for seed in SEEDS:
        delays = first_delays(crowds.crowd_marks(name, [DEED], 0.0, END, seed))
        if "user3" in delays:
            logs.append(math.log(delays["user3"]))
    # He marks in one trial of two. 500 marks tell their deviation to 1 part in 30.
    assert len(logs) == pytest.approx(500, abs=60)
    assert statistics.fmean(logs) == pytest.approx(math.log(11.45), abs=0.08)
    assert statistics.stdev(logs) == pytest.approx(sigma, rel=0.1)


@pytest.mark.parametrize("cause", [DEED, WAIT], ids=["deed", "wait"])
def test_everybody_marks_both_kinds_twice(crowds, cause):
    for seed in range(50):
        marks = crowds.crowd_marks("two-marks", [cause], 0.0, END, seed)
        assert sorted(m.observer for m in marks) == sorted(["user1", "user2", "user3", "user4"] * 2)


# The shortest delay of a wait is user 1's 1.71 s; 0.5 s are over before anybody has seen it.
def test_nobody_marks_what_is_over(crowds):
    brief = Cause("II", 100.0, 100.5, "it should have")
    assert crowds.crowd_marks("two-marks", [brief], 0.0, END, 1) == []


def test_one_user_alone_marks_as_he_does_among_others(crowds):
    causes = [DEED, WAIT]
    marks = crowds.crowd_marks("thesis", causes, 0.0, END, 5)
    alone = crowds.crowd_marks("alone", causes, 0.0, END, 5)
    assert alone == [mark for mark in marks if mark.observer == "user2"] != []


# 26 of 51 marks of a wait are said to be of kind I, but 2 of 17 of a deed. A coin says 1 of 2.
@pytest.mark.parametrize(("name", "share"), [("thesis", 2 / 17), ("coin", 0.5)])
def test_what_a_coin_says(crowds, name, share):
    marks = [m for s in SEEDS for m in crowds.crowd_marks(name, [DEED], 0.0, END, s)]
    said = [mark.said == "I" for mark in marks]
    # About 8500 marks: a deviation of 0.005.
    assert statistics.fmean(said) == pytest.approx(share, abs=0.02)
    assert {mark.right for mark in marks} == {"I"}


def test_a_coin_changes_nothing_but_the_type(crowds):
    own = crowds.crowd_marks("thesis", [DEED, WAIT], 0.0, END, 3)
    coin = crowds.crowd_marks("coin", [DEED, WAIT], 0.0, END, 3)
    assert [asdict(m) | {"said": ""} for m in coin] == [asdict(m) | {"said": ""} for m in own]


@pytest.fixture
def watched(tmp_path):
    """A mission's folder from 0 to 200 s, with one deed."""
    (tmp_path / "causes.json").write_text(json.dumps([asdict(DEED)]))
    write_sights(tmp_path, [0.0, 200.0])
    (tmp_path / "marks").mkdir()
    return tmp_path


def write_sights(folder, times):
    look = shared_module("rules").Look
    sights = [look(time, 0.0, 0.0, 0.0) for time in times]
    shared_module("sights").save_sights(sights, look, folder / "sights.parquet")


def run(folder, seed=7):
    words = ["--causes", "causes.json", "--sights", "sights.parquet", "--folder", "marks"]
    return subprocess.run(
        [sys.executable, str(PROGRAM), *words, "--seed", str(seed)],
        cwd=folder,
        env={"PYTHONPATH": str(SHARED_PACKAGE / "src")},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_program_writes_a_file_for_each_crowd(watched):
    assert run(watched).returncode == 0
    assert {path.stem for path in (watched / "marks").iterdir()} == {*CROWDS}
    # The mission's own people, byte for byte.
    own = crowd.marks_of([DEED], 0.0, 200.0, 7)
    shared_module("marks_file").save_marks(own, watched / "own.parquet")
    thesis = (watched / "marks/thesis.parquet").read_bytes()
    assert thesis == (watched / "own.parquet").read_bytes()
    assert len(user_marks(watched / "marks/two-marks.parquet")) == 8


def test_who_saw_nothing_marks_nothing(watched):
    write_sights(watched, [])
    assert run(watched).returncode == 0
    assert [user_marks(watched / f"marks/{name}.parquet") for name in CROWDS] == [()] * len(CROWDS)


@pytest.mark.parametrize(
    ("file", "text", "said"),
    [
        ("causes.json", "{", "causes.json: not the causes of a mission: "),
        ("causes.json", '[{"kind": "I"}]', "causes.json: not the causes of a mission: "),
        (
            "causes.json",
            '[{"kind": "III", "start": 1, "end": 1, "reason": ""}]',
            "causes.json: not the causes of a mission: an unknown kind",
        ),
        (
            "causes.json",
            '[{"kind": "I", "start": "soon", "end": 1, "reason": ""}]',
            "causes.json: not the causes of a mission: ",
        ),
        ("sights.parquet", "x", "sights.parquet: no readable Parquet file"),
        ("sights.parquet", None, "sights.parquet: No such file or directory"),
    ],
)
def test_what_cannot_be_read_is_one_line(watched, file, text, said):
    if text is None:
        (watched / file).unlink()
    else:
        (watched / file).write_text(text)
    ended = run(watched)
    assert ended.returncode == 1
    assert ended.stderr.startswith(f"crowds.py: {said}")
    assert ended.stderr.count("\n") == 1
