"""A workspace without install() rules, as most are: built, run, edited, and started by hand.

The launch file, the configuration and the Python node are in the sources alone. The C++ node uses
the headers and the library of another package, and a plugin, which it finds as pluginlib does.
"""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from click.testing import CliRunner
from recorded_robot import environment, shell, wait_until
from started_by_hand import roslaunch

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import cmake_file, log_library, plugin, require_ros
from pytpc.build.nodes_env import nodes_env
from pytpc.cli.main import main
from pytpc.ingest.reading import read
from pytpc.ros.mission_run import read_status
from pytpc.static.static_info import StaticInfo
from screens import Screen
from terminals import pytpc

PATIENCE_S = 120

try:
    require_ros()
    for half in (cmake_file, plugin, log_library):
        half()
except MissingToolError as error:
    pytest.skip(str(error), allow_module_level=True)

MANIFEST = """<package format="2">
  <name>{name}</name><version>0.1.0</version><description>d</description>
  <maintainer email="a@b.org">a</maintainer><license>x</license>
  <buildtool_depend>catkin</buildtool_depend>{depends}
</package>
"""
CORE = {
    "package.xml": MANIFEST.format(name="core", depends="<depend>roscpp</depend>"),
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.10)
project(core)
find_package(catkin REQUIRED COMPONENTS roscpp)
catkin_package(INCLUDE_DIRS include LIBRARIES core CATKIN_DEPENDS roscpp)
include_directories(include ${catkin_INCLUDE_DIRS})
add_library(core src/core.cpp)
target_link_libraries(core ${catkin_LIBRARIES})
""",
    "include/core/core.h": """#pragma once
double sawtooth(int step);
""",
    "src/core.cpp": """#include <core/core.h>
