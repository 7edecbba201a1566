"""What is particular to graphs of ROS 2."""
