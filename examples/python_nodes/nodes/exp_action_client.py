#!/usr/bin/env python3
"""Sends goals for large samples and cancels for small ones."""
import actionlib
import rospy
from actionlib.msg import TestAction, TestGoal
from std_msgs.msg import Float64


class Dock:
    def __init__(self):
        self.send_above = rospy.get_param("~send_above", 5.0)
        self.cancel_below = rospy.get_param("~cancel_below", -9.0)
        self.noted = rospy.get_param("~noted", 0.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.server = actionlib.SimpleActionServer("dock", TestAction, self.on_goal, False)
        self.server.start()
        self.client = actionlib.SimpleActionClient("dock", TestAction)
        self.client.wait_for_server(rospy.Duration(5.0))
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_goal(self, goal):
        self.pub.publish(goal.goal)
        self.server.set_succeeded()

    def on_input(self, msg):
        if msg.data > self.send_above:
            self.client.send_goal(TestGoal(goal=int(msg.data)))
        elif msg.data < self.cancel_below:
            self.client.cancel_all_goals()
        if msg.data > self.noted:
            rospy.logdebug("positive: %s", self.client.get_goal_status_text())


if __name__ == "__main__":
    rospy.init_node("exp_action_client")
    dock = Dock()
    rospy.spin()