double sawtooth(int step) { return (step % 10) * 0.1; }
""",
}
ROVER = {
    "package.xml": MANIFEST.format(
        name="rover",
        depends="<depend>core</depend><depend>std_msgs</depend><exec_depend>rospy</exec_depend>"
        '<export><core plugin="${prefix}/plugins.xml"/></export>',
    ),
    "plugins.xml": '<library path="lib/librover_plugins"/>\n',
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.10)
project(rover)
find_package(catkin REQUIRED COMPONENTS core std_msgs)
catkin_python_setup()
catkin_package()
include_directories(${catkin_INCLUDE_DIRS})
add_library(rover_plugins src/plugins.cpp)
target_link_libraries(rover_plugins ${catkin_LIBRARIES})
add_executable(driver src/driver.cpp)
target_link_libraries(driver ${catkin_LIBRARIES} dl)
""",
    "setup.py": """from setuptools import setup
from catkin_pkg.python_setup import generate_distutils_setup
setup(**generate_distutils_setup(packages=["rover"], package_dir={"": "src"}))
""",
    "src/plugins.cpp": """#include <ros/ros.h>
#include <std_msgs/Float64.h>
extern "C" void brake(double speed) {
  static ros::NodeHandle nh, own("~");
  static ros::Publisher out = nh.advertise<std_msgs::Float64>("brake", 1);
  double ceiling = 0.55;
  own.getParam("ceiling", ceiling);
  if (speed > ceiling) {
    std_msgs::Float64 message;
    message.data = speed;
    out.publish(message);
  }
}
""",
    # 40 steps of 0, 0.1, ... 0.9.
    "src/driver.cpp": """#include <core/core.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>
#include <cstdlib>
#include <dlfcn.h>
#include <sstream>
int main(int argc, char **argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle nh, own("~");
  void *library = nullptr;
  std::istringstream prefixes(std::getenv("CMAKE_PREFIX_PATH"));
  for (std::string prefix; !library && std::getline(prefixes, prefix, ':');)
    library = dlopen((prefix + "/lib/librover_plugins.so").c_str(), RTLD_NOW);
  if (!library)
    return 3;
  auto brake = reinterpret_cast<void (*)(double)>(dlsym(library, "brake"));
  double limit = 0.5;
  own.getParam("limit", limit);
  bool stay = false;
  own.getParam("stay", stay);
  ros::Publisher out = nh.advertise<std_msgs::Float64>("speed", 1);
  ros::Publisher done = nh.advertise<std_msgs::Bool>("driven", 1, true);
  ros::Rate rate(100);
  for (int i = 0; ros::ok() && (stay || i < 40); ++i, rate.sleep()) {
    double speed = sawtooth(i);
    if (speed > limit) {
      std_msgs::Float64 message;
      message.data = speed;
      out.publish(message);
    }
    brake(speed);
  }
  done.publish(std_msgs::Bool());
  ros::spin();
}
""",
    "src/rover/__init__.py": """def is_low(number, floor):
    return number < floor
""",
    # The numbers 0 to 6, ten times each, and then the end of the mission.
    "scripts/pilot.py": """#!/usr/bin/env python3
import rospy
from rover import is_low
from std_msgs.msg import Bool, Float64

rospy.init_node("pilot")
floor = rospy.get_param("~floor")
out = rospy.Publisher("turn", Float64, queue_size=10)
for number in range(70):
    if is_low(float(number % 7), floor):
        out.publish(float(number))
rospy.wait_for_message("driven", Bool)
""",
    "config/rover.yaml": "driver: {limit: 0.25}\npilot: {floor: 2.0}\n",
    "launch/rover.launch": """<launch>
  <arg name="stay" default="false"/>
  <rosparam file="$(find rover)/config/rover.yaml"/>
  <include file="$(find rover)/launch/nodes.launch"/>
  <param name="driver/stay" value="$(arg stay)"/>
</launch>
""",
    "launch/nodes.launch": """<launch>
  <node pkg="rover" type="driver" name="driver" required="true"/>
  <node pkg="rover" type="pilot.py" name="pilot" required="true"/>
</launch>
""",
    "launch/broken.launch": """<launch>
  <include file="$(find rover)/launch/nodes.launch"/>
  <rosparam file="$(find rover)/config/rover.yaml"/>
  <node pkg="rover" type="steer" name="steer"/>
</launch>
""",
}
# Speeds above 0.25 and above 0.55: 7 and 4 of ten. Numbers below 2: 2 of seven. `stay` is asked
# before each of the 40 steps, and at the end.
EXPECTED = {
    ("/driver", 0.0, False): 41,
    ("/driver", 0.25, True): 28,
    ("/driver", 0.25, False): 12,
    ("/driver", 0.55, True): 16,
    ("/driver", 0.55, False): 24,
    ("/pilot", 2.0, True): 20,
    ("/pilot", 2.0, False): 50,
}


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("robot") / "ws"
    for package, files in (("core", CORE), ("rover", ROVER)):
        for name, text in files.items():
            path = folder / "src" / package / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
    (folder / "src/rover/scripts/pilot.py").chmod(0o755)
    done = CliRunner().invoke(main, ["build", str(folder)])
    assert done.exit_code == 0, done.output
    return folder


def sources(workspace: Path) -> list[str]:
    return sorted(str(path) for path in (workspace / "src").rglob("*"))


def reported(place: Path) -> Counter[tuple[str, float, bool]]:
    """How often each node had each outcome with each threshold."""
    found = read(sorted((place / "tpc").glob("*.tpc")))
    assert (found.malformed, found.notes) == (0, ())
    events = found.events
    nodes = (events.nodes[code] for code in events.node)
    thresholds, results = map(float, events.thresh), map(bool, events.result)
    return Counter(zip(nodes, thresholds, results, strict=True))


def record(workspace: Path, out: Path, *words: str) -> subprocess.CompletedProcess[str]:
    words = ("record", str(workspace), "rover", *words, "-o", str(out))
    env = environment(out.parent / "runtime")
    return subprocess.run(
        pytpc(*words, "--timeout", str(PATIENCE_S)),
        env={**os.environ, **env, "TPC_SINK": "file", "TPC_FILE_RESERVE": "0"},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=2 * PATIENCE_S,
        check=False,
    )


def test_a_mission_runs_from_the_sources_and_reports(workspace: Path, tmp_path: Path) -> None:
    before = sources(workspace)
    done = record(workspace, tmp_path / "out", "rover.launch")
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stderr
    assert reported(tmp_path / "out") == EXPECTED
    assert sources(workspace) == before


