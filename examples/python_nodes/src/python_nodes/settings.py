"""Settings that other modules look at; they are read once the node has its name."""

import rospy

LIMIT = None
FLOOR = None
NOTED = None


def load():
    """Read all settings."""
    global LIMIT, FLOOR, NOTED
    LIMIT = rospy.get_param("~limit", 4.0)
    FLOOR = rospy.get_param("~floor", -4.0)
    NOTED = rospy.get_param("~noted", 0.0)
