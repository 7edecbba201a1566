"""What the mission does in each of its states.

``step`` is called with each pose and its time; it returns the name of the next state, or None to
stay.
"""

import math

import rospy


class State:
    """One state; ``mission`` has what the states share."""

    name = "state"
    driving = True

    def __init__(self, mission):
        self.mission = mission
        self.entered = None

    def enter(self, now):
        """The mission comes into this state."""
        self.entered = now

    def age(self, now):
        """Seconds in this state."""
        return (now - self.entered).to_sec()

    def step(self, now):
        raise NotImplementedError


class Idle(State):
    """In the dock, until all is there."""

    name = "idle"
    driving = False

    def __init__(self, mission):
        super().__init__(mission)
        self._start_delay = rospy.get_param("~start_delay", 2.0)
        self._start_patience = rospy.get_param("~start_patience", 40.0)
        self._min_start_quality = rospy.get_param("~min_start_quality", 0.5)
        self._sure_samples = rospy.get_param("~sure_samples", 5)
        self._sure = 0

    def step(self, now):
        mission = self.mission
        if mission.pose.quality > self._min_start_quality:
            self._sure += 1
        else:
            self._sure = 0
        if self.age(now) > self._start_patience:
            rospy.logerr("it does not get ready")
            return "done"
        if self.age(now) < self._start_delay or not mission.battery.full:
            return None
        return "go_out" if self._sure >= self._sure_samples else None


class Leg(State):
    """To a place."""

    following = "done"
    hopeless = "done"

    def __init__(self, mission):
        super().__init__(mission)
        self._leg_timeout = rospy.get_param("~leg_timeout", 45.0)

    def place(self):
        """Where it goes: m, m, rad."""
        raise NotImplementedError

    def enter(self, now):
        super().enter(now)
        self.mission.drive.forget(now)
        self.mission.pilot.go(*self.place())

    def step(self, now):
        mission = self.mission
        goal_id = mission.pilot.goal_id
        if mission.drive.arrived(goal_id) or mission.pilot.at_goal(mission.pose):
            return self.following
        late = self.age(now) > self._leg_timeout
        if late or mission.drive.given_up(goal_id) or mission.drive.no_way(now):
            rospy.logwarn("it does not get there")
            return self.hopeless
        return None


class GoOut(Leg):
    """To the goal."""

    name = "go_out"
    following = "settle"
    hopeless = "go_home"

    def __init__(self, mission):
        super().__init__(mission)
        self._goal_x = rospy.get_param("~goal_x", 6.6)
        self._goal_y = rospy.get_param("~goal_y", 4.8)
        self._goal_yaw = math.radians(rospy.get_param("~goal_yaw_deg", 90.0))

    def place(self):
        return self._goal_x, self._goal_y, self._goal_yaw

    def enter(self, now):
        super().enter(now)
        self.mission.started = now


class Settle(State):
    """At the goal, until the robot stands still."""

    name = "settle"

    def __init__(self, mission):
        super().__init__(mission)
        self._settle_time = rospy.get_param("~settle_time", 0.5)

    def enter(self, now):
        super().enter(now)
        self.mission.pilot.stand()

    def step(self, now):
        if self.age(now) > self._settle_time and self.mission.drive.still:
            return "signal"
        return None


class Signal(State):
    """The goal's lamp is lit."""

    name = "signal"

    def __init__(self, mission):
        super().__init__(mission)
        self._lamp_time = rospy.get_param("~lamp_time", 3.0)
        self._enable_horn = rospy.get_param("~enable_horn", True)
        self._horn_time = rospy.get_param("~horn_time", 0.5)

    def enter(self, now):
        super().enter(now)
        self.mission.light(True)

    def step(self, now):
        self.mission.sound(self._enable_horn and self.age(now) < self._horn_time)
        if self.age(now) < self._lamp_time:
            return None
        self.mission.light(False)
        return "go_home"


class GoHome(Leg):
    """To the dock."""

    name = "go_home"
    following = "dock"

    def __init__(self, mission):
        super().__init__(mission)
        self._dock_x = rospy.get_param("~dock_x", 1.0)
        self._dock_y = rospy.get_param("~dock_y", 1.2)
        self._dock_yaw = math.radians(rospy.get_param("~dock_yaw_deg", 180.0))

    def place(self):
        return self._dock_x, self._dock_y, self._dock_yaw


class Dock(State):
    """In the dock, until the contacts hold."""

    name = "dock"

    def __init__(self, mission):
        super().__init__(mission)
        self._dock_time = rospy.get_param("~dock_time", 1.5)

    def enter(self, now):
        super().enter(now)
        self.mission.pilot.stand()

    def step(self, now):
        return "done" if self.age(now) > self._dock_time else None


class Done(State):
    """In its dock, or where it could not get on."""

    name = "done"
    driving = False

    def enter(self, now):
        super().enter(now)
        self.mission.pilot.stand()
        # The time may be up while they are on.
        self.mission.light(False)
        self.mission.sound(False)
        self.mission.finish()

    def step(self, now):
        return None


STATES = (Idle, GoOut, Settle, Signal, GoHome, Dock, Done)
