#!/usr/bin/env python3
"""Drops samples that are too small, too large, or come too often."""
import rospy
from std_msgs.msg import Float64

skipped = 0


def main():
    rospy.init_node("ctl_early_return")
    smallest = rospy.get_param("~smallest", -8.0)
    largest = rospy.get_param("~largest", 8.0)
    every = rospy.get_param("~every", 2)
    pub = rospy.Publisher("output", Float64, queue_size=1000)

    def on_input(msg):
        global skipped
        if msg.data < smallest:
            rospy.logdebug("too small")
            return
        if largest < msg.data:
            return
        skipped += 1
        if skipped < every:
            return
        skipped = 0
        pub.publish(msg.data)

    rospy.Subscriber("input", Float64, on_input)
    rospy.spin()


if __name__ == "__main__":
    main()
