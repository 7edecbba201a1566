#!/usr/bin/env python3
"""Searches the first power that is large enough."""
import rospy
from std_msgs.msg import Float64


class Search:
    def __init__(self):
        self.enough = rospy.get_param("~enough", 20.0)
        self.most = rospy.get_param("~most", 12)
        self.worth = rospy.get_param("~worth", 3)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        value, rounds = abs(msg.data) + 1.1, 0
        while True:
            rounds += 1
            if value >= self.enough:
                break
            if rounds == self.most:
                return
            value *= value
        self.pub.publish(value)
        while True:
            rounds -= 1
            if rounds < self.worth:
                break
            rospy.logdebug("worth a line")


if __name__ == "__main__":
    rospy.init_node("ctl_forever_break")
    search = Search()
    rospy.spin()
