#!/usr/bin/env python3
"""The mission with one wrong comparison: a fault in the source."""

from navigation.mission import main
from navigation.pilot import Pilot


class FaultyPilot(Pilot):
    """Takes each place for the goal but the goal itself."""

    def at_goal(self, pose):
        return self.distance(pose) > self._goal_radius


if __name__ == "__main__":
    main(FaultyPilot)
