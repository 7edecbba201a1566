"""Fleets of the robots of the study: what is flown, published, asked, and how it is judged."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace

import pyarrow as pa
import pytest
from click.testing import CliRunner
from mission_samples import comparison, events, static_info
from study_flights import made, treatment

from pytpc.base.columns import write_table
from pytpc.base.errors import InputError
from pytpc.cli.main import main
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording, load_recording, save_recording
from pytpc.recording.parameter_change import Change
from pytpc_evaluation.demo.demo_examples import EXAMPLES, WATER_SAMPLER
from pytpc_evaluation.study import fleet_judge
from pytpc_evaluation.study.case import Verdict
from pytpc_evaluation.study.changes import harmless_changes
from pytpc_evaluation.study.data import UserMark
from pytpc_evaluation.study.dataset import MARKED_FILE, save_done
from pytpc_evaluation.study.fleet_flying import (
    FLIGHTS_FILE,
    FleetRun,
    load_rows,
    mission_folder,
    observer_of,
)
from pytpc_evaluation.study.fleet_judge import (
    AloneVerdict,
    FleetVerdict,
    alone_in_questions,
    judge_alone,
    judge_fleets,
    judged,
    load_verdicts,
)
from pytpc_evaluation.study.fleet_plan import (
    ROBOTS,
    all_fleet_flights,
    fleet_flights,
    mission_settings,
    ordered_treatments,
    robot_settings,
)
from pytpc_evaluation.study.fleet_questions import FleetQuestion, questions
from pytpc_evaluation.study.report.fleets import first_share, fleet_tables

AMONG = {Change(f"~{name}", "/pump", 2.0, 5.5): frozenset[str]() for name in "abcdefghijk"}
WATER = fleet_flights(WATER_SAMPLER)


def values(changes):
    return {one.parameter.lstrip("~"): one.new for one in changes}


# --- what is set


def test_a_robots_own_settings_are_drawn_by_hashes_and_go_a_part_of_the_way():
    # The first six by sha256sum of fleet/robot/robot-1/pump~NAME. The first 8 digits of that of
    # fleet/robot/robot-1/share/pump~NAME leave 1 if divided by 3, but for c, which leaves 0: so
    # they go 3/4 of the way from 2 to 5.5, and c half of it.
    assert values(robot_settings("robot", "robot-1", AMONG)) == {
        "j": 4.625,
        "e": 4.625,
        "a": 4.625,
        "c": 3.75,
        "k": 4.625,
        "f": 4.625,
    }


def test_a_missions_settings_are_none_of_the_robots_and_not_the_wrong_parameter():
    own = robot_settings("robot", "robot-1", AMONG)
    # Left are b d g h i; sha256sum of fleet/robot/robot-1/7/pump~NAME sorts them b h i d g, and
    # the rests of their shares are 2 1 0 0 0.
    drawn = mission_settings("robot/robot-1/7", treatment("clean"), own, AMONG)
    assert values(drawn) == {"b": 5.5, "h": 4.625, "i": 3.75, "d": 3.75}
    drawn = mission_settings("robot/robot-1/7", treatment("type1_b"), own, AMONG)
    assert values(drawn) == {"h": 4.625, "i": 3.75, "d": 3.75, "g": 3.75}


def test_whole_numbers_stay_whole_and_never_stay_as_they_were():
    among = {Change("~a", "/pump", 1.0, 2.0): (), Change("~b", "/pump", 3.0, 15.0): ()}
    seen = {"a": set(), "b": set()}
    for number in range(40):
        for name, value in values(robot_settings("robot", f"robot-{number}", among)).items():
            seen[name].add(value)
    assert seen == {"a": {2.0}, "b": {9.0, 12.0, 15.0}}


def test_what_hides_an_error_is_no_robots_own_and_not_set_in_its_missions():
    hidden = {one: {"type1_b"} if one.parameter in "~g~h~i" else set() for one in AMONG}
    for number in range(20):
        own = robot_settings("robot", f"robot-{number}", hidden)
        assert not {"g", "h", "i"} & set(values(own))
        drawn = mission_settings(f"robot/{number}", treatment("type1_b"), own, hidden)
        assert not {"g", "h", "i"} & set(values(drawn))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda one: one.name)
def test_sisters_have_other_settings_and_every_mission_sets_what_its_robot_has(example):
    among = harmless_changes(example)
    own = [values(robot_settings(example.name, one, among)) for one in ROBOTS]
    assert all(one != other for one in own for other in own if one is not other)
    assert all(len(one) == 6 for one in own)
    for flight in fleet_flights(example)[::5]:
        settings = flight.settings()
        wrong = (flight.treatment.parameter or "").lstrip("~")
        kept = [one for one in flight.own if one.parameter.lstrip("~") != wrong]
        assert all(settings[f"{one.node}/{one.parameter[1:]}"] == one.new for one in kept)
        if flight.is_bad:
            # The wrong value counts where the robot or the mission has another one.
            names = [name for name in settings if name.endswith(f"/{wrong}")]
            assert [settings[name] for name in names] == [flight.treatment.new], flight.treatment


# --- what is flown


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda one: one.name)
def test_a_system_has_sixty_good_missions_and_ten_bad_ones_of_each_treatment(example):
    flights = fleet_flights(example)
    good = [one for one in flights if not one.is_bad]
    assert Counter(one.robot for one in good) == dict.fromkeys(ROBOTS, 20)
    for name in {one.treatment.name for one in flights if one.is_bad}:
        ten = [one for one in flights if one.treatment.name == name and not one.is_extra]
        more = [one for one in flights if one.treatment.name == name and one.is_extra]
        robots = Counter(one.robot for one in ten)
        assert sorted(robots.values()) == [3, 3, 4]
        # With six more of it, there are ten of one robot.
        assert {one.robot for one in more} == {max(robots, key=robots.__getitem__)}
        assert len(more) == 6
    numbers = [one.number for one in flights]
    assert sorted(numbers) == list(range(1, len(flights) + 1))
    assert len({one.seed for one in flights}) == len(flights)
    assert len({one.people for one in flights}) == len(flights)


def test_wherever_it_stops_there_are_good_missions_and_whole_treatments():
    # 21 good, 10 bad; 21 good, 10 bad; 18 good, 10 bad; then bad ones; the extra ones are last.
    parts = [(one.is_bad, one.treatment.name) for one in WATER]
    order = [one.name for one in ordered_treatments(WATER_SAMPLER)]
    expected = []
    for good, name in zip((21, 21, 18), order, strict=False):
        expected += [(False, "clean")] * good + [(True, name)] * 10
    assert parts[:90] == expected
    assert [one.treatment.name for one in WATER[90:100]] == [order[3]] * 10
    extra = [one.is_extra for one in WATER]
    assert extra == sorted(extra)
    # The first four treatments are of both types and both halves.
    first = (WATER[21], WATER[52], WATER[80], WATER[90])
    assert {(one.treatment.type, one.half) for one in first} == {
        ("type1", "tuning"),
        ("type2", "held-back"),
        ("type2", "tuning"),
        ("type1", "held-back"),
    }


def test_a_mission_is_the_same_whichever_others_are_flown():
    name = WATER[60].treatment.name
    some = fleet_flights(WATER_SAMPLER, [name])
    assert {one.treatment.name for one in some} == {"clean", name}
    known = {one.name: one for one in WATER}
    assert all(one == known[one.name] for one in some)
    systems = [one.example.name for one in all_fleet_flights()[:6]]
    assert systems == [one.name for one in EXAMPLES] * 2


def test_nothing_that_a_flight_is_given_says_what_is_wrong():
    for flight in (WATER[0], WATER[25]):
        assert flight.overlay.parent.name == "clean"
        assert flight.treatment.launch == {}
    assert WATER[25].is_bad
    # The fifth mission of type1_min_land_height: sha256sum of fleet/water_sampler/NAME begins with
    # 40e46394, which leaves 2, so the robots are 3 1 2 3 1.
    assert WATER[25].name == "water_sampler/robot-1/mission-0065"


# --- flown, and published


class Writes:
    """Seems to fly: writes a small mission with two observers' marks."""

    def __init__(self, out, marks):
        self.out, self.marks, self.flown = out, marks, []

    def kept(self, flight):
        return made() if (flight.folder(self.out) / "done.json").is_file() else None

    def fly(self, flight, on_progress=None):
        self.flown.append(flight.label)
        folder = flight.folder(self.out)
        folder.mkdir(parents=True, exist_ok=True)
        save_recording(Recording("mission", EVENTS, (), 0, 10**9), folder)
        (folder / "params.yaml").write_text("pump: {b: 0.5}\n")
        (folder / "treatment.json").write_text("{}")
        columns = ("time_ns", "observer", "cause", "right", "said")
        rows = [dict(zip(columns, mark, strict=True)) for mark in self.marks]
        write_table(pa.Table.from_pylist(rows), folder / MARKED_FILE)
        save_done(made(), folder)
        return made()


