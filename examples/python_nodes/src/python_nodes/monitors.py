"""What watches values and says what it sees."""

import rospy
from std_msgs.msg import Float64

from .levels import Levels as Steps


class Monitor:
    """Publishes what reaches a level."""

    def __init__(self, topic):
        self.steps = Steps()
        self.pub = rospy.Publisher(topic, Float64, queue_size=1000)

    def watch(self, value):
        """Look at one value."""
        if value >= self.steps.alarm:
            self.pub.publish(value)
        elif self.steps.is_warning(value):
            self.pub.publish(0.5 * value)
        if value > self.steps.info:
            rospy.logdebug("info")
