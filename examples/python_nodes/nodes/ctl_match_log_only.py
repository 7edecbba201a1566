#!/usr/bin/env python3
"""Publishes everything; the mode chooses what is logged."""
import rospy
from std_msgs.msg import Float64


class Logger:
    def __init__(self):
        self.mode = rospy.get_param("~mode", "long")
        self.limit = rospy.get_param("~limit", 4.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        match self.mode:
            case "long":
                rospy.logdebug("a sample came: %f", msg.data)
            case "short" if msg.data > self.limit:
                rospy.logdebug("%f", msg.data)
            case _:
                pass
        self.pub.publish(msg)


if __name__ == "__main__":
    rospy.init_node("ctl_match_log_only")
    logger = Logger()
    rospy.spin()
