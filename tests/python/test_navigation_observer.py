"""The observer of the ground robot: what it takes for wrong."""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import SimpleNamespace

import pytest
from observer_scripts import load_observer, shared_module

from pytpc_evaluation.demo.demo_examples import NAVIGATION

observer = load_observer(NAVIGATION)
causes_of = shared_module("rules").causes_of

DOCK = (1.0, 1.2)
GOAL = (6.6, 4.8)
EAST, WEST = 0.0, math.pi


@dataclass(frozen=True)
class Phase:
    """Until a time in s the robot comes evenly to a place, with a heading that changes evenly."""

    until: float
    place: tuple[float, float]
    heading: float = EAST
    lamp: bool = False
    contact: bool = False


def sights(*phases: Phase, cart_y: float = 5.6) -> list:
    """Ten a second, from the dock on."""
    seen, before = [], Phase(0.0, DOCK)
    for phase in phases:
        steps = round((phase.until - before.until) * 10)
        for step in range(1, steps + 1):
            share = step / steps
            x, y = (a + share * (b - a) for a, b in zip(before.place, phase.place, strict=True))
            seen.append(
                observer.Sight(
                    time=round(before.until + step * 0.1, 3),
                    x=x,
                    y=y,
                    z=0.0,
                    heading=before.heading + share * (phase.heading - before.heading),
                    cart_x=5.15,
                    cart_y=cart_y,
                    goal_x=GOAL[0],
                    goal_y=GOAL[1],
                    contact=phase.contact,
                    lamp=phase.lamp,
                )
            )
        before = phase
    return seen


def causes(*phases: Phase, cart_y: float = 5.6) -> list[tuple[str, float, str]]:
    found = causes_of(observer.OBSERVER.rules(), sights(*phases, cart_y=cart_y))
    return [(cause.kind, cause.start, cause.reason) for cause in found]


OUT = [Phase(2.0, DOCK), Phase(22.0, GOAL)]
LIT = [*OUT, Phase(23.5, GOAL), Phase(26.5, GOAL, lamp=True)]
HOME = [Phase(29.0, GOAL, WEST), Phase(49.0, DOCK, WEST), Phase(70.0, DOCK, WEST)]


def test_mission_that_goes_right_has_no_cause():
    assert causes(*LIT, *HOME) == []


def test_a_robot_that_does_not_start_is_waited_for():
    assert causes(Phase(20.0, DOCK)) == [("II", 0.1, "it stands, and does not drive to the mark")]


def test_a_short_stop_is_no_cause():
    # 4 s for the cart; what is seen as standing is a second of sights later.
    place = (4.5, 3.0)
    assert causes(Phase(2.0, DOCK), Phase(10.0, place), Phase(14.0, place), Phase(20.0, GOAL)) == []


def test_standing_at_the_mark_is_a_missing_lamp():
    [(kind, start, reason)] = causes(*OUT, Phase(40.0, GOAL))
    assert (kind, reason) == ("II", "it is at the mark, and the lamp is not lit")
    # The window of a second has to hold no more than 0.06 m of the way.
    assert 22.0 < start <= 23.1


def test_turning_to_and_fro_is_standing():
    turns = [Phase(22.0 + n, GOAL, 0.1 * (-1) ** n) for n in range(1, 12)]
    assert [kind for kind, _, _ in causes(*OUT, *turns)] == ["II"]


def test_lamp_that_is_lit_elsewhere_is_wrong():
    # At x 6.6 and y 4.3 the mark is 0.5 m away.
    place = (6.6, 4.3)
    found = causes(Phase(2.0, DOCK), Phase(22.0, place), Phase(25.0, place, lamp=True))
    assert found == [("I", 22.1, "the lamp is lit, and the robot is not at the mark")]


def test_contact_is_wrong_once():
    touching = Phase(13.0, (3.0, 2.8), contact=True)
    found = causes(Phase(2.0, DOCK), Phase(12.0, (3.0, 2.8)), touching, Phase(22.0, GOAL))
    assert found == [("I", 12.1, "it touches something")]


def test_driving_home_without_the_lamp_is_wrong():
    # Back it goes by 0.616 m/s. After 1.08 m the mark is 1.6 m away, a metre more than it was: at
    # 14 + 1.08 / 0.616 = 15.75 s.
    [(kind, start, reason)] = causes(
        Phase(2.0, DOCK), Phase(12.0, (6.0, 4.8)), Phase(14.0, (6.0, 4.8), WEST),
        Phase(24.0, (1.0, 1.2), WEST),
    )  # fmt: skip
    assert (kind, reason) == ("I", "it drives home, and the lamp was not lit")
    assert start == pytest.approx(15.8, abs=0.11)


@pytest.mark.parametrize(
    ("heading", "wrong"),
    # At (5.35, 3.25) a box begins 0.35 m to the east; to the west the floor is free.
    [(EAST, False), (WEST, True)],
)
def test_backing_up_is_wrong_where_nothing_is_in_the_way(heading, wrong):
    begin = (5.35, 3.25)
    back = (begin[0] - 0.4 * math.cos(heading), begin[1])
    found = causes(
        Phase(2.0, DOCK, heading), Phase(12.0, begin, heading), Phase(14.0, back, heading),
        cart_y=0.4,
    )  # fmt: skip
    # With the west before it the robot came backwards all the way.
    assert any("backwards" in reason for _, _, reason in found) == wrong


def test_turning_round_on_the_spot_is_wrong():
    place = (3.0, 2.8)
    # 360 degrees in 6 s: 300 of them after 5 s.
    found = causes(
        Phase(2.0, DOCK), Phase(12.0, place), Phase(18.0, place, 2.0 * math.pi),
        Phase(22.0, GOAL, 2.0 * math.pi),
    )  # fmt: skip
    assert [(kind, reason) for kind, _, reason in found] == [("I", "it turns round and round")]
    assert found[0][1] == pytest.approx(17.0, abs=0.2)


def test_robot_and_arena_make_one_sight_in_either_order():
    eyes = observer.OBSERVER.eyes()
    take = {topic: channel.take for topic, channel in eyes.channels().items()}
    early = SimpleNamespace(to_sec=lambda: 0.1)
    point = SimpleNamespace(x=1.0, y=2.0, z=0.0)
    facing = SimpleNamespace(z=0.0, w=1.0)
    pose = SimpleNamespace(
        header=SimpleNamespace(stamp=early),
        pose=SimpleNamespace(position=point, orientation=facing),
    )
    arena = SimpleNamespace(header=pose.header, cart_x=5.0, cart_y=4.0, contact=False, lamp=True)
    assert take["/truth/goal"](pose) is None
    assert take["/truth/events"](arena) is None
    sight = take["/truth/robot"](pose)
    assert (sight.time, sight.x, sight.y, sight.cart_y, sight.lamp) == (0.1, 1.0, 2.0, 4.0, True)
    # The next moment begins with either: what is known of the other is old.
    later = SimpleNamespace(**{**vars(pose), "header": SimpleNamespace(stamp="later")})
    assert take["/truth/robot"](later) is None
