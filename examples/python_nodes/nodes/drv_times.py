#!/usr/bin/env python3
"""Waits for the next input; the inputs are times."""
import rospy
from std_msgs.msg import Float64


class Patient:
    def __init__(self):
        self.patience = rospy.get_param("~patience", 1.0)
        self.timeout = rospy.Duration(rospy.get_param("~timeout", 2.0))
        self.hold = rospy.Duration.from_sec(rospy.get_param("~hold", 0.5))
        self.age = rospy.get_param("~age", 3.0)
        self.shown = rospy.get_param("~shown", 1.0)
        self.sleep = rospy.Duration(rospy.get_param("~sleep", 0.0))
        self.last = rospy.Time.from_sec(100.0)
        self.deadline = rospy.Time.from_sec(100.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        now = rospy.Time.from_sec(100.0 + msg.data)
        if now > self.last + rospy.Duration(self.patience):
            self.pub.publish(1.0)
        if now - self.last < self.timeout:
            self.pub.publish(2.0)
        if now > self.deadline:
            self.pub.publish(3.0)
        if (now - self.last).to_sec() > self.age:
            self.pub.publish(4.0)
        if now > self.last + rospy.Duration(self.shown):
            rospy.logdebug("late")
        self.deadline = now + self.hold
        rospy.sleep(self.sleep)
        self.last = now


if __name__ == "__main__":
    rospy.init_node("drv_times")
    patient = Patient()
    rospy.spin()
