"""What it says about "none of the parameters" that a good run was flown with the same code."""

from __future__ import annotations

import hashlib
import json
import math
import re
from dataclasses import replace

import pytest
from click.testing import CliRunner
from mission_samples import comparison, events, link_unit, ns

import pytpc
from pytpc.cli.main import main
from pytpc.diagnosis.differences import RunValues, changes_of, differences
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.ranking.other_values import NOBODY, nobody
from pytpc.diagnosis.results.differences import CodeComparison
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording, save_recording
from pytpc.static.builds import build_of
from pytpc.static.static_info import StaticInfo

FASTEST, NEAREST, OTHERS = 0, 1, range(2, 8)
COMPARISONS = [comparison(FASTEST, "~fastest"), comparison(NEAREST, "~nearest")]
COMPARISONS += [comparison(number, f"~other{number}") for number in OTHERS]
PROGRAM = "robot/node"


def static_of(content="a", root="/ws/src/robot"):
    """The program's static information; ``content`` stands for that of its only source file."""
    static = StaticInfo.of([link_unit(COMPARISONS, source_root=root)])
    digest = hashlib.sha256(content.encode()).hexdigest()
    return replace(static, sources=((f"{root}/src/node.cpp", digest),))


STATIC = static_of()


def flight(fastest=5.0, nearest=5.0, marks=()):
    """100 s. The speed is 8 all the time: it is above ``fastest`` where that is 5, never at 12.

    The distance is 2, which turns nothing, whatever ``nearest`` is. The others go up and down.
    """
    rows = []
    for tick in range(500):
        t = tick / 5
        rows.append((t, FASTEST, fastest < 8.0, 8.0, fastest))
        rows.append((t + 0.01, NEAREST, nearest < 2.0, 2.0, nearest))
        for number in OTHERS:
            value = 5.0 + 3.0 * math.sin(t / (3 + number))
            rows.append((t + number / 100, number, value > 5.0, value, 5.0))
    return Recording("flight", events(rows), tuple(marks), 0, ns(100))


def run(name, build="a", **limits):
    given = {f"/node/{one}": limits.get(one, 5.0) for one in ("fastest", "nearest")}
    given["/node/unread"] = limits.pop("unread", 1)
    return RunValues(name, flight(**limits), given, build=build and {PROGRAM: build})


def judged(bad, *good, **more):
    found = differences(bad, good or (run("monday"),), STATIC)
    references = [one.recording for one in good or (run("monday"),)]
    question = Question(references=references, differences=found, changes=changes_of(found), **more)
    return blame(bad.recording, STATIC, question)


ONE, TWO, FOUR = (70,), (70, 85), (40, 55, 70, 85)


def marks_at(times, kind):
    return tuple(Mark(ns(at), kind) for at in times)


# The robot is too slow all the time, so that the times of the marks say nothing. It is of type II.
@pytest.mark.parametrize("times", [ONE, TWO, FOUR])
@pytest.mark.parametrize("kind", ["I", "II", None])
def test_the_only_difference_is_blamed_if_it_turns_the_decisions_at_the_marks(times, kind):
    found = judged(run("bad", fastest=12.0, marks=marks_at(times, kind)))
    assert found.accused == "~fastest", found.text
    assert found.confidence > found.none


@pytest.mark.parametrize("times", [ONE, TWO, FOUR])
@pytest.mark.parametrize("kind", ["I", "II", None])
def test_what_turns_nothing_is_not_blamed_though_nothing_else_differs(times, kind):
    found = judged(run("bad", nearest=12.0, marks=marks_at(times, kind)))
    assert found.none > 0.8, found.text
    assert found.text.startswith("not sure: most likely none of the parameters (")
    assert "; the code is that of the good run monday, so perhaps something around" in found.text


@pytest.mark.parametrize("times", [ONE, FOUR])
def test_where_nothing_differs_it_is_none_of_the_parameters(times):
    assert judged(run("bad", marks=marks_at(times, "II"))).none > 0.99