EVENTS = events([(0.5, 1, True, 1.0, 2.0)], node="/pump")
MARKS = (
    (7 * 10**8, "user1", -1, "I", "I"),
    (8 * 10**8, "user2", 0, "I", "II"),
    (9 * 10**8, "user2", 0, "I", "I"),
)


class Told:
    def __init__(self):
        self.lines = []

    def starts(self, flights):
        self.lines.append(flights)

    def flying(self, flight, progress):
        pass

    def ended(self, result):
        self.lines.append(result.flight.name)


def test_a_user_gets_the_recording_with_one_observers_marks_and_not_the_truth(tmp_path):
    flight = WATER[25]
    run = FleetRun(tmp_path, {"water_sampler": Writes(tmp_path, MARKS)}, WATER)
    run.fly([flight], Told())
    folder = mission_folder(flight, tmp_path)
    assert folder == tmp_path / "missions/water_sampler/robot-1/mission-0065"
    names = sorted(one.name for one in folder.iterdir())
    assert names == ["events.parquet", "marks.json", "params.yaml"]
    recording = load_recording(folder)
    # user1 marked no error, so user2 watched; the types are those that user2 said.
    marks = [(mark.time_ns, mark.type, mark.observer) for mark in recording.marks]
    assert marks == [(8 * 10**8, "II", "user2"), (9 * 10**8, "I", "user2")]
    assert len(recording.events) == 1
    (row,) = [one for one in load_rows(tmp_path) if one["state"] == "done"]
    told = {name: row[name] for name in ("robot", "observer", "marks", "parameter", "extra")}
    assert told == {
        "robot": "robot-1",
        "observer": "user2",
        "marks": 2,
        "parameter": flight.treatment.parameter,
        "extra": False,
    }
    assert len(load_rows(tmp_path)) == len(all_fleet_flights())


