"""The world: simulated time, the UAV, its sensors and its camera.

The time waits for the nodes that decide, so that a mission does not depend on the machine's load.
"""

import time
from random import Random

import rclpy
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, Twist, TwistStamped
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import BatteryState, CompressedImage, Imu, PointCloud
from std_msgs.msg import Header
from std_srvs.srv import SetBool, Trigger

from image_capture_ros2.camera_model import CameraModel
from image_capture_ros2.geometry import pose_at
from image_capture_ros2.lockstep import Lockstep
from image_capture_ros2.sights import Blob, to_message
from image_capture_ros2.spinning import run_node
from image_capture_ros2.uav_dynamics import UavDynamics

STEP_MS = 50
IMAGE_MS = 100
BATTERY_MS = 200
PREVIEW_MS = 2000
PICTURE_BYTES = 20_000
PREVIEW_BYTES = 2_000
MISSION_LAG_MS = 90


class UavSimulator(Node):
    """Publishes what happens, one step after the other."""

    def __init__(self) -> None:
        super().__init__("uav_simulator")
        seed = self.declare_parameter("seed", 1).value
        self._rate = self.declare_parameter("rate", 3.0).value
        self._shutter_interval = self.declare_parameter("shutter_interval", 0.5).value
        self._dynamics = UavDynamics(self, Random(seed))
        self._camera = CameraModel(self, Random(seed + 1000), Random(seed + 2000))
        self._noise = Random(seed + 3000)
        self._now_ms = 0
        self._last_shutter_ms = -PREVIEW_MS
        self._command = Twist()
        self._clock_pub = self.create_publisher(Clock, "/clock", 10)
        self._pose_pub = self.create_publisher(PoseStamped, "/uav/pose", 10)
        self._imu_pub = self.create_publisher(Imu, "/uav/imu", 10)
        self._battery_pub = self.create_publisher(BatteryState, "/uav/battery", 10)
        self._blobs_pub = self.create_publisher(PointCloud, "/camera/blobs", 10)
        self._picture_pub = self.create_publisher(CompressedImage, "/camera/picture", 10)
        self._preview_pub = self.create_publisher(CompressedImage, "/camera/preview", 10)
        self._uav_truth_pub = self.create_publisher(PoseStamped, "/truth/uav", 10)
        self._person_truth_pub = self.create_publisher(PoseStamped, "/truth/person", 10)
        self._controller = Lockstep(self, TwistStamped, "/uav/command", self._on_command)
        self._detector = Lockstep(self, PointCloud, "/camera/faces")
        self._mission = Lockstep(self, PoseStamped, "/mission/setpoint")
        self.create_service(SetBool, "/uav/arm", self._on_arm)
        self.create_service(Trigger, "/camera/capture", self._on_capture)

    def run(self) -> None:
        """Let the time pass until somebody stops the node."""
        self._wait_for_robot()
        next_s = time.monotonic()
        while rclpy.ok():
            self._tick()
            self._controller.hold(0)
            self._detector.hold(0)
            self._mission.hold(MISSION_LAG_MS, self._publish_clock)
            # Who is late loses time, and does not hurry.
            next_s = max(next_s + 1e-3 * STEP_MS / self._rate, time.monotonic() - 0.05)
            while rclpy.ok() and (left := next_s - time.monotonic()) > 0.0:
                rclpy.spin_once(self, timeout_sec=left)

    def _wait_for_robot(self) -> None:
        peers = (self._controller, self._detector, self._mission)
        heard = (self._pose_pub, self._blobs_pub)
        while rclpy.ok() and not (
            all(peer.is_there() for peer in peers)
            and all(publisher.get_subscription_count() for publisher in heard)
            and self._clock_pub.get_subscription_count() == self.count_subscribers("/clock")
        ):
            rclpy.spin_once(self, timeout_sec=0.05)
        # And a moment later, in which they connect to each other.
        time.sleep(0.5)

    def _tick(self) -> None:
        self._now_ms += STEP_MS
        stamp = self._stamp()
        self._publish_clock()
        self._dynamics.step(self._command, 1e-3 * STEP_MS)
        self._mission.sent(self._now_ms)
        self._controller.sent(self._now_ms)
        self._publish_sensors(Header(stamp=stamp, frame_id="world"))
        if self._now_ms % IMAGE_MS == 0:
            self._detector.sent(self._now_ms)
            blobs = self._camera.observe(self._dynamics.state, self._seconds())
            header = Header(stamp=stamp, frame_id="camera")
            self._blobs_pub.publish(to_message(header, Blob, blobs))
            self._publish_truth(Header(stamp=stamp, frame_id="world"))
        if self._now_ms % PREVIEW_MS == 0:
            self._preview_pub.publish(self._image(PREVIEW_BYTES))

    def _publish_clock(self) -> None:
        self._clock_pub.publish(Clock(clock=self._stamp()))

    def _publish_sensors(self, header: Header) -> None:
        uav, gauss = self._dynamics.state, self._noise.gauss
        imu = Imu(header=header)
        imu.angular_velocity.z = uav.yaw_rate + gauss(0.0, 0.005)
        self._imu_pub.publish(imu)
        x, y, z = (place + gauss(0.0, 0.008) for place in (uav.x, uav.y, uav.z))
        pose = pose_at(x, y, z, uav.yaw + gauss(0.0, 0.003))
        self._pose_pub.publish(PoseStamped(header=header, pose=pose))
        if self._now_ms % BATTERY_MS == 0:
            battery = BatteryState(header=header, voltage=self._dynamics.voltage(), present=True)
            self._battery_pub.publish(battery)

    def _publish_truth(self, header: Header) -> None:
        person = pose_at(*self._camera.person(self._seconds()), 1.6, 0.0)
        self._person_truth_pub.publish(PoseStamped(header=header, pose=person))
        uav = self._dynamics.state
        pose = pose_at(uav.x, uav.y, uav.z, uav.yaw)
        self._uav_truth_pub.publish(PoseStamped(header=header, pose=pose))

    def _on_command(self, command: TwistStamped) -> None:
        self._command = command.twist

    def _on_arm(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self._dynamics.motors_on = request.data
        response.success = True
        return response

    def _on_capture(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        if 1e-3 * (self._now_ms - self._last_shutter_ms) < self._shutter_interval:
            response.message = "the shutter is not ready"
            return response
        self._last_shutter_ms = self._now_ms
        self._picture_pub.publish(self._image(PICTURE_BYTES))
        response.success = True
        return response

    def _image(self, size: int) -> CompressedImage:
        header = Header(stamp=self._stamp(), frame_id="camera")
        return CompressedImage(header=header, format="raw", data=self._noise.randbytes(size))

    def _seconds(self) -> float:
        return 1e-3 * self._now_ms

    def _stamp(self) -> Time:
        return Time(sec=self._now_ms // 1000, nanosec=self._now_ms % 1000 * 1_000_000)


def main() -> None:
    """Run the node."""
    run_node(UavSimulator, UavSimulator.run)


if __name__ == "__main__":
    main()
