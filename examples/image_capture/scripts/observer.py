#!/usr/bin/env python3
"""A scripted observer: sees what a person beside the field sees, and sets marks.

It knows how the mission looks when it goes right (thesis, appendix D.3): the UAV
turns until the person is in front of it, takes the picture, flies home and lands.
It sees the UAV, the person and the shutter; no parameter, report or treatment.
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
    from geometry_msgs.msg import Point, PoseStamped
    from image_capture.msg import Picture

NOBODY_PATIENCE_S = 6.0

IN_FRONT_RAD = math.radians(25.0)
IN_VIEW_RAD = math.radians(32.0)
IN_FRONT_M = 5.0
FLYING_M = 1.0
DESCENT_M = 0.35
TURNING_RAD_S = 0.15


@dataclass(frozen=True)
class Sight(Look):
    """What is seen at one moment: yaw in rad, the person's place in m.

    ``pictures`` is how often the camera has clicked so far.
    """

    yaw: float
    person_x: float
    person_y: float
    pictures: int

    @property
    def bearing(self) -> float:
        """Angle between the UAV's heading and the person, rad, in [-pi, pi]."""
        angle = math.atan2(self.person_y - self.y, self.person_x - self.x) - self.yaw
        return math.remainder(angle, 2.0 * math.pi)

    @property
    def distance(self) -> float:
        """Distance from the UAV to the person on the ground plan, m."""
        return math.hypot(self.person_x - self.x, self.person_y - self.y)


class FieldRules(Rules[Sight]):
    """What the person beside the field knows."""

    window_s = 0.5

    def __init__(self) -> None:
        """The UAV stands at home."""
        super().__init__()
        self._highest = 0.0
        self._has_turned = False
        self._pictures = 0
        self._person_photographed = False
        self._descent_seen = False
        self._nobody_since: float | None = None
        self._nobody_marked = False

    def judge(self, sight: Sight) -> None:
        """Say what is wrong."""
        self._highest = max(self._highest, sight.z)
        flying = sight.z > FLYING_M
        if self._turning():
            self._has_turned = self._has_turned or flying
        self._listen(sight)
        self._watch_person(sight, flying)
        self._watch_nobody(sight, flying)
        self._watch_descent(sight)

    def _listen(self, sight: Sight) -> None:
        """The camera clicked, or did not; whom a picture shows is seen at once."""
        if sight.pictures == self._pictures:
            return
        self._pictures = sight.pictures
        if abs(sight.bearing) < IN_VIEW_RAD:
            self._person_photographed = True
        else:
            self.wrong(sight.time, "a picture of nobody")

    def _watch_person(self, sight: Sight, flying: bool) -> None:
        in_front = abs(sight.bearing) < IN_FRONT_RAD and sight.distance < IN_FRONT_M
        standing = flying and self._has_turned and not self.moving() and not self._turning()
        waiting = in_front and standing and not self._person_photographed
        self.waiting(waiting, "in front of the person, and no picture")

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
            self.wrong(sight.time, "it stopped turning, and nobody is there")

    def _watch_descent(self, sight: Sight) -> None:
        if self._descent_seen or not self._has_turned:
            return
        if sight.z < self._highest - DESCENT_M:
            self._descent_seen = True
            # After any picture landing is the next step; a wrong picture was marked as such.
            if self._pictures == 0:
                self.wrong(sight.time, "it lands without having taken a picture")

    def _turning(self) -> bool:
        first, last = self.recent[0], self.recent[-1]
        turned = math.remainder(last.yaw - first.yaw, 2.0 * math.pi)
        return self.elapsed() > 0.0 and abs(turned) / self.elapsed() > TURNING_RAD_S


class FieldEyes(Eyes[Sight]):
    """The person is seen before the UAV is."""

    def __init__(self) -> None:
        """Nothing was seen yet."""
        self._person: Point | None = None
        self._pictures = 0

    def channels(self) -> Mapping[str, Channel[Sight]]:
        """The UAV, the person, and the shutter."""
        return {
            "/truth/person": Channel("geometry_msgs/PoseStamped", self._somebody),
            "/truth/uav": Channel("geometry_msgs/PoseStamped", self._uav),
            "/camera/picture": Channel("image_capture/Picture", self._click),
        }

    def _somebody(self, message: PoseStamped) -> None:
        self._person = message.pose.position

    def _click(self, _: Picture) -> None:
        self._pictures += 1

    def _uav(self, message: PoseStamped) -> Sight | None:
        if self._person is None:
            return None
        place, turn = message.pose.position, message.pose.orientation
        return Sight(
            message.header.stamp.to_sec(),
            place.x,
            place.y,
            place.z,
            2.0 * math.atan2(turn.z, turn.w),
            self._person.x,
            self._person.y,
            self._pictures,
        )


OBSERVER = Observer(Sight, FieldRules, FieldEyes)

if __name__ == "__main__":
    sys.exit(main(OBSERVER, sys.argv[1:]))
