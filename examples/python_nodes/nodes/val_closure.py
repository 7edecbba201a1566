#!/usr/bin/env python3
"""Gates are functions that remember their limits."""
import rospy
from std_msgs.msg import Float64


def make_gate(limit, emit):
    def gate(value):
        if value > limit:
            emit(value)

    return gate


def make_counter(every):
    count = 0

    def is_due():
        nonlocal count
        count += 1
        if count >= every:
            count = 0
            return True
        return False

    return is_due


def make_logger(limit):
    def log(value):
        if value < limit:
            rospy.logdebug("low: %f", value)

    return log


def main():
    rospy.init_node("val_closure")
    pub = rospy.Publisher("output", Float64, queue_size=1000)
    gate = make_gate(rospy.get_param("~gate", 4.0), lambda value: pub.publish(value))
    is_due = make_counter(rospy.get_param("~every", 3))
    log = make_logger(rospy.get_param("~logged", 0.0))

    def on_input(msg):
        log(msg.data)
        gate(msg.data)
        if is_due():
            pub.publish(-1.0)

    rospy.Subscriber("input", Float64, on_input)
    rospy.spin()


if __name__ == "__main__":
    main()