def test_edited_configuration_is_used_without_a_build(workspace: Path, tmp_path: Path) -> None:
    config = workspace / "src/rover/config/rover.yaml"
    text = config.read_text()
    config.write_text(text.replace("0.25", "0.65"))
    try:
        assert record(workspace, tmp_path / "out", "rover.launch").returncode == 0
        # 0.7, 0.8 and 0.9 are above 0.65.
        found = reported(tmp_path / "out")
        assert (found["/driver", 0.65, True], found["/driver", 0.65, False]) == (12, 28)
        words = ["apply", str(tmp_path / "out"), "/driver/limit", "0.35", "--dry-run", "--json"]
        applied = CliRunner().invoke(main, words)
        assert applied.exit_code == 0, applied.output
        change = json.loads(applied.stdout)["file"]
        assert (change["path"], change["lineno"]) == (str(config), 1)
        assert change["notes"] == []
    finally:
        config.write_text(text)


def test_marks_and_the_verdict_in_one_terminal(workspace: Path, tmp_path: Path) -> None:
    words = ("run", str(workspace), "rover", "rover.launch", "stay:=true", "-o", "out")
    with Screen(shell(*words, folder=tmp_path), 120, 30) as screen:
        screen.wait_for("watching on http://127.0.0.1", "~limit", timeout_s=60)
        status = tmp_path / "out/ros/recorder.json"
        wait_until(lambda: (one := read_status(status)) and one.reports > 2, screen.terminal)
        screen.terminal.press("1")
        screen.wait_for("marked: type I")
        screen.terminal.press("q")
        assert screen.terminal.wait(90) == 0
        said = screen.terminal.text
    assert "1 mark: out/marks.csv" in said
    assert "next: " in said
    assert (tmp_path / "out/report.html").is_file()


@pytest.mark.parametrize("way", ["source and env", "env --setup"])
def test_a_robot_that_is_started_by_hand(workspace: Path, tmp_path: Path, way: str) -> None:
    env = shlex.join([sys.executable, "-m", "pytpc", "env", str(workspace)])
    words = f'eval "$({env} --setup)"'
    if way == "source and env":
        words = f'source {shlex.quote(f"{workspace}/.tpc/install/setup.bash")}; eval "$({env})"'
    said = roslaunch(tmp_path, words, "rover rover.launch")
    assert "tpc:" not in said
    assert reported(tmp_path) == EXPECTED, said


def test_the_plugin_is_found_as_pluginlib_finds_it(workspace: Path) -> None:
    # Its manifest names the file of the plugins, that names the library, which is in a prefix.
    ask = (
        "import rospkg; print(rospkg.RosPack().get_manifest('rover').get_export('core', 'plugin'))"
    )
    env = nodes_env(workspace)
    said = subprocess.check_output(["/usr/bin/python3", "-c", ask], env=env, text=True)
    assert said.strip() == f"['{workspace}/src/rover/plugins.xml']"
    prefixes = [Path(one) for one in env["CMAKE_PREFIX_PATH"].split(":")]
    found = [one for one in prefixes if (one / "lib/librover_plugins.so").exists()]
    assert found == [workspace / ".tpc/devel"]


def test_a_node_that_is_not_there_is_told_at_once(workspace: Path, tmp_path: Path) -> None:
    done = record(workspace, tmp_path / "out", "broken.launch")
    first = done.stderr.splitlines()[0]
    assert first.startswith("warning: package rover has no program steer, so this node will not")
    assert "pytpc build" in first


def test_the_static_information_is_that_of_the_sources(workspace: Path) -> None:
    static = StaticInfo.load(workspace / ".tpc/static.json")
    places = {(unit.package, unit.link_unit) for unit in static.units if unit.comparisons}
    assert places == {("rover", "driver"), ("rover", "rover_plugins"), ("rover", "pilot")}
    files = {one.file for unit in static.units for one in unit.comparisons}
    assert files == {"src/driver.cpp", "src/plugins.cpp", "src/rover/__init__.py"}