@pytest.mark.parametrize("kind", ["I", "II", None])
def test_the_one_of_two_differences_that_turns_the_decisions_is_blamed(kind):
    marks = marks_at(FOUR, kind)
    found = judged(run("bad", fastest=12.0, nearest=12.0, marks=marks))
    assert found.accused == "~fastest", found.text


# A fault in the code could be it.
@pytest.mark.parametrize("times", [ONE, FOUR])
def test_with_other_code_it_stays_none_of_them(times):
    bad = run("bad", build="b", fastest=12.0, marks=marks_at(times, "II"))
    found = judged(bad)
    assert found.accused is None
    assert found.none > found.confidence
    assert "perhaps a fault in the code: the code is not that of the good run monday:" in found.text
    assert f"{PROGRAM} changed" in found.text


def test_one_good_run_of_the_same_code_is_enough():
    bad = run("bad", fastest=12.0, marks=marks_at(FOUR, "II"))
    assert judged(bad, run("monday"), run("tuesday", "b")).accused == "~fastest"
    assert judged(bad, run("monday", "c"), run("tuesday", "b")).accused is None
    assert judged(bad, run("monday", None)).accused is None


# log(1 - 2/3 * 4/5) = log(7/15): with the same code, most faults in it would have shown.
SAME = NOBODY + math.log(7 / 15)


def differing(bad, build="a"):
    return differences(bad, [run("monday", build)], STATIC)


def test_the_score_of_none_of_them():
    marks = marks_at(ONE, "II")
    assert nobody(None) == NOBODY
    # With other code a fault is twice as likely as if nothing is known of the code.
    other = differing(run("bad", fastest=12.0, marks=marks), "b")
    assert nobody(other) == pytest.approx(NOBODY + math.log(2))
    assert nobody(differing(run("bad", fastest=12.0, marks=marks), None)) == NOBODY
    # No decision near the mark would have come out otherwise.
    assert nobody(differing(run("bad", marks=marks))) == pytest.approx(SAME)
    assert nobody(differing(run("bad", nearest=12.0, marks=marks))) == pytest.approx(SAME)
    # One of six that were candidates in the study.
    alone = differing(run("bad", fastest=12.0, nearest=12.0, marks=marks))
    assert nobody(alone) == pytest.approx(SAME + math.log(1 / 6))
    many = replace(alone, found=alone.found[:1] * 7)
    assert nobody(many) == pytest.approx(SAME)
    # Another parameter that is not known to differ may be it.
    assert nobody(replace(alone, is_complete=False)) == pytest.approx(SAME)
    # One that no comparison reports is a second candidate.
    silent = replace(alone.found[0], parameter="/node/radius", keys=(), replayed=())
    both = replace(alone, found=(*alone.found, silent))
    assert nobody(both) == pytest.approx(SAME + math.log(2 / 6))


# A parameter that no node reads cannot be the cause.
def test_what_nobody_reads_does_not_count():
    found = differing(run("bad", fastest=12.0, unread=2, marks=marks_at(ONE, "II")))
    assert [one.parameter for one in found.found] == ["/node/fastest", "/node/unread"]
    assert nobody(found) == pytest.approx(SAME + math.log(1 / 6))


def test_a_build_is_known_by_the_content_of_its_sources_wherever_it_lies():
    assert build_of(static_of()) == build_of(static_of(root="/elsewhere/robot"))
    assert build_of(static_of()) != build_of(static_of("b"))
    fewer = StaticInfo.of([link_unit(COMPARISONS[:-1], source_root="/ws/src/robot")])
    assert build_of(static_of()) != build_of(replace(fewer, sources=static_of().sources))
    # Built before TPC kept the digests.
    assert build_of(replace(static_of(), sources=())) is None


# As after `collect` of two builds, of which one was made without digests.
def test_a_program_of_which_a_source_is_not_known_is_not_said_to_be_the_same():
    two = replace(link_unit([comparison(9, "~two", file="two.cpp")]), link_unit="two")
    static = replace(StaticInfo.of([*static_of().units, two]), sources=static_of().sources)
    assert build_of(static).keys() == {PROGRAM}
    bad, good = run("bad"), run("monday")
    assert differences(bad, [good], static).code.is_same
    assert differences(bad, [replace(good, build={"robot/two": "a"})], static).code is None
    assert differences(replace(bad, build={"robot/two": "a"}), [good], static).code is None


