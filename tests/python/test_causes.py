"""From sights to causes: when what was wrong began, and when it ended."""

from __future__ import annotations

import pytest
import test_observer as field
import test_water_observer as tank
from hypothesis import given
from hypothesis import strategies as st
from observer_scripts import shared_module

person = shared_module("person")
rules = shared_module("rules")
Cause, causes_of = rules.Cause, rules.causes_of


class Plain(rules.Rules):
    """What is wrong is written into the sights: x over 0 is wrong, y over 0 is a wait."""

    patience_s = 3.0

    def judge(self, sight):
        if sight.x > 0.0:
            self.wrong(sight.time - sight.x, "wrong")
        self.waiting(sight.y == 1.0, "first")
        self.waiting(sight.y >= 1.0, "second")


def causes(*rows: tuple[float, float, float]) -> list:
    """Of sights (time, x, y)."""
    return causes_of(Plain(), [rules.Look(*row, 0.0) for row in rows])


def test_no_sight_no_cause():
    assert causes() == []


def test_one_sight_is_a_moment_and_no_wait():
    assert causes((5.0, 0.5, 1.0)) == [Cause("I", 4.5, 4.5, "wrong")]


def test_a_wait_lasts_from_its_first_sight_to_the_first_without_it():
    waits = [(1.0, 0.0, 0.0), (2.0, 0.0, 1.0), (4.0, 0.0, 1.0), (5.0, 0.0, 0.0), (9.0, 0.0, 0.0)]
    assert causes(*waits) == [Cause("II", 2.0, 5.0, "first")]


def test_a_wait_shorter_than_the_patience_is_none():
    assert causes((2.0, 0.0, 1.0), (4.0, 0.0, 1.0), (4.9, 0.0, 0.0), (9.0, 0.0, 0.0)) == []


def test_what_never_ended_ends_with_the_last_sight():
    assert causes((2.0, 0.0, 1.0), (7.5, 0.0, 1.0)) == [Cause("II", 2.0, 7.5, "first")]
    assert causes((2.0, 0.0, 1.0), (4.9, 0.0, 1.0)) == []


def test_each_wait_is_a_cause_of_its_own():
    rows = [(0.0, 0.0, 1.0), (4.0, 0.0, 0.0), (5.0, 0.0, 2.0), (8.0, 0.0, 2.0)]
    assert causes(*rows) == [Cause("II", 0.0, 4.0, "first"), Cause("II", 5.0, 8.0, "second")]


def test_a_wait_whose_reason_changes_is_one_with_the_reason_it_began_with():
    rows = [(0.0, 0.0, 2.0), (2.0, 0.0, 1.0), (4.0, 0.0, 0.0)]
    assert causes(*rows) == [Cause("II", 0.0, 4.0, "second")]


def test_causes_are_in_the_order_of_their_begin():
    # The wait is known to be one at 6 s, the wrong moment of 3 s at 4 s, and that of 0.5 s at 5 s.
    rows = [(1.0, 0.0, 1.0), (4.0, 1.0, 1.0), (5.0, 4.5, 1.0), (6.0, 0.0, 0.0)]
    assert [(each.kind, each.start, each.end) for each in causes(*rows)] == [
        ("I", 0.5, 0.5),
        ("II", 1.0, 6.0),
        ("I", 3.0, 3.0),
    ]


def test_a_rule_knows_nothing_of_what_comes_later():
    """What live people are told at a sight is the same, whatever follows."""
    rows = [rules.Look(float(t), t % 4 - 2.0, t % 3 - 1.0, 0.0) for t in range(40)]
    whole = Plain()
    all_findings = [whole.see(row) for row in rows]
    for until in range(1, 40):
        part = Plain()
        assert [part.see(row) for row in rows[:until]] == all_findings[:until]


def of_tank(*phases) -> list:
    return causes_of(tank.observer.OBSERVER.rules(), tank.sights(*phases))


