"""The nodes of the suite that the analysis does not get right, and why (analysis-limits.md)."""

KNOWN: dict[str, str] = {}

# The same for Python nodes.
PYTHON_KNOWN: dict[str, str] = {}

# The same for those of ROS 2.
RCLPY_KNOWN: dict[str, str] = {}
RCLCPP_KNOWN: dict[str, str] = {
    "drv_duration": "nanoseconds that rclcpp::Duration(int32_t, uint32_t) gets are not followed",
    "exp_broadcaster": "a list of messages that is made of others in braces is not followed",
    "exp_loaned": "what is written through a LoanedMessage is not followed",
    "read_get_many": "parameters in a list that get_parameters returned have no names",
    "read_prefix": "parameters in a map that get_parameters filled have no names",
    "val_component": "a message that is changed may be any message of its class",
    "val_event_handler": "a parameter of another node is taken for one of this node",
    "val_overwritten": "a library that gets the node may see the first value",
}
# Those whose reports are not what their lists say.
RCLCPP_REPORTS_KNOWN: dict[str, str] = {
    "cmp_operator": "of an operator with a threshold on each side, one call reports for both",
}
