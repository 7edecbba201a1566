#!/usr/bin/env python3
"""A scripted observer: sees what a person beside the field sees, and sets marks.

It knows how the mission looks when it goes right (thesis, appendix D.3): the UAV
turns until the person is in front of it, takes the picture, flies home and lands.
It sees the UAV, the person and the shutter; no parameter, report or treatment.
``/mark_action`` is "it did what it should not" (type I), ``/mark_no_action`` "it
does not do what it should" (type II). The time in a mark is the simulated time at
which the key was pressed, a human's delay after the cause.
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
REPEAT_S = (4.0, 9.0)
NOBODY_PATIENCE_S = 6.0

IN_FRONT_RAD = math.radians(25.0)
IN_VIEW_RAD = math.radians(32.0)
IN_FRONT_M = 5.0
FLYING_M = 1.0
DESCENT_M = 0.35
TURNING_RAD_S = 0.15
MOVING_M_S = 0.3


@dataclass(frozen=True)
class Sight:
    """What is seen at one moment: time in s, positions in m, yaw in rad."""

    time: float
    x: float
    y: float
    z: float
    yaw: float
    person_x: float
    person_y: float

    @property
    def bearing(self) -> float:
        """Angle between the UAV's heading and the person, rad, in [-pi, pi]."""
        angle = math.atan2(self.person_y - self.y, self.person_x - self.x) - self.yaw
        return math.remainder(angle, 2.0 * math.pi)

    @property
    def distance(self) -> float:
        """Distance from the UAV to the person on the ground plan, m."""
        return math.hypot(self.person_x - self.x, self.person_y - self.y)


@dataclass(frozen=True)
class Mark:
    """A key press: simulated time in s, and which key."""

    time: float
    topic: str
    reason: str


