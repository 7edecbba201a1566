"""Reports of a Python node: the hook rewrites its modules while they are imported.

This room runs inside the robot's node, under the node's interpreter: Python 3.8 or newer, with the
standard library alone. It uses rospy or rclpy where the program has imported it (``ros1_*`` and
``ros2_*``; ``ros_state`` knows which).

``listed`` (which comparisons) -> ``find`` (where they are in a module) -> ``rewrite`` (a module
that reports) -> ``loader``, ``run`` (how it is run); ``sites`` (what an evaluation calls, hidden
from tracers by ``quiet``) -> ``runtime`` (which settings apply) -> ``policies``, ``log_file``,
``ros1_sinks``, ``ros2_sinks`` (where reports go). docs/reference/python-runtime.md describes it.
"""