def of_field(*phases, pictures: tuple[float, ...] = ()) -> list:
    return causes_of(field.observer.OBSERVER.rules(), field.sights(*phases, pictures=pictures))


def test_standing_at_the_tank_begins_when_it_stands():
    # At rest from 8 s on. Of the second that a person looks back 0.65 s are over when what is left
    # of 0.75 m/s is less than 0.3 m/s. The pump is heard first at the sight of 30.1 s.
    phases = [
        *tank.BEGIN,
        (30.0, tank.AT_TANK, 2.4, False, 0.0),
        (33.0, tank.AT_TANK, 2.4, True, 0.9),
    ]
    begin, *_ = of_tank(*phases)
    assert begin.start == pytest.approx(8.65, abs=0.06)
    assert (begin.kind, begin.end) == ("II", 30.1)
    assert begin.reason == "it stands at the tank, and the tube stays above the water"


def test_a_pump_in_the_air_is_wrong_when_it_began():
    phases = [
        *tank.BEGIN,
        (11.0, tank.AT_TANK, 1.9, False, 0.0),
        (15.0, tank.AT_TANK, 1.9, True, 0.0),
        *tank.home(15.0, 0.0),
    ]
    assert of_tank(*phases) == [
        Cause("I", 11.1, 11.1, "the pump runs, and the tube is not in the water")
    ]


def test_a_picture_of_nobody_is_wrong_at_the_click():
    phases = [*field.BEGIN, (40.0, 0, 0, 1.6, field.AWAY, 0.0)]
    first, *_ = of_field(*phases, pictures=(9.52,))
    assert (first.kind, first.start) == ("I", pytest.approx(9.6))


def test_in_front_of_the_person_until_the_picture():
    phases = [
        *field.BEGIN,
        (11.0, 0, 0.8, 1.6, field.LOOK_AT, 0.0),
        (60.0, 0, 0.8, 1.6, field.LOOK_AT, 0.0),
    ]
    until_picture, *_ = of_field(*phases, pictures=(30.0,))
    assert (until_picture.kind, until_picture.end) == ("II", 30.0)
    # Still over half a second: 0.4 m/s is below 0.3 m/s when a quarter of that is over.
    assert until_picture.start == pytest.approx(11.2, abs=0.11)
    (never,) = of_field(*phases)
    assert (never.start, never.end) == (until_picture.start, 60.0)


@pytest.mark.parametrize("module", [field, tank], ids=["image_capture", "water_sampler"])
def test_no_sight_and_one_sight_of_a_robot(module):
    observer = module.observer.OBSERVER
    (first, *_) = module.sights(*module.BEGIN)
    assert causes_of(observer.rules(), []) == []
    assert causes_of(observer.rules(), [first]) == []


# One second each: whether a deed is done at it, and whether it waits.
STORIES = st.lists(st.tuples(st.booleans(), st.booleans()), max_size=80)


@given(STORIES, st.integers(0, 50))
def test_who_watches_live_marks_the_causes_that_a_recording_shows(story, seed):
    rows = [
        rules.Look(float(time), 0.5 * deed, float(waits), 0.0)
        for time, (deed, waits) in enumerate(story)
    ]
    found = causes_of(Plain(), rows)
    live = person.Person(Plain(), seed)
    marks = [mark for row in rows for mark in live.see(row)]
    deeds = [cause.start for cause in found if cause.kind == "I"]
    assert deeds == [time - 0.5 for time, (deed, _) in enumerate(story) if deed]
    of_deeds = [mark for mark in marks if mark.topic == person.TYPE_I]
    # The n-th key pressed comes after the n-th deed; a reaction may outlast the mission.
    assert len(of_deeds) <= len(deeds)
    assert all(mark.time > deed for mark, deed in zip(of_deeds, deeds, strict=False))
    waits = [cause for cause in found if cause.kind == "II"]
    for mark in marks:
        if mark.topic == person.TYPE_II:
            assert any(each.start + Plain.patience_s < mark.time <= each.end for each in waits)
