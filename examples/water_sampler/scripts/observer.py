#!/usr/bin/env python3
"""A scripted observer: sees what a person beside the tank sees, and sets marks.

It knows how the mission looks when it goes right (thesis, appendix D.1): the UAV flies over the
tank, lowers the tube into the water, pumps one vial full, flies home and lands. It sees the UAV,
the tube and the vial and hears the pump; no parameter, report or treatment.
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
    from water_sampler.msg import SamplerTruth

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


class TankRules(Rules[Sight]):
    """What the person beside the tank knows."""

    patience_s = 5.0

    def __init__(self) -> None:
        """The UAV stands at home."""
        super().__init__()
        self._highest = 0.0
        self._was_at_tank = False
        self._pumped = False
        self._descent_seen = False
        self._dry_since: float | None = None
        self._dry_marked = False
        self._silent_since: float | None = None

    def judge(self, sight: Sight) -> None:
        """Say what is wrong."""
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
            self.wrong(sight.time, "the pump stops, and the vial is not full")

    def _hear_air(self, sight: Sight) -> None:
        if sight.tip_in_water:
            self._dry_since = None
            return
        if self._dry_since is None:
            self._dry_since = sight.time
        if not self._dry_marked and sight.time - self._dry_since > HEARD_S:
            self._dry_marked = True
            self.wrong(self._dry_since, "the pump runs, and the tube is not in the water")

    def _watch_waiting(self, sight: Sight) -> None:
        idle = not sight.pump_running and sight.vial_level < FULL
        at_tank = sight.above_tank and sight.z > FLYING_M
        still = not self.moving() and not self._climbing()
        missing = "no pump is heard" if sight.tip_in_water else "the tube stays above the water"
        self.waiting(idle and at_tank and still, f"it stands at the tank, and {missing}")

    def _watch_descent(self, sight: Sight) -> None:
        leaving = self._was_at_tank and not sight.above_tank
        if self._descent_seen or not leaving or sight.z > self._highest - DESCENT_M:
            return
        self._descent_seen = True
        if not self._pumped:
            self.wrong(sight.time, "it lands without having pumped")

    def _climbing(self) -> bool:
        climbed = abs(self.recent[-1].z - self.recent[0].z)
        return self.elapsed() > 0.0 and climbed / self.elapsed() > CLIMBING_M_S


class TankEyes(Eyes[Sight]):
    """The UAV is seen a little before what hangs below it."""

    def __init__(self) -> None:
        """Nothing was seen yet."""
        self._place: Point | None = None

    def channels(self) -> Mapping[str, Channel[Sight]]:
        """The UAV's place; the tube, the pump and the vial."""
        return {
            "/truth/uav": Channel("geometry_msgs/PoseStamped", self._uav),
            "/truth/sampler": Channel("water_sampler/SamplerTruth", self._sampler),
        }

    def _uav(self, message: PoseStamped) -> None:
        self._place = message.pose.position

    def _sampler(self, message: SamplerTruth) -> Sight | None:
        if self._place is None:
            return None
        tip, tank = message.tip, message.tank
        return Sight(
            message.header.stamp.to_sec(),
            self._place.x,
            self._place.y,
            self._place.z,
            math.hypot(tip.x - tank.x, tip.y - tank.y) < message.tank_radius,
            tank.z - tip.z,
            message.pump_running,
            message.vial_level,
        )


OBSERVER = Observer(Sight, TankRules, TankEyes)

if __name__ == "__main__":
    sys.exit(main(OBSERVER, sys.argv[1:]))
