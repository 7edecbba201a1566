#!/usr/bin/env python3
"""Looks at the age of samples; the samples themselves are the ages."""
import rospy
from std_msgs.msg import Float64


class Ages:
    def __init__(self):
        self.timeout = rospy.get_param("~timeout", 5.0)
        self.grace = rospy.Duration(rospy.get_param("~grace", 2.0))
        self.period = 1.0 / rospy.get_param("~rate", 4.0)
        self.minutes = rospy.get_param("~minutes", 0.1)
        self.shown = rospy.get_param("~shown", 1.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        age = rospy.Time.from_sec(100.0 + msg.data) - rospy.Time.from_sec(100.0)
        if age.to_sec() > self.timeout:
            self.pub.publish(1.0)
        if age < self.grace:
            self.pub.publish(2.0)
        if abs(msg.data) < self.period:
            self.pub.publish(3.0)
        if age.to_sec() < -60 * self.minutes:
            self.pub.publish(4.0)
        if age.to_sec() > self.shown:
            rospy.logdebug("old")


if __name__ == "__main__":
    rospy.init_node("drv_duration")
    ages = Ages()
    rospy.spin()