def test_what_was_flown_is_not_flown_again_and_its_mission_stays_the_same_file(tmp_path):
    flier = Writes(tmp_path, MARKS)
    told = Told()
    FleetRun(tmp_path, {"water_sampler": flier}, WATER).fly(WATER[:2], told)
    file = mission_folder(WATER[0], tmp_path) / "marks.json"
    before = file.stat()
    FleetRun(tmp_path, {"water_sampler": flier}, WATER).fly(WATER[:3], told)
    assert flier.flown == [one.label for one in WATER[:3]]
    assert told.lines == [
        2,
        WATER[0].name,
        WATER[1].name,
        *(one.name for one in WATER[:2]),
        1,
        WATER[2].name,
    ]
    after = file.stat()
    assert (after.st_ino, after.st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
    # A run of others forgets nothing of these.
    FleetRun(tmp_path, {"water_sampler": flier}, WATER).fly(WATER[5:6], told)
    done = [one["number"] for one in load_rows(tmp_path) if one["state"] == "done"]
    assert sorted(done) == [1, 2, 3, 6]


def test_who_watched_is_drawn_from_those_who_marked_an_error_or_else_from_all():
    marks = [UserMark(1, "user1", -1, "I", "I"), UserMark(2, "user4", 0, "I", "I")]
    assert {observer_of(flight, marks) for flight in WATER} == {"user4"}
    assert {observer_of(flight, marks[:1]) for flight in WATER} == {
        f"user{number}" for number in range(1, 5)
    }


def test_a_broken_list_of_flights_is_said_to_be_one(tmp_path):
    (tmp_path / FLIGHTS_FILE).write_text('{"flights": [1]}')
    with pytest.raises(InputError, match=r"flights\.json: not the flights of a fleet"):
        load_rows(tmp_path)


# --- what is asked, and how it is judged


def flown(system="pump", goods=60, marked=10, robots=ROBOTS):
    """Rows of good missions, and of ten bad ones of which the first ``marked`` were marked."""

    def row(number, wrong, marks):
        return {
            "folder": f"missions/{system}/{robots[number % len(robots)]}/mission-{number:04}",
            "system": system,
            "robot": robots[number % len(robots)],
            "treatment": "type1_b" if wrong else "clean",
            "type": "type1" if wrong else "clean",
            "half": "tuning" if wrong else None,
            "parameter": "~b" if wrong else None,
            "node": "/pump" if wrong else None,
            "state": "done",
            "errors": int(wrong),
            "marks": marks,
        }

    # A clean mission with a false alarm is a good one.
    good = [row(number, wrong=False, marks=number % 2) for number in range(goods)]
    bad = [row(100 + number, wrong=True, marks=int(number < marked)) for number in range(10)]
    return good + bad


def test_a_question_has_ten_bad_and_fifty_good_missions_of_all_robots():
    asked = list(questions(flown(), draws=2, shapes=["mixed"]))
    assert [one.draw for one in asked] == [0, 1]
    for one in asked:
        assert len(set(one.bad)) == 10
        assert len(set(one.good)) == 50
        robots = Counter(folder.split("/")[2] for folder in one.good)
        assert sorted(robots.values()) == [16, 17, 17]
        assert all(int(folder[-4:]) < 60 for folder in one.good)
        assert all(int(folder[-4:]) >= 100 for folder in one.bad)
        assert (one.parameter, one.node, one.type, one.half) == ("~b", "/pump", "type1", "tuning")
    assert asked[0].good != asked[1].good
    assert asked == list(questions(flown()[::-1], draws=2, shapes=["mixed"]))


def test_by_marks_the_same_missions_are_asked_about():
    (said,) = questions(flown(), 1, ["mixed"])
    (marked,) = questions(flown(), 1, ["by-marks"])
    assert marked == replace(said, shape="by-marks")


def test_a_question_may_have_other_numbers_of_missions():
    (one,) = questions(flown(goods=9, marked=4), 1, ["mixed"], 4, 9)
    assert (len(one.bad), len(one.good)) == (4, 9)
    robots = Counter(folder.split("/")[2] for folder in one.bad)
    assert sorted(robots.values()) == [1, 1, 2]


def test_nothing_is_asked_with_too_few_missions():
    assert not list(questions(flown(goods=49)))
    assert not list(questions(flown(marked=7)))
    # Four of ten bad missions are of one robot: too few for the question about one.
    assert {one.shape for one in questions(flown())} == {"mixed"}
    assert {one.shape for one in questions(flown(robots=("robot-1",)))} == {"mixed", "one-robot"}
    # A clean mission that went wrong is not a good one.
    good = flown(goods=50)
    assert list(questions(good))
    assert not list(questions([{**good[0], "errors": 1}, *good[1:]]))
    # Marks of a bad mission in which nothing was to be seen are false alarms.
    unseen = [{**row, "errors": 0} for row in flown()]
    assert not list(questions(unseen))
    planned = [{**row, "state": "planned"} for row in flown()]
    assert not list(questions(planned))


QUESTION = FleetQuestion(
    "pump", "type1_b", "type1", "tuning", "~b", "/pump", "mixed", 0, ("m/1", "m/2"), ("m/3",)
)


def test_a_verdict_counts_with_the_chance_of_the_wrong_parameter_if_it_is_tied():
    found = judged(QUESTION, "fleet", Verdict(("/pump/b", "/pump/a"), 0.9, none=0.05))
    assert (found.first, found.third, found.top, found.confidence) == (1.0, 1.0, "/pump/b", 0.9)
    assert (found.none, found.bad, found.good) == (0.05, 2, 1)
    # Four share the first place: a quarter, and three quarters.
    tied = Verdict(("/pump/a", "/pump/b", "/pump/c", "/pump/d"), scores=(1.0,) * 4)
    assert (judged(QUESTION, "fleet", tied).first, judged(QUESTION, "fleet", tied).third) == (
        0.25,
        0.75,
    )
    missed = judged(QUESTION, "fleet", Verdict(("/pump/a",)))
    assert (missed.first, missed.third, missed.confidence) == (0.0, 0.0, None)


def test_rankings_of_single_missions_count_with_their_share_of_the_bad_ones():
    alone = [
        AloneVerdict("m/1", "tpc", 1.0, 1.0, ""),
        AloneVerdict("m/2", "tpc", 0.0, 1.0, ""),
        AloneVerdict("m/1", "thesis", 1.0, 1.0, ""),
    ]
    (found,) = alone_in_questions([QUESTION], alone)
    # The thesis's ranking did not see both missions.
    assert (found.method, found.first, found.third) == ("tpc", 0.5, 1.0)


def test_a_question_is_asked_again_only_if_a_mission_has_changed(tmp_path):
    for name in ("1", "2", "3"):
        (tmp_path / "m" / name).mkdir(parents=True)
        (tmp_path / "m" / name / "marks.json").write_text(name)
    asked = []

    def ranks(question, out):
        asked.append(question)
        return {"fleet": Verdict(("/pump/b",)), "fleet-differs": Verdict(())}

    assert load_verdicts(tmp_path) == []
    first = judge_fleets(tmp_path, [QUESTION], ranks)
    assert load_verdicts(tmp_path) == first
    assert [(one.method, one.first) for one in first] == [("fleet", 1.0), ("fleet-differs", 0.0)]
    assert judge_fleets(tmp_path, [QUESTION], ranks) == first
    assert len(asked) == 1
    other = replace(QUESTION, draw=1)
    judge_fleets(tmp_path, [other], ranks)
    (tmp_path / "m" / "3" / "marks.json").write_text("other")
    judge_fleets(tmp_path, [QUESTION], ranks)
    assert [one.draw for one in asked] == [0, 1, 0]
    # The verdicts on the other question were kept, though it was not asked.
    assert len(judge_fleets(tmp_path, [QUESTION, other], ranks)) == 4
    assert [one.draw for one in asked] == [0, 1, 0, 1]
    # One with fewer missions is another question.
    judge_fleets(tmp_path, [replace(QUESTION, bad=("m/1",))], ranks)
    judge_fleets(tmp_path, [QUESTION], ranks)
    assert [len(one.bad) for one in asked] == [2, 2, 2, 2, 1]


def test_each_bad_mission_is_ranked_once_beside_good_ones_of_its_question(tmp_path, monkeypatch):
    static = tmp_path / "systems/pump/static.json"
    static.parent.mkdir(parents=True)
    static_info(comparison(1, "~b"), comparison(2, "~a")).save(static)
    for name in ("1", "2", "3"):
        (tmp_path / "m" / name).mkdir(parents=True)
        marks = [Mark(5 * 10**8, "I", "user1")] if name != "3" else []
        recording = Recording(name, EVENTS, tuple(marks), 0, 10**9)
        save_recording(recording, tmp_path / "m" / name)
    seen = []

    def ranks(case):
        seen.append((case.recording.name, [run.name for run in case.good]))
        return Verdict(("~a", "~b"))

    monkeypatch.setattr(fleet_judge, "ALONE", ("tpc",))
    monkeypatch.setattr(fleet_judge, "METHODS", {"tpc": ranks})
    found = judge_alone(tmp_path, [QUESTION, replace(QUESTION, draw=1)])
    assert [(one.folder, one.method, one.first, one.third) for one in found] == [
        ("m/1", "tpc", 0.0, 1.0),
        ("m/2", "tpc", 0.0, 1.0),
    ]
    assert seen == [("1", ["3"]), ("2", ["3"])]
    assert judge_alone(tmp_path, [QUESTION]) == found
    assert len(seen) == 2
    # Another build has all ranked again; what cannot be read is told, and the others are kept.
    static_info(comparison(1, "~b"), comparison(3, "~a")).save(static)
    (tmp_path / "m/1/marks.json").write_text("[")
    with pytest.raises(InputError, match=r"m/1/marks\.json"):
        judge_alone(tmp_path, [QUESTION])
    assert seen[2:] == [("2", ["3"])]
    save_recording(Recording("1", EVENTS, (Mark(5 * 10**8, "I"),), 0, 10**9), tmp_path / "m/1")
    judge_alone(tmp_path, [QUESTION])
    assert seen[3:] == [("1", ["3"])]


def verdict(treatment, draw, first, method="fleet", **other):
    fields = {"type": "type1", "half": "tuning", "shape": "mixed", "third": 1.0, **other}
    return FleetVerdict(
        "pump", treatment, fields["type"], fields["half"], fields["shape"], draw, method, first,
        fields["third"], "/pump/b", None, None, 10, 50,
    )  # fmt: skip


def test_shares_are_those_of_treatments_with_exact_intervals():
    rows = [
        verdict("type1_a", 0, 1.0),
        verdict("type1_a", 1, 1.0),
        verdict("type1_b", 0, 1.0),
        verdict("type1_b", 1, 0.0, half="held-back", type="type2"),
    ]
    # The means of the treatments are 1 and 0.5.
    found = first_share(rows)
    assert (found.value, found.treatments) == (0.75, 2)
    # Two of two (Clopper and Pearson): from 0.025 ** (1 / 2) = 0.158 to 1.
    (table,) = fleet_tables(rows[:3])
    assert table.rows[0] == ("fleet", ("100 [16, 100]",) * 3 + ("100 [16, 100]",))
    assert table.rows[-1] == ("treatments", (2, 2, 2, 2))
    assert [column.heading for column in table.columns] == ["all", "tuning", "type I", "all"]
    assert table.notes == ("Each question has 10 bad missions and 50 good ones.",)


# --- the commands


def test_the_plan_is_listed_as_it_is_flown():
    words = ["study", "fleet", "plan", "--system", "water_sampler", "--json"]
    result = CliRunner().invoke(main, words, catch_exceptions=False)
    rows = json.loads(result.stdout)
    assert [row["number"] for row in rows] == [one.number for one in WATER]
    assert rows[25]["settings"] == WATER[25].settings()
    assert rows[25]["state"] == "planned"


def test_a_treatment_that_is_none_is_said_to_be_none():
    words = ["study", "fleet", "plan", "--treatment", "type1_typo"]
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 1
    assert "there is no treatment type1_typo" in result.stderr


def test_how_far_the_flights_are_is_shown(tmp_path):
    FleetRun(tmp_path, {"water_sampler": Writes(tmp_path, MARKS)}, WATER).fly(WATER[20:23], Told())
    words = ["study", "fleet", "show", "--out", str(tmp_path)]
    result = CliRunner().invoke(main, words, catch_exceptions=False)
    assert "1,556 missions: 3 flown, 0 failed, 1553 to fly" in result.stdout
    line = next(line for line in result.stdout.splitlines() if WATER[21].treatment.name in line)
    assert "2 of 16" in line
