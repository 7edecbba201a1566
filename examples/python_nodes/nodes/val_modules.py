#!/usr/bin/env python3
"""The script: what is checked elsewhere is published here."""
import rospy
from python_nodes import settings
from python_nodes.gates import Gate, is_noted
from std_msgs.msg import Float64


def main():
    rospy.init_node("val_modules")
    settings.load()
    gate = Gate()
    pub = rospy.Publisher("output", Float64, queue_size=1000)

    def on_input(msg):
        if gate.is_open(msg.data):
            pub.publish(msg.data)
        if msg.data < settings.FLOOR:
            pub.publish(settings.FLOOR)
        if is_noted(msg.data):
            rospy.logdebug("noted")

    rospy.Subscriber("input", Float64, on_input)
    rospy.spin()


if __name__ == "__main__":
    main()
