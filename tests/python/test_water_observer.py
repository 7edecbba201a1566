"""The observer of the water sampler: what it sees and hears, and when it presses a key."""

from __future__ import annotations

from collections.abc import Iterable
from types import SimpleNamespace

import pytest
from observer_scripts import load_observer, shared_module

from pytpc_evaluation.demo.demo_examples import WATER_SAMPLER

observer = load_observer(WATER_SAMPLER)
Person = shared_module("person").Person

# The tube is 1 m long and the water 0.65 m above the ground: its tip is wet below a height of 1.65.
WET_BELOW = 1.65
TANK_X = 3.0
AT_TANK, AT_HOME = TANK_X, 0.0


def sights(*phases: tuple[float, float, float, bool, float]) -> Iterable:
    """Sights ten times a second. A phase: until, then at its end x, z, vial's level; the pump runs.

    A phase is (until, x, z, pump runs, vial's level); place, height and level change evenly.
    """
    time, x, z, level = 0.0, 0.0, 0.0, 0.0
    for until, to_x, to_z, running, to_level in phases:
        steps = round((until - time) * 10)
        for step in range(1, steps + 1):
            share = step / steps
            at_x, at_z = x + share * (to_x - x), z + share * (to_z - z)
            yield observer.Sight(
                round(time + step * 0.1, 3),
                at_x,
                0.0,
                at_z,
                abs(at_x - TANK_X) < 0.45,
                WET_BELOW - at_z,
                running,
                level + share * (to_level - level),
            )
        time, x, z, level = until, to_x, to_z, to_level


def watch(phases: list, seed: int = 1) -> list:
    person = Person(observer.OBSERVER.rules(), seed)
    return [mark for sight in sights(*phases) for mark in person.see(sight)]


# Up in 4 s, at the tank at 8 s, there until 10 s.
BEGIN = [(4.0, 0.0, 2.4, False, 0.0), (8.0, AT_TANK, 2.4, False, 0.0)]
LOWERED = [*BEGIN, (10.0, AT_TANK, 2.4, False, 0.0), (16.0, AT_TANK, 1.5, False, 0.0)]


def home(at: float, level: float) -> list:
    """From the tank at ``at`` up, home and down."""
    return [
        (at + 2.0, AT_TANK, 2.4, False, level),
        (at + 6.0, AT_HOME, 2.4, False, level),
        (at + 10.0, AT_HOME, 0.0, False, level),
        (at + 40.0, AT_HOME, 0.0, False, level),
    ]


@pytest.mark.parametrize("seed", range(10))
def test_right_mission_gets_no_mark(seed):
    phases = [
        *LOWERED,
        (19.0, AT_TANK, 1.5, False, 0.0),
        (29.0, AT_TANK, 1.5, True, 0.9),
        *home(29.0, 0.9),
    ]
    assert watch(phases, seed) == []


@pytest.mark.parametrize("seed", range(10))
def test_pump_in_the_air_is_one_type1_mark(seed):
    # At 1.9 m the tip is 0.25 m above the water; the pump runs from 14 to 18 s.
    phases = [
        *BEGIN,
        (13.0, AT_TANK, 1.9, False, 0.0),
        (14.0, AT_TANK, 1.9, False, 0.0),
        (18.0, AT_TANK, 1.9, True, 0.0),
        *home(18.0, 0.0),
    ]
    marks = watch(phases, seed)
    assert [mark.topic for mark in marks] == ["mark_action"]
    assert "not in the water" in marks[0].reason
    # After the 0.5 s in which the pump is recognised, and a reaction: less than 2.5 * e^(3 * 0.4).
    assert 14.5 < marks[0].time < 14.0 + 8.3


def test_pump_that_stops_early_is_one_type1_mark():
    # From 17 s it pumps a third of a vial in 4 s.
    phases = [
        *LOWERED,
        (17.0, AT_TANK, 1.5, False, 0.0),
        (21.0, AT_TANK, 1.5, True, 0.33),
        *home(21.0, 0.33),
    ]
    marks = watch(phases)
    assert [mark.topic for mark in marks] == ["mark_action"]
    assert "not full" in marks[0].reason
    assert marks[0].time > 21.0


