#!/usr/bin/env python3
"""Settings are passed on as keywords."""
import rospy
from std_msgs.msg import Float64


class Gate:
    def __init__(self, **settings):
        self.low = settings["low"]
        self.high = settings.get("high", 9.0)
        self.note = settings.pop("note", 0.0)


def between(value, *limits):
    if value < limits[0]:
        return False
    return value <= limits[1]


def main():
    rospy.init_node("val_keywords")
    pub = rospy.Publisher("output", Float64, queue_size=1000)
    settings = {"low": rospy.get_param("~low", -8.0), "high": rospy.get_param("~high", 8.0)}
    gate = Gate(note=rospy.get_param("~note", 1.0), **settings)
    limits = [rospy.get_param("~inner", -2.0), rospy.get_param("~outer", 2.0)]

    def on_input(msg):
        if msg.data < gate.low or msg.data > gate.high:
            pub.publish(msg)
        if between(msg.data, *limits):
            pub.publish(0.0)
        if msg.data > gate.note:
            rospy.logdebug("noted")

    rospy.Subscriber("input", Float64, on_input)
    rospy.spin()


if __name__ == "__main__":
    main()
