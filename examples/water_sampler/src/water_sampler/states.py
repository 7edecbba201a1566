"""What the mission does in each of its states.

``step`` is called with each state of the flight controller and its time; it returns the name of the
next state, or None to stay.
"""

import rospy


class State:
    """One state; ``mission`` has what the states share."""

    name = "state"
    flying = True

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
    """On the ground, until all is there."""

    name = "idle"
    flying = False

    def __init__(self, mission):
        super().__init__(mission)
        self._start_delay = rospy.get_param("~start_delay", 2.0)
        self._min_start_voltage = rospy.get_param("~min_start_voltage", 11.4)

    def step(self, now):
        mission = self.mission
        if mission.flight is None or self.age(now) < self._start_delay:
            return None
        if mission.flight.battery_voltage < self._min_start_voltage:
            rospy.logerr("the battery is too weak to fly")
            return "done"
        mission.home = mission.flight.position
        return "takeoff"


class Takeoff(State):
    """Straight up."""

    name = "takeoff"

    def __init__(self, mission):
        super().__init__(mission)
        self._flight_height = rospy.get_param("~flight_height", 2.4)

    def enter(self, now):
        super().enter(now)
        mission = self.mission
        mission.started = now
        mission.pilot.motors_on = True
        mission.pilot.go(mission.home.x, mission.home.y, self._flight_height)

    def step(self, now):
        if self.mission.flight.position.z < 0.9 * self._flight_height:
            return None
        return "approach"


class Approach(State):
    """To the tank."""

    name = "approach"

    def __init__(self, mission):
        super().__init__(mission)
        self._leg_timeout = rospy.get_param("~leg_timeout", 25.0)
        self._enable_sampling = rospy.get_param("~enable_sampling", True)

    def enter(self, now):
        super().enter(now)
        tank, pilot = self.mission.tank, self.mission.pilot
        pilot.go(tank.x, tank.y, pilot.target.z)

    def step(self, now):
        if self.mission.pilot.there(self.mission.flight):
            return "hold" if self._enable_sampling else "go_home"
        return "go_home" if self.age(now) > self._leg_timeout else None


class Hold(State):
    """Above the tank, until the UAV stands still."""

    name = "hold"

    def step(self, now):
        mission = self.mission
        if mission.tank.held(now) and mission.pilot.at_height(mission.flight):
            return "lower"
        return None


class Lower(State):
    """Down, until the tip of the tube is in the water."""

    name = "lower"

    def __init__(self, mission):
        super().__init__(mission)
        self._lower_rate = rospy.get_param("~lower_rate", 0.15)
        self._min_lower_height = rospy.get_param("~min_lower_height", 1.45)
        self._last = None

    def enter(self, now):
        super().enter(now)
        self._last = now
        self.mission.water.forget()

    def step(self, now):
        mission = self.mission
        if mission.water.in_water:
            return "dip"
        height = mission.pilot.target.z - self._lower_rate * (now - self._last).to_sec()
        self._last = now
        # Lower down the UAV's feet would get wet.
        if height < self._min_lower_height:
            return "wait_for_water"
        if mission.tank.over_tank:
            mission.pilot.climb(height)
        return None


class WaitForWater(State):
    """As low as the UAV may be, with the tip dry."""

    name = "wait_for_water"

    def step(self, now):
        return "dip" if self.mission.water.in_water else None


class Dip(State):
    """A little deeper than where the water was met."""

    name = "dip"

    def __init__(self, mission):
        super().__init__(mission)
        self._dip_depth = rospy.get_param("~dip_depth", 0.08)
        self._max_dip_depth = rospy.get_param("~max_dip_depth", 0.3)
        self._dip_time = rospy.get_param("~dip_time", 1.0)
        self._from = 0.0

    def enter(self, now):
        super().enter(now)
        pilot = self.mission.pilot
        self._from = self.mission.flight.position.z
        pilot.climb(self._from - self._dip_depth)

    def deep_enough(self, depth):
        """Whether the tip is not so deep that it stirs up the ground of the tank."""
        return depth < self._max_dip_depth

    def step(self, now):
        depth = self._from - self.mission.flight.position.z
        if self.age(now) > self._dip_time and self.deep_enough(depth):
            return "pump"
        return None


class Pump(State):
    """In the water, until the vial is full."""

    name = "pump"

    def __init__(self, mission):
        super().__init__(mission)
        self._pump_patience = rospy.get_param("~pump_patience", 30.0)

    def enter(self, now):
        super().enter(now)
        self.mission.water.forget()

    def step(self, now):
        mission = self.mission
        pump, water = mission.pump, mission.water
        started = pump.started
        pump.start(now)
        if not started:
            # The status that is here already is of the time before.
            return "rise" if pump.hopeless else None
        if water.vial_full or water.pump_failed or water.out_of_water(now):
            return "drain"
        return "drain" if self.age(now) > self._pump_patience else None


class Drain(State):
    """The pump stands still, and what is in the tube runs into the vial."""

    name = "drain"

    def __init__(self, mission):
        super().__init__(mission)
        self._drain_time = rospy.get_param("~drain_time", 4.0)

    def enter(self, now):
        super().enter(now)
        self.mission.pump.stop()

    def step(self, now):
        return "rise" if self.age(now) > self._drain_time else None


class Rise(State):
    """Out of the water and up."""

    name = "rise"

    def __init__(self, mission):
        super().__init__(mission)
        self._return_height = rospy.get_param("~return_height", 2.4)

    def enter(self, now):
        super().enter(now)
        self.mission.pump.stop()
        self.mission.pilot.climb(self._return_height)

    def step(self, now):
        return "go_home" if self.mission.pilot.at_height(self.mission.flight) else None


class GoHome(State):
    """To where it took off."""

    name = "go_home"

    def enter(self, now):
        super().enter(now)
        mission = self.mission
        mission.pilot.go(mission.home.x, mission.home.y, mission.pilot.target.z)

    def step(self, now):
        return "land" if self.mission.pilot.there(self.mission.flight) else None


class Land(State):
    """Down; the motors stop on the ground."""

    name = "land"

    def __init__(self, mission):
        super().__init__(mission)
        self._landing_rate = rospy.get_param("~landing_rate", 0.4)
        self._min_land_height = rospy.get_param("~min_land_height", 0.12)
        self._last = None

    def enter(self, now):
        super().enter(now)
        self._last = now
        # After an alarm the pump may still run.
        self.mission.pump.stop()

    def step(self, now):
        mission = self.mission
        below = mission.pilot.target.z - self._landing_rate * (now - self._last).to_sec()
        self._last = now
        mission.pilot.climb(max(below, -0.3))
        if mission.flight.position.z < self._min_land_height:
            mission.pilot.motors_on = False
            return "done"
        return None


class Done(State):
    """On the ground, for good."""

    name = "done"
    flying = False

    def enter(self, now):
        super().enter(now)
        self.mission.finish()

    def step(self, now):
        return None


STATES = (
    Idle,
    Takeoff,
    Approach,
    Hold,
    Lower,
    WaitForWater,
    Dip,
    Pump,
    Drain,
    Rise,
    GoHome,
    Land,
    Done,
)
