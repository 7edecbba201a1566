#!/usr/bin/env python3
"""Publishes at a fixed rate while the last value is small enough."""
import rospy
from std_msgs.msg import Float64

latest = None


def on_input(msg):
    global latest
    latest = msg.data


def main():
    rospy.init_node("ctl_main_loop")
    limit = rospy.get_param("~limit", 9.5)
    most = rospy.get_param("~most", 1000)
    noted = rospy.get_param("~noted", 5.0)
    pub = rospy.Publisher("output", Float64, queue_size=1000)
    rospy.Subscriber("input", Float64, on_input)
    rate = rospy.Rate(rospy.get_param("~rate", 50))
    sent = 0
    while not rospy.is_shutdown() and sent < most:
        value, moving = latest, 0
        if value is not None and abs(value) < limit:
            pub.publish(value)
            sent += 1
        if value is not None and value > noted:
            moving += 1
            rospy.logdebug("moving %d", moving)
        rate.sleep()
    rospy.spin()


if __name__ == "__main__":
    main()
