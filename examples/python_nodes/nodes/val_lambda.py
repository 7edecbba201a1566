#!/usr/bin/env python3
"""A node with as few functions as possible."""
import rospy
from std_msgs.msg import Float64


def main():
    rospy.init_node("val_lambda")
    limit = rospy.get_param("~limit", 5.0)
    low = rospy.get_param("~low", -5.0)
    noted = rospy.get_param("~noted", 0.0)
    pub = rospy.Publisher("output", Float64, queue_size=1000)
    low_pub = rospy.Publisher("low", Float64, queue_size=1000)
    is_low = lambda value: value < low
    is_noted = lambda value, limit=noted: value > limit

    def on_input(msg):
        if is_low(msg.data):
            low_pub.publish(msg)
        if is_noted(msg.data):
            rospy.logdebug("noted")

    rospy.Subscriber("input", Float64, lambda msg: pub.publish(msg) if msg.data > limit else None)
    rospy.Subscriber("input", Float64, on_input)
    rospy.spin()


if __name__ == "__main__":
    main()
