"""The mission: the state machine, and the topics that drive it."""

import threading

import rospy
from std_msgs.msg import Bool

from navigation.battery_watch import BatteryWatch
from navigation.drive_watch import DriveWatch
from navigation.msg import (
    ControllerStatus,
    Localised,
    MissionState,
    PlanStatus,
    RecoveryStatus,
    RobotStatus,
)
from navigation.pilot import Pilot
from navigation.states import STATES


class Mission:
    """Steps with each pose."""

    def __init__(self, pilot=Pilot):
        self._mission_timeout = rospy.get_param("~mission_timeout", 85.0)
        self.battery = BatteryWatch()
        self.drive = DriveWatch()
        self.pilot = pilot()
        self.pose = None
        self.started = None
        self._states = {state.name: state(self) for state in STATES}
        self._state = None
        self._lock = threading.Lock()
        self._state_pub = rospy.Publisher("/mission/state", MissionState, queue_size=10)
        self._lamp_pub = rospy.Publisher("/mission/lamp", Bool, queue_size=10)
        self._horn_pub = rospy.Publisher("/mission/horn", Bool, queue_size=10)
        self._done_pub = rospy.Publisher("/mission/done", Bool, queue_size=1, latch=True)
        rospy.Subscriber("/robot/status", RobotStatus, self.on_robot, queue_size=10)
        rospy.Subscriber("/planner/status", PlanStatus, self.on_plan, queue_size=10)
        rospy.Subscriber("/controller/status", ControllerStatus, self.on_control, queue_size=10)
        rospy.Subscriber("/recovery/status", RecoveryStatus, self.on_recovery, queue_size=10)
        rospy.Subscriber(
            "/localisation/pose", Localised, self.on_pose, queue_size=10, tcp_nodelay=True
        )

    def on_robot(self, status):
        """The base says how it is."""
        with self._lock:
            self.battery.update(status.voltage)

    def on_plan(self, status):
        """The planner says whether there is a way."""
        with self._lock:
            self.drive.update_plan(status)

    def on_control(self, status):
        """The controller says how far it is."""
        with self._lock:
            self.drive.update_control(status)

    def on_recovery(self, status):
        """The recovery says what it does."""
        with self._lock:
            self.drive.update_recovery(status)

    def on_pose(self, pose):
        """The localisation says where the robot is."""
        with self._lock:
            self.pose = pose
            self.drive.update_pose(pose)
            self.step(pose.header.stamp)

    def step(self, now):
        """One step of the state machine."""
        if self._state is None:
            self._state = self._states["idle"]
            self._state.enter(now)
        following = self.emergency(now) or self._state.step(now)
        if following is not None:
            self.enter(following, now)
        self.pilot.send(now, self.drive.sure)
        self.publish_state(now)

    def emergency(self, now):
        """The state into which something from outside forces the mission, or None."""
        if not self._state.driving:
            return None
        if (now - self.started).to_sec() > self._mission_timeout:
            rospy.logwarn("the time is up")
            return "done"
        if self._state.name in {"go_out", "settle"} and self.battery.weak:
            rospy.logwarn("the battery is weak")
            return "go_home"
        return None

    def enter(self, name, now):
        """Come into a state."""
        rospy.loginfo("mission: %s", name)
        self._state = self._states[name]
        self._state.enter(now)

    def publish_state(self, now):
        """Say what the mission does."""
        state = MissionState()
        state.header.stamp = now
        state.name = self._state.name
        state.goal_distance = self.pilot.distance(self.pose)
        state.voltage = self.battery.voltage
        self._state_pub.publish(state)

    def light(self, on):
        """Switch the goal's lamp."""
        self._lamp_pub.publish(Bool(on))

    def sound(self, on):
        """Switch the horn."""
        self._horn_pub.publish(Bool(on))

    def finish(self):
        """Say that the mission is over."""
        self._done_pub.publish(Bool(True))


def main(pilot=Pilot):
    """Run the mission as a node."""
    rospy.init_node("mission")
    Mission(pilot)
    rospy.spin()
