"""A workspace of ROS 2 with two packages in Python alone, for tests: literal files.

``guard`` has a node that an entry point starts, a launch file and a file of parameters. It uses a
module of ``limits``, which is built before it.
"""

from pathlib import Path

_MANIFEST = """<package format="3">
  <name>{name}</name><version>0.1.0</version><description>d</description>
  <maintainer email="a@b.org">a</maintainer><license>x</license>
  <exec_depend condition="$ROS_VERSION == 1">rospy</exec_depend>
  <exec_depend condition="$ROS_VERSION == 2">rclpy</exec_depend>
  <depend>std_msgs</depend>{more}
  <export><build_type>ament_python</build_type></export>
</package>
"""
_SETUP = """from glob import glob
from setuptools import setup
setup(name="{name}", version="0.1.0", packages=["{name}"],
      data_files=[("share/ament_index/resource_index/packages", ["resource/{name}"]),
                  ("share/{name}", ["package.xml"]),
                  ("share/{name}/launch", glob("launch/*")),
                  ("share/{name}/config", glob("config/*"))],
      entry_points={{"console_scripts": {scripts}}})
"""
_PLACES = """[develop]
script_dir=$base/lib/{name}
[install]
install_scripts=$base/lib/{name}
"""
# Line 2 compares 0 to 9 with the parameter's 6.5: true for 7, 8 and 9.
_RULE = """def is_too_fast(speed, limit):
    return speed > limit
"""
_NODE = """import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

from limits.rule import is_too_fast


def main():
    rclpy.init()
    node = Node("guard", namespace="/robot1")
    limit = node.declare_parameter("speed_limit", 6.5).value
    publisher = node.create_publisher(Float64, "stop", 10)
    for step in range(10):
        if is_too_fast(float(step), limit):
            publisher.publish(Float64(data=float(step)))
    node.destroy_node()
    rclpy.shutdown()
"""


def make_ros2_workspace(workspace: Path) -> Path:
    """Write the workspace; returns it."""
    files = {}
    for name, more, scripts in (
        ("limits", "", []),
        ("guard", "<depend>limits</depend>", ["speed_guard = guard.node:main"]),
    ):
        files[f"{name}/package.xml"] = _MANIFEST.format(name=name, more=more)
        files[f"{name}/setup.py"] = _SETUP.format(name=name, scripts=scripts)
        files[f"{name}/setup.cfg"] = _PLACES.format(name=name)
        files[f"{name}/resource/{name}"] = ""
        files[f"{name}/{name}/__init__.py"] = ""
    files["limits/limits/rule.py"] = _RULE
    files["guard/guard/node.py"] = _NODE
    files["guard/config/guard.yaml"] = "/**: {ros__parameters: {speed_limit: 6.5}}\n"
    files["guard/launch/guard.launch.py"] = "def generate_launch_description(): ...\n"
    for name, text in files.items():
        path = workspace / "src" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return workspace
