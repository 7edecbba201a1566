"""The node of ROS 2 that pytpc starts under the interpreter that has rclpy."""
