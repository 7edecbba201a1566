from __future__ import annotations

import json
import math

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from mission_samples import comparison, events, key, ns, static_info

from pytpc.base.errors import InputError
from pytpc.diagnosis.importance import importance_of
from pytpc.diagnosis.ranking.posterior import diagnose_log
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording, save_recording
from pytpc.recording.parameter_change import Change
from pytpc_evaluation.study.case import Case
from pytpc_evaluation.study.data import Mission, UserMark, missions
from pytpc_evaluation.study.fit import REASONED, Batch, fit, samples
from pytpc_evaluation.study.judge import judge, position, save_positions
from pytpc_evaluation.study.methods import METHODS
from pytpc_evaluation.study.methods.importance import importance, windows
from pytpc_evaluation.study.methods.ours import _with_other_defaults
from pytpc_evaluation.study.methods.plain import (
    by_chance,
    differs_at_random,
    largest_change,
    recent_change,
    turned_decisions,
)
from pytpc_evaluation.study.methods.thesis import thesis, thesis_doubt

STATIC = static_info(
    comparison(0, "~a"), comparison(1, "~b"), comparison(2, "~c"), comparison(3, "~never")
)


def case(rows, marks, end=100.0, **known):
    recording = Recording("mission", events(rows), tuple(marks), 0, ns(end))
    return Case(recording, STATIC, **known)


# Five windows, the first two failed. True in both and in one that passed; evaluated in all:
# Increase = 2/3 - 2/5 = 4/15. log(2)/log(2) = 1. Importance = 2 / (15/4 + 1) = 8/19.
def test_importance_by_hand():
    failed = np.array([1, 1, 0, 0, 0], bool)
    true = np.array([1, 1, 1, 0, 0], bool)
    assert importance_of(true, np.ones(5, bool), failed) == pytest.approx(8 / 19)


# Of four that failed, true in two: log(2)/log(4) = 1/2; in none that passed of two:
# Increase = 1 - 4/6 = 1/3, Importance = 2 / (3 + 2) = 0.4.
def test_importance_counts_how_many_failures_a_predicate_explains():
    failed = np.array([1, 1, 1, 1, 0, 0], bool)
    true = np.array([1, 1, 0, 0, 0, 0], bool)
    assert importance_of(true, np.ones(6, bool), failed) == pytest.approx(0.4)
    once = np.array([1, 0, 0, 0, 0, 0], bool)
    assert importance_of(once, np.ones(6, bool), failed) == 0.0
    assert importance_of(np.ones(6, bool), np.ones(6, bool), failed) == 0.0
    assert importance_of(~failed, np.ones(6, bool), failed) == 0.0


# One failure: Increase = 1 - 1/3 = 2/3, all of the recall: 2 / (3/2 + 1) = 0.8.
def test_importance_of_a_single_failure():
    failed = np.array([1, 0, 0], bool)
    assert importance_of(failed, np.ones(3, bool), failed) == pytest.approx(0.8)


# Before the mark at 20 s: [8, 20]. Before that 8 s, more than half a window. After it 31 s: two
# whole windows and one of 7 s.
def test_windows_before_marks_fail_and_the_rest_passes():
    begins, ends, failed = windows(np.array([ns(20)]), 0, ns(51), ns(12))
    assert failed.tolist() == [True, False, False, False, False]
    assert (begins / 1e9).round(6).tolist() == [8, 0, 20, 32, 44]
    assert (ends / 1e9).round(6).tolist() == [20, 8, 32, 44, 51]


def test_windows_of_marks_near_each_other_overlap_and_leave_no_gap():
    begins, _, failed = windows(np.array([ns(20), ns(23), ns(23)]), 0, ns(24), ns(12))
    assert failed.tolist() == [True, True, False]
    assert (begins / 1e9).tolist() == [8, 11, 0]


# a is true in [8, 20] alone, b always, c is evaluated in it and always false.
def test_importance_names_what_is_true_where_it_fails():
    rows = [(t, 0, 8 <= t <= 20, 1, 2) for t in range(0, 52, 2)]
    rows += [(t, 1, 1, 1, 2) for t in range(0, 52, 2)]
    rows += [(12, 2, 0, 1, 2)]
    found = importance(case(rows, [Mark(ns(20), None)], end=51))
    assert found.order[0] == "~a"
    assert "~b" not in found.order
    assert math.isnan(found.confidence)


# Type I at 50 s: a (50-49)*2 = 2 before b (50-40)*2 = 20: ranks 1 and 3/4 of four. At 60 s b has
# changed at 59 s, too: a 11*2 = 22, b 1*3 = 3: ranks 3/4 and 1. Both have the mean 7/8: tied.
def test_the_thesis_is_joined_by_mean_rank():
    rows = [(1, 0, 0, 1, 2), (49, 0, 1, 3, 2), (1, 1, 0, 1, 2), (40, 1, 1, 3, 2), (59, 1, 0, 1, 2)]
    marks = [Mark(ns(50), "I"), Mark(ns(60), "I")]
    found = thesis(case(rows, marks))
    assert (found.order, found.scores) == (("~a", "~b"), (0.875, 0.875))
    found = thesis(case(rows, marks[:1]))
    assert (found.order, found.scores) == (("~a", "~b"), (1.0, 0.75))


