#!/usr/bin/env python3
"""Keeps a state for the log."""
import rospy
from std_msgs.msg import Float64


class Gripper:
    def __init__(self):
        self.close_force = rospy.get_param("gripper/close_force", 2.0)
        self.hold_force = rospy.get_param("gripper/hold_force", 6.0)
        self.state = "open"
        self.history = {}
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_force)

    def on_force(self, msg):
        if self.state == "open":
            if msg.data > self.close_force:
                self.state = "closing"
        elif self.state == "closing" and msg.data >= self.hold_force:
            self.state = "holding"
        self.history[self.state] = self.history.get(self.state, 0) + 1
        rospy.logdebug("%s", self.history)
        self.pub.publish(0.1 * msg.data)


if __name__ == "__main__":
    rospy.init_node("ctl_dead_state")
    gripper = Gripper()
    rospy.spin()
