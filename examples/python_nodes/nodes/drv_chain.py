#!/usr/bin/env python3
"""From kilometres per hour to a distance."""
import rospy
from std_msgs.msg import Float64


def metres_per_second(kmh):
    return kmh / 3.6


class Distance:
    def __init__(self):
        speed = metres_per_second(rospy.get_param("~speed_kmh", 7.2))
        self.reach = 2 * speed
        self.slack = rospy.get_param("~slack", 0.5)
        self.shown = metres_per_second(rospy.get_param("~shown_kmh", 3.6))
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def is_reached(self, distance):
        return distance < self.reach - 1.0

    def on_input(self, msg):
        if self.is_reached(msg.data):
            self.pub.publish(msg.data)
        if msg.data - 5.0 > 2 * self.slack:
            self.pub.publish(-1.0)
        if msg.data > self.shown:
            rospy.logdebug("shown")


if __name__ == "__main__":
    rospy.init_node("drv_chain")
    distance = Distance()
    rospy.spin()