# By type II alone c is first (it is the only one in the window); doubted, a comes in by type I with
# 45/70 of its rank.
def test_the_doubting_thesis_brings_in_the_other_type():
    rows = [(1, 0, 0, 1, 2), (20, 0, 1, 3, 2), (49, 2, 0, 1, 2), (50, 2, 0, 1.5, 2)]
    marks = [Mark(ns(50), "II")]
    assert thesis(case(rows, marks)).order == ("~c",)
    found = thesis_doubt(case(rows, marks))
    assert (found.order, found.scores) == (("~c", "~a"), (1.0, pytest.approx(45 / 70)))


def test_the_last_change_is_the_first_suspect():
    changes = tuple(Change(name, "/node", 1.0, 2.0) for name in ("~a", "~c", "~elsewhere", "~a"))
    assert recent_change(case([], [], changes=changes)).order == ("~a", "~c")
    assert recent_change(case([], [])).order == ()


def test_the_largest_change_is_by_its_part_of_the_value():
    changes = (
        Change("~a", "/n", 100.0, 103.0),
        Change("~b", "/n", 0.1, 0.2),
        Change("~c", "/n", 0, 0),
    )
    assert largest_change(case([], [], changes=changes)).order == ("~b", "~a", "~c")


# Of a the good run's 3.5 turns the 3 alone; of b its 5 turns one in each of
# its nodes; c is as it was, and ~never is in neither.
def test_what_the_good_run_would_have_turned():
    rows = [(t, 0, t > 2, t, 2) for t in range(1, 5)] + [(1, 2, 0, 1, 2), (2, 2, 0, 1, 2)]
    rows += [(t, 1, 1, 4 * t, 3, node) for t in (1, 2) for node in ("/left", "/right")]
    clean = Recording(
        "clean", events([(1, 0, 0, 1, 3.5), (1, 1, 0, 1, 5), (1, 2, 0, 1, 2)]), (), 0, ns(9)
    )
    known = case(rows, [], reference=clean)
    found = turned_decisions(known)
    assert (found.order, found.scores) == (("~b", "~a"), (2.0, 1.0))
    tied = differs_at_random(known)
    assert (set(tied.order), tied.scores) == ({"~a", "~b"}, (0.0, 0.0))
    assert turned_decisions(case(rows, [])) == differs_at_random(case(rows, []))


# Of four that share the places 1 to 4.
def test_chance_is_exact():
    names = ("~a", "~b", "~c", "~never")
    assert position(by_chance(case([], [])), "~b", names) == (2.5, 4)


def mission(marks, parameter="~a", rows=((1, 0, 0, 1, 2), (49, 0, 1, 3, 2), (10, 1, 0, 1, 2))):
    recording = Recording("mission", events(rows), (), 0, ns(100))
    kind = "clean" if parameter is None else "type1"
    return Mission(
        "robot", kind, kind, "tuning", 1, parameter, None, recording, STATIC, marks, None, ()
    )


def test_every_method_is_judged_by_all_marks_and_by_each_user():
    marks = (
        UserMark(ns(50), "user1", 0, "I", "II"),
        UserMark(ns(52), "user2", 0, "I", "I"),
    )
    rows = list(judge(mission(marks), METHODS))
    assert len(rows) == 3 * 3 * len(METHODS)
    assert {(row.who, row.marks) for row in rows} == {("all", 2), ("user1", 1), ("user2", 1)}
    (first,) = [r for r in rows if (r.method, r.labels, r.who) == ("thesis", "typed", "all")]
    assert (first.position, first.parameters, first.top, first.confidence) == (1, 4, "~a", None)
    assert all(row.confidence is None for row in rows if not row.method.startswith("tpc"))
    assert all(row.confidence is not None for row in rows if row.method.startswith("tpc"))


def test_labels_are_what_the_methods_see():
    seen = []
    marks = (UserMark(ns(50), "user1", 0, "I", "II"),)
    method = {"spy": lambda one: seen.append(one.recording.marks[0].type) or thesis(one)}
    list(judge(mission(marks), method, users=[]))
    assert seen == ["I", None, "II"]


def test_a_mission_without_marks_is_a_miss_and_no_accusation():
    rows = list(judge(mission(()), METHODS))
    assert len(rows) == 3 * len(METHODS)
    assert {(r.position, r.confidence, r.marks, r.top) for r in rows} == {(None, None, 0, "")}


def test_a_clean_mission_has_no_position():
    marks = (UserMark(ns(50), "user1", -1, "I", "II"),)
    rows = list(judge(mission(marks, None), METHODS))
    assert {row.position for row in rows} == {None}
    assert all(row.top for row in rows if row.method == "tpc")


