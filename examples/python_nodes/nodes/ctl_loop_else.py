#!/usr/bin/env python3
"""Says when a batch of samples was quiet, and when it grew all the time."""
import rospy
from std_msgs.msg import Float64, String


class Batch:
    def __init__(self):
        self.loud = rospy.get_param("~loud", 8.0)
        self.step = rospy.get_param("~step", -6.0)
        self.values = []
        self.pub = rospy.Publisher("output", String, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        self.values.append(msg.data)
        if len(self.values) == 4:
            self.judge(self.values)
            self.values = []

    def judge(self, values):
        for value in values:
            if abs(value) > self.loud:
                break
        else:
            self.pub.publish("quiet")
        at = 1
        while at < len(values):
            if values[at] - values[at - 1] < self.step:
                break
            at += 1
        else:
            self.pub.publish("steady")


if __name__ == "__main__":
    rospy.init_node("ctl_loop_else")
    batch = Batch()
    rospy.spin()
