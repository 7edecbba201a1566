"""The robot of the made-up fleet: its loops, what they compare with which parameter, and how.

What a robot compares is given as steps: a value is ``centre + spread * z``, a threshold
``centre + spread * level``, where z is a process of time (`pytpc_evaluation.fleet.processes`).
Where the relation is ``<``, both have a minus instead. So each decision holds while z > level.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

PACKAGE = "fleet_robot"
SOURCES = f"/opt/ws/src/{PACKAGE}"


class Kind(Enum):
    """How the value of a decision behaves."""

    EVENT = "event"
    """Near zero, with small bumps that do not count and large ones that do."""
    WANDER = "wander"
    """Smooth and random, with a standard deviation of 1."""
    STEADY = "steady"
    """Smooth and random, with a standard deviation of 0.5, far from the threshold."""
    RAMP = "ramp"
    """From -2 to 2 over the mission."""
    FLAG = "flag"
    """The parameter itself, a bool, is the condition."""


@dataclass(frozen=True)
class Loop:
    """A thread of a node that evaluates its comparisons at a rate (Hz)."""

    node: str
    function: str
    file: str
    rate: float
    topic: str
    message: str


@dataclass(frozen=True)
class Decision:
    """A parameter and the value that it is compared with, in one loop.

    ``places`` is how many comparisons of it there are: the second one compares a smoothed value,
    and if ``nested`` it is evaluated only where the first one holds. ``scale`` is that of a derived
    threshold: threshold = scale * parameter. A ``shared`` parameter is not the node's own.
    """

    loop: int
    kind: Kind
    parameter: str
    relation: str
    value: str
    centre: float = 0.0
    spread: float = 1.0
    level: float = 1.25
    places: int = 2
    scale: float = 1.0
    nested: bool = False
    shared: bool = False

    @property
    def sign(self) -> float:
        """1 if the decision holds above the threshold, -1 below it."""
        return -1.0 if self.relation == "<" else 1.0

    @property
    def source(self) -> str:
        """The parameter's name in the source."""
        return self.parameter if self.shared else f"~{self.parameter}"

    def value_at(self, level: float) -> float:
        """The parameter's value for a level, with the four digits that a person writes."""
        threshold = self.centre + self.sign * self.spread * level
        return float(f"{threshold / self.scale:.4g}")

    def level_of(self, value: float) -> float:
        """The level of a value of the parameter."""
        return (value * self.scale - self.centre) / (self.sign * self.spread)


LOOPS = (
    Loop("navigator", "Planner::plan", "src/planner.cpp", 10.0, "path", "nav_msgs/Path"),
    Loop(
        "navigator", "Controller::step", "src/control.cpp", 20.0, "cmd_vel", "geometry_msgs/Twist"
    ),
    Loop("perception", "Detector::onImage", "src/detector.cpp", 30.0, "person", "std_msgs/Bool"),
    Loop("perception", "Ground::onCloud", "src/ground.cpp", 10.0, "ground", "std_msgs/Float64"),
    Loop("driver", "Motor::step", "src/motor.cpp", 100.0, "wheels", "sensor_msgs/JointState"),
    Loop("driver", "Imu::onSample", "src/imu.cpp", 1000.0, "shock", "std_msgs/Bool"),
    Loop("guard", "Guard::check", "src/guard.cpp", 50.0, "stop", "std_msgs/Bool"),
)
_DEGREE = math.pi / 180
_E, _W, _S = Kind.EVENT, Kind.WANDER, Kind.STEADY

