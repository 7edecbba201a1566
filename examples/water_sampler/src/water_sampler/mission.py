"""The mission: the state machine, and the topics that drive it."""

import threading

import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import Bool

from water_sampler.msg import FlightState, MissionState, PumpStatus
from water_sampler.pilot import Pilot
from water_sampler.pump_client import PumpClient
from water_sampler.states import STATES
from water_sampler.tank_watch import TankWatch
from water_sampler.water_watch import WaterWatch


class Mission:
    """Steps with each state of the flight controller."""

    def __init__(self, states=STATES):
        self._mission_timeout = rospy.get_param("~mission_timeout", 75.0)
        self._battery_return_voltage = rospy.get_param("~battery_return_voltage", 11.0)
        self.tank = TankWatch()
        self.water = WaterWatch()
        self.pump = PumpClient()
        self.pilot = Pilot()
        self.flight = None
        self.home = Point()
        self.started = None
        self._states = {state.name: state(self) for state in states}
        self._state = None
        self._lock = threading.Lock()
        self._state_pub = rospy.Publisher("/mission/state", MissionState, queue_size=10)
        self._done_pub = rospy.Publisher("/mission/done", Bool, queue_size=1, latch=True)
        rospy.Subscriber("/pump/status", PumpStatus, self.on_pump_status, queue_size=10)
        rospy.Subscriber("/controller/state", FlightState, self.on_flight_state, queue_size=10)

    def on_pump_status(self, status):
        """The pump control says how it is."""
        with self._lock:
            self.water.update(status)

    def on_flight_state(self, flight):
        """The flight controller says where the UAV is."""
        with self._lock:
            self.flight = flight
            self.tank.update(flight)
            self.step(flight.header.stamp)

    def step(self, now):
        """One step of the state machine."""
        if self._state is None:
            self._state = self._states["idle"]
            self._state.enter(now)
        following = self.emergency(now) or self._state.step(now)
        if following is not None:
            self.enter(following, now)
        self.pilot.send(now)
        self.publish_state(now)

    def emergency(self, now):
        """The state into which something from outside forces the mission, or None."""
        if not self._state.flying or self._state.name == "land":
            return None
        if self.flight.aborting:
            return "land"
        if self._state.name in ("drain", "rise", "go_home"):
            return None
        weak = self.flight.battery_voltage < self._battery_return_voltage
        late = (now - self.started).to_sec() > self._mission_timeout
        if weak or late or self.water.silent(now):
            rospy.logwarn("the mission is broken off")
            return "rise"
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
        state.tank_offset = self.tank.offset
        state.over_tank = self.tank.over_tank
        state.in_water = self.water.in_water
        if self.water.status is not None:
            state.wet_readings = self.water.status.wet_readings
        state.requests = self.pump.requests
        self._state_pub.publish(state)

    def finish(self):
        """Say that the mission is over."""
        self._done_pub.publish(Bool(True))


def main(states=STATES):
    """Run the mission as a node."""
    rospy.init_node("mission")
    mission = Mission(states)
    rospy.spin()
    return mission
