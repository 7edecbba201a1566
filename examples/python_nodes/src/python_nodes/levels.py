"""Levels of what is watched."""

import rospy


class Levels:
    """Three levels, read when the object is made."""

    def __init__(self):
        self.alarm = rospy.get_param("~alarm", 6.0)
        self.warning = rospy.get_param("~warning", 3.0)
        self.info = rospy.get_param("~info", 1.0)

    def is_warning(self, value):
        """Whether a value reaches the second level."""
        return value >= self.warning
