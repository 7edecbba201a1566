#!/usr/bin/env python3
"""Two limits each from two reads and from a list."""
import rospy
from std_msgs.msg import Float64


class Band:
    def __init__(self):
        self.low, self.high = rospy.get_param("~low", -6.0), rospy.get_param("~high", 6.0)
        near, far = rospy.get_param("~range", [1.0, 3.0])
        self.band = (near, far)
        (self.loud, _), self.faint = (rospy.get_param("~loud", 9.0), 1), 0.5
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        value = msg.data
        near, far = self.band
        if value < self.low:
            self.pub.publish(self.low)
        if value > self.high:
            self.pub.publish(self.high)
        if near < value:
            if value < far:
                self.pub.publish(value)
        if value > self.loud:
            rospy.logdebug("loud")
        if abs(value) < self.faint:
            self.pub.publish(0.0)


if __name__ == "__main__":
    rospy.init_node("read_tuple")
    band = Band()
    rospy.spin()