@pytest.mark.parametrize(
    ("height", "what"), [(2.4, "stays above the water"), (1.5, "no pump is heard")]
)
def test_standing_at_the_tank_is_type2_again_and_again(height, what):
    # It stands from 16 s on. Patience 7 s, never under 5 s, and the reaction, which is over 0.7 s
    # in 999 of 1000 cases; then a mark every 4 to 9 s: at least (60 - 16 - 11 - 9) / 9 = 2.
    phases = [*BEGIN, (16.0, AT_TANK, height, False, 0.0), (60.0, AT_TANK, height, False, 0.0)]
    # Where it is not lowered it stands from 8 s on.
    stands = 16.0 if height < 2.4 else 8.0
    for seed in range(20):
        marks = watch(phases, seed)
        assert {mark.topic for mark in marks} == {"mark_no_action"}
        assert all(what in mark.reason for mark in marks)
        assert stands + 5.0 < marks[0].time < stands + 11.0 + 9.0
        assert 2 <= len(marks) <= 13
        assert [mark.time for mark in marks] == sorted(mark.time for mark in marks)


def test_a_pump_at_last_ends_the_marks_and_what_was_about_to_be_pressed():
    phases = [
        *LOWERED,
        (36.0, AT_TANK, 1.5, False, 0.0),
        (46.0, AT_TANK, 1.5, True, 0.9),
        *home(46.0, 0.9),
    ]
    for seed in range(20):
        marks = watch(phases, seed)
        assert marks
        assert all(mark.time <= 36.1 for mark in marks)


def test_lowering_slowly_is_not_standing():
    # 0.15 m a second for 6 s between 4 s and 3 s of standing: 13 s at the tank without a pump, but
    # the patience, never under 5 s, begins anew each time.
    phases = [
        *BEGIN,
        (12.0, AT_TANK, 2.4, False, 0.0),
        (18.0, AT_TANK, 1.5, False, 0.0),
        (21.0, AT_TANK, 1.5, False, 0.0),
        (31.0, AT_TANK, 1.5, True, 0.9),
        *home(31.0, 0.9),
    ]
    assert all(watch(phases, seed) == [] for seed in range(20))


def causes(phases: list) -> list[tuple[str, float, str]]:
    """Kind, begin in s and reason of all that is wrong."""
    found = shared_module("rules").causes_of(observer.TankRules(), sights(*phases))
    return [(cause.kind, round(cause.start, 1), cause.reason) for cause in found]


def test_leaving_without_having_pumped_is_type1():
    # It goes on at once: nobody loses patience. It leaves at 11 s with 3 m in 4 s: 0.45 m, where
    # the tank ends, after 0.6 s, and 0.5 m, where it is plain that it goes home, after 0.67 s.
    phases = [*BEGIN, (9.0, AT_TANK, 2.4, False, 0.0), *home(9.0, 0.0)]
    assert causes(phases) == [("I", 11.7, "it leaves the tank without having pumped")]


def test_turning_back_before_the_tank_is_type1():
    # At 2 m, before the tank, it turns at 7 s; 0.5 m back at 1 m/s are 0.5 s, and a look more.
    phases = [
        BEGIN[0],
        (7.0, 2.0, 2.4, False, 0.0),
        (9.0, AT_HOME, 2.4, False, 0.0),
        (13.0, AT_HOME, 0.0, False, 0.0),
    ]
    assert causes(phases) == [("I", 7.6, "it turns back before the tank")]


def test_coming_down_in_the_midst_is_type1_once():
    # From 2.4 m at 0.6 m/s: 0.5 m lower after 0.83 s.
    phases = [BEGIN[0], (6.0, 1.5, 2.4, False, 0.0), (10.0, 1.5, 0.0, False, 0.0)]
    assert causes(phases) == [("I", 6.9, "it comes down far from home")]


def test_coming_down_into_the_tank_is_type1():
    # 0.5 m deep is the tip at 1.15 m: 1.25 m lower, after 2.08 s at 0.6 m/s.
    phases = [*BEGIN, (12.0, AT_TANK, 0.0, False, 0.0)]
    assert causes(phases) == [("I", 10.1, "it comes down into the tank")]


def test_falling_is_type1():
    # The last metre in 0.4 s are 2.5 m/s; over 0.3 s that is 0.45 m after 0.2 s:
    # 0.1 s at 0.6 m/s and 0.2 s at 2.5 m/s are 0.56 m.
    filled = [*LOWERED, (26.0, AT_TANK, 1.5, True, 0.9), (28.0, AT_TANK, 2.4, False, 0.9)]
    down = [(32.0, AT_HOME, 2.4, False, 0.9), (34.0, AT_HOME, 1.0, False, 0.9)]
    fall = (34.4, AT_HOME, 0.0, False, 0.9)
    assert causes([*filled, *down, fall]) == [("I", 34.2, "it falls")]
    # At 0.6 m/s it lands.
    assert causes([*filled, *down, (35.7, AT_HOME, 0.0, False, 0.9)]) == []


