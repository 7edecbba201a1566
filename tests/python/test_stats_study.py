"""Tables 6.13 to 6.16 of small missions, worked out by hand, and how missions are found."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from mission_samples import SummaryBuilder, comparison, events, key, ns, static_info

from pytpc.base.errors import InputError
from pytpc.recording.events import Events
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording, save_recording
from pytpc.recording.summaries import Summary
from pytpc.static.link_unit import Transform
from pytpc_evaluation.stats.delays import delays_of, error_start
from pytpc_evaluation.stats.found import found_in, found_table
from pytpc_evaluation.stats.marked import MarksOfTrial, confusion_table, marks_table
from pytpc_evaluation.stats.missions import StudyMission, Trial, in_order, load_missions, users_of
from pytpc_evaluation.stats.thesis_tables import NUMBERS, study_complaints, thesis_tables
from pytpc_evaluation.treatment import Treatment, TreatmentType

# 0 is the changed one, 1 and 2 are others; 3 is a flag; 4 compares with twice its parameter.
STATIC = static_info(
    comparison(0, "~limit", ">"),
    comparison(1, "~idle", "<"),
    comparison(2, "~faces", ">="),
    comparison(3, "~use_gps", "flag"),
    comparison(4, "~half", ">", transform=Transform("affine", 2.0, 0.0, "2 * x")),
)


def treatment(kind: TreatmentType, parameter="~limit", old=0.035, new=0.058, name="") -> Treatment:
    if kind in {"clean", "fault"}:
        return Treatment(name or kind, kind, None, None, None, None, {}, "", Path("p.yaml"))
    return Treatment(name or kind, kind, parameter, "/node", old, new, {}, "", Path("p.yaml"))


def mission(rows=(), marks=(), given: Treatment | None = None, **changes) -> StudyMission:
    recording = Recording("m", events(rows), tuple(marks), 0, ns(100))
    return StudyMission("m", replace(recording, **changes), given)


# At 1 s both thresholds say yes. At 2 s only the old one does: it would not have flopped. At 3 s
# neither; it would have flopped to what it has. At 4 s the old one would have flopped to yes.
MISSED = [
    (1, 0, 1, 0.13, 0.058),
    (2, 0, 0, 0.055, 0.058),
    (3, 0, 0, 0.02, 0.058),
    (4, 0, 0, 0.05, 0.058),
    (5, 0, 0, 0.055, 0.058),
]
# Users: a marks before, then at 6; b twice, at 10 and 12; c only before.
MARKS = [
    Mark(ns(3.5), "II", "a"),
    Mark(ns(6), "I", "a"),
    Mark(ns(10), "II", "b"),
    Mark(ns(12), "II", "b"),
    Mark(ns(3.9), "I", "c"),
]


def test_an_error_of_type2_begins_when_it_should_have_flopped():
    trial = Trial("t", mission(MISSED, MARKS, treatment("type2")))
    found = delays_of(trial, STATIC)
    assert found is not None
    assert (found.start, found.delays) == (4.0, {"a": 2.0, "b": 6.0})


# The observer's clock says 2020, the robot's begins at 0.
def test_marks_on_another_clock_have_no_delay_and_are_told_of():
    marks = [Mark(ns(1.6e9), "II", "a"), Mark(ns(6), "II", "b")]
    given = mission(MISSED, marks, treatment("type2"))
    found = delays_of(Trial("t", given), STATIC)
    assert found is not None
    assert found.delays == {"b": 2.0}
    (said,) = study_complaints(given, STATIC)
    assert said.startswith("1 of 2 marks are on another clock than the reports")


def test_an_error_of_type1_begins_with_the_first_flop():
    # The flop of ~idle at 1.5 s is none of ~limit, whose first is from 1 to 2 s.
    rows = [(1, 1, 0, 1, 2), (1.5, 1, 1, 3, 2), *MISSED]
    found = delays_of(Trial("t", mission(rows, MARKS, treatment("type1"))), STATIC)
    assert found is not None
    assert (found.start, found.delays) == (2.0, {"a": 1.5, "b": 8.0, "c": 1.9})


def test_evaluations_in_another_node_begin_nothing():
    other = [(*row, "/other") for row in MISSED]
    shifted = [(row[0] + 50, *row[1:]) for row in MISSED]
    assert error_start(mission([*other, *shifted], (), treatment("type2")), STATIC) == ns(54)
    # Without any in the node of the treatment, those that there are count.
    assert error_start(mission(other, (), treatment("type2")), STATIC) == ns(4)


def of_objects(given: StudyMission) -> StudyMission:
    """The same, where what key 9 names is evaluated by a second object of ~limit's class."""
    keys = tuple(f"{key(0)}#2" if one == key(9) else one for one in given.recording.events.keys)
    table = replace(given.recording.events, keys=keys)
    return replace(given, recording=replace(given.recording, events=table))


