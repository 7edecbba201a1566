"""A small workspace with nodes in both languages, for tests: literal files.

``mission`` is a catkin package with the C++ node ``mission`` and the script ``scripts/mission.py``,
which share nothing but the name. ``scripts/pump.py`` uses the same module as the script, that is
``src/sampling/limits.py``, and ``scripts/broken.py`` is no Python.
``camera`` is a package of ROS 2 with Python alone.
"""

from pathlib import Path

_MANIFEST = """<package format="3">
  <name>{name}</name><version>0.1.0</version><description>d</description>
  <maintainer email="a@b.org">a</maintainer><license>x</license>
  {more}
</package>
"""
MISSION = _MANIFEST.format(
    name="mission",
    more="""<buildtool_depend>catkin</buildtool_depend>
  <depend>roscpp</depend><depend>std_msgs</depend>""",
)
CAMERA = _MANIFEST.format(
    name="camera",
    more="<depend>mission</depend><export><build_type>ament_python</build_type></export>",
)
CMAKELISTS = """cmake_minimum_required(VERSION 3.10)
project(mission)
find_package(catkin REQUIRED COMPONENTS roscpp std_msgs)
catkin_python_setup()
catkin_package()
include_directories(${catkin_INCLUDE_DIRS})
add_executable(mission src/mission.cpp)
target_link_libraries(mission ${catkin_LIBRARIES})
install(TARGETS mission RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
catkin_install_python(PROGRAMS scripts/mission.py scripts/pump.py
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
"""
SETUP = """from setuptools import setup
from catkin_pkg.python_setup import generate_distutils_setup
setup(**generate_distutils_setup(packages=["sampling"], package_dir={"": "src"}))
"""
# One comparison: line 8, depth > max_depth, with a publish on line 9 that hangs on it.
MISSION_CPP = """#include <ros/ros.h>
#include <std_msgs/Float64.h>
int main(int argc, char **argv) {
  ros::init(argc, argv, "mission");
  ros::NodeHandle nh("~");
  ros::Publisher pub = nh.advertise<std_msgs::Float64>("winch", 1);
  double depth = 0, max_depth = nh.param("max_depth", 3.0);
  if (depth + argc > max_depth)
    pub.publish(std_msgs::Float64());
}
"""
# Line 8 is over two lines: height > top, and not ready (a flag).
MISSION_PY = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Float64
from sampling import limits
def step(height):
    top = rospy.get_param("~top", 5.0)
    ready = rospy.get_param("~ready", True)
    if (height > top
            and not ready):
        pub.publish(Float64(height))
if __name__ == "__main__":
    rospy.init_node("mission_py")
    pub = rospy.Publisher("up", Float64, queue_size=1)
    limits.check(pub, 2.0)
    step(7.0)
"""
PUMP_PY = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Float64
from sampling import limits
if __name__ == "__main__":
    rospy.init_node("pump")
    limits.check(rospy.Publisher("pump", Float64, queue_size=1), 1.0)
"""
# Line 5, for both scripts.
LIMITS_PY = """import rospy
from std_msgs.msg import Float64
LOW = rospy.get_param("~low", 0.5)
def check(pub, level):
    if level < LOW:
        pub.publish(Float64(level))
"""
BROKEN_PY = """#!/usr/bin/env python3
import rospy
rospy.init_node("broken"
"""
# Line 8.
CAMERA_PY = """import rclpy
from rclpy.node import Node
from std_msgs.msg import String
class Camera(Node):
    def __init__(self):
        super().__init__("camera")
        pub = self.create_publisher(String, "shots", 1)
        if self.declare_parameter("bright", 3).value > 2 + len(self.get_name()):
            pub.publish(String())
def main():
    rclpy.init()
    Camera()
if __name__ == "__main__":
    main()
"""
CAMERA_SETUP = """from setuptools import setup
setup(name="camera", version="0.1.0", packages=["camera"],
      data_files=[("share/ament_index/resource_index/packages", ["resource/camera"]),
                  ("share/camera", ["package.xml"])])
"""
BROKEN_TEXT = "not Python 3: '(' was never closed"


def make_mixed(workspace: Path) -> Path:
    """Write the workspace; returns it."""
    files = {
        "mission/package.xml": MISSION,
        "mission/CMakeLists.txt": CMAKELISTS,
        "mission/setup.py": SETUP,
        "mission/src/mission.cpp": MISSION_CPP,
        "mission/src/sampling/__init__.py": "",
        "mission/src/sampling/limits.py": LIMITS_PY,
        "mission/scripts/mission.py": MISSION_PY,
        "mission/scripts/pump.py": PUMP_PY,
        "mission/scripts/broken.py": BROKEN_PY,
        "camera/package.xml": CAMERA,
        "camera/setup.py": CAMERA_SETUP,
        "camera/resource/camera": "",
        "camera/camera/__init__.py": "",
        "camera/camera/node.py": CAMERA_PY,
    }
    for name, text in files.items():
        path = workspace / "src" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        if path.parent.name == "scripts":
            path.chmod(0o755)
    return workspace
