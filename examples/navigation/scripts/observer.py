#!/usr/bin/env python3
"""A scripted observer: sees what a person beside the arena sees, and sets marks.

It knows how the mission looks when it goes right: the robot leaves its dock, drives to the mark on
the floor without touching anything, lights its lamp there, drives back and stays in the dock. It
sees the robot, the cart and the lamp and hears what is touched; walls and boxes stand where they
stand. It knows no parameter, report or treatment.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from simulated_world.command import main
from simulated_world.observer import Channel, Eyes, Observer
from simulated_world.rules import Look, Rules

if TYPE_CHECKING:
    from geometry_msgs.msg import PoseStamped
    from navigation.msg import ArenaTruth

# What stands in the arena: from x, from y, to x, to y, m.
STANDING = (
    (-0.1, -0.1, 8.1, 0.0),
    (-0.1, 6.0, 8.1, 6.1),
    (-0.1, -0.1, 0.0, 6.1),
    (8.0, -0.1, 8.1, 6.1),
    (3.95, 0.0, 4.05, 2.3),
    (3.95, 3.3, 4.05, 6.0),
    (2.3, 1.7, 2.7, 2.1),
    (5.7, 3.0, 6.2, 3.5),
    (6.8, 1.6, 7.2, 2.0),
)
CART_HALF_M = 0.2

AT_MARK_M = 0.45
AT_DOCK_M = 0.5
STILL_M_S = 0.06
TURNING_RAD_S = 0.4  # slower is no turn that leads anywhere
BACKWARDS_M_S = 0.08
BACKWARDS_S = 0.5
FREE_AHEAD_M = 0.55  # from the robot's middle
AHEAD_RAD = math.radians(40.0)
ROUND_RAD = math.radians(300.0)
ON_THE_SPOT_M = 0.25
WITHDRAWN_M = 1.0


@dataclass(frozen=True)
class Sight(Look):
    """What is seen and heard at one moment.

    ``heading`` in rad, places in m. ``contact``: since the last sight something was touched.
    """

    heading: float
    cart_x: float
    cart_y: float
    goal_x: float
    goal_y: float
    contact: bool
    lamp: bool

    @property
    def from_goal(self) -> float:
        """The way to the mark on the floor, m."""
        return math.hypot(self.x - self.goal_x, self.y - self.goal_y)


def turn(before: float, after: float) -> float:
    """The turn from one heading to another, rad."""
    return math.remainder(after - before, 2.0 * math.pi)


def ahead(sight: Sight) -> float:
    """How far it is to what stands before the robot, m."""
    cart = (
        sight.cart_x - CART_HALF_M,
        sight.cart_y - CART_HALF_M,
        sight.cart_x + CART_HALF_M,
        sight.cart_y + CART_HALF_M,
    )
    least = math.inf
    for low_x, low_y, high_x, high_y in (*STANDING, cart):
        dx = min(max(sight.x, low_x), high_x) - sight.x
        dy = min(max(sight.y, low_y), high_y) - sight.y
        if abs(turn(sight.heading, math.atan2(dy, dx))) < AHEAD_RAD:
            least = min(least, math.hypot(dx, dy))
    return least


class ArenaRules(Rules[Sight]):
    """What the person beside the arena knows."""

    patience_s = 5.0

    def __init__(self) -> None:
        """The robot stands in its dock."""
        super().__init__()
        self._dock: tuple[float, float] | None = None
        self._left = False
        self._lit = False
        self._home_again = False
        self._nearest = math.inf
        self._withdrawal_seen = False
        self._last: Sight | None = None
        self._back_since: float | None = None
        self._back_seen = False
        self._turn_begun: Sight | None = None
        self._turned = 0.0

    def judge(self, sight: Sight) -> None:
        """Say what is wrong."""
        last = self._last or sight
        self._dock = self._dock or (sight.x, sight.y)
        self._watch_lamp(sight, last)
        self._follow(sight)
        if sight.contact and not last.contact:
            self.wrong(sight.time, "it touches something")
        self._watch_withdrawal(sight)
        self._watch_backwards(sight, last)
        self._watch_turns(sight, last)
        self._watch_waiting(sight)
        self._last = sight

    def _follow(self, sight: Sight) -> None:
        dock = self._dock or (sight.x, sight.y)
        from_dock = math.hypot(sight.x - dock[0], sight.y - dock[1])
        self._left = self._left or from_dock > 2.0 * AT_DOCK_M
        self._home_again = self._left and from_dock < AT_DOCK_M

    def _watch_lamp(self, sight: Sight, last: Sight) -> None:
        if not sight.lamp or last.lamp:
            return
        self._lit = True
        if sight.from_goal > AT_MARK_M:
            self.wrong(sight.time, "the lamp is lit, and the robot is not at the mark")

    def _watch_withdrawal(self, sight: Sight) -> None:
        self._nearest = min(self._nearest, sight.from_goal)
        away = sight.from_goal - self._nearest
        if self._lit or self._withdrawal_seen or away < WITHDRAWN_M:
            return
        self._withdrawal_seen = True
        self.wrong(sight.time, "it drives home, and the lamp was not lit")

    def _watch_backwards(self, sight: Sight, last: Sight) -> None:
        seconds = sight.time - last.time
        forwards = (sight.x - last.x) * math.cos(sight.heading)
        forwards += (sight.y - last.y) * math.sin(sight.heading)
        if seconds <= 0.0 or forwards / seconds > -BACKWARDS_M_S:
            self._back_since, self._back_seen = None, False
            return
        if self._back_since is None:
            self._back_since = sight.time
            self._back_seen = ahead(sight) < FREE_AHEAD_M
        if not self._back_seen and sight.time - self._back_since > BACKWARDS_S:
            self._back_seen = True
            self.wrong(self._back_since, "it drives backwards, and nothing is in its way")

    def _watch_turns(self, sight: Sight, last: Sight) -> None:
        begun = self._turn_begun
        if begun is None or math.hypot(sight.x - begun.x, sight.y - begun.y) > ON_THE_SPOT_M:
            self._turn_begun, self._turned = sight, 0.0
            return
        before = self._turned
        self._turned += turn(last.heading, sight.heading)
        if abs(self._turned) >= ROUND_RAD > abs(before):
            self.wrong(sight.time, "it turns round and round")

    def _watch_waiting(self, sight: Sight) -> None:
        standing = self._standing() and not sight.lamp
        if self._lit:
            reason = "it stands, and does not drive home"
        elif sight.from_goal < AT_MARK_M:
            reason = "it is at the mark, and the lamp is not lit"
        else:
            reason = "it stands, and does not drive to the mark"
        self.waiting(standing and not self._home_again, reason)

    def _standing(self) -> bool:
        first, last = self.recent[0], self.recent[-1]
        if self.elapsed() <= 0.0:
            return True
        moved = math.hypot(last.x - first.x, last.y - first.y)
        turned = abs(turn(first.heading, last.heading))
        return moved < STILL_M_S * self.elapsed() and turned < TURNING_RAD_S * self.elapsed()


class ArenaEyes(Eyes[Sight]):
    """The robot and what happens around it are seen at once, whichever message comes first."""

    def __init__(self) -> None:
        """Nothing was seen yet."""
        self._robot: PoseStamped | None = None
        self._arena: ArenaTruth | None = None
        self._goal: PoseStamped | None = None

    def channels(self) -> Mapping[str, Channel[Sight]]:
        """The robot's place; the mark on the floor; the cart, the lamp, a contact's sound."""
        return {
            "/truth/robot": Channel("geometry_msgs/PoseStamped", self._see_robot),
            "/truth/goal": Channel("geometry_msgs/PoseStamped", self._see_goal),
            "/truth/events": Channel("navigation/ArenaTruth", self._see_arena),
        }

    def _see_robot(self, message: PoseStamped) -> Sight | None:
        self._robot = message
        return self._sight()

    def _see_goal(self, message: PoseStamped) -> None:
        self._goal = message

    def _see_arena(self, message: ArenaTruth) -> Sight | None:
        self._arena = message
        return self._sight()

    def _sight(self) -> Sight | None:
        if self._robot is None or self._arena is None or self._goal is None:
            return None
        if self._robot.header.stamp != self._arena.header.stamp:
            return None
        robot, arena, goal = self._robot.pose, self._arena, self._goal.pose.position
        return Sight(
            time=arena.header.stamp.to_sec(),
            x=robot.position.x,
            y=robot.position.y,
            z=robot.position.z,
            heading=2.0 * math.atan2(robot.orientation.z, robot.orientation.w),
            cart_x=arena.cart_x,
            cart_y=arena.cart_y,
            goal_x=goal.x,
            goal_y=goal.y,
            contact=arena.contact,
            lamp=arena.lamp,
        )


OBSERVER = Observer(Sight, ArenaRules, ArenaEyes)

if __name__ == "__main__":
    sys.exit(main(OBSERVER, sys.argv[1:]))
