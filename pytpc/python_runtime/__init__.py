"""Reports of a Python node: its modules are rewritten while they are imported.

This room runs inside of the robot's node, under the node's interpreter: Python 3.8 and up, the
standard library alone. rospy is used where the program has imported it.

``listed`` (which comparisons) -> ``find`` (where they are in a module) -> ``rewrite`` (a module
that reports) -> ``loader``, ``script`` (how it comes to run); ``quiet`` (unseen by tracers) ->
``sites`` (what an evaluation calls) -> ``runtime`` (what is chosen) -> ``policies``, ``log_file``,
``ros_sinks`` (where reports go).
docs/reference/python-runtime.md has it in words.
"""
