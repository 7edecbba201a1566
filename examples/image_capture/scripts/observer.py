#!/usr/bin/env python3
"""A scripted observer: sees what a person beside the field sees, and sets marks.

It knows how the mission looks when it goes right (thesis, appendix D.3): the UAV
turns until the person is in front of it, takes the picture, flies home and lands.
It sees the UAV, the person and the shutter; no parameter, report or treatment.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from simulated_world.observer import TYPE_I, Look, Person

NOBODY_PATIENCE_S = 6.0

IN_FRONT_RAD = math.radians(25.0)
IN_VIEW_RAD = math.radians(32.0)
IN_FRONT_M = 5.0
FLYING_M = 1.0
DESCENT_M = 0.35
TURNING_RAD_S = 0.15


@dataclass(frozen=True)
class Sight(Look):
    """What is seen at one moment: yaw in rad, the person's place in m."""

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


class Observer(Person[Sight]):
    """The person beside the field."""

    window_s = 0.5

    def __init__(self, seed: int) -> None:
        """``seed`` is for the delays of this person."""
        super().__init__(seed)
        self._highest = 0.0
        self._has_turned = False
        self._pictures = 0
        self._person_photographed = False
        self._descent_seen = False
        self._nobody_since: float | None = None
        self._nobody_marked = False

    def judge(self, sight: Sight) -> None:
        """Press keys for what is wrong."""
        self._highest = max(self._highest, sight.z)
        flying = sight.z > FLYING_M
        if self._turning():
            self._has_turned = self._has_turned or flying
        self._watch_person(sight, flying)
        self._watch_nobody(sight, flying)
        self._watch_descent(sight)

    def shutter(self) -> None:
        """The camera clicked; whom it shows is judged by the last sight."""
        if not self.recent:
            return
        self._pictures += 1
        sight = self.recent[-1]
        if abs(sight.bearing) < IN_VIEW_RAD:
            self._person_photographed = True
            self.give_up()
        else:
            self.press(TYPE_I, sight.time, "a picture of nobody")

    def _watch_person(self, sight: Sight, flying: bool) -> None:
        in_front = abs(sight.bearing) < IN_FRONT_RAD and sight.distance < IN_FRONT_M
        standing = flying and self._has_turned and not self.moving() and not self._turning()
        waiting = in_front and standing and not self._person_photographed
        self.wait(sight, waiting, "in front of the person, and no picture")

    def _watch_nobody(self, sight: Sight, flying: bool) -> None:
        watching = flying and self._has_turned and not self._descent_seen
        alone = abs(sight.bearing) > IN_VIEW_RAD
        if not (watching and alone) or self._turning() or self.moving():
            self._nobody_since = None
            self._nobody_marked = False
            return
        if self._nobody_since is None:
            self._nobody_since = sight.time
        if not self._nobody_marked and sight.time - self._nobody_since > NOBODY_PATIENCE_S:
            self._nobody_marked = True
            self.press(TYPE_I, sight.time, "it stopped turning, and nobody is there")

    def _watch_descent(self, sight: Sight) -> None:
        if self._descent_seen or not self._has_turned:
            return
        if sight.z < self._highest - DESCENT_M:
            self._descent_seen = True
            # After any picture landing is the next step; a wrong picture was marked as such.
            if self._pictures == 0:
                self.press(TYPE_I, sight.time, "it lands without having taken a picture")

    def _turning(self) -> bool:
        first, last = self.recent[0], self.recent[-1]
        turned = math.remainder(last.yaw - first.yaw, 2.0 * math.pi)
        return self.elapsed() > 0.0 and abs(turned) / self.elapsed() > TURNING_RAD_S


def main() -> None:
    """Run the observer as a ROS node."""
    # Imported here, so that the rules above can be tested without ROS.
    import rospy  # noqa: PLC0415
    from geometry_msgs.msg import PoseStamped  # noqa: PLC0415
    from image_capture.msg import Picture  # noqa: PLC0415
    from simulated_world.observer_node import Keys, start_observer  # noqa: PLC0415

    observer = Observer(start_observer())
    keys = Keys()
    person: list[PoseStamped] = []

    def on_person(message: PoseStamped) -> None:
        person[:] = [message]

    def on_uav(message: PoseStamped) -> None:
        if not person:
            return
        pose, head = message.pose, person[0].pose.position
        yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
        place = pose.position
        time = message.header.stamp.to_sec()
        sight = Sight(time, place.x, place.y, place.z, yaw, head.x, head.y)
        keys.press(observer.see(sight))

    rospy.Subscriber("/truth/person", PoseStamped, on_person, queue_size=100)
    rospy.Subscriber("/truth/uav", PoseStamped, on_uav, queue_size=100)
    rospy.Subscriber("/camera/picture", Picture, lambda _: observer.shutter(), queue_size=4)
    rospy.spin()


if __name__ == "__main__":
    main()
