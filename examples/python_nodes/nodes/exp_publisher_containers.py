#!/usr/bin/env python3
"""Many publishers."""
import rospy
from std_msgs.msg import Float64


def send(pub, value, limit):
    if value < limit:
        pub.publish(value)


def pretend(pub, value, limit):
    if value < limit:
        rospy.logdebug("would be sent on %s", pub.name)


class Router:
    def __init__(self):
        self.split = rospy.get_param("~split", 0.0)
        self.high = rospy.get_param("~high", 6.0)
        self.low = rospy.get_param("~low", -4.0)
        self.pubs = {
            name: rospy.Publisher(name, Float64, queue_size=1000) for name in ("left", "right")
        }
        self.more = [rospy.Publisher("first", Float64, queue_size=1000)]
        self.more.append(rospy.Publisher("second", Float64, queue_size=1000))
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        side = "left" if msg.data < self.split else "right"
        self.pubs[side].publish(msg.data)
        if msg.data > self.high:
            for pub in self.more:
                pub.publish(msg.data)
        send(self.more[0], msg.data, self.low)
        pretend(self.more[1], msg.data, self.low)


if __name__ == "__main__":
    rospy.init_node("exp_publisher_containers")
    router = Router()
    rospy.spin()