# Only the second object evaluates; what it does is what the one of the other tests does.
def test_an_error_of_the_second_object_begins_and_is_found():
    rows = [(at, 9, *rest) for at, _, *rest in MISSED]
    for kind, start in (("type1", 2), ("type2", 4)):
        assert error_start(of_objects(mission(rows, (), treatment(kind))), STATIC) == ns(start)
    marked = of_objects(mission(rows, [Mark(ns(10), "I")], treatment("type1")))
    found = found_in(Trial("t", marked), STATIC)
    assert found is not None
    # (10 - 2) * (1 + 1), see test_table_6_16_by_hand.
    assert [(mark.rank, mark.score) for mark in found.marks] == [(1.0, 16.0)]


# A flag that is off from the beginning should have been on at its first evaluation.
def test_a_flag_is_missed_at_once():
    rows = [(7, 3, 0, 0, 0), (8, 3, 0, 0, 0)]
    off = treatment("type2", "~use_gps", old=1.0, new=0.0)
    assert error_start(mission(rows, (), off), STATIC) == ns(7)
    assert error_start(mission(rows, (), replace(off, old=0.0)), STATIC) is None


# The old value 2 gives the threshold 4: 5 is above, 3 is not. The new one, 4, gives 8.
def test_the_old_value_goes_through_the_arithmetic():
    rows = [(1, 4, 0, 3, 8), (2, 4, 0, 5, 8)]
    half = treatment("type2", "~half", old=2.0, new=4.0)
    assert error_start(mission(rows, (), half), STATIC) == ns(2)


def test_an_error_that_never_began_has_no_delay():
    for kind in ("type1", "type2"):
        found = delays_of(Trial("t", mission([MISSED[0]], MARKS, treatment(kind))), STATIC)
        assert found is not None
        assert (found.start, found.delays) == (None, {})
    assert delays_of(Trial("t", mission(MISSED, MARKS, treatment("clean"))), STATIC) is None
    assert delays_of(Trial("t", mission(MISSED, MARKS)), STATIC) is None


def kept(begin: float, low: float, high: float, last: float) -> Summary:
    """A second of evaluations against 0.058 that were all false."""
    return Summary(
        key(0), "/node", ns(begin), ns(begin + 0.9), 9, 0, 9, 0, False, False, last, 0.058,
        low - 0.058, high - 0.058, 0.0, 0.01, low, 0.058,
    )  # fmt: skip


def summaries(*rows: Summary):
    builder = SummaryBuilder()
    for row in rows:
        builder.add(row)
    return builder.build()


def start_of(*rows: Summary) -> int | None:
    given = mission([], (), treatment("type2"), summaries=summaries(*rows))
    return error_start(given, STATIC)


# Against 0.035: the second from 1 s stays below, that from 2 s is above all the time, having been
# below before: it should have flopped within it, and its begin is taken.
def test_summaries_tell_when_it_should_have_flopped():
    below = kept(1, 0.01, 0.02, 0.02)
    assert start_of(below) is None
    assert start_of(below, kept(2, 0.04, 0.05, 0.05)) == ns(2)
    # The first of all counts, as a first evaluation does.
    assert start_of(kept(0, 0.04, 0.05, 0.05), below) == ns(0)


