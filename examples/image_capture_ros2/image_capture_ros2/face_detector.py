"""Finds faces among the blobs of an image."""

from random import Random

from rclpy.node import Node
from sensor_msgs.msg import Imu, PointCloud
from std_msgs.msg import Bool

from image_capture_ros2.sights import (
    EXPOSURE_S,
    IMAGE_HEIGHT,
    IMAGE_WIDTH,
    Blob,
    Face,
    from_message,
    to_message,
)
from image_capture_ros2.spinning import run_node


class BlobFilter:
    """Tells faces from other blobs."""

    def __init__(self, node: Node) -> None:
        self._min_contrast = node.declare_parameter("min_contrast", 0.15).value
        self._min_face_width = node.declare_parameter("min_face_width", 24.0).value
        self._min_aspect_ratio = node.declare_parameter("min_aspect_ratio", 0.8).value
        self._max_aspect_ratio = node.declare_parameter("max_aspect_ratio", 1.8).value
        self._min_detection_score = node.declare_parameter("min_detection_score", 0.55).value
        self._noise = Random(7001)

    def score(self, blob: Blob) -> float | None:
        """How much it looks like a face; None if it is none."""
        if blob.contrast < self._min_contrast:
            return None
        if not self._plausible(blob):
            return None
        score = blob.response + self._noise.gauss(0.0, 0.05)
        return score if score > self._min_detection_score else None

    def _plausible(self, blob: Blob) -> bool:
        if blob.width < self._min_face_width:
            return False
        aspect = blob.height / blob.width
        return self._min_aspect_ratio < aspect < self._max_aspect_ratio


class FaceDetector(Node):
    """Answers each image; without faces where it is blurred, or nobody asks for any."""

    def __init__(self) -> None:
        super().__init__("face_detector")
        self._filter = BlobFilter(self)
        self._max_motion_blur = self.declare_parameter("max_motion_blur", 0.05).value
        self._max_faces = self.declare_parameter("max_faces", 6).value
        self._enabled = False
        self._yaw_rate = 0.0
        self._faces_pub = self.create_publisher(PointCloud, "/camera/faces", 10)
        self.create_subscription(Bool, "/camera/detect", self._on_detect, 10)
        self.create_subscription(Imu, "/uav/imu", self._on_imu, 10)
        self.create_subscription(PointCloud, "/camera/blobs", self._on_blobs, 10)

    def _on_detect(self, message: Bool) -> None:
        self._enabled = message.data

    def _on_imu(self, message: Imu) -> None:
        self._yaw_rate = message.angular_velocity.z

    def _on_blobs(self, message: PointCloud) -> None:
        faces: list[Face] = []
        if self._enabled and self._sharp():
            faces = self._find(from_message(message, Blob))
        self._faces_pub.publish(to_message(message.header, Face, faces))

    def _sharp(self) -> bool:
        return abs(self._yaw_rate) * EXPOSURE_S < self._max_motion_blur

    def _find(self, blobs: list[Blob]) -> list[Face]:
        faces: list[Face] = []
        for blob in blobs:
            if len(faces) >= self._max_faces:
                break
            score = self._filter.score(blob)
            if score is not None:
                coverage = blob.width * blob.height / (IMAGE_WIDTH * IMAGE_HEIGHT)
                faces.append(Face(blob.offset, coverage, score))
        return faces


def main() -> None:
    """Run the node."""
    run_node(FaceDetector)


if __name__ == "__main__":
    main()
