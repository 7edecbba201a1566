#!/usr/bin/env python3
"""A scripted observer: sees what a person beside the tank sees, and sets marks.

It knows how the mission looks when it goes right (thesis, appendix D.1): the UAV flies over the
tank, lowers the tube into the water, pumps one vial full, flies home and lands. It sees the UAV,
the tube and the vial and hears the pump; no parameter, report or treatment. ``/mark_action`` is "it
did what it should not" (type I), ``/mark_no_action`` "it does not do what it should" (type II). The
time in a mark is the simulated time at which the key was pressed, a human's delay after the cause.
"""

from __future__ import annotations

import argparse
import math
import random
from collections import deque
from dataclasses import dataclass

TYPE_I = "mark_action"
TYPE_II = "mark_no_action"

REACTION_MEDIAN_S = 2.5  # thesis, table 6.14: 1 to 4 s where the error was plain to see
REACTION_SIGMA = 0.4
PATIENCE_S = (7.0, 1.0)  # with the reaction the 7 to 10 s of table 6.14, type II
LEAST_PATIENCE_S = 5.0
REPEAT_S = (4.0, 9.0)

FULL = 0.8  # of the vial; less is plainly not full
HEARD_S = 0.5  # a pump is heard to run or to have stopped
FLYING_M = 1.0
DESCENT_M = 0.5
MOVING_M_S = 0.3
CLIMBING_M_S = 0.1
WINDOW_S = 1.0


@dataclass(frozen=True)
class Sight:
    """What is seen and heard at one moment: time in s, positions in m.

    ``above_tank`` is of the tube's tip, ``tip_depth`` how far it is below the water's level.
    """

    time: float
    x: float
    y: float
    z: float
    above_tank: bool
    tip_depth: float
    pump_running: bool
    vial_level: float

    @property
    def tip_in_water(self) -> bool:
        """Whether the pump can draw water."""
        return self.above_tank and self.tip_depth > 0.0


@dataclass(frozen=True)
class Mark:
    """A key press: simulated time in s, and which key."""

    time: float
    topic: str
    reason: str


