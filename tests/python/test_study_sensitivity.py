"""Rankings by other people's marks, and what the page says of them."""

from __future__ import annotations

import json
import shutil
from collections import Counter
from dataclasses import asdict, replace
from pathlib import Path

import pytest
from click.testing import CliRunner
from observer_scripts import shared_module
from study_pages import row_of
from study_samples import Row, write_rows

from pytpc.base.errors import InputError
from pytpc_evaluation.commands.study_commands import study_group
from pytpc_evaluation.study.data import Mission, UserMark, load_mission
from pytpc_evaluation.study.dataset import Cause, Done, save_done
from pytpc_evaluation.study.judge import POSITIONS_FILE
from pytpc_evaluation.study.other_marks import SPAN_S, VARIANTS, other_marks
from pytpc_evaluation.study.people import look_on
from pytpc_evaluation.study.report import sensitivity
from pytpc_evaluation.study.report.judging import by_own_marks
from pytpc_evaluation.study.report.making import ReportOptions, make_report
from pytpc_evaluation.study.report.positions import Position, read_positions
from pytpc_evaluation.study.report.sensitivity import (
    ALONE_METHODS,
    CROWDS,
    PROGRAM,
    SENSITIVITY_FILE,
    by_others,
)

TUNING = {("type1_low", 1), ("type1_low", 2), ("fault_wires", 1), ("clean", 1)}
METHODS = {"tpc", "tpc+reference", "thesis"}


def rows_in(study: Path) -> list[Position]:
    return read_positions(study / SENSITIVITY_FILE)


def seen(
    mission: Path, causes: list[tuple[str, float, float]], people: int = 77, seconds: int = 21
) -> None:
    """What those who looked on left: the robot stood still, and this was wrong."""
    told = [{"kind": k, "start": s, "end": e, "reason": "wrong"} for k, s, e in causes]
    (mission / "causes.json").write_text(json.dumps(told))
    done = Done("", "", 1.0, 1, people, 20.0, 1.0, 41, reached=False, causes=len(causes), marks=0)
    save_done(done, mission)
    look = shared_module("rules").Look
    sights = [look(float(second), 0.0, 0.0, 0.0) for second in range(seconds)]
    shared_module("sights").save_sights(sights, look, mission / "sights.parquet")


# In both missions of type1_low it does at 6 s what it should not; nothing is seen in the others.
@pytest.fixture(scope="module")
def looked_at(study, tmp_path_factory) -> Path:
    folder = Path(shutil.copytree(study, tmp_path_factory.mktemp("others") / "study"))
    for name, seed in TUNING:
        wrong = [("I", 6.0, 6.0)] if name == "type1_low" else []
        seen(folder / f"missions/alpha/{name}/seed-{seed}", wrong)
    by_others().complete(folder, ["tuning"])
    return folder


@pytest.fixture
def own(looked_at, tmp_path) -> Path:
    return Path(shutil.copytree(looked_at, tmp_path / "own"))


@pytest.fixture
def asked(monkeypatch) -> list[str]:
    """Each mission that somebody looks at."""
    found = []

    def spy(program, env, words):
        found.append(Path(words[1]).parent.parent.name)
        look_on(program, env, words)

    monkeypatch.setattr(sensitivity, "look_on", spy)
    return found


def test_every_crowd_is_ranked_by_each_method(looked_at):
    rows = rows_in(looked_at)
    assert {(row.treatment, row.seed) for row in rows} == TUNING
    of_crowds = [row for row in rows if row.who in CROWDS]
    each = Counter((row.treatment, row.seed, row.who, row.method) for row in of_crowds)
    assert each == {
        (*m, crowd, method): 2 for m in TUNING for crowd in CROWDS for method in METHODS
    }
    assert {row.labels for row in of_crowds} == {"typed", "confused"}


