#!/usr/bin/env python3
"""Publishes under a lock, and a summary when a batch is left."""
import threading
from contextlib import contextmanager

import rospy
from std_msgs.msg import Float64


class Summary:
    def __init__(self, pub, alarm):
        self.pub = pub
        self.alarm = alarm
        self.worst = 0.0

    def __enter__(self):
        self.worst = 0.0
        return self

    def __exit__(self, kind, error, trace):
        if self.worst > self.alarm:
            self.pub.publish(self.worst)
        return False


class Node:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 2.0)
        self.timed = rospy.get_param("~timed", 4.0)
        self.lock = threading.Lock()
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.summary = Summary(self.pub, rospy.get_param("~alarm", 7.0))
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    @contextmanager
    def noted(self, value):
        if value > self.timed:
            rospy.logdebug("begins")
        yield
        rospy.logdebug("ends")

    def on_input(self, msg):
        with self.lock, self.noted(msg.data):
            if msg.data > self.limit:
                self.pub.publish(msg.data)
        with self.summary as summary:
            summary.worst = abs(msg.data)


if __name__ == "__main__":
    rospy.init_node("ctl_with")
    node = Node()
    rospy.spin()