# The first second is above both thresholds and came out so. In the next it is above the old one
# alone, which would not have flopped. In the third it goes below that and comes back.
def test_summaries_in_which_it_went_there_and_back():
    above = replace(kept(0, 0.06, 0.07, 0.06), result=True, res=True)
    between, back = kept(1, 0.04, 0.05, 0.05), kept(2, 0.02, 0.05, 0.05)
    assert start_of(above, between) is None
    assert start_of(above, between, back) == ns(2)


# At 10 s ~limit has flopped at 2 s, once: 8 * 2 = 16, ~idle at 9 s: 1 * 2 = 2. Five parameters:
# ~idle has rank 1, ~limit 1 - 1/5 = 0.8. At 1.5 s nothing has flopped: rank 0, no score. Type II
# at 10 s, window [-2, 10]: ~limit |0.13 - 0.058| + 0.003 + 0.038 + 0.008 + 0.003 = 0.124,
# / 5 / (0.13 - 0.02) = 0.225; ~idle (1 + 1) / 2 / (3 - 1) = 0.5, one flop. So ~limit is first.
def test_table_6_16_by_hand():
    rows = [(8, 1, 0, 1, 2), (9, 1, 1, 3, 2), *MISSED]
    marks = [Mark(ns(1.5), "I"), Mark(ns(10), "I"), Mark(ns(10), "II")]
    found = found_in(Trial("t", mission(rows, marks, treatment("type1"))), STATIC)
    assert found is not None
    table = found_table([found])
    expected = (2, 0.4, (9999.9 + 16) / 2, 1, 1.0, 0.124 / 5 / 0.11)
    assert table.rows[0][1] == pytest.approx(expected)


def test_table_6_16_with_marks_without_a_type():
    found = found_in(Trial("t", mission(MISSED, [Mark(ns(10), None)], treatment("type1"))), STATIC)
    assert found is not None
    table = found_table([found])
    # Both ranks are 1 where ~limit is the only one with scores.
    assert table.rows == (("t", (0, None, None, 0, None, None, 1, 1.0)),)
    assert [column.heading for column in table.columns][-2:] == ["No type Marks", "No type Rank"]


def test_marks_without_a_type_have_columns_of_their_own():
    marks = [Mark(ns(1), None, "a"), Mark(ns(2), "I", "a"), Mark(ns(3), None)]
    one = MarksOfTrial.of(Trial("one", mission(MISSED, marks, treatment("type2"))))
    table = marks_table([one], ["a", "unnamed"])
    assert table.rows == (("one", (1, 0, 1, 0, 0, 1, 1, 0, 2)),)
    confusion = confusion_table([one])
    assert confusion.rows == (("Treatment Type II", (1, 0, 2)),)
    # Those without a type are neither right nor wrong.
    assert confusion.notes == ("1 of 1 mark are of the wrong type.",)


def test_trials_stand_in_the_order_of_the_thesis():
    given = [
        StudyMission("x", mission().recording),
        StudyMission("c", mission().recording, treatment("clean")),
        StudyMission("f", mission().recording, treatment("fault")),
        StudyMission("b", mission().recording, treatment("type2"), seed=10),
        StudyMission("a", mission().recording, treatment("type2"), seed=2),
        StudyMission("y", mission().recording, treatment("type1", name="t10")),
        StudyMission("z", mission().recording, treatment("type1", name="t9")),
    ]
    trials = in_order(given)
    assert [(trial.label, trial.mission.name) for trial in trials] == [
        ("t9 trial 1", "z"),
        ("t10 trial 1", "y"),
        ("type2 trial 1", "a"),
        ("type2 trial 2", "b"),
        ("fault trial 1", "f"),
        ("clean trial 1", "c"),
        ("x", "x"),
    ]
    marks = [Mark(1, "I", name) for name in ("marks10", "marks2", "")]
    assert users_of([mission((), marks)]) == ["marks2", "marks10", "unnamed"]


