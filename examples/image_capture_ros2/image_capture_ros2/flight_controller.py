"""Flies to the mission's setpoint."""

import math

from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.time import Time
from sensor_msgs.msg import BatteryState

from image_capture_ros2.geometry import wrap_angle, yaw_of
from image_capture_ros2.safety_monitor import SafetyMonitor
from image_capture_ros2.spinning import run_node

POSITION_GAIN = 1.0
HEIGHT_GAIN = 1.2
YAW_GAIN = 1.5


class FlightController(Node):
    """Answers each measured pose with velocities."""

    def __init__(self) -> None:
        super().__init__("flight_controller")
        self._cruise_speed = self.declare_parameter("cruise_speed", 1.0).value
        self._max_velocity = self.declare_parameter("max_velocity", 1.5).value
        self._max_climb_rate = self.declare_parameter("max_climb_rate", 0.8).value
        self._max_yaw_rate = self.declare_parameter("max_yaw_rate", 1.0).value
        self._setpoint_timeout = self.declare_parameter("setpoint_timeout", 1.5).value
        self._safety = SafetyMonitor(self)
        self._setpoint: PoseStamped | None = None
        self._x = self._y = 0.0
        self._last = 0.0
        self._command_pub = self.create_publisher(TwistStamped, "/uav/command", 10)
        self._state_pub = self.create_publisher(Odometry, "/controller/state", 10)
        self.create_subscription(PoseStamped, "/mission/setpoint", self._on_setpoint, 10)
        self.create_subscription(BatteryState, "/uav/battery", self._on_battery, 10)
        self.create_subscription(PoseStamped, "/uav/pose", self._on_pose, 10)

    def _on_setpoint(self, setpoint: PoseStamped) -> None:
        self._setpoint = setpoint

    def _on_battery(self, battery: BatteryState) -> None:
        self._safety.add_voltage(battery.voltage)

    def _on_pose(self, pose: PoseStamped) -> None:
        now = Time.from_msg(pose.header.stamp).nanoseconds / 1e9
        self._safety.check(pose.pose.position, now)
        command = TwistStamped(header=pose.header)
        if self._setpoint is not None and self._fresh(self._setpoint, now):
            self._advance(self._setpoint, now - self._last)
            self._steer(command, pose, self._setpoint)
        self._last = now
        self._command_pub.publish(command)
        state = Odometry(header=pose.header)
        state.pose.pose = pose.pose
        state.twist.twist = command.twist
        self._state_pub.publish(state)

    def _fresh(self, setpoint: PoseStamped, now: float) -> bool:
        sent = Time.from_msg(setpoint.header.stamp).nanoseconds / 1e9
        return now - sent < self._setpoint_timeout

    def _advance(self, setpoint: PoseStamped, seconds: float) -> None:
        """Move the point that it flies to, as fast as it is to travel."""
        dx = setpoint.pose.position.x - self._x
        dy = setpoint.pose.position.y - self._y
        distance = math.hypot(dx, dy)
        step = self._cruise_speed * seconds
        share = step / distance if distance > step else 1.0
        self._x += share * dx
        self._y += share * dy

    def _steer(self, command: TwistStamped, pose: PoseStamped, setpoint: PoseStamped) -> None:
        place, linear = pose.pose.position, command.twist.linear
        vx = POSITION_GAIN * (self._x - place.x)
        vy = POSITION_GAIN * (self._y - place.y)
        speed = math.hypot(vx, vy)
        if speed > self._max_velocity:
            vx *= self._max_velocity / speed
            vy *= self._max_velocity / speed
        linear.x, linear.y = vx, vy
        linear.z = self._climb_rate(setpoint.pose.position.z - place.z)
        command.twist.angular.z = self._yaw_rate(yaw_of(setpoint.pose) - yaw_of(pose.pose))

    def _climb_rate(self, error: float) -> float:
        rate = HEIGHT_GAIN * error
        if abs(rate) > self._max_climb_rate:
            return math.copysign(self._max_climb_rate, rate)
        return rate

    def _yaw_rate(self, error: float) -> float:
        rate = YAW_GAIN * wrap_angle(error)
        if abs(rate) > self._max_yaw_rate:
            return math.copysign(self._max_yaw_rate, rate)
        return rate


def main() -> None:
    """Run the node."""
    run_node(FlightController)


if __name__ == "__main__":
    main()
