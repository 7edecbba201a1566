"""The nodes of the suite that the analysis does not get right, and why (analysis-limits.md)."""

KNOWN: dict[str, str] = {}

# The same for Python nodes.
PYTHON_KNOWN: dict[str, str] = {}

# The same for those of ROS 2.
RCLPY_KNOWN: dict[str, str] = {}
RCLCPP_KNOWN: dict[str, str] = {
    "val_component": "a message that is changed may be any message of its class",
    "val_overwritten": "a library that gets the node may see the first value",
}
# Those whose reports are not what their lists say.
RCLCPP_REPORTS_KNOWN: dict[str, str] = {}
