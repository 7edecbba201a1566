"""Follows one face from image to image."""

from rclpy.node import Node

from image_capture_ros2.sights import Face


class FaceTracker:
    """The face that is followed; times in s."""

    def __init__(self, node: Node) -> None:
        self._threshold = node.declare_parameter("face_detection_threshold", 25).value
        self._association_gate = node.declare_parameter("association_gate", 0.35).value
        self._lost_face_timeout = node.declare_parameter("lost_face_timeout", 0.8).value
        self._min_track_coverage = node.declare_parameter("min_track_coverage", 0.006).value
        self._sightings = 0
        self._last_seen = 0.0
        self.offset = 0.0
        self.coverage = 0.0

    def update(self, faces: list[Face], now: float) -> bool:
        """Take in the faces of an image; return whether one of them is followed."""
        face = self._select(faces)
        if face is None:
            self._sightings = max(0, self._sightings - 1)
            return False
        first = self._sightings == 0
        self._sightings += 1
        self._last_seen = now
        self.offset = face.offset
        self.coverage += (face.coverage - self.coverage) * (1.0 if first else 0.3)
        return True

    def identified(self) -> bool:
        """Whether it was seen often enough to be a face."""
        return self._sightings >= self._threshold

    def lost(self, now: float) -> bool:
        """Whether it is out of sight."""
        return self._sightings == 0 or now - self._last_seen > self._lost_face_timeout

    def reset(self) -> None:
        """Follow another one."""
        self._sightings = 0
        self.offset = self.coverage = 0.0

    def _select(self, faces: list[Face]) -> Face | None:
        best: Face | None = None
        for face in faces:
            if face.coverage < self._min_track_coverage:
                continue
            if self._sightings > 0 and abs(face.offset - self.offset) > self._association_gate:
                continue
            if best is None or face.score > best.score:
                best = face
        return best
