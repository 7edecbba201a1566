"""Limits in a dictionary of the module."""

import rospy

LIMITS = {}


def read_limits():
    """Fill the dictionary."""
    LIMITS["high"] = rospy.get_param("~high", 5.0)
    LIMITS["low"] = rospy.get_param("~low", -5.0)
    LIMITS["note"] = rospy.get_param("~note", 0.0)