class Observer:
    """Turns sights and shutter events into marks; time runs forwards only."""

    def __init__(self, seed: int) -> None:
        """``seed`` is for the delays of this person."""
        self._random = random.Random(seed)
        self._pending: list[Mark] = []
        self._recent: deque[Sight] = deque()
        self._highest = 0.0
        self._has_turned = False
        self._pictures = 0
        self._person_photographed = False
        self._descent_seen = False
        self._front_since: float | None = None
        self._front_until_mark = 0.0
        self._nobody_since: float | None = None
        self._nobody_marked = False

    def see(self, sight: Sight) -> list[Mark]:
        """Take in one sight; return the keys that were pressed until it."""
        self._recent.append(sight)
        while sight.time - self._recent[0].time > 0.5:
            self._recent.popleft()
        self._highest = max(self._highest, sight.z)
        flying = sight.z > FLYING_M
        if self._turning():
            self._has_turned = self._has_turned or flying
        self._watch_person(sight, flying)
        self._watch_nobody(sight, flying)
        self._watch_descent(sight)
        pressed = [mark for mark in self._pending if mark.time <= sight.time]
        self._pending = [mark for mark in self._pending if mark.time > sight.time]
        return sorted(pressed, key=lambda mark: mark.time)

    def shutter(self) -> None:
        """The camera clicked; whom it shows is judged by the last sight."""
        if not self._recent:
            return
        self._pictures += 1
        sight = self._recent[-1]
        if abs(sight.bearing) < IN_VIEW_RAD:
            self._person_photographed = True
            self._pending = [mark for mark in self._pending if mark.topic != TYPE_II]
        else:
            self._press(TYPE_I, sight.time, "a picture of nobody")

    def _press(self, topic: str, cause: float, reason: str) -> None:
        delay = self._random.lognormvariate(math.log(REACTION_MEDIAN_S), REACTION_SIGMA)
        self._pending.append(Mark(cause + delay, topic, reason))

    def _watch_person(self, sight: Sight, flying: bool) -> None:
        in_front = abs(sight.bearing) < IN_FRONT_RAD and sight.distance < IN_FRONT_M
        standing = flying and self._has_turned and not self._moving() and not self._turning()
        if not (in_front and standing) or self._person_photographed:
            if self._front_since is not None:
                # It turned away or went on: the hand leaves the key.
                self._pending = [mark for mark in self._pending if mark.topic != TYPE_II]
            self._front_since = None
            return
        if self._front_since is None:
            self._front_since = sight.time
            patience = max(4.0, self._random.gauss(*PATIENCE_S))
            self._front_until_mark = sight.time + patience
        if sight.time < self._front_until_mark:
            return
        self._press(TYPE_II, sight.time, "in front of the person, and no picture")
        self._front_until_mark = sight.time + self._random.uniform(*REPEAT_S)

    def _watch_nobody(self, sight: Sight, flying: bool) -> None:
        watching = flying and self._has_turned and not self._descent_seen
        alone = abs(sight.bearing) > IN_VIEW_RAD
        if not (watching and alone) or self._turning() or self._moving():
            self._nobody_since = None
            self._nobody_marked = False
            return
        if self._nobody_since is None:
            self._nobody_since = sight.time
        if not self._nobody_marked and sight.time - self._nobody_since > NOBODY_PATIENCE_S:
            self._nobody_marked = True
            self._press(TYPE_I, sight.time, "it stopped turning, and nobody is there")

    def _watch_descent(self, sight: Sight) -> None:
        if self._descent_seen or not self._has_turned:
            return
        if sight.z < self._highest - DESCENT_M:
            self._descent_seen = True
            # After any picture landing is the next step; a wrong picture was marked as such.
            if self._pictures == 0:
                self._press(TYPE_I, sight.time, "it lands without having taken a picture")

    def _turning(self) -> bool:
        first, last = self._recent[0], self._recent[-1]
        if last.time <= first.time:
            return False
        turned = math.remainder(last.yaw - first.yaw, 2.0 * math.pi)
        return abs(turned) / (last.time - first.time) > TURNING_RAD_S

    def _moving(self) -> bool:
        first, last = self._recent[0], self._recent[-1]
        if last.time <= first.time:
            return False
        moved = math.hypot(last.x - first.x, last.y - first.y)
        return moved / (last.time - first.time) > MOVING_M_S


def main() -> None:
    """Run the observer as a ROS node."""
    # Imported here, so that the rules above can be tested without ROS.
    import rospy  # noqa: PLC0415
    from geometry_msgs.msg import PoseStamped  # noqa: PLC0415
    from image_capture.msg import Picture  # noqa: PLC0415
    from std_msgs.msg import Time  # noqa: PLC0415

    parser = argparse.ArgumentParser(description="scripted observer")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args(rospy.myargv()[1:])
    rospy.init_node("observer")
    observer = Observer(arguments.seed)
    publishers = {
        topic: rospy.Publisher(f"/{topic}", Time, queue_size=10) for topic in (TYPE_I, TYPE_II)
    }
    person: list[PoseStamped] = []

    def on_person(message: PoseStamped) -> None:
        person[:] = [message]

    def on_uav(message: PoseStamped) -> None:
        if not person:
            return
        pose, head = message.pose, person[0].pose.position
        yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
        time = message.header.stamp.to_sec()
        place = pose.position
        for mark in observer.see(Sight(time, place.x, place.y, place.z, yaw, head.x, head.y)):
            rospy.loginfo("%s at %.2f: %s", mark.topic, mark.time, mark.reason)
            publishers[mark.topic].publish(Time(rospy.Time.from_sec(mark.time)))

    rospy.Subscriber("/truth/person", PoseStamped, on_person, queue_size=10)
    rospy.Subscriber("/truth/uav", PoseStamped, on_uav, queue_size=10)
    rospy.Subscriber("/camera/picture", Picture, lambda _: observer.shutter(), queue_size=4)
    rospy.spin()


if __name__ == "__main__":
    main()
