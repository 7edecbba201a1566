#!/usr/bin/env python3
"""Globals, as many small nodes have them."""
import rospy
from std_msgs.msg import Float64

LIMIT = 0.0
GAIN = 1.0
WINDOW = None
pub = aux_pub = None


def on_input(msg):
    if msg.data > LIMIT:
        pub.publish(msg)


def on_aux(msg):
    GAIN = 2.0
    if msg.data > GAIN:
        aux_pub.publish(GAIN)
    if WINDOW < msg.data:
        rospy.logdebug("outside of the window")


def main():
    global LIMIT, GAIN, WINDOW, pub, aux_pub
    rospy.init_node("read_module_global")
    LIMIT = rospy.get_param("~limit", 3.0)
    GAIN = rospy.get_param("~gain", 1.0)
    WINDOW = rospy.get_param("~window", 5.0)
    pub = rospy.Publisher("output", Float64, queue_size=1000)
    aux_pub = rospy.Publisher("gained", Float64, queue_size=1000)
    rospy.Subscriber("input", Float64, on_input)
    rospy.Subscriber("aux", Float64, on_aux)
    rospy.loginfo("gain %f", GAIN)
    rospy.spin()


if __name__ == "__main__":
    main()
