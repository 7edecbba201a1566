#!/usr/bin/env python3
"""Does much, and publishes the same in any case."""
import os

import rospy
from std_msgs.msg import Float64


class Blackboard:
    """Notes for people in the same process."""

    def __init__(self):
        self.notes = []

    def publish(self, text):
        self.notes.append(text)

    def call(self):
        self.notes.clear()


class Node:
    def __init__(self):
        self.stored = rospy.get_param("~stored", 8.0)
        self.printed = rospy.get_param("~printed", 9.0)
        self.written = rospy.get_param("~written", -9.0)
        self.posted = rospy.get_param("~posted", 2.0)
        self.full = rospy.get_param("~full", 20)
        self.board = Blackboard()
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        self.pub.publish(msg.data)
        if msg.data > self.stored:
            rospy.set_param("~last", msg.data)
        if msg.data > self.printed:
            print("high")
        if msg.data < self.written:
            with open(os.devnull, "w", encoding="utf-8") as stream:
                stream.write("low")
        if msg.data > self.posted:
            self.board.publish("posted")
        if len(self.board.notes) > self.full:
            self.board.call()


if __name__ == "__main__":
    rospy.init_node("exp_not_exposing")
    node = Node()
    rospy.spin()