def study_folder(out, halves):
    """Missions of one system, by treatment -> half; all of them flown."""
    rows = []
    for name, half in halves.items():
        folder = f"missions/robot/{name}/seed-1"
        rows.append({"folder": folder, "half": half})
        recording = Recording(name, events([(1, 0, 0, 1, 2), (9, 0, 1, 3, 2)]), (), 0, ns(20))
        (out / folder).mkdir(parents=True)
        save_recording(recording, out / folder)
        document = {"type": name.split("_")[0], "parameter": "~a", "node": "/node"}
        (out / folder / "treatment.json").write_text(json.dumps(document))
        change = {"parameter": "~a", "node": "/node", "old": 1.0, "new": 2.0}
        (out / folder / "changes.json").write_text(json.dumps([change]))
        (out / folder / "done.json").write_text("{}")
        mark = {"time_ns": ns(12), "observer": "user1", "cause": 0, "right": "I", "said": "II"}
        pq.write_table(pa.Table.from_pylist([mark]), out / folder / "marks.parquet")
    (out / "study.json").write_text(json.dumps({"missions": rows}))
    (out / "systems" / "robot").mkdir(parents=True)
    STATIC.save(out / "systems" / "robot" / "static.json")


def test_what_is_held_back_is_not_even_read(tmp_path):
    study_folder(tmp_path, {"type1_a": "tuning", "type1_b": "held-back", "type2_a": "tuning"})
    (tmp_path / "missions/robot/type1_b/seed-1/events.parquet").write_bytes(b"not to be read")
    found = list(missions(tmp_path))
    assert [(m.treatment, m.type, m.half, m.seed) for m in found] == [
        ("type1_a", "type1", "tuning", 1),
        ("type2_a", "type2", "tuning", 1),
    ]
    assert found[0].marks == (UserMark(ns(12), "user1", 0, "I", "II"),)
    assert found[0].changes == (Change("~a", "/node", 1.0, 2.0),)
    assert found[0].case("confused").recording.marks == (Mark(ns(12), "II", "user1"),)
    with pytest.raises(InputError, match=r"events\.parquet"):
        list(missions(tmp_path, ["held-back"]))


def test_a_mission_that_was_not_flown_to_its_end_is_left_out(tmp_path):
    study_folder(tmp_path, {"type1_a": "tuning", "type2_a": "tuning"})
    (tmp_path / "missions/robot/type1_a/seed-1/done.json").unlink()
    assert [m.treatment for m in missions(tmp_path)] == ["type2_a"]


@pytest.mark.parametrize("text", ["[]", "{}", '{"missions": [{"half": "tuning"}]}'])
def test_a_folder_without_a_plan_is_refused(tmp_path, text):
    (tmp_path / "study.json").write_text(text)
    with pytest.raises(InputError, match="not a study's file"):
        list(missions(tmp_path))


def test_the_table_of_positions_is_written(tmp_path):
    marks = (UserMark(ns(50), "user1", 0, "I", "II"),)
    save_positions(judge(mission(marks), {"thesis": thesis}), tmp_path)
    table = pq.read_table(tmp_path / "results" / "positions.parquet")
    assert table.num_rows == 6
    assert table.column("position")[0].as_py() == 1.0
    assert table.column("confidence")[0].as_py() is None


# A fit on one mission cannot but believe what it saw: the loss falls, and weights stay near.
def test_the_fit_lowers_the_loss_and_is_the_same_again():
    marks = (UserMark(ns(50), "user1", 0, "I", "I"),)
    found = samples(mission(marks))
    assert len(found) == 6
    assert found[0].right == (0,)
    before = Batch.of(found).loss(REASONED)
    weights = fit(found)
    assert Batch.of(found).loss(weights) < before
    assert weights == fit(found)
    assert weights.flat == pytest.approx(REASONED.flat, abs=1.0)


def test_the_loss_is_that_of_the_posterior():
    marks = (UserMark(ns(50), "user1", 0, "I", "I"),)
    (sample, *_) = samples(mission(marks))
    case = mission(marks).case("typed")
    found = diagnose_log(case.recording, STATIC, weights=REASONED)
    assert Batch.of([sample]).loss(REASONED) == pytest.approx(-math.log(found.posterior[0]))


# Only the defaults are others, drawn by the mission: the same each time.
def test_other_defaults_are_drawn_for_each_mission():
    found = [comparison(n, f"~p{n}", default=value) for n, value in enumerate((2.0, 0.0, True) * 9)]
    static = static_info(*found, comparison(99, "~unknown"))
    rows = [(t, n, t > 5, t, 5) for t in range(10) for n in range(27)]
    mission = Recording("m", events(rows), (Mark(ns(8), "I"),), 0, ns(10))
    drawn = [_with_other_defaults(Case(mission, static)) for _ in range(2)]
    assert drawn[0] == drawn[1]
    changed = [
        (before.default, after.default)
        for before, after in zip(found, drawn[0].units[0].comparisons, strict=False)
        if before.default != after.default
    ]
    assert 5 < len(changed) < 17
    assert all(2 / 3 <= after <= 6 for before, after in changed if before == 2.0)
    assert {after for before, after in changed if before == 0.0} == {1.0}
    assert {after for before, after in changed if before is True} == {False}
    assert drawn[0].comparisons[key(99)].default is None
