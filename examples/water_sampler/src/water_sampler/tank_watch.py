"""Whether the UAV stands above the tank."""

import math

import rospy


class TankWatch:
    """Follows how far the UAV is from above the tank's middle, and for how long it stays."""

    def __init__(self):
        self.x = rospy.get_param("~tank_x", 3.0)
        self.y = rospy.get_param("~tank_y", 2.0)
        self._hold_radius = rospy.get_param("~hold_radius", 0.35)
        self._hold_time = rospy.get_param("~hold_time", 1.5)
        self.offset = math.inf
        self.over_tank = False
        self._since = None

    def update(self, flight):
        """Take in a FlightState."""
        place = flight.position
        self.offset = math.hypot(place.x - self.x, place.y - self.y)
        self.over_tank = self.offset < self._hold_radius
        if not self.over_tank:
            self._since = None
        elif self._since is None:
            self._since = flight.header.stamp

    def held(self, now):
        """Whether it has stood there long enough to lower the tube."""
        if self._since is None:
            return False
        return (now - self._since).to_sec() >= self._hold_time
