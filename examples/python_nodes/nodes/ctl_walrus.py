#!/usr/bin/env python3
"""Halves samples until they are small enough."""
import rospy
from std_msgs.msg import Float64

last = 0.0
limit = small = loud = 0.0
pub = None


def on_input(msg):
    global last
    if (change := abs(msg.data - last)) > limit:
        pub.publish(change)
    last = msg.data
    value = msg.data
    while (value := value / 2) > small:
        pub.publish(value)
    if (size := abs(msg.data)) > loud:
        rospy.logdebug("loud: %f", size)


def main():
    global limit, small, loud, pub
    rospy.init_node("ctl_walrus")
    limit = rospy.get_param("~limit", 5.0)
    small = rospy.get_param("~small", 1.0)
    loud = rospy.get_param("~loud", 9.0)
    pub = rospy.Publisher("output", Float64, queue_size=1000)
    rospy.Subscriber("input", Float64, on_input)
    rospy.spin()


if __name__ == "__main__":
    main()
