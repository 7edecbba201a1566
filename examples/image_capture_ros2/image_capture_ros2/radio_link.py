"""Sends poses, states and pictures to the base station, in packets."""

import math
from collections import deque

from geometry_msgs.msg import Point
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.serialization import serialize_message
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import String, UInt8MultiArray

from image_capture_ros2.spinning import run_node


class RadioLink(Node):
    """Sends one packet after the other."""

    def __init__(self) -> None:
        super().__init__("radio_link")
        self.declare_parameters(
            "",
            [
                ("max_pkt_size", 512),
                ("max_queue_length", 400),
                ("min_displacement", 0.05),
                ("min_z_displacement", 0.15),
                ("enable_preview", True),
            ],
        )
        self._max_pkt_size = self.get_parameter("max_pkt_size").value
        self._max_queue_length = self.get_parameter("max_queue_length").value
        self._min_displacement = self.get_parameter("min_displacement").value
        self._min_z_displacement = self.get_parameter("min_z_displacement").value
        self._enable_preview = self.get_parameter("enable_preview").value
        self._queue: deque[bytes] = deque()
        self._flight: Odometry | None = None
        self._sent = Point()
        self._packet_pub = self.create_publisher(UInt8MultiArray, "/radio/packets", 10)
        self.create_subscription(Odometry, "/controller/state", self._on_flight, 10)
        self.create_subscription(String, "/mission/state", self._on_state, 10)
        self.create_subscription(CompressedImage, "/camera/picture", self._on_picture, 10)
        self.create_subscription(CompressedImage, "/camera/preview", self._on_preview, 10)
        self.create_timer(0.2, self._on_pose_timer)
        self.create_timer(0.05, self._on_transmit_timer)

    def _on_flight(self, flight: Odometry) -> None:
        self._flight = flight

    def _on_state(self, state: String) -> None:
        self._push(serialize_message(state))

    def _on_picture(self, picture: CompressedImage) -> None:
        self._push(bytes(picture.data))

    def _on_preview(self, preview: CompressedImage) -> None:
        if self._enable_preview:
            self._push(bytes(preview.data))

    def _on_pose_timer(self) -> None:
        if self._flight is not None and self._moved(self._flight.pose.pose.position):
            self._sent = self._flight.pose.pose.position
            self._push(serialize_message(self._flight))

    def _moved(self, place: Point) -> bool:
        sent = self._sent
        if math.hypot(place.x - sent.x, place.y - sent.y) > self._min_displacement:
            return True
        return abs(place.z - sent.z) > self._min_z_displacement

    def _push(self, data: bytes) -> None:
        while len(data) > self._max_pkt_size:
            self._add(data[: self._max_pkt_size])
            data = data[self._max_pkt_size :]
        self._add(data)

    def _add(self, packet: bytes) -> None:
        self._queue.append(packet)
        # Old data is worth less than new data.
        if len(self._queue) > self._max_queue_length:
            self._queue.popleft()

    def _on_transmit_timer(self) -> None:
        if self._queue:
            self._packet_pub.publish(UInt8MultiArray(data=self._queue.popleft()))


def main() -> None:
    """Run the node."""
    run_node(RadioLink)


if __name__ == "__main__":
    main()