def write_treatment(folder: Path, kind: str = "type2", name: str = "high") -> None:
    folder.mkdir(parents=True, exist_ok=True)
    changed = kind in {"type1", "type2"}
    document = {
        "name": name,
        "type": kind,
        "parameter": "~limit" if changed else None,
        "node": "/node" if changed else None,
        "old": 0.035 if changed else None,
        "new": 0.058 if changed else None,
        "launch": {},
        "effect": "waits",
    }
    (folder / "treatment.json").write_text(json.dumps(document))
    (folder / "params.yaml").write_text("{}\n")


def write_mission(folder: Path, args: dict[str, str] | None = None) -> None:
    save_recording(mission(MISSED, MARKS).recording, folder)
    if args is not None:
        (folder / "run.json").write_text(json.dumps({"schema": 1, "args": args, "bag": "m.bag"}))


def test_where_a_treatment_is_found(tmp_path):
    write_treatment(tmp_path / "treatments" / "high")
    write_treatment(tmp_path / "treatments" / "none", "clean", "none")
    write_treatment(tmp_path / "elsewhere" / "far", "fault", "far")
    # Of its own; by the folder above; by what run.json names; where that still is; nowhere.
    write_mission(tmp_path / "m" / "own", {"seed": "3"})
    write_treatment(tmp_path / "m" / "own", "clean", "mine")
    write_mission(tmp_path / "m" / "high" / "seed1", {"seed": "1"})
    write_mission(tmp_path / "m" / "other", {"treatment": "/gone/none/params.yaml"})
    far = tmp_path / "elsewhere" / "far" / "params.yaml"
    write_mission(tmp_path / "m" / "third", {"treatment": str(far), "seed": "no number"})
    write_mission(tmp_path / "m" / "zero", {})
    found = load_missions([tmp_path / "m"], tmp_path / "treatments")
    assert [(m.name, m.treatment.name if m.treatment else None, m.seed) for m in found] == [
        ("seed1", "high", 1),
        ("other", "none", None),
        ("own", "mine", 3),
        ("third", "far", None),
        ("zero", None, None),
    ]


def test_bad_studies(tmp_path):
    write_mission(tmp_path / "m")
    with pytest.raises(InputError, match="given twice"):
        load_missions([tmp_path / "m", tmp_path / "m"])
    with pytest.raises(InputError, match="no such folder of treatments"):
        load_missions([tmp_path / "m"], tmp_path / "none")
    with pytest.raises(InputError, match=r"no folder in it has a treatment\.json"):
        load_missions([tmp_path / "m"], tmp_path)
    for text in ("{", "[]", '{"a": "\udcff"}'):
        (tmp_path / "m" / "run.json").write_bytes(text.encode("utf-8", "surrogateescape"))
        with pytest.raises(InputError, match=r"run\.json(:1)?: not"):
            load_missions([tmp_path / "m"])
    (tmp_path / "m" / "run.json").write_text('{"args": 7, "bag": 8}')
    (found,) = load_missions([tmp_path / "m"])
    assert (found.treatment, found.seed, found.bag) == (None, None, None)


def test_all_tables_of_odd_missions():
    for odd in (
        [],
        [mission()],
        [mission((), MARKS, treatment("type2"))],
        [replace(mission((), MARKS), recording=Recording("e", Events.empty(), (), 5, 5))],
    ):
        tables = thesis_tables(odd, STATIC)
        assert [table.label for table in tables] == list(NUMBERS)
    # Marks and no reports: the changed parameter has no score at any of them.
    (table,) = thesis_tables([mission((), MARKS, treatment("type2"))], STATIC, ["found"])
    assert table.rows[0][1] == (2, 0.0, pytest.approx(9999.9), 3, 0.0, pytest.approx(9999.9))


def test_complaints():
    assert list(study_complaints(mission(MISSED, (), treatment("type2")), STATIC)) == []
    (first,) = study_complaints(mission(MISSED), STATIC)
    assert first.startswith("its treatment is unknown")
    (first,) = study_complaints(mission(MISSED, (), treatment("type1", "~other")), STATIC)
    assert "changed ~other, with which nothing" in first
    (first,) = study_complaints(mission((), (), treatment("clean")), STATIC)
    assert first.startswith("no threshold reports")