def test_each_observer_is_ranked_alone_by_other_marks(looked_at):
    alone = [row for row in rows_in(looked_at) if row.who not in CROWDS]
    assert {row.who for row in alone} == {*VARIANTS}
    assert {row.labels for row in alone} == {"confused"}
    assert {row.method for row in alone} == {*ALONE_METHODS}
    observers = {mark.observer for mark in first_mission(looked_at).marks}
    own = [r for r in alone if (r.treatment, r.seed, r.method) == ("type1_low", 1, "tpc")]
    assert Counter(row.who for row in own) == dict.fromkeys(VARIANTS, len(observers))


def first_mission(folder: Path) -> Mission:
    return load_mission(folder, folder / "missions/alpha/type1_low/seed-1", "tuning")


# Marks at 9 and 14 s of an error that was seen from 6 s on.
def test_other_marks_are_made_of_those_that_were_set(looked_at):
    own = [UserMark(at * 10**9, "a", 0, "I", "II") for at in (9, 14)]
    mission = replace(
        first_mission(looked_at), marks=tuple(own), causes=(Cause("I", 6.0, 6.0, "it was wrong"),)
    )
    made = {name: other_marks(mission, name)[0].marks for name in VARIANTS}
    assert made["own"] == tuple(own)
    assert (made["first"], made["last"]) == ((own[0],), (own[1],))
    assert [(mark.right, mark.said) for mark in made["wrong-types"]] == [("II", "I")] * 2
    # The mission takes 20 s.
    assert made["late-30"] == ()
    assert [mark.time_ns for mark in made["late-15"]] == []
    for mark, told in zip(own, made["own-began"], strict=True):
        early, late = told.mark("confused").began
        assert early - late <= SPAN_S
        assert told.mark("confused").time_ns == mark.time_ns


# ~low alone has flopped before any mark, so whoever believes that it is of type I puts it first.
# Whose delays are half as long marks within the 14 s that are left what others do not.
def test_positions_are_by_the_marks_of_the_crowd(looked_at):
    found = {
        row.who: row
        for row in rows_in(looked_at)
        if (row.treatment, row.seed, row.method, row.labels) == ("type1_low", 1, "thesis", "typed")
    }
    assert {row.position for row in found.values() if row.marks} == {1.0}
    assert {row.position for row in found.values() if not row.marks} <= {None}
    assert found["fast"].marks >= found["thesis"].marks >= found["slow"].marks
    assert found["thesis"].marks == found["coin"].marks > 0
    assert found["alone"].marks <= 2


# The study's own people are the first crowd.
def test_the_first_crowd_ranks_as_the_study_does(own, tmp_path):
    for name, seed in TUNING:
        mission = own / f"missions/alpha/{name}/seed-{seed}"
        words = ["--causes", str(mission / "causes.json"), "--seed", "77"]
        words += ["--sights", str(mission / "sights.parquet"), "--folder", str(tmp_path)]
        look_on(PROGRAM, {}, words)
        shutil.copy(tmp_path / "thesis.parquet", mission / "marks.parquet")
    by_own_marks().complete(own, ["tuning"])

    def verdicts(rows: list[Position], who: str) -> dict[tuple[object, ...], tuple[object, ...]]:
        return {
            (r.treatment, r.seed, r.method, r.labels): (r.position, r.tied, r.confidence, r.marks)
            for r in rows
            if r.half == "tuning" and r.who == who and r.method in METHODS
        }

    study = verdicts(read_positions(own / POSITIONS_FILE), "all")
    others = verdicts(rows_in(own), CROWDS[0])
    assert others == {place: study[place] for place in others}
    assert len(others) == 4 * 3 * 2


def test_what_is_known_is_kept(own, asked):
    before = (own / SENSITIVITY_FILE).read_bytes()
    by_others().complete(own, ["tuning"])
    assert asked == []
    by_others().complete(own, ["tuning"], again=True, jobs=1)
    assert sorted(asked) == ["clean", "fault_wires", "type1_low", "type1_low"]
    assert (own / SENSITIVITY_FILE).read_bytes() == before