# A header of another package, which the program compares in.
def test_a_source_of_another_package_counts_wherever_it_lies():
    def build(root, content):
        header = f"{root}/lib/limits.h"
        units = [
            link_unit([comparison(0, "~a", file=header)], source_root=f"{root}/robot"),
            replace(link_unit([], source_root=f"{root}/lib"), package="lib"),
        ]
        return build_of(replace(StaticInfo.of(units), sources=((header, content),)))

    assert build("/ws", "a") == build("/other", "a") != build("/other", "b")


# As the good run never ran it, a fault in it did not show there.
def test_a_program_that_ran_only_in_the_mission_is_other_code():
    late = replace(link_unit([comparison(9, "~late")]), link_unit="late")
    static = StaticInfo.of([*STATIC.units, late])
    build = {PROGRAM: "a", "robot/late": "a"}
    rows = [(t, 9, False, 1, 2) for t in range(20)]
    bad = RunValues("bad", Recording("bad", events(rows), (), 0, ns(20)), {}, build=build)
    good = replace(run("monday"), build=build)
    code = differences(bad, [good], static).code
    assert code == CodeComparison("monday", (), ("robot/late",))
    assert code.line == (
        "the code is that of the good run monday, but robot/late reported only now"
    )
    assert differences(replace(bad, recording=flight()), [good], static).code.is_same


@pytest.fixture
def folders(tmp_path):
    """Makes the folder of a recorded mission."""

    def make(name, fastest, content="a", root="/ws/src/robot", marks=()):
        folder = tmp_path / name
        folder.mkdir()
        save_recording(flight(fastest, marks=marks), folder)
        (folder / "params.yaml").write_text(f"node: {{fastest: {fastest}, nearest: 5.0}}\n")
        (folder / "run.json").write_text("{}")
        static_of(content, root).save(folder / "static.json")
        return folder

    return make


def asked(*words):
    result = CliRunner().invoke(main, [str(word) for word in words])
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.mark.parametrize("root", ["/ws/src/robot", "/elsewhere/robot"])
def test_recordings_say_what_they_were_built_from(folders, root):
    good = folders("monday", 5.0, root=root)
    bad = folders("tuesday", 12.0, marks=marks_at(FOUR, "II"))
    assert "1 parameter differs from the good run monday; the code is the same" in asked(
        "diff", good, bad
    )
    (told,) = {json.dumps(one["diagnosis"]) for one in json.loads(
        asked("rank", bad, "--reference", good, "--json"))}  # fmt: skip
    diagnosis = json.loads(told)
    assert diagnosis["accused"] == "~fastest"
    assert diagnosis["differences"]["code"] == {
        "same": True, "run": "monday", "changed": [], "unseen": [],
    }  # fmt: skip
    found = pytpc.diagnose(bad, bad / "static.json", reference=good)
    assert found.blame.confidence == pytest.approx(diagnosis["confidence"])


def test_other_sources_are_said(folders):
    good = folders("monday", 5.0, "older")
    bad = folders("tuesday", 12.0, marks=marks_at(FOUR, "II"))
    said = f"the code is not that of the good run monday: {PROGRAM} changed"
    assert said in asked("diff", good, bad)
    assert said in asked("rank", bad, "--reference", good)
    asked("report", bad, "--reference", good, "-o", bad / "page.html")
    # Terms on the page are explained where they stand.
    assert said in re.sub("<[^>]*>", "", (bad / "page.html").read_text())


def test_a_recording_without_static_information_says_nothing(folders):
    good = folders("monday", 5.0)
    bad = folders("tuesday", 12.0, marks=marks_at(FOUR, "II"))
    (good / "static.json").rename(good / "other.json")
    assert json.loads(asked("diff", good, bad, "--json"))["code"] is None
