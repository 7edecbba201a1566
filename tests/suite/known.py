"""The nodes of the suite that the analysis does not get right, and why (analysis-limits.md)."""

KNOWN: dict[str, str] = {}

# The same for Python nodes.
PYTHON_KNOWN: dict[str, str] = {}

# The same for those of ROS 2.
RCLPY_KNOWN: dict[str, str] = {}
RCLCPP_KNOWN: dict[str, str] = {}
