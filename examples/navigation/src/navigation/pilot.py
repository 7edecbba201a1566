"""Tells the planner and the controller where to go."""

import math

import rospy

from navigation.msg import MissionCommand


class Pilot:
    """Holds the goal, and sends it at each step."""

    def __init__(self):
        self._goal_radius = rospy.get_param("~goal_radius_cm", 8.0) / 100.0
        self._command_pub = rospy.Publisher("/mission/command", MissionCommand, queue_size=10)
        self._command = MissionCommand()

    @property
    def goal_id(self):
        """Which goal it is: they are counted."""
        return self._command.goal_id

    def go(self, x, y, yaw):
        """Set a new goal, in m and rad."""
        self._command.mode = MissionCommand.DRIVE
        self._command.goal_id += 1
        self._command.goal_x = x
        self._command.goal_y = y
        self._command.goal_yaw = yaw

    def stand(self):
        """Stay here."""
        self._command.mode = MissionCommand.STAND

    def send(self, now, sure):
        """Publish the goal; the robot stands while it is not sure where it is."""
        command = MissionCommand()
        command.header.stamp = now
        command.mode = self._command.mode if sure else MissionCommand.STAND
        command.goal_id = self._command.goal_id
        command.goal_x = self._command.goal_x
        command.goal_y = self._command.goal_y
        command.goal_yaw = self._command.goal_yaw
        self._command_pub.publish(command)

    def distance(self, pose):
        """To the goal, in m."""
        return math.hypot(pose.x - self._command.goal_x, pose.y - self._command.goal_y)

    def at_goal(self, pose):
        """Whether it is so near that the heading does not matter any more."""
        return self.distance(pose) < self._goal_radius
