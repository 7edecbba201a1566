"""What the nodes that drive say of themselves."""

import rospy


class DriveWatch:
    """Whether the robot gets on, stands still, and knows where it is."""

    def __init__(self):
        self._pause_quality = rospy.get_param("~pause_quality", 0.3)
        self._resume_quality = rospy.get_param("~resume_quality", 0.45)
        self._still_speed = rospy.get_param("~still_speed", 0.03)
        self._still_turn_rate = rospy.get_param("~still_turn_rate", 0.06)
        self._still_samples = rospy.get_param("~still_samples", 8)
        self._plan_patience = rospy.get_param("~plan_patience", 12.0)
        self._still = 0
        self._planned = None
        self._control = None
        self._recovery = None
        self.sure = True

    def update_pose(self, pose):
        """Where the robot is, and how fast."""
        if pose.quality < self._pause_quality:
            self.sure = False
        elif pose.quality > self._resume_quality:
            self.sure = True
        slow = abs(pose.speed) < self._still_speed
        if slow and abs(pose.turn_rate) < self._still_turn_rate:
            self._still += 1
        else:
            self._still = 0

    def update_plan(self, status):
        """Whether there is a way."""
        if status.has_plan or self._planned is None:
            self._planned = status.header.stamp

    def update_control(self, status):
        """How far the controller is."""
        self._control = status

    def update_recovery(self, status):
        """What is done against being stuck."""
        self._recovery = status

    def forget(self, now):
        """A new leg: what was said of the last one does not count."""
        self._planned = now
        self._control = None
        self._recovery = None

    def arrived(self, goal_id):
        """Whether the controller is content with where it is."""
        control = self._control
        return control is not None and control.goal_id == goal_id and control.arrived

    def given_up(self, goal_id):
        """Whether the robot was stuck too often on its way to this goal."""
        recovery = self._recovery
        return recovery is not None and recovery.goal_id == goal_id and recovery.given_up

    def no_way(self, now):
        """Whether there was no plan for too long."""
        return (now - self._planned).to_sec() > self._plan_patience

    @property
    def still(self):
        """Whether the robot has come to rest."""
        return self._still >= self._still_samples
