#!/usr/bin/env python3
"""ROS behind own objects, as in many larger programs."""
import rospy
from std_msgs.msg import Float64, String


class Output:
    def __init__(self, topic):
        self._pub = rospy.Publisher(topic, String, queue_size=1000)

    def say(self, *words):
        self._pub.publish(" ".join(words))

    def __call__(self, value):
        self.say("value", f"{value:.3f}")


class Mute:
    def say(self, *words):
        rospy.logdebug(" ".join(words))


class Node:
    def __init__(self):
        self.loud = rospy.get_param("~loud", 6.0)
        self.called = rospy.get_param("~called", -6.0)
        self.bound = rospy.get_param("~bound", 3.0)
        self.muted = rospy.get_param("~muted", 0.0)
        self.output = Output("output")
        self.mute = Mute()
        self.emit = self.output._pub.publish
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if msg.data > self.loud:
            self.output.say("loud")
        if msg.data < self.called:
            self.output(msg.data)
        if abs(msg.data) < self.bound:
            self.emit("small")
        if msg.data > self.muted:
            self.mute.say("positive")


if __name__ == "__main__":
    rospy.init_node("exp_own_classes")
    node = Node()
    rospy.spin()