DECISIONS = (
    Decision(0, _E, "obstacle_stop_cost", ">", "cost", 0.0, 40.0, nested=True),
    Decision(0, _E, "replan_deviation", ">", "deviation", 0.0, 0.4),
    Decision(0, _E, "goal_blocked_share", ">", "blocked", 0.05, 0.3),
    Decision(0, _W, "max_path_curvature", ">", "curvature", 0.4, 0.25, 1.0),
    Decision(0, _W, "min_clearance", "<", "clearance", 0.9, 0.35, 1.1),
    Decision(0, _W, "lookahead_limit", "<", "lookahead", 1.5, 0.5, 0.9),
    Decision(0, _S, "max_plan_age", ">", "age", 0.12, 0.03, 6.0),
    Decision(0, Kind.RAMP, "goal_tolerance", "<", "distance", 6.0, 3.0, 1.6),
    Decision(1, _E, "slip_ratio_limit", ">", "slip", 0.02, 0.2, nested=True),
    Decision(1, _E, "yaw_error_stop_deg", ">", "yaw_error", 0.0, 0.25, scale=_DEGREE),
    Decision(1, _W, "limits/max_speed", ">", "speed", 0.8, 0.25, 1.2, shared=True),
    Decision(1, _W, "heading_tolerance_deg", ">", "heading", 0.1, 0.06, 0.9, scale=_DEGREE),
    Decision(1, _W, "cross_track_limit", ">", "cross_track", 0.2, 0.1, 1.3),
    Decision(1, _S, "max_tilt", ">", "tilt", 0.05, 0.03, 6.0),
    Decision(1, _S, "max_command_delay", ">", "delay", 0.02, 0.01, 6.5),
    Decision(1, Kind.FLAG, "use_feedforward", "flag", "", places=1),
    Decision(2, _E, "min_detection_score", ">", "score", 0.2, 0.3),
    Decision(2, _E, "max_motion_blur", ">", "blur", 0.02, 0.05),
    Decision(2, _E, "person_distance", "<", "distance", 6.0, 1.8),
    Decision(2, _W, "min_contrast", "<", "contrast", 0.4, 0.1, 1.2),
    Decision(2, _W, "min_box_height", "<", "height", 40.0, 12.0, 1.0),
    Decision(2, _W, "max_aspect_ratio", ">", "aspect", 1.1, 0.3, 1.4),
    Decision(2, _S, "max_exposure", ">", "exposure", 0.01, 0.002, 6.0),
    Decision(2, _S, "min_sharpness", "<", "sharpness", 120.0, 12.0, 6.0),
    Decision(2, Kind.FLAG, "detect_when_dark", "flag", "", places=1),
    Decision(3, _E, "step_height", ">", "step", 0.01, 0.08),
    Decision(3, _W, "max_slope_deg", ">", "slope", 0.1, 0.05, 1.2, scale=_DEGREE),
    Decision(3, _W, "min_ground_share", "<", "share", 0.7, 0.1, 1.1),
    Decision(3, _S, "max_cloud_age", ">", "age", 0.1, 0.02, 6.0),
    Decision(4, _E, "overcurrent_limit", ">", "current", 4.0, 6.0),
    Decision(4, _E, "stall_speed", "<", "wheel_speed", 0.6, 0.2),
    Decision(4, _W, "max_acceleration", ">", "acceleration", 0.5, 0.3, 1.3),
    Decision(4, _S, "max_motor_temperature", ">", "temperature", 45.0, 4.0, 6.0),
    Decision(4, _S, "max_bus_latency", ">", "latency", 0.002, 0.0005, 6.5),
    Decision(5, _E, "shock_limit", ">", "acceleration", 9.8, 6.0, places=1),
    Decision(6, _W, "limits/max_speed", ">", "measured_speed", 0.8, 0.25, 1.2, 1, shared=True),
    Decision(6, _E, "bumper_force", ">", "force", 2.0, 14.0),
    Decision(6, _W, "min_link_quality", "<", "quality", 0.8, 0.1, 1.3),
    Decision(6, _S, "min_battery_voltage", "<", "voltage", 12.6, 0.2, 6.0),
    Decision(6, Kind.FLAG, "enable_bumper", "flag", "", places=1),
    Decision(6, Kind.FLAG, "allow_reverse", "flag", "", places=1),
)

GAINS: dict[str, dict[str, float | str]] = {
    "navigator": {"path_weight": 32.0, "goal_weight": 24.0, "frame_id": "map"},
    "driver": {"current_gain": 0.8, "wheel_radius": 0.165},
}
"""Parameters that are never compared, by node."""

SMALL, LARGE = (0.55, 0.8), (1.75, 2.3)
"""How high the bumps of an event are."""
EARLY, LATE = 0.32, 2.7
"""Levels of wrong values: small bumps count as well; not even large ones do."""


@dataclass(frozen=True)
class Compared:
    """A comparison in the code: a decision, and which of its places (from 0)."""

    decision: int
    place: int


def comparisons_of(loop: int) -> tuple[Compared, ...]:
    """The comparisons of a loop in the order in which it evaluates them."""
    return tuple(
        Compared(number, place)
        for number, one in enumerate(DECISIONS)
        if one.loop == loop
        for place in range(one.places)
    )


def nominal_rate() -> float:
    """Reports per second, without those of nested comparisons."""
    return sum(
        loop.rate
        * sum(not (c.place and DECISIONS[c.decision].nested) for c in comparisons_of(number))
        for number, loop in enumerate(LOOPS)
    )
