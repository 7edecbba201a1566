#!/usr/bin/env python3
"""Climbs to a goal; a client in the same node asks for it."""
import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestGoal, TestResult
from std_msgs.msg import Float64


class Climber:
    def __init__(self):
        self.highest = rospy.get_param("~highest", 6)
        self.step = rospy.get_param("~step", 2)
        self.noted = rospy.get_param("~noted", 3)
        self.server = actionlib.SimpleActionServer(
            "climb", TestAction, execute_cb=self.on_goal, auto_start=False
        )
        self.server.start()
        self.client = actionlib.SimpleActionClient("climb", TestAction)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        self.pub.publish(msg)
        self.client.send_goal(TestGoal(goal=abs(int(msg.data))))

    def on_goal(self, goal):
        if goal.goal > self.highest:
            self.server.set_aborted(text="too high")
            return
        if goal.goal >= self.step:
            self.server.publish_feedback(TestFeedback(feedback=self.step))
        if goal.goal < self.noted:
            rospy.logdebug("a low goal")
        self.server.set_succeeded(TestResult(result=goal.goal))


if __name__ == "__main__":
    rospy.init_node("exp_action_server")
    climber = Climber()
    rospy.spin()
