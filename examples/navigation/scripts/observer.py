#!/usr/bin/env python3
"""A scripted observer: sees what a person beside the tank sees, and sets marks.

It knows how the mission looks when it goes right (thesis, appendix D.1): the UAV flies over the
tank, lowers the tube into the water, pumps one vial full, flies home and lands. It sees the UAV,
the tube and the vial and hears the pump; no parameter, report or treatment.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from simulated_world.observer import TYPE_I, Look, Person

FULL = 0.8  # of the vial; less is plainly not full
HEARD_S = 0.5  # a pump is heard to run or to have stopped
FLYING_M = 1.0
DESCENT_M = 0.5
CLIMBING_M_S = 0.1


@dataclass(frozen=True)
class Sight(Look):
    """What is seen and heard at one moment.

    ``above_tank`` is of the tube's tip, ``tip_depth`` how far it is below the
    water's level, m.
    """

    above_tank: bool
    tip_depth: float
    pump_running: bool
    vial_level: float

    @property
    def tip_in_water(self) -> bool:
        """Whether the pump can draw water."""
        return self.above_tank and self.tip_depth > 0.0


class Observer(Person[Sight]):
    """The person beside the tank."""

    least_patience_s = 5.0

    def __init__(self, seed: int) -> None:
        """``seed`` is for the delays of this person."""
        super().__init__(seed)
        self._highest = 0.0
        self._was_at_tank = False
        self._pumped = False
        self._descent_seen = False
        self._dry_since: float | None = None
        self._dry_marked = False
        self._silent_since: float | None = None

    def judge(self, sight: Sight) -> None:
        """Press keys for what is wrong."""
        self._highest = max(self._highest, sight.z)
        self._was_at_tank = self._was_at_tank or (sight.above_tank and sight.z > FLYING_M)
        self._listen(sight)
        self._watch_waiting(sight)
        self._watch_descent(sight)

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
            self.press(TYPE_I, sight.time, "the pump stops, and the vial is not full")

    def _hear_air(self, sight: Sight) -> None:
        if sight.tip_in_water:
            self._dry_since = None
            return
        if self._dry_since is None:
            self._dry_since = sight.time
        if not self._dry_marked and sight.time - self._dry_since > HEARD_S:
            self._dry_marked = True
            self.press(TYPE_I, self._dry_since, "the pump runs, and the tube is not in the water")

    def _watch_waiting(self, sight: Sight) -> None:
        idle = not sight.pump_running and sight.vial_level < FULL
        at_tank = sight.above_tank and sight.z > FLYING_M
        still = not self.moving() and not self._climbing()
        missing = "no pump is heard" if sight.tip_in_water else "the tube stays above the water"
        self.wait(sight, idle and at_tank and still, f"it stands at the tank, and {missing}")

    def _watch_descent(self, sight: Sight) -> None:
        leaving = self._was_at_tank and not sight.above_tank
        if self._descent_seen or not leaving or sight.z > self._highest - DESCENT_M:
            return
        self._descent_seen = True
        if not self._pumped:
            self.press(TYPE_I, sight.time, "it lands without having pumped")

    def _climbing(self) -> bool:
        climbed = abs(self.recent[-1].z - self.recent[0].z)
        return self.elapsed() > 0.0 and climbed / self.elapsed() > CLIMBING_M_S


def main() -> None:
    """Run the observer as a ROS node."""
    # Imported here, so that the rules above can be tested without ROS.
    import rospy  # noqa: PLC0415
    from geometry_msgs.msg import PoseStamped  # noqa: PLC0415
    from simulated_world.observer_node import Keys, start_observer  # noqa: PLC0415
    from water_sampler.msg import SamplerTruth  # noqa: PLC0415

    observer = Observer(start_observer())
    keys = Keys()
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
        keys.press(observer.see(sight))

    rospy.Subscriber("/truth/uav", PoseStamped, on_uav, queue_size=100)
    rospy.Subscriber("/truth/sampler", SamplerTruth, on_sampler, queue_size=100)
    rospy.spin()


if __name__ == "__main__":
    main()
