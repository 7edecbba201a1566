"""`pytpc fix --command` on a real graph: a robot built with TPC flies again until it is right."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest
from flown import need_cpp_half
from recorded_robot import environment, make_package

from pytpc.build.build import build_workspace
from pytpc.workspace.colcon import BuildOptions
from terminals import pytpc

if shutil.which("roslaunch") is None:
    pytest.skip("ROS is not installed", allow_module_level=True)
need_cpp_half()

PATIENCE_S = 300.0
CMAKE = """cmake_minimum_required(VERSION 3.10)
project(guard)
find_package(catkin REQUIRED COMPONENTS roscpp std_msgs)
catkin_package()
include_directories(${catkin_INCLUDE_DIRS})
add_executable(guard src/guard.cpp)
target_link_libraries(guard ${catkin_LIBRARIES})
install(TARGETS guard RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(PROGRAMS scripts/observer.py DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY launch config DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
"""
# Four times a load of 0.8 comes, and just before it a speed of 0.8. What it does depends on its
# steps alone: they take longer on a slow machine.
GUARD = """
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, "guard");
  ros::NodeHandle node, own("~");
  double max_load, max_speed;
  if (!own.getParam("max_load", max_load) || !own.getParam("max_speed", max_speed))
    return 1;
  ros::Publisher alarm = node.advertise<std_msgs::Int32>("alarm", 100);
  ros::Publisher brake = node.advertise<std_msgs::Float64>("brake", 100);
  while (ros::ok() && !alarm.getNumSubscribers())
    ros::Duration(0.05).sleep();
  for (int step = 0; step < 800 && ros::ok(); ++step) {
    int round = step / 200, at = step % 200;
    double noise = 0.001 * (step % 7);
    double speed = (at >= 90 && at < 110 ? 0.8 : 0.2) + noise;
    double load = (at >= 100 && at < 120 ? 0.8 : 0.2) + noise;
    if (speed > max_speed) {
      std_msgs::Float64 said;
      said.data = speed;
      brake.publish(said);
    }
    if (load > max_load) {
      std_msgs::Int32 said;
      said.data = round;
      alarm.publish(said);
    }
    ros::Duration(0.02).sleep();
  }
  return 0;
}
"""
# It marks an alarm, once in each round: nothing is wrong.
OBSERVER = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int32, Time

rospy.init_node("observer")
mark = rospy.Publisher("/mark_action", Time, queue_size=100)
seen = set()

def heard(message):
    if message.data not in seen:
        seen.add(message.data)
        mark.publish(Time(rospy.get_rostime()))

while not mark.get_num_connections() and not rospy.is_shutdown():
    rospy.sleep(0.05)
rospy.Subscriber("/alarm", Int32, heard, queue_size=100)
rospy.spin()
"""
LAUNCH = """<launch>
  <rosparam command="load" file="$(find guard)/config/params.yaml"/>
  <node pkg="guard" type="guard" name="guard" required="true"/>
  <node pkg="guard" type="observer.py" name="observer"/>
</launch>
"""
RIGHT = "# of the guard\r\nguard:\r\n  max_load: 1.0   # t\r\n  max_speed: 1.5\r\n"
WRONG = RIGHT.replace("1.0", "0.5").replace("1.5", "0.6")


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder above the built workspace ``ws``."""
    folder = tmp_path_factory.mktemp("guard")
    files = {
        "CMakeLists.txt": CMAKE,
        "src/guard.cpp": GUARD,
        "scripts/observer.py": OBSERVER,
        "launch/guard.launch": LAUNCH,
        "config/params.yaml": RIGHT,
    }
    make_package(folder / "ws/src", "guard", files)
    manifest = folder / "ws/src/guard/package.xml"
    needs = "<buildtool_depend>catkin</buildtool_depend><depend>roscpp</depend>"
    needs += "<depend>std_msgs</depend></package>"
    manifest.write_text(manifest.read_text().replace("</package>", needs))
    result = build_workspace(folder / "ws", BuildOptions())
    assert {"~max_load", "~max_speed"} <= {
        one.source for unit in result.units for one in unit.comparisons
    }
    return folder


def run(folder: Path, *words: str) -> str:
    given = {**os.environ, **environment(folder / "runtime"), "ROS_MASTER_URI": ""}
    given |= {"XDG_STATE_HOME": str(folder / "state"), "PATH": "/usr/bin:/bin"}
    done = subprocess.run(
        pytpc(*words), cwd=folder, env=given, capture_output=True, text=True, timeout=PATIENCE_S,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


# Both limits were lower than the peaks; only the load's makes the alarm. The speed passes its limit
# before it does, and may be tried first.
def test_it_flies_until_nothing_is_marked_and_takes_everything_back(robot: Path):
    file = robot / "ws/src/guard/config/params.yaml"
    record = ("record", "ws", "guard", "guard.launch", "-o")
    file.write_bytes(RIGHT.encode())
    run(robot, *record, "yesterday")
    assert json.loads(run(robot, "marks", "yesterday", "--json")) == []
    file.write_bytes(WRONG.encode())
    run(robot, *record, "today")
    assert len(json.loads(run(robot, "marks", "today", "--json"))) == 4

    command = f'{shlex.join(pytpc(*record))} "$TPC_FIX_MISSION"'
    shown = run(robot, "fix", "today", "--reference", "yesterday", "--command", command)
    assert "today: fixed" in shown

    *before, last = json.loads((robot / "fix.json").read_text())["tries"]
    assert [(one["verdict"], one["undone"]) for one in before] == [("same", True)] * len(before)
    assert (last["name"], last["old"], last["new"]) == ("/guard/max_load", 0.5, 1.0)
    assert last["verdict"] == "fixed"
    assert file.read_bytes() == WRONG.replace("max_load: 0.5", "max_load: 1.0").encode()

    run(robot, "fix", "--undo")
    assert file.read_bytes() == WRONG.encode()
