"""When a picture may be taken."""

from rclpy.node import Node


class PictureLogic:
    """Which pictures are good, and how many were taken; times in s."""

    def __init__(self, node: Node) -> None:
        self._min_coverage_limit = node.declare_parameter("min_coverage_limit", 0.035).value
        self._max_coverage_limit = node.declare_parameter("max_coverage_limit", 0.2).value
        self._center_tolerance = node.declare_parameter("center_tolerance", 0.25).value
        self._standoff_distance = node.declare_parameter("standoff_distance", 2.2).value
        self._capture_cooldown = node.declare_parameter("capture_cooldown", 2.0).value
        self._max_selfie_count = node.declare_parameter("max_selfie_count", 1).value
        self._selfies = 0
        self._last_capture = 0.0

    def good(self, coverage: float, offset: float) -> bool:
        """Whether the face is large enough, and in the middle."""
        return self._in_range(coverage) and abs(offset) < self._center_tolerance

    def wanted_distance(self, coverage: float) -> float | None:
        """How far from the face to fly, m; None: stay."""
        if coverage < self._min_coverage_limit:
            return self._standoff_distance
        if coverage > self._max_coverage_limit:
            return 1.5 * self._standoff_distance
        return None

    def may_capture(self, now: float) -> bool:
        """Whether another picture is wanted by now."""
        if self._selfies >= self._max_selfie_count:
            return False
        return self._selfies == 0 or now - self._last_capture > self._capture_cooldown

    def note_capture(self, now: float) -> None:
        """A picture was taken."""
        self._selfies += 1
        self._last_capture = now

    def album_full(self) -> bool:
        """Whether all pictures were taken."""
        return self._selfies >= self._max_selfie_count

    def _in_range(self, coverage: float) -> bool:
        return self._min_coverage_limit < coverage < self._max_coverage_limit