def test_staying_on_the_ground_is_type2_from_when_it_should_have_gone():
    late = [(40.0, 0.0, 0.0, False, 0.0), (44.0, 0.0, 2.4, False, 0.0)]
    # It is given 10 s from the first look on, at 0.1 s.
    assert causes(late) == [("II", 10.2, "it does not take off")]
    # 14 s are 4 s too many: less than the patience of 5 s.
    assert causes([(14.0, 0.0, 0.0, False, 0.0), (18.0, 0.0, 2.4, False, 0.0)]) == []


def test_hovering_away_from_the_tank_is_type2():
    # Still since 6 s; in the second before, which is looked at together, it moved over 0.3 m/s
    # until 0.6 s later: 1.5 m in 2 s are 0.75 m/s, of which 0.4 s are left in that second.
    phases = [BEGIN[0], (6.0, 1.5, 2.4, False, 0.0), (16.0, 1.5, 2.4, False, 0.0)]
    assert causes(phases) == [("II", 6.6, "it hovers where there is nothing to do")]


def test_a_sight_is_of_one_time_though_its_halves_come_late():
    def uav(seconds: float, z: float) -> SimpleNamespace:
        place = SimpleNamespace(x=0.0, y=0.0, z=z)
        return SimpleNamespace(header=header(seconds), pose=SimpleNamespace(position=place))

    def sampler(seconds: float) -> SimpleNamespace:
        return SimpleNamespace(
            header=header(seconds), tip=SimpleNamespace(x=0.0, y=0.0, z=0.0),
            tank=SimpleNamespace(x=TANK_X, y=0.0, z=0.65), tank_radius=0.45,
            pump_running=False, vial_level=0.0,
        )  # fmt: skip

    def header(seconds: float) -> SimpleNamespace:
        nanoseconds = round(seconds * 1e9)
        stamp = SimpleNamespace(to_nsec=lambda: nanoseconds, to_sec=lambda: seconds)
        return SimpleNamespace(stamp=stamp)

    channels = observer.TankEyes().channels()
    see_uav, see_sampler = (channels[f"/truth/{name}"].take for name in ("uav", "sampler"))
    # Three of the UAV at once, then those of the tube; one of each has no other half.
    seen = [see_uav(uav(seconds, seconds)) for seconds in (0.1, 0.2, 0.3)]
    seen += [see_sampler(sampler(seconds)) for seconds in (0.1, 0.3, 0.4)]
    seen.append(see_uav(uav(0.4, 0.4)))
    assert [(s.time, s.z) for s in seen if s is not None] == [(0.1, 0.1), (0.3, 0.3), (0.4, 0.4)]


def test_waiting_for_a_moment_does_not_change_how_fast_a_person_is():
    # The pump stops at 21 s with a third of a vial. Before, the UAV goes evenly down, or stands
    # twice on its way, for 1.5 s: nobody loses patience, which is over 5 s.
    pumping = [
        (17.0, AT_TANK, 1.5, True, 0.0),
        (21.0, AT_TANK, 1.5, True, 0.33),
        *home(21.0, 0.33),
    ]
    evenly = [*BEGIN, (16.0, AT_TANK, 1.5, False, 0.0), *pumping]
    standing = [
        *BEGIN,
        (9.5, AT_TANK, 2.2, False, 0.0),
        (11.0, AT_TANK, 2.2, False, 0.0),
        (13.0, AT_TANK, 1.8, False, 0.0),
        (14.5, AT_TANK, 1.8, False, 0.0),
        (16.0, AT_TANK, 1.5, False, 0.0),
        *pumping,
    ]
    for seed in range(20):
        assert watch(evenly, seed) == watch(standing, seed)
        assert len(watch(evenly, seed)) == 1


def test_same_seed_same_marks():
    phases = [*BEGIN, (60.0, AT_TANK, 2.4, False, 0.0)]
    assert watch(phases, seed=5) == watch(phases, seed=5)
    assert watch(phases, seed=5) != watch(phases, seed=6)
