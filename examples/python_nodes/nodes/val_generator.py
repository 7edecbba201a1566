#!/usr/bin/env python3
"""Samples go through generators."""
import rospy
from std_msgs.msg import Float64


class Pipeline:
    def __init__(self):
        self.floor = rospy.get_param("~floor", -5.0)
        self.step = rospy.get_param("~step", 2.0)
        self.loud = rospy.get_param("~loud", 8.0)
        self.values = []
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def usable(self, values):
        for value in values:
            if value > self.floor:
                yield value

    def spread(self, values):
        last = None
        for value in values:
            if last is None or abs(value - last) >= self.step:
                last = value
                yield value

    def loud_ones(self):
        yield from (value for value in self.values if value > self.loud)

    def on_input(self, msg):
        self.values = [*self.values[-3:], msg.data]
        for value in self.spread(self.usable(self.values)):
            self.pub.publish(value)
        for value in self.loud_ones():
            rospy.logdebug("loud: %f", value)


if __name__ == "__main__":
    rospy.init_node("val_generator")
    pipeline = Pipeline()
    rospy.spin()
