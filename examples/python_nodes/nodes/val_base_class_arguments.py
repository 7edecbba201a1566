#!/usr/bin/env python3
"""What a subclass is made with goes to the base class, which keeps it."""
import rospy
from std_msgs.msg import Float64


class Check:
    def __init__(self, limit, pub=None):
        self.limit = limit
        self.pub = pub


class Upper(Check):
    def __init__(self, limit, pub):
        super().__init__(limit, pub=pub)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg.data)


class Lower(Check):
    def __init__(self, limit, pub):
        Check.__init__(self, limit, pub)

    def on_input(self, msg):
        if msg.data < self.limit:
            self.pub.publish(msg.data)


class Lowest(Lower):
    def __init__(self, limit):
        super().__init__(limit, None)

    def on_input(self, msg):
        if msg.data <= self.limit:
            rospy.logdebug("lowest")


if __name__ == "__main__":
    rospy.init_node("val_base_class_arguments")
    pub = rospy.Publisher("output", Float64, queue_size=1000)
    checks = [
        Upper(rospy.get_param("~upper", 5.0), pub),
        Lower(rospy.get_param("~lower", -5.0), pub),
        Lowest(rospy.get_param("~lowest", -8.0)),
    ]
    subs = [rospy.Subscriber("input", Float64, check.on_input) for check in checks]
    rospy.spin()
