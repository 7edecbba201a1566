#!/usr/bin/env python3
"""Limits samples in one of several modes."""
import rospy
from std_msgs.msg import Float64, Int32


class Limits:
    level = 0


class Limiter:
    def __init__(self):
        self.mode = rospy.get_param("~mode", "clip")
        self.limit = rospy.get_param("~limit", 4.0)
        Limits.level = rospy.get_param("~level", 3)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.level_pub = rospy.Publisher("level", Int32, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        match self.mode:
            case "clip":
                value = max(-1.0, min(1.0, msg.data))
            case "half":
                value = 0.5 * msg.data
            case _:
                value = msg.data
        match value:
            case float() as high if high > self.limit:
                rospy.logdebug("dropped")
            case float():
                self.pub.publish(value)
        match int(msg.data):
            case Limits.level:
                self.level_pub.publish(int(msg.data))


if __name__ == "__main__":
    rospy.init_node("ctl_match")
    limiter = Limiter()
    rospy.spin()
