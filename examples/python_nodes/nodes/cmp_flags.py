#!/usr/bin/env python3
"""Does what its flags allow."""
import rospy
from std_msgs.msg import Float64


class Flags:
    def __init__(self):
        self.enabled = rospy.get_param("~enabled", True)
        self.muted = rospy.get_param("~muted", False)
        self.exact = rospy.get_param("~exact", True)
        self.rough = rospy.get_param("~rough", False)
        self.extra = rospy.get_param("~extra", 1)
        self.label = rospy.get_param("~label", "label")
        self.verbose = rospy.get_param("~verbose", False)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if self.enabled:
            self.pub.publish(1.0)
        if not self.muted:
            self.pub.publish(2.0)
        if self.exact is True:
            self.pub.publish(3.0)
        if self.rough == False:
            self.pub.publish(4.0)
        if self.extra:
            self.pub.publish(5.0)
        labelled = self.label
        if labelled:
            self.pub.publish(6.0)
        if self.verbose:
            rospy.logdebug("%f", msg.data)


if __name__ == "__main__":
    rospy.init_node("cmp_flags")
    flags = Flags()
    rospy.spin()
