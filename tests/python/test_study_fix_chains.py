"""Conversations of ``pytpc fix`` in the study: one observer, whose marks decide what is next."""

from __future__ import annotations

import json
from dataclasses import asdict, replace

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fix_samples import PARAMS, STATIC, recorded
from mission_samples import ns
from study_pages import row_of
from study_samples import make_study

from pytpc_evaluation.study.data import UserMark
from pytpc_evaluation.study.fix_chains import observer_of
from pytpc_evaluation.study.report.making import ReportOptions, make_report
from pytpc_evaluation.study.suggestion_chains import Chain, Try
from pytpc_evaluation.study.suggestions import Asked, next_round

MISSION = "robot/type1_speed/seed-1"
ASKED = Asked(variants=["fix-2-runs"])
STARTS = (20, 50, 80, 110)


@pytest.fixture
def out(tmp_path):
    """The robot of `fix_samples` as one of the study: today it was too slow, or so one of them saw.

    Two good runs have a speed and a tilt of 4. As in its own tests the tilt is a little likelier.
    """
    (tmp_path / "src/robot").mkdir(parents=True)
    (tmp_path / "src/robot/params.yaml").write_text(PARAMS)
    STATIC.save(tmp_path / "systems/robot/static.json")
    row = {"system": "robot", "treatment": "type1_speed", "type": "type1", "half": "tuning"}
    row |= {"parameter": "~max_speed", "node": "/node", "old": 4.0, "new": 1.0, "seed": 1}
    (tmp_path / "study.json").write_text(json.dumps({"missions": [row]}))
    fly(tmp_path, f"missions/{MISSION}", marks=STARTS)
    for number in (11, 12):
        fly(tmp_path, f"good/robot/seed-{number}", speed=4.0, tilt=4.0, at=1000 * number)
    return tmp_path


def fly(out, folder, *, marks=(), who="user2", came=None, **values):
    """A flight in its folder, with one observer's marks, and what the study says ``came`` of it."""
    recorded(out, folder, marks=(), **values)
    at = values.get("at", 0)
    rows = [
        {"time_ns": ns(at + one + 8), "observer": who, "cause": 0, "right": "II", "said": "I"}
        for one in marks
    ]
    columns = {name: pa.array([row[name] for row in rows], kind) for name, kind in KINDS.items()}
    pq.write_table(pa.table(columns), out / folder / "marks.parquet")
    (out / folder / "done.json").write_text("{}")
    if came is not None:
        gone, new = came
        said = {"gone": gone, "new": new, "errors": []}
        (out / folder / "suggestion.json").write_text(json.dumps(said))


KINDS = {
    "time_ns": pa.int64(),
    "observer": pa.string(),
    "cause": pa.int64(),
    "right": pa.string(),
    "said": pa.string(),
}


def wanted(out):
    document = json.loads((out / "results/suggestions-wanted.json").read_text())
    return [
        {name: one[name] for name in ("parameter", "value", "kept") if name in one}
        for one in document
    ]


# The same marks again: it was not the tilt. Nobody marks with the other speed.
def test_the_observer_s_marks_decide_what_is_tried_next(out):
    (chain,) = next_round(out, ASKED)
    assert chain.observer == "user2"
    assert wanted(out) == [{"parameter": "/node/max_tilt", "value": 4.0}]
    fly(out, chain.flown(), marks=STARTS, tilt=4.0, at=2000, came=(False, False))
    (chain,) = next_round(out, ASKED)
    assert wanted(out) == [{"parameter": "/node/max_speed", "value": 4.0}]
    assert chain.flown() == f"suggested/{MISSION}/node.max_speed=4.0"
    fly(out, chain.flown(), speed=4.0, at=3000, came=(True, False))
    (chain,) = next_round(out, ASKED)
    assert (wanted(out), chain.is_over) == ([], True)
    rows = pq.read_table(out / "results/suggestion-tries.parquet").to_pylist()
    assert [(row["verdict"], row["gone"], row["observer"]) for row in rows] == [
        ("same", False, "user2"),
        ("fixed", True, "user2"),
    ]