class Observer:
    """Turns sights into marks; time runs forwards only."""

    def __init__(self, seed: int) -> None:
        """``seed`` is for the delays of this person."""
        self._random = random.Random(seed)
        self._pending: list[Mark] = []
        self._recent: deque[Sight] = deque()
        self._highest = 0.0
        self._was_at_tank = False
        self._pumped = False
        self._descent_seen = False
        self._dry_since: float | None = None
        self._dry_marked = False
        self._silent_since: float | None = None
        self._waiting_until: float | None = None

    def see(self, sight: Sight) -> list[Mark]:
        """Take in one sight; return the keys that were pressed until it."""
        self._recent.append(sight)
        while sight.time - self._recent[0].time > WINDOW_S:
            self._recent.popleft()
        self._highest = max(self._highest, sight.z)
        self._was_at_tank = self._was_at_tank or (sight.above_tank and sight.z > FLYING_M)
        self._listen(sight)
        self._watch_waiting(sight)
        self._watch_descent(sight)
        pressed = [mark for mark in self._pending if mark.time <= sight.time]
        self._pending = [mark for mark in self._pending if mark.time > sight.time]
        return sorted(pressed, key=lambda mark: mark.time)

    def _press(self, topic: str, cause: float, reason: str) -> None:
        delay = self._random.lognormvariate(math.log(REACTION_MEDIAN_S), REACTION_SIGMA)
        self._pending.append(Mark(cause + delay, topic, reason))

    def _listen(self, sight: Sight) -> None:
        if sight.pump_running:
            self._pumped = True
            self._silent_since = None
            self._hear_air(sight)
            return
        stopped = self._pumped and self._silent_since is None
        if stopped:
            self._silent_since = sight.time
        was_dry, self._dry_since = self._dry_marked, None
        self._dry_marked = False
        # A pump that ran in the air was complained of already.
        if stopped and not was_dry and sight.vial_level < FULL:
            self._press(TYPE_I, sight.time, "the pump stops, and the vial is not full")

    def _hear_air(self, sight: Sight) -> None:
        if sight.tip_in_water:
            self._dry_since = None
            return
        if self._dry_since is None:
            self._dry_since = sight.time
        if not self._dry_marked and sight.time - self._dry_since > HEARD_S:
            self._dry_marked = True
            self._press(TYPE_I, self._dry_since, "the pump runs, and the tube is not in the water")

    def _watch_waiting(self, sight: Sight) -> None:
        idle = not sight.pump_running and sight.vial_level < FULL
        at_tank = sight.above_tank and sight.z > FLYING_M
        if not (idle and at_tank) or self._moving():
            if self._waiting_until is not None:
                # It goes on: the hand leaves the key.
                self._pending = [mark for mark in self._pending if mark.topic != TYPE_II]
            self._waiting_until = None
            return
        if self._waiting_until is None:
            patience = max(LEAST_PATIENCE_S, self._random.gauss(*PATIENCE_S))
            self._waiting_until = sight.time + patience
        if sight.time < self._waiting_until:
            return
        missing = "no pump is heard" if sight.tip_in_water else "the tube stays above the water"
        self._press(TYPE_II, sight.time, f"it stands at the tank, and {missing}")
        self._waiting_until = sight.time + self._random.uniform(*REPEAT_S)

    def _watch_descent(self, sight: Sight) -> None:
        leaving = self._was_at_tank and not sight.above_tank
        if self._descent_seen or not leaving or sight.z > self._highest - DESCENT_M:
            return
        self._descent_seen = True
        if not self._pumped:
            self._press(TYPE_I, sight.time, "it lands without having pumped")

    def _moving(self) -> bool:
        first, last = self._recent[0], self._recent[-1]
        duration = last.time - first.time
        if duration <= 0.0:
            return False
        sideways = math.hypot(last.x - first.x, last.y - first.y) / duration
        return sideways > MOVING_M_S or abs(last.z - first.z) / duration > CLIMBING_M_S


def main() -> None:
    """Run the observer as a ROS node."""
    # Imported here, so that the rules above can be tested without ROS.
    import rospy  # noqa: PLC0415
    from geometry_msgs.msg import PoseStamped  # noqa: PLC0415
    from std_msgs.msg import Time  # noqa: PLC0415
    from water_sampler.msg import SamplerTruth  # noqa: PLC0415

    parser = argparse.ArgumentParser(description="scripted observer")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args(rospy.myargv()[1:])
    rospy.init_node("observer")
    observer = Observer(arguments.seed)
    publishers = {
        topic: rospy.Publisher(f"/{topic}", Time, queue_size=10) for topic in (TYPE_I, TYPE_II)
    }
    uav: list[PoseStamped] = []

    def on_uav(message: PoseStamped) -> None:
        uav[:] = [message]

    def on_sampler(message: SamplerTruth) -> None:
        if not uav:
            return
        place, tip, tank = uav[0].pose.position, message.tip, message.tank
        sight = Sight(
            message.header.stamp.to_sec(),
            place.x,
            place.y,
            place.z,
            math.hypot(tip.x - tank.x, tip.y - tank.y) < message.tank_radius,
            tank.z - tip.z,
            message.pump_running,
            message.vial_level,
        )
        for mark in observer.see(sight):
            rospy.loginfo("%s at %.2f: %s", mark.topic, mark.time, mark.reason)
            publishers[mark.topic].publish(Time(rospy.Time.from_sec(mark.time)))

    rospy.Subscriber("/truth/uav", PoseStamped, on_uav, queue_size=10)
    rospy.Subscriber("/truth/sampler", SamplerTruth, on_sampler, queue_size=10)
    rospy.spin()


if __name__ == "__main__":
    main()
