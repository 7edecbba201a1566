"""The nodes of the robot and of its world."""
