#!/usr/bin/env python3
"""A scripted observer: sees what a person beside the field sees, and sets marks.

It sees the UAV, the person and the shutter; no parameter, report or treatment.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from typing import TYPE_CHECKING

from simulated_world.command import main
from simulated_world.field import FieldRules, Sight
from simulated_world.observer import Channel, Eyes, Observer

if TYPE_CHECKING:
    from geometry_msgs.msg import Point, PoseStamped
    from image_capture.msg import Picture


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
            "/camera/picture": Channel("image_capture/Picture", self._click),
            "/truth/uav": Channel("geometry_msgs/PoseStamped", self._uav),
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