@pytest.mark.parametrize(
    "otherwise",
    [{"causes": [("I", 3.0, 3.0)]}, {"people": 78}, {"seconds": 20}],
    ids=["causes", "people", "sights"],
)
def test_a_mission_that_was_seen_otherwise_is_looked_at_again(own, asked, otherwise):
    seen(own / "missions/alpha/clean/seed-1", **{"causes": [], **otherwise})
    by_others().complete(own, ["tuning"])
    assert asked == ["clean"]


def test_a_mission_that_is_not_whole_does_not_keep_others_from_being_ranked(own):
    (own / SENSITIVITY_FILE).unlink()
    (own / "missions/alpha/clean/seed-1/done.json").write_text("{}")
    with pytest.raises(InputError, match=r"clean/seed-1/done\.json: does not say who looked on"):
        by_others().complete(own, ["tuning"])
    assert {(row.treatment, row.seed) for row in rows_in(own)} == TUNING - {("clean", 1)}


def test_the_command(own):
    before = (own / SENSITIVITY_FILE).read_bytes()
    (own / SENSITIVITY_FILE).unlink()
    result = CliRunner().invoke(study_group, ["sensitivity", "--out", str(own), "--jobs", "1"])
    assert result.exit_code == 0, result.output
    assert (own / SENSITIVITY_FILE).read_bytes() == before


# type2_high has the first place, the recorded mission's treatment the 5th: half of the treatments
# are found, and each draw of two has none, one or both. What is clean is no treatment to find.
# Of one treatment that is not found the interval ends at 1 - 0.025 (Clopper and Pearson).
def test_the_page_shows_them(own_study, tmp_path):
    high = ("alpha", "type2_high", "type2", "held-back", 1, "typed")
    picture = ("image_capture", "type2_min_coverage_limit", "type2", "held-back", 1, "typed")
    rows = [
        Row(*high, 1, marks=5, who="fast"),
        Row(*picture, 5, marks=2, who="fast", parameters=41, round=2),
        Row(*high, 4, marks=5, who="fast", method="thesis"),
        Row(*picture, 1, marks=2, who="fast", method="thesis", parameters=41, round=2),
        Row(*high, None, marks=0, who="alone"),
        Row("alpha", "clean", "clean", "held-back", 1, "typed", None, 0.2, who="fast", marks=50),
    ]
    write_rows(own_study / SENSITIVITY_FILE, [asdict(row) for row in rows])
    made = make_report(own_study, tmp_path / "study.md", ReportOptions(["held-back"], draw=False))
    tables = made.numbers["tables"]
    assert "others-tuning" not in tables
    text = made.page.read_text().replace("Second round alone, top 3", "# Others again\n")
    held_back = "Other people"
    assert row_of(text, held_back, "delays x 0.5") == [
        "typed", "2", "3.5", "50 [0, 100]", "50 [0, 100]"
    ]  # fmt: skip
    assert row_of(text, held_back, "user 2 alone") == ["typed", "1", "0.0", "0 [0, 98]", "-"]
    names = [row["people"] for row in tables["others-held-back"]["rows"]]
    assert names == ["delays x 0.5", "user 2 alone"]
    (second,) = tables["others-second-round"]["rows"]
    assert second["people"] == "delays x 0.5"


def troubles_of(study: Path, target: Path) -> list[str]:
    made = make_report(
        study, target / "study.md", ReportOptions(["tuning", "held-back"], draw=False)
    )
    return [trouble for trouble in made.troubles if "other people" in trouble]


# The other half has none, which nobody asked for.
def test_what_is_out_of_date_is_said(own, tmp_path):
    assert troubles_of(own, tmp_path) == []
    seen(own / "missions/alpha/clean/seed-1", [], people=78)
    said = "Rankings by other people's marks are out of date: `study sensitivity`."
    assert troubles_of(own, tmp_path) == [said]


def test_without_them_the_page_says_nothing_of_them(study_text, made_study):
    assert "Other people" not in study_text
    assert not any("ensitivity" in trouble for trouble in made_study.troubles)
