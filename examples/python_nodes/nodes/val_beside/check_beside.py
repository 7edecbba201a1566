"""Looks at values."""

import rospy
from limits_beside import LIMITS


class Check:
    """Publishes what is too low."""

    def __init__(self, pub):
        self.pub = pub

    def look_at(self, value):
        """Look at one value."""
        if value < LIMITS["low"]:
            self.pub.publish(value)
        if value > LIMITS["note"]:
            rospy.logdebug("noted")
