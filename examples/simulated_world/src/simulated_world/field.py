"""What a person beside the field of the image capture missions knows (thesis, appendix D.3).

The UAV takes off, flies to a point, turns until the person is in front of it, takes one picture,
flies home and lands. Only the UAV, the person and the shutter are seen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from simulated_world.rules import Look, Rules

NOBODY_PATIENCE_S = 6.0
START_PATIENCE_S = 5.0
AFTER_PICTURE_S = 2.0

IN_FRONT_RAD = math.radians(25.0)
IN_VIEW_RAD = math.radians(32.0)
IN_FRONT_M = 5.0
FLYING_M = 1.0
DESCENT_M = 0.35
GROUND_M = 0.3
TOO_HIGH_M = 2.5
LEAVING_M = 1.0
NEARER_SHARE = 0.5
FALLING_M_S = 1.5
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

    @property
    def in_front(self) -> bool:
        """The person is where the UAV looks, and near enough for a picture."""
        return abs(self.bearing) < IN_FRONT_RAD and self.distance < IN_FRONT_M


class FieldRules(Rules[Sight]):
    """What the person beside the field knows."""

    window_s = 0.5

    def __init__(self) -> None:
        """The UAV stands at home."""
        super().__init__()
        self._began: float | None = None
        self._highest = 0.0
        self._has_turned = False
        self._pictures = 0
        self._last_click = math.inf
        self._person_photographed = False
        self._descent_seen = False
        self._turned_at: Sight | None = None
        self._left = False
        self._is_high = False
        self._falls = False
        self._person_was_in_front = False
        self._nobody_since: float | None = None
        self._nobody_marked = False

    def judge(self, sight: Sight) -> None:
        """Say what is wrong."""
        self._highest = max(self._highest, sight.z)
        flying = sight.z > FLYING_M
        if self._turning():
            self._has_turned = self._has_turned or flying
        self._listen(sight)
        self._watch_start(sight)
        self._watch_way(sight, flying)
        self._watch_person(sight, flying)
        self._watch_turn(sight, flying)
        self._watch_leaving(sight, flying)
        self._watch_nobody(sight, flying)
        self._watch_height(sight)
        self._watch_descent(sight)

    def _listen(self, sight: Sight) -> None:
        """The camera clicked, or did not; whom a picture shows is seen at once."""
        if sight.pictures == self._pictures:
            return
        self._pictures = sight.pictures
        self._last_click = sight.time
        if abs(sight.bearing) >= IN_VIEW_RAD:
            self.wrong(sight.time, "a picture of nobody")
        elif self._person_photographed:
            self.wrong(sight.time, "one picture more than was wanted")
        else:
            self._person_photographed = True

    def _watch_start(self, sight: Sight) -> None:
        if self._began is None:
            self._began = sight.time
        late = sight.time - self._began > START_PATIENCE_S
        self.waiting(late and self._highest < GROUND_M, "it does not take off")

    def _watch_way(self, sight: Sight, flying: bool) -> None:
        standing = flying and not self.moving() and not self._turning()
        self.waiting(standing and not self._has_turned, "it stands on its way")
        done = sight.time - self._last_click > AFTER_PICTURE_S
        self.waiting(standing and done, "it has its picture, and does not come home")

    def _watch_person(self, sight: Sight, flying: bool) -> None:
        standing = flying and self._has_turned and not self.moving() and not self._turning()
        waiting = sight.in_front and standing and not self._person_photographed
        self.waiting(waiting, "in front of the person, and no picture")

    def _watch_leaving(self, sight: Sight, flying: bool) -> None:
        if not (flying and self._has_turned) or self._pictures > 0:
            return
        if self._turning() or self._turned_at is None:
            self._turned_at = sight
        flown = math.hypot(sight.x - self._turned_at.x, sight.y - self._turned_at.y)
        nearer = self._turned_at.distance - sight.distance
        if flown > LEAVING_M and nearer < NEARER_SHARE * flown and not self._left:
            self._left = True
            self.wrong(sight.time, "it flies off without a picture")

    def _watch_turn(self, sight: Sight, flying: bool) -> None:
        if self._pictures > 0 or not flying:
            self._person_was_in_front = False
        elif sight.in_front:
            self._person_was_in_front = self._has_turned
        passed = self._person_was_in_front and abs(sight.bearing) > IN_VIEW_RAD
        self.waiting(passed, "it turns past the person")

    def _watch_nobody(self, sight: Sight, flying: bool) -> None:
        watching = flying and self._has_turned and self._pictures == 0
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

    def _watch_height(self, sight: Sight) -> None:
        if sight.z > TOO_HIGH_M and not self._is_high:
            self._is_high = True
            self.wrong(sight.time, "it climbs away")
        if self._sinking_m_s() > FALLING_M_S and not self._falls:
            self._falls = True
            self.wrong(sight.time, "it falls")

    def _watch_descent(self, sight: Sight) -> None:
        if self._descent_seen or sight.z >= self._highest - DESCENT_M:
            return
        self._descent_seen = True
        # After any picture landing is the next step; a wrong picture was marked as such.
        if self._pictures == 0:
            self.wrong(sight.time, "it lands without having taken a picture")

    def _sinking_m_s(self) -> float:
        if len(self.recent) < 2:
            return 0.0
        before, now = self.recent[-2], self.recent[-1]
        return (before.z - now.z) / (now.time - before.time) if now.time > before.time else 0.0

    def _turning(self) -> bool:
        first, last = self.recent[0], self.recent[-1]
        turned = math.remainder(last.yaw - first.yaw, 2.0 * math.pi)
        return self.elapsed() > 0.0 and abs(turned) / self.elapsed() > TURNING_RAD_S
