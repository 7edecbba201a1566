"""The mission: take off, fly to a point, turn until somebody is seen, take a picture, fly home."""

import math
from enum import Enum

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from rclpy.time import Time
from sensor_msgs.msg import PointCloud
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool, Trigger

from image_capture_ros2.face_tracker import FaceTracker
from image_capture_ros2.geometry import pose_at, wrap_angle, yaw_of
from image_capture_ros2.picture_logic import PictureLogic
from image_capture_ros2.search_pattern import SearchPattern
from image_capture_ros2.sights import FACE_AREA, HALF_ANGLE, Face, from_message
from image_capture_ros2.spinning import run_node

TICK_S = 0.1
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class State(Enum):
    """What the mission is at."""

    IDLE = "idle"
    TAKE_OFF = "take_off"
    GO_TO = "go_to"
    ALIGN = "align"
    SEARCH = "search"
    APPROACH = "approach"
    RETURN = "return"
    LAND = "land"
    DONE = "done"


class Mission(Node):
    """Decides ten times a second where to fly."""

    def __init__(self) -> None:
        super().__init__("mission")
        self._read_parameters()
        self._tracker = FaceTracker(self)
        self._pictures = PictureLogic(self)
        self._search = SearchPattern(self)
        self._state = State.IDLE
        self._flight: Odometry | None = None
        self._now = self._entered = self._started = 0.0
        self._x = self._y = self._yaw = 0.0
        self._hold_x = self._hold_y = self._goal_yaw = 0.0
        self._distance = 0.0
        self._ready = False
        self._capture: Future | None = None
        self._setpoint_pub = self.create_publisher(PoseStamped, "/mission/setpoint", 10)
        self._state_pub = self.create_publisher(String, "/mission/state", LATCHED)
        self._done_pub = self.create_publisher(Bool, "/mission/done", LATCHED)
        self._detect_pub = self.create_publisher(Bool, "/camera/detect", 10)
        self._arm_client = self.create_client(SetBool, "/uav/arm")
        self._capture_client = self.create_client(Trigger, "/camera/capture")
        self.create_subscription(Odometry, "/controller/state", self._on_flight, 10)
        self.create_subscription(String, "/safety/alarm", self._on_alarm, 10)
        self.create_subscription(PointCloud, "/camera/faces", self._on_faces, 10)
        self.create_timer(TICK_S, self._on_tick)

    def _read_parameters(self) -> None:
        self._start_delay = self.declare_parameter("start_delay", 2.0).value
        self._takeoff_height = self.declare_parameter("takeoff_height", 1.6).value
        self._search_x = self.declare_parameter("search_x", 4.0).value
        self._search_y = self.declare_parameter("search_y", 1.0).value
        self._search_yaw = self.declare_parameter("search_yaw", -1.8).value
        self._landing_x = self.declare_parameter("landing_x", 0.0).value
        self._landing_y = self.declare_parameter("landing_y", 0.0).value
        self._waypoint_tolerance = self.declare_parameter("waypoint_tolerance", 0.25).value
        self._yaw_tolerance = math.radians(self.declare_parameter("yaw_tolerance_deg", 8.0).value)
        self._leg_timeout = self.declare_parameter("leg_timeout", 25.0).value
        self._mission_timeout = self.declare_parameter("mission_timeout", 60.0).value
        self._min_land_height = self.declare_parameter("min_land_height", 0.15).value
        self._enable_approach = self.declare_parameter("enable_approach", True).value

    def _on_flight(self, flight: Odometry) -> None:
        self._flight = flight
        pose = flight.pose.pose
        self._x, self._y, self._yaw = pose.position.x, pose.position.y, yaw_of(pose)

    def _on_alarm(self, alarm: String) -> None:
        if self._state not in (State.LAND, State.DONE):
            self.get_logger().error(f"{alarm.data}: landing")
            self._enter(State.LAND)

    def _on_faces(self, message: PointCloud) -> None:
        now = Time.from_msg(message.header.stamp).nanoseconds / 1e9
        if self._state not in (State.SEARCH, State.APPROACH):
            return
        if self._state is State.SEARCH and not self._search.looking(now):
            return
        if not self._tracker.update(from_message(message, Face), now):
            return
        if self._state is State.SEARCH:
            self._enter(State.APPROACH)
        self._goal_yaw = wrap_angle(self._yaw - self._tracker.offset * HALF_ANGLE)
        self._distance = math.sqrt(FACE_AREA / self._tracker.coverage)

    def _on_tick(self) -> None:
        self._now = self.get_clock().now().nanoseconds / 1e9
        flying = self._state not in (State.IDLE, State.LAND, State.DONE)
        if flying and self._now - self._started > self._mission_timeout:
            self._enter(State.LAND)
        run = {
            State.IDLE: self._run_idle,
            State.TAKE_OFF: self._run_take_off,
            State.GO_TO: self._run_go_to,
            State.ALIGN: self._run_align,
            State.SEARCH: self._run_search,
            State.APPROACH: self._run_approach,
            State.RETURN: self._run_return,
            State.LAND: self._run_land,
            State.DONE: self._run_done,
        }
        run[self._state]()

    def _run_idle(self) -> None:
        self._fly_to(0.0, 0.0, 0.0, 0.0)
        if self._flight is None or not self._arm_client.service_is_ready():
            return
        if not self._ready:
            self._ready = True
            self._entered = self._now
        if self._now - self._entered < self._start_delay:
            return
        self._started = self._now
        self._arm_client.call_async(SetBool.Request(data=True))
        self._enter(State.TAKE_OFF)

    def _run_take_off(self) -> None:
        self._hover()
        if self._height() > self._takeoff_height - 0.15:
            self._enter(State.GO_TO)

    def _run_go_to(self) -> None:
        self._fly_to(self._search_x, self._search_y, self._takeoff_height, self._goal_yaw)
        if self._leg_overdue():
            self._enter(State.LAND)
        elif self._arrived(self._search_x, self._search_y):
            self._enter(State.ALIGN)

    def _run_align(self) -> None:
        self._goal_yaw = self._search_yaw
        self._hover()
        if abs(wrap_angle(self._search_yaw - self._yaw)) < self._yaw_tolerance:
            self._start_search()

    def _run_search(self) -> None:
        self._goal_yaw = self._search.advance(TICK_S)
        self._hover()
        if self._search.exhausted():
            self.get_logger().warning("nobody was found")
            self._enter(State.RETURN)

    def _run_approach(self) -> None:
        tracker = self._tracker
        if tracker.lost(self._now):
            tracker.reset()
            self._start_search()
            return
        if tracker.identified():
            good = self._pictures.good(tracker.coverage, tracker.offset)
            if good and self._pictures.may_capture(self._now):
                self._take_picture()
            elif self._enable_approach:
                self._move_to_face()
        self._hover()

    def _move_to_face(self) -> None:
        wanted = self._pictures.wanted_distance(self._tracker.coverage)
        if wanted is not None:
            self._hold_x = self._x + (self._distance - wanted) * math.cos(self._goal_yaw)
            self._hold_y = self._y + (self._distance - wanted) * math.sin(self._goal_yaw)

    def _take_picture(self) -> None:
        if self._capture is None:
            self._capture = self._capture_client.call_async(Trigger.Request())
            self._capture.add_done_callback(self._on_picture)

    def _on_picture(self, capture: Future) -> None:
        self._capture = None
        if not capture.result().success:
            return
        self._pictures.note_capture(self._now)
        self.get_logger().info("a picture")
        if self._pictures.album_full():
            self._enter(State.RETURN)

    def _run_return(self) -> None:
        self._fly_to(self._landing_x, self._landing_y, self._takeoff_height, self._goal_yaw)
        if self._arrived(self._landing_x, self._landing_y) or self._leg_overdue():
            self._enter(State.LAND)

    def _run_land(self) -> None:
        self._fly_to(self._hold_x, self._hold_y, self._height() - 0.5, self._goal_yaw)
        if self._height() < self._min_land_height:
            self._arm_client.call_async(SetBool.Request(data=False))
            self._enter(State.DONE)
            self._done_pub.publish(Bool(data=True))

    def _run_done(self) -> None:
        self._fly_to(self._hold_x, self._hold_y, 0.0, self._goal_yaw)

    def _start_search(self) -> None:
        self._enter(State.SEARCH)
        self._search.resume(self._yaw, self._now)

    def _enter(self, state: State) -> None:
        self.get_logger().info(f"{self._state.value} -> {state.value}")
        self._state = state
        self._entered = self._now
        self._hold_x, self._hold_y, self._goal_yaw = self._x, self._y, self._yaw
        self._state_pub.publish(String(data=state.value))
        # Face detection costs power, and on the way faces would only distract.
        detect = state in (State.SEARCH, State.APPROACH)
        self._detect_pub.publish(Bool(data=detect))

    def _height(self) -> float:
        return self._flight.pose.pose.position.z if self._flight is not None else 0.0

    def _arrived(self, x: float, y: float) -> bool:
        return math.hypot(x - self._x, y - self._y) < self._waypoint_tolerance

    def _leg_overdue(self) -> bool:
        return self._now - self._entered > self._leg_timeout

    def _hover(self) -> None:
        self._fly_to(self._hold_x, self._hold_y, self._takeoff_height, self._goal_yaw)

    def _fly_to(self, x: float, y: float, z: float, yaw: float) -> None:
        setpoint = PoseStamped(pose=pose_at(x, y, z, yaw))
        setpoint.header.stamp = self.get_clock().now().to_msg()
        setpoint.header.frame_id = "world"
        self._setpoint_pub.publish(setpoint)


def main() -> None:
    """Run the node."""
    run_node(Mission)


if __name__ == "__main__":
    main()
