"""The scripted observer: what it sees, when it presses a key, and when it does not."""

from __future__ import annotations

import re
import statistics
from collections.abc import Iterable

import pytest
from observer_scripts import load_observer, shared_module

from pytpc.demo_examples import IMAGE_CAPTURE, WATER_SAMPLER

observer = load_observer(IMAGE_CAPTURE)
Person = shared_module("person").Person
PERSON = (0.0, 3.0)


def sights(
    *phases: tuple[float, float, float, float, float, float], pictures: tuple[float, ...] = ()
) -> Iterable:
    """Sights ten times a second. A phase: until, then at its end x, y, z, yaw, turning rate.

    Position and height change evenly within a phase; with a rate other than 0 the yaw begins at
    the phase's yaw and turns.
    """
    time, x, y, z = 0.0, 0.0, 0.0, 0.0
    for until, to_x, to_y, to_z, yaw, rate in phases:
        steps = round((until - time) * 10)
        for step in range(1, steps + 1):
            share = step / steps
            now = round(time + step * 0.1, 3)
            yield observer.Sight(
                now,
                x + share * (to_x - x),
                y + share * (to_y - y),
                z + share * (to_z - z),
                yaw + rate * step * 0.1,
                *PERSON,
                sum(click <= now for click in pictures),
            )
        time, x, y, z = until, to_x, to_y, to_z


def watch(phases: list, seed: int = 1, pictures: tuple[float, ...] = ()) -> list:
    person = Person(observer.OBSERVER.rules(), seed)
    return [mark for sight in sights(*phases, pictures=pictures) for mark in person.see(sight)]


# The person stands in the direction of yaw 1.5708. Up in 3 s, turning for 6 s, then looking at it.
BEGIN = [(3.0, 0, 0, 1.6, -1.5, 0.0), (9.0, 0, 0, 1.6, -1.5, 0.5)]
LOOK_AT = 1.5708
AWAY = -1.2


def test_right_mission_gets_no_mark():
    # In front at 9 s, nearer until 11 s, picture at 13 s, home at 20 s, down at 24 s.
    phases = [
        *BEGIN,
        (11.0, 0, 0.8, 1.6, LOOK_AT, 0.0),
        (13.0, 0, 0.8, 1.6, LOOK_AT, 0.0),
        (20.0, -3, 0, 1.6, LOOK_AT, 0.0),
        (24.0, -3, 0, 0.0, LOOK_AT, 0.0),
        (60.0, -3, 0, 0.0, LOOK_AT, 0.0),
    ]
    assert watch(phases, pictures=(13.0,)) == []


def test_picture_of_nobody_is_one_type1_mark_after_the_picture():
    phases = [
        *BEGIN,
        (10.0, 0, 0, 1.6, AWAY, 0.0),
        (16.0, -3, 0, 1.6, AWAY, 0.0),
        (20.0, -3, 0, 0.0, AWAY, 0.0),
        (60.0, -3, 0, 0.0, AWAY, 0.0),
    ]
    marks = watch(phases, pictures=(9.5,))
    assert [mark.topic for mark in marks] == ["mark_action"]
    assert 9.5 < marks[0].time < 9.5 + 10.0


def test_reaction_is_that_of_people():
    # Lognormal with median 2.5 s and sigma 0.4: half of them below 2.5 s, and 95 of 100 below
    # 2.5 * exp(1.645 * 0.4) = 4.83 s. The click is seen at 9.5 s.
    phases = [*BEGIN, (40.0, 0, 0, 1.6, AWAY, 0.0)]
    delays = sorted(watch(phases, seed=seed, pictures=(9.5,))[0].time - 9.5 for seed in range(300))
    assert statistics.median(delays) == pytest.approx(2.5, abs=0.2)
    assert delays[285] == pytest.approx(4.83, abs=0.7)
    assert delays[0] > 0.5


def test_standing_before_the_person_without_a_picture_is_type2_again_and_again():
    # It stands from 11.5 s on (half a second after it came to rest at 11 s). Patience 7 s, never
    # under 4 s; then a mark every 4 to 9 s and a reaction each: at least 4 until 60 s.
    phases = [*BEGIN, (11.0, 0, 0.8, 1.6, LOOK_AT, 0.0), (60.0, 0, 0.8, 1.6, LOOK_AT, 0.0)]
    for seed in range(20):
        marks = watch(phases, seed=seed)
        assert {mark.topic for mark in marks} == {"mark_no_action"}
        assert marks[0].time > 11.0 + 4.0 + 0.5
        assert marks[0].time < 11.5 + 11.0 + 8.0
        assert 4 <= len(marks) <= 12
        assert [m.time for m in marks] == sorted(m.time for m in marks)


def test_a_picture_at_last_ends_the_marks_and_what_was_about_to_be_pressed():
    phases = [*BEGIN, (11.0, 0, 0.8, 1.6, LOOK_AT, 0.0), (60.0, 0, 0.8, 1.6, LOOK_AT, 0.0)]
    for seed in range(20):
        marks = watch(phases, seed=seed, pictures=(30.0,))
        assert marks
        assert all(mark.time <= 30.0 for mark in marks)


def test_moving_or_turning_is_not_standing():
    # It circles round the person's front all the time: no position is held for 4 s.
    turns = [(9.0 + 3.0 * n, 0.6 * (-1) ** n, 0.8, 1.6, LOOK_AT, 0.0) for n in range(1, 15)]
    assert watch([*BEGIN, *turns]) == []
    assert watch([*BEGIN, (60.0, 0, 0, 1.6, LOOK_AT - 0.4, 0.2)]) == []


def test_landing_without_any_picture_is_type1():
    phases = [*BEGIN, (13.0, 0, 0, 0.0, AWAY, 0.0), (60.0, 0, 0, 0.0, AWAY, 0.0)]
    marks = watch(phases)
    assert [mark.topic for mark in marks] == ["mark_action"]
    assert "lands" in marks[0].reason
    # 0.35 m below the cruising height of 1.6 m is passed 0.875 s after the descent begins.
    assert marks[0].time > 9.875


def test_stopping_where_nobody_is_becomes_wrong_only_after_a_while():
    short = [*BEGIN, (13.0, 0, 0, 1.6, AWAY, 0.0), (30.0, 0, 0, 1.6, AWAY, 0.5)]
    assert watch(short) == []
    long = [*BEGIN, (30.0, 0, 0, 1.6, AWAY, 0.0)]
    marks = watch(long)
    assert [mark.topic for mark in marks] == ["mark_action"]
    # It stands from 9 s on and is seen to stand half a second later at most; then 6 s of patience.
    assert marks[0].time > 15.0


def test_same_seed_same_marks():
    phases = [*BEGIN, (60.0, 0, 0.8, 1.6, LOOK_AT, 0.0)]
    assert watch(phases, seed=5) == watch(phases, seed=5)
    assert watch(phases, seed=5) != watch(phases, seed=6)


@pytest.mark.parametrize(
    ("example", "seen"),
    [
        (IMAGE_CAPTURE, {"/truth/uav", "/truth/person", "/camera/picture"}),
        (WATER_SAMPLER, {"/truth/uav", "/truth/sampler"}),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_observer_is_told_nothing_but_what_a_person_sees(example, seen):
    script = (example.folder / "scripts/observer.py").read_text()
    assert set(re.findall(r'"(/[^"]+)"', script)) == seen
    assert "param" not in re.sub(r"no parameter", "", script)
