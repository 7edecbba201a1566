"""The scripted observer: what it sees, when it presses a key, and when it does not."""

from __future__ import annotations

import re
import statistics
from collections.abc import Iterable

import pytest
from observer_scripts import load_observer, shared_module

from pytpc_evaluation.demo.demo_examples import IMAGE_CAPTURE, WATER_SAMPLER

observer = load_observer(IMAGE_CAPTURE)
Person = shared_module("person").Person
causes_of = shared_module("rules").causes_of
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
# The same, but it turns from -3 to -1.2, where the person is never in view.
BEGIN_AWAY = [(3.0, 0, 0, 1.6, -3.0, 0.0), (9.0, 0, 0, 1.6, -3.0, 0.3)]


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
        *BEGIN_AWAY,
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
    phases = [*BEGIN_AWAY, (40.0, 0, 0, 1.6, AWAY, 0.0)]
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
    home = [(38.0, -3, 0, 1.6, LOOK_AT, 0.0), (42.0, -3, 0, 0.0, LOOK_AT, 0.0)]
    phases = [*BEGIN, (11.0, 0, 0.8, 1.6, LOOK_AT, 0.0), (30.0, 0, 0.8, 1.6, LOOK_AT, 0.0), *home]
    for seed in range(20):
        marks = watch(phases, seed=seed, pictures=(30.0,))
        assert marks
        assert all(mark.time <= 30.0 for mark in marks)


def test_moving_or_turning_is_not_standing():
    # It circles round the person's front all the time: no position is held for 4 s.
    turns = [(9.0 + 3.0 * n, 0.6 * (-1) ** n, 0.8, 1.6, LOOK_AT, 0.0) for n in range(1, 15)]
    assert watch([*BEGIN, *turns]) == []
    # It turns by 0.8 rad within 25 degrees of the person's direction.
    assert watch([*BEGIN, (13.0, 0, 0, 1.6, LOOK_AT - 0.4, 0.2)]) == []


def test_landing_without_any_picture_is_type1():
    phases = [*BEGIN_AWAY, (13.0, 0, 0, 0.0, AWAY, 0.0), (60.0, 0, 0, 0.0, AWAY, 0.0)]
    marks = watch(phases)
    assert [mark.topic for mark in marks] == ["mark_action"]
    assert "lands" in marks[0].reason
    # 0.35 m below the cruising height of 1.6 m is passed 0.875 s after the descent begins.
    assert marks[0].time > 9.875


def test_stopping_where_nobody_is_becomes_wrong_only_after_a_while():
    short = [*BEGIN_AWAY, (13.0, 0, 0, 1.6, AWAY, 0.0), (18.0, 0, 0, 1.6, AWAY, 0.5)]
    assert watch(short) == []
    long = [*BEGIN_AWAY, (30.0, 0, 0, 1.6, AWAY, 0.0)]
    marks = watch(long)
    assert [mark.topic for mark in marks] == ["mark_action"]
    # It stands from 9 s on and is seen to stand half a second later at most; then 6 s of patience.
    assert marks[0].time > 15.0


def causes(phases: list, pictures: tuple[float, ...] = ()) -> list[tuple[str, float, float, str]]:
    found = causes_of(observer.OBSERVER.rules(), sights(*phases, pictures=pictures))
    return [(one.kind, one.start, one.end, one.reason) for one in found]


def test_staying_on_the_ground_is_type2_when_it_should_have_taken_off():
    # The first sight is at 0.1 s; more than 5 s later is 5.2 s. It rises by 1.6 m from 20 to 22 s
    # and is higher than 0.3 m at 20.4 s.
    stays = [(20.0, 0, 0, 0.0, 0.0, 0.0), (22.0, 0, 0, 1.6, 0.0, 0.0)]
    assert causes(stays) == [("II", 5.2, 20.4, "it does not take off")]
    # It waits for 3.2 s, which is none.
    assert causes([(8.0, 0, 0, 0.0, 0.0, 0.0), (10.0, 0, 0, 1.6, 0.0, 0.0)]) == []


def test_standing_on_the_way_is_type2():
    # It flies 2 m in 4 s until 7 s. Half a second before 7.3 s it was 0.1 m back: 0.2 m/s is
    # standing; 0.3 m/s at 7.2 s is neither, to the rounding.
    up = [(3.0, 0, 0, 1.6, 0.0, 0.0), (7.0, 2, 0, 1.6, 0.0, 0.0)]
    ((kind, start, end, reason),) = causes([*up, (17.0, 2, 0, 1.6, 0.0, 0.0)])
    assert (kind, end, reason) == ("II", 17.0, "it stands on its way")
    assert 7.1 < start < 7.4
    assert causes([*up, (10.0, 2, 0, 1.6, 0.0, 0.0), (12.0, 3, 0, 1.6, 0.0, 0.0)]) == []