# One of four marks is left. The other parameter is set beside it; a further value of the same one
# would take its place.
def test_what_helped_stays_set(out):
    (chain,) = next_round(out, ASKED)
    fly(out, chain.flown(), marks=STARTS[:1], tilt=4.0, at=2000, came=(False, False))
    (chain,) = next_round(out, ASKED)
    tilt = {"parameter": "/node/max_tilt", "node": "", "value": 4.0}
    assert wanted(out) == [{"parameter": "/node/max_speed", "value": 4.0, "kept": [tilt]}]
    assert chain.flown() == f"suggested/{MISSION}/node.max_tilt=4.0+node.max_speed=4.0"
    assert chain.flown(0) == f"suggested/{MISSION}/node.max_tilt=4.0"
    further = replace(chain.tries[-1], parameter="/node/max_tilt", value=8.0)
    other = replace(chain, tries=[chain.tries[0], further])
    assert [one.label for one in other.settings()] == ["node.max_tilt=8.0"]


# What the study knows does not end it: the observer set a mark all the same.
def test_a_false_alarm_keeps_it_going(out):
    (chain,) = next_round(out, ASKED)
    fly(out, chain.flown(), marks=(33, 70, 90), tilt=4.0, at=2000, came=(True, False))
    (chain,) = next_round(out, ASKED)
    assert (chain.tries[0].verdict, chain.is_over, len(chain.tries)) == ("same", False, 2)


def test_nobody_begins_who_saw_nothing(out):
    fly(out, f"missions/{MISSION}")
    (chain,) = next_round(out, ASKED)
    assert (chain.observer, chain.tries[0].reason) == ("", "nobody set a mark")


# What no file sets is not tried: `--command` passes it over.
def test_what_no_file_sets_is_passed_over(out):
    path = out / "missions" / MISSION / "origins.json"
    document = json.loads(path.read_text())
    document["parameters"]["/node/max_tilt"] = {"kind": "unknown", "value": 2.0}
    path.write_text(json.dumps(document))
    next_round(out, ASKED)
    assert wanted(out) == [{"parameter": "/node/max_speed", "value": 4.0}]


def test_one_of_those_who_marked_is_drawn():
    marks = [UserMark(0, user, 0, "I", "I") for user in ("user1", "user3")]
    drawn = {observer_of(f"robot/type1_a/seed-{number}", marks) for number in range(30)}
    assert drawn == {"user1", "user3"}
    assert observer_of(MISSION, marks) == observer_of(MISSION, list(reversed(marks)))
    assert observer_of(MISSION, []) == ""


def chain(treatment, *tries, variant="fix", observer="user1"):
    """Each of ``tries`` is what was said, whether the error is gone, and whether a new one came."""
    made = [
        Try("/node/high", None, 1.0 + n, "log", gone, new, fix={"verdict": said})
        for n, (said, gone, new) in enumerate(tries)
    ]
    return Chain(
        "alpha", treatment, "type2", "held-back", 1, variant, 1.0, 2.0, (), made, "", observer
    )


# Of two treatments: in the one the error is gone with the second try, after which a false alarm and
# a third one, in vain, follow; the first try made a new error, and was taken back. In the other one
# nobody marks after the first try, though the error is still there, and a new one. Tries: one of
# three has a new error and one of one, (1/3 + 1) / 2. Nobody marked the third treatment.
def test_the_page_tells_what_came_of_them(tmp_path):
    folder = make_study(tmp_path / "study")
    chains = [
        chain("type2_high", ("same", False, True), ("same", True, False), ("same", False, False)),
        chain("type2_low", ("fixed", False, True)),
        chain("type2_none", observer=""),
    ]
    text = json.dumps([asdict(one) for one in chains])
    (folder / "results/suggestion-chains.json").write_text(text)
    target = tmp_path / "study.md"
    made = make_report(folder, target, ReportOptions(draw=False))
    rows = made.numbers["tables"]["conversations"]["rows"]
    names = ("error gone %", "rightly ended %", "wrongly ended %")
    own = [row for row in rows if row["part"] == "held-back"]
    assert [(row["tries"], *(row[name].split()[0] for name in names)) for row in own] == [
        (1, "0", "0", "50"),
        (2, "50", "0", "50"),
        (3, "50", "0", "50"),
    ]
    last = row_of(target.read_text(), "Fixed try by try", "fix", "held-back", "3")
    # Clopper and Pearson for 1 of 2: 0.013 and 0.987.
    assert last[:2] == ["2", "50 [1, 99]"]
    assert [last[5].split()[0], last[6].split()[0]] == ["67", "50"]
    figures = {one["name"]: one["value"] for one in made.numbers["figures"]}
    assert figures["fix-gone-held-back"] == 50.0
    assert "fix-2-runs-gone-held-back" not in figures
