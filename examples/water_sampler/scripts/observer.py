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
READY_S = 10.0  # by then it takes off
ON_GROUND_M = 0.3
FLYING_M = 1.0
AWAY_M = 1.0  # from where it took off: too far to land there
DESCENT_M = 0.5
BACK_M = 0.5
SUNK_M = 0.5  # no tube is lowered so deep: the UAV itself gets wet
CLIMBING_M_S = 0.1
FALLING_M_S = 1.5
FALL_S = 0.3  # a shorter fall is a landing


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
        self._home: Sight | None = None
        self._highest = 0.0
        self._farthest = 0.0
        self._was_at_tank = False
        self._pumped = False
        self._told: set[str] = set()
        self._dry_since: float | None = None
        self._dry_marked = False
        self._silent_since: float | None = None

    def judge(self, sight: Sight) -> None:
        """Say what is wrong."""
        if self._home is None:
            self._home = sight
        self._highest = max(self._highest, sight.z)
        away = math.hypot(sight.x - self._home.x, sight.y - self._home.y)
        self._farthest = max(self._farthest, away)
        self._was_at_tank = self._was_at_tank or (sight.above_tank and sight.z > FLYING_M)
        self._listen(sight)
        self._watch_waiting(sight, self._home)
        self._watch_way(sight, away)
        self._watch_descent(sight, away)

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

    def _watch_waiting(self, sight: Sight, home: Sight) -> None:
        idle = not sight.pump_running and sight.vial_level < FULL
        at_tank = sight.above_tank and sight.z > FLYING_M
        still = not self.moving() and not self._climbing()
        missing = "no pump is heard" if sight.tip_in_water else "the tube stays above the water"
        self.waiting(idle and at_tank and still, f"it stands at the tank, and {missing}")
        late = self._highest < ON_GROUND_M and sight.time - home.time > READY_S
        self.waiting(late, "it does not take off")
        hovers = still and not sight.above_tank and sight.z > ON_GROUND_M
        self.waiting(hovers, "it hovers where there is nothing to do")

    def _watch_way(self, sight: Sight, away: float) -> None:
        if sight.z < FLYING_M:
            return
        if self._was_at_tank:
            left = not sight.above_tank and away < self._farthest - BACK_M
            if left and not self._pumped:
                self._tell("empty", sight, "it leaves the tank without having pumped")
        elif AWAY_M < away < self._farthest - BACK_M:
            self._tell("empty", sight, "it turns back before the tank")

    def _watch_descent(self, sight: Sight, away: float) -> None:
        if sight.above_tank and sight.tip_depth > SUNK_M:
            self._tell("wrong place", sight, "it comes down into the tank")
        down = ON_GROUND_M < sight.z < self._highest - DESCENT_M
        if down and not sight.above_tank and away > AWAY_M:
            self._tell("wrong place", sight, "it comes down far from home")
        if self._sinking() > FALLING_M_S:
            self._tell("fall", sight, "it falls")

    def _tell(self, what: str, sight: Sight, reason: str) -> None:
        if what not in self._told:
            self._told.add(what)
            self.wrong(sight.time, reason)

    def _sinking(self) -> float:
        """How fast it came down in the last moments, m/s; 0 where too little was seen."""
        last = self.recent[-1]
        before = [sight for sight in self.recent if last.time - sight.time > 0.99 * FALL_S]
        if not before:
            return 0.0
        return (before[-1].z - last.z) / (last.time - before[-1].time)

    def _climbing(self) -> bool:
        climbed = abs(self.recent[-1].z - self.recent[0].z)
        return self.elapsed() > 0.0 and climbed / self.elapsed() > CLIMBING_M_S


class TankEyes(Eyes[Sight]):
    """What is seen of the UAV and of what hangs below it at one time is one sight.

    Under load either may come late, and a sight of two times has a UAV that jumps.
    """

    def __init__(self) -> None:
        """Nothing was seen yet."""
        self._uavs: dict[int, Point] = {}
        self._samplers: dict[int, SamplerTruth] = {}

    def channels(self) -> Mapping[str, Channel[Sight]]:
        """The UAV's place; the tube, the pump and the vial."""
        return {
            "/truth/uav": Channel("geometry_msgs/PoseStamped", self._uav),
            "/truth/sampler": Channel("water_sampler/SamplerTruth", self._sampler),
        }

    def _uav(self, message: PoseStamped) -> Sight | None:
        stamp = message.header.stamp.to_nsec()
        self._uavs[stamp] = message.pose.position
        return self._sight(stamp)

    def _sampler(self, message: SamplerTruth) -> Sight | None:
        stamp = message.header.stamp.to_nsec()
        self._samplers[stamp] = message
        return self._sight(stamp)

    def _sight(self, stamp: int) -> Sight | None:
        """What is seen at a time (ns); None while half of it is missing."""
        if stamp not in self._uavs or stamp not in self._samplers:
            return None
        place, sampler = self._uavs[stamp], self._samplers[stamp]
        # Each topic's messages come in order: nothing older will be whole.
        self._uavs = {time: uav for time, uav in self._uavs.items() if time > stamp}
        self._samplers = {time: seen for time, seen in self._samplers.items() if time > stamp}
        tip, tank = sampler.tip, sampler.tank
        return Sight(
            sampler.header.stamp.to_sec(),
            place.x,
            place.y,
            place.z,
            math.hypot(tip.x - tank.x, tip.y - tank.y) < sampler.tank_radius,
            tank.z - tip.z,
            sampler.pump_running,
            sampler.vial_level,
        )


OBSERVER = Observer(Sight, TankRules, TankEyes)

if __name__ == "__main__":
    sys.exit(main(OBSERVER, sys.argv[1:]))