def test_turning_past_the_person_is_type2_until_it_is_in_view_again():
    # From -1.5 at 3 s with 0.5 rad/s. The person is at 1.5708: within 25 degrees from 8.3 s on,
    # beyond 32 degrees (2.1293) after 10.26 s, within them again at 1.0123 + 2 pi = 7.2955, which
    # is 20.59 s.
    turning = [(3.0, 0, 0, 1.6, -1.5, 0.0), (21.0, 0, 0, 1.6, -1.5, 0.5)]
    assert causes(turning) == [("II", 10.3, 20.6, "it turns past the person")]


def test_staying_after_the_picture_is_type2():
    # The click is at 13 s; after more than 2 s, from 15.1 s on, it should have gone. Before it
    # stands from 11.2 s to 13 s only: less than 4 s.
    phases = [*BEGIN, (11.0, 0, 0.8, 1.6, LOOK_AT, 0.0), (30.0, 0, 0.8, 1.6, LOOK_AT, 0.0)]
    reason = "it has its picture, and does not come home"
    assert causes(phases, pictures=(13.0,)) == [("II", 15.1, 30.0, reason)]


def test_nobody_is_looked_for_after_the_picture():
    # Picture at 11.5 s, home at 18 s, where it hovers for 12 s before it lands.
    reason = "it has its picture, and does not come home"
    phases = [
        *BEGIN,
        (11.0, 0, 0.8, 1.6, LOOK_AT, 0.0),
        (18.0, -3, 0, 1.6, LOOK_AT, 0.0),
        (30.0, -3, 0, 1.6, LOOK_AT, 0.0),
    ]
    assert [cause[3] for cause in causes(phases, pictures=(11.5,))] == [reason]


def test_a_second_picture_is_type1():
    # Before the person until 14 s, then home.
    phases = [
        *BEGIN,
        (11.0, 0, 0.8, 1.6, LOOK_AT, 0.0),
        (14.0, 0, 0.8, 1.6, LOOK_AT, 0.0),
        (21.0, -3, 0, 1.6, LOOK_AT, 0.0),
    ]
    found = causes(phases, pictures=(11.5, 13.5))
    assert found == [("I", 13.5, 13.5, "one picture more than was wanted")]


def test_flying_off_without_a_picture_is_type1_but_flying_to_the_person_is_not():
    # The person is at (0, 3). It is seen to turn until 9.2 s (0.09 rad in half a second), when it
    # has flown 0.1 m to the side with 0.5 m/s. More than 1 m from there is 11.3 s.
    aside = [*BEGIN_AWAY, (15.0, -3, 0, 1.6, AWAY, 0.0)]
    assert causes(aside) == [("I", 11.3, 11.3, "it flies off without a picture")]
    assert causes([*BEGIN_AWAY, (13.0, 0, 2, 1.6, AWAY, 0.0)]) == []


def test_landing_before_it_has_turned_is_type1():
    # 0.35 m below 1.6 m is passed at 7.875 s, when it sinks by 1.6 m in 4 s.
    phases = [(3.0, 0, 0, 1.6, 0.0, 0.0), (7.0, 2, 0, 1.6, 0.0, 0.0), (11.0, 2, 0, 0.0, 0.0, 0.0)]
    assert causes(phases) == [("I", 7.9, 7.9, "it lands without having taken a picture")]


def test_falling_and_climbing_away_are_type1():
    # At home with its picture, 1 m up at 24 s: down in 0.5 s is 2 m/s, in 2 s is 0.5 m/s.
    home = [*BEGIN, (11.0, 0, 0.8, 1.6, LOOK_AT, 0.0), (18.0, -3, 0, 1.6, LOOK_AT, 0.0)]
    low = (20.0, -3, 0, 1.0, LOOK_AT, 0.0)
    assert causes([*home, low, (20.5, -3, 0, 0.0, LOOK_AT, 0.0)], (11.5,)) == [
        ("I", 20.1, 20.1, "it falls")
    ]
    assert causes([*home, low, (22.0, -3, 0, 0.0, LOOK_AT, 0.0)], (11.5,)) == []
    # From 1.6 m at 3 s to 4.6 m at 5 s: 2.5 m are passed at 3.6 s.
    climbing = [(3.0, 0, 0, 1.6, 0.0, 0.0), (5.0, 0, 0, 4.6, 0.0, 0.0)]
    ((kind, start, _, reason),) = causes(climbing)
    assert (kind, reason) == ("I", "it climbs away")
    assert 3.55 < start < 3.75


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
