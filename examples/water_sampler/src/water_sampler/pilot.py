"""Tells the flight controller where to be."""

import math

import rospy
from geometry_msgs.msg import Point

from water_sampler.msg import WayPose


class Pilot:
    """Holds the target, sends it at each step, and knows when it is reached."""

    def __init__(self):
        self._waypoint_tolerance = rospy.get_param("~waypoint_tolerance", 0.3)
        self._height_tolerance = rospy.get_param("~height_tolerance_cm", 12.0) / 100.0
        self._waypose_pub = rospy.Publisher("/mission/waypose", WayPose, queue_size=10)
        self.target = Point()
        self.motors_on = False

    def go(self, x, y, z):
        """Set the target, in m."""
        self.target = Point(x, y, z)

    def climb(self, z):
        """Set the target's height alone, in m."""
        self.target.z = z

    def send(self, now):
        """Publish the target."""
        waypose = WayPose()
        waypose.header.stamp = now
        waypose.position = self.target
        waypose.motors_on = self.motors_on
        self._waypose_pub.publish(waypose)

    def there(self, flight):
        """Whether the UAV is above the target's place on the ground."""
        place = flight.position
        away = math.hypot(place.x - self.target.x, place.y - self.target.y)
        return away < self._waypoint_tolerance

    def at_height(self, flight):
        """Whether the UAV is at the target's height."""
        return abs(flight.position.z - self.target.z) < self._height_tolerance
