"""The protocols of ROS 1."""
