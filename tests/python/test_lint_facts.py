"""The facts that lint is given: of nodes, params files, launch files and recordings."""

from __future__ import annotations

from pathlib import Path

import pytest
from launch_samples import environment, make_package, needs_roslaunch
from lint_samples import setting
from ros2_bags import Ros2Bag
from test_ros2_values import event

from pytpc.api.building import analyse
from pytpc.api.lint_facts import Robot, _classes_in, _why_unknown_plugin, settings_of
from pytpc.api.lint_mission import recorded
from pytpc.base.paths import project_root
from pytpc.ingest.parameter_events import TOPIC, TYPE
from pytpc.lint.check import check
from pytpc.lint.facts import Facts
from pytpc.lint.finding import Finding
from pytpc.processes.plugins import Plugin
from pytpc.processes.process import NONE, Choice, Process
from pytpc.python_analysis.rules_file import load_rules
from pytpc.static.static_info import StaticInfo
from pytpc.values.ros2_arguments import origins_in_params
from pytpc.values.trace import LaunchNode, Trace, trace_launch

EXAMPLE = project_root() / "examples/recorded_mission"
RCLPY = """\
#!/usr/bin/env python3
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64

class Guard(Node):
    def __init__(self):
        super().__init__('guard')
        self.declare_parameter('limits.max', 1.5)
        self.declare_parameter('limits.min', 0.5)
        self.declare_parameter('beams', 4)
        self.declare_parameter('port', Parameter.Type.STRING)
        self.out = self.create_publisher(Float64, 'out', 1)
        if self.get_parameter('limits.max').value > 1.0:
            self.out.publish(Float64())

rclpy.init()
rclpy.spin(Guard())
"""
ROSPY = """\
#!/usr/bin/env python3
import rospy
from std_msgs.msg import Float64

rospy.init_node('guard')
out = rospy.Publisher('out', Float64, queue_size=1)
if rospy.get_param('~beams', 4) > rospy.get_param('~rate', 5):
    out.publish(1.0)
"""
PARAMS = """\
guard:
  ros__parameters:
    limits:
      max: 1
      mni: 0.5
      min: 2.5
    beams: 4
"""


def robot_at(folder: Path) -> Robot:
    """The package ``robot`` in this folder, with one node."""
    folder.mkdir()
    (folder / "package.xml").write_text("<package><name>robot</name></package>")
    (folder / "guard.py").write_text(RCLPY)
    (folder / "guard.py").chmod(0o755)
    return Robot(analyse([folder], load_rules()), NONE, ())


def findings(facts: Facts) -> list[Finding]:
    return list(check(facts).findings)


def test_a_node_of_ros2(tmp_path: Path):
    params = tmp_path / "params.yaml"
    params.write_text(PARAMS)
    nodes = [LaunchNode("/guard", "robot", "guard.py", tmp_path / "x.launch.py", 3, 0)]
    trace = Trace(None, {}, {}, nodes, {}, placed=origins_in_params(params))
    found = findings(robot_at(tmp_path / "robot").facts(trace))
    assert [(one.spot.lineno, one.kind, one.severity, one.text) for one in found] == [
        (4, "type", "error",
         "/guard/limits.max is 1, an int, and the node refuses all but a double"),
        (5, "unread", "warning",
         "/guard does not read /guard/limits.mni"),
        (6, "limits", "warning", "/guard/limits.min is 2.5, above max, which is 1"),
        (13, "unset", "error", "nothing sets /guard/port, and /guard fails without it"),
    ]  # fmt: skip


# A section for all nodes and one for this node may both have it on purpose; one map may not.
def test_a_key_that_a_params_file_has_twice(tmp_path: Path):
    params = tmp_path / "params.yaml"
    params.write_text(
        "/**:\n  ros__parameters:\n    rate: 1.0\nguard:\n  ros__parameters:\n"
        "    rate: 2.0\n    size: 3\n    size: 4\n"
    )
    trace = Trace(None, {}, {}, [], {}, placed=origins_in_params(params, "/guard/x"))
    found = {one.name: one.earlier for one in settings_of(trace)}
    assert [(one.spot.lineno, one.is_same_map) for one in found["/guard/size"]] == [(7, True)]
    assert not any(one.is_same_map for one in found["/guard/rate"])


@needs_roslaunch
def test_the_values_of_a_launch_file(tmp_path: Path):
    launch = make_package(tmp_path)
    trace = trace_launch(environment(tmp_path), launch, {})
    found = {one.name: one for one in settings_of(trace)}
    again = found["/again"]
    assert (again.value, again.spot.lineno) == (2, 28)
    assert [(one.value, one.spot.lineno) for one in again.earlier] == [(1, 27)]
    limit = found["/mission/limit"]
    assert (limit.value, limit.spot) == (0.058, (str(tmp_path / "robot/config/extra.yaml"), 2))
    [earlier] = limit.earlier
    assert (earlier.value, earlier.spot.lineno, earlier.is_same_map) == (0.035, 3, False)
    # The program sets this one itself when it starts, behind the <param>.
    assert found["/leg/step"].value == 0.5
    assert found["/left/arm/joints/elbow"].value == 1.0


# roslaunch itself keeps only the last one of a node.
@needs_roslaunch
def test_a_param_that_one_node_has_twice(tmp_path: Path):
    launch = make_package(tmp_path)
    launch.write_text(
        '<launch>\n<param name="rate" value="1"/>\n<param name="rate" value="2"/>\n'
        '<node pkg="robot" type="a" name="a">\n<param name="limit" value="3"/>\n'
        '<param name="limit" value="4"/>\n</node>\n</launch>\n'
    )
    found = {one.name: one for one in settings_of(trace_launch(environment(tmp_path), launch, {}))}
    for name, value, earlier, lineno in (("/rate", 2, 1, 2), ("/a/limit", 4, 3, 5)):
        assert found[name].value == value
        assert [(one.value, one.spot.lineno) for one in found[name].earlier] == [(earlier, lineno)]


@needs_roslaunch
def test_a_key_that_one_map_has_twice(tmp_path: Path):
    launch = make_package(tmp_path)
    (tmp_path / "robot/config/extra.yaml").write_text("mission:\n  limit: 1\n  limit: 2\n")
    trace = trace_launch(environment(tmp_path), launch, {})
    [one] = [one for one in settings_of(trace) if one.name == "/mission/limit"]
    twins = [earlier for earlier in one.earlier if earlier.is_same_map]
    assert [earlier.spot.lineno for earlier in twins] == [2]


def test_a_node_that_was_not_analysed(tmp_path: Path):
    robot = robot_at(tmp_path / "robot")
    other = LaunchNode("/amcl", "amcl", "amcl", tmp_path, 1, 0)
    assert robot.node(other, [other], frozenset()).unjudged == "amcl/amcl was not analysed"
    nodelet = LaunchNode("/n", "nodelet", "nodelet", tmp_path, 1, 0, args="load a/B manager")
    assert robot.node(nodelet, [nodelet], frozenset()).unjudged == (
        "/manager, which loads a node, is not started"
    )


# `<remap from="~beams" to="/all/beams"/>`: rospy and roscpp read a parameter under its new name.
# ROS 2 does not rename parameters.
def test_a_name_that_is_remapped(tmp_path: Path):
    remaps = (("~beams", "/all/beams"),)
    folder = tmp_path / "robot"
    robot = robot_at(folder)
    node = LaunchNode("/guard", "robot", "guard.py", tmp_path, 1, 0, remaps=remaps)
    names = {read.name for read in robot.node(node, [node], frozenset()).reads}
    assert "/guard/beams" in names
    (folder / "guard.py").write_text(ROSPY)
    robot = Robot(analyse([folder], load_rules()), NONE, ())
    names = {read.name for read in robot.node(node, [node], frozenset()).reads}
    assert names == {"/all/beams", "/guard/rate"}


# A module of the system, as diagnostic_updater, may read the parameters of the node, too.
def test_a_module_of_the_system(tmp_path: Path):
    modules = tmp_path / "modules"
    modules.mkdir()
    (modules / "updater.py").write_text("import rospy\nrospy.get_param('~diagnostic_period', 1)\n")
    (modules / "other.py").write_text("'~strange'\n")
    folder = tmp_path / "robot"
    robot_at(folder)
    script = ROSPY.replace("import rospy\n", "import rospy\nimport updater, other\n")
    (folder / "guard.py").write_text(script)
    robot = Robot(analyse([folder], load_rules()), NONE, (), {"PYTHONPATH": str(modules)})
    node = LaunchNode("/guard", "robot", "guard.py", tmp_path, 1, 0)
    found = robot.node(node, [node], frozenset({"diagnostic_period", "strange"}))
    assert {"diagnostic_period", "strange"} & found.texts == {"diagnostic_period"}


# A planner of another workspace: nobody knows what it reads.
def test_a_plugin_whose_code_was_not_seen(tmp_path: Path):
    plugin = Plugin("base/Planner", "base::Planner", "B", "base", tmp_path, tmp_path, 1)
    found = Process("robot/move", "robot/move", None, (), (Choice("B", (plugin,), "launch"),))
    names = frozenset({"base/Planner"})
    assert _why_unknown_plugin("robot/move", [found], names) == ""
    assert _why_unknown_plugin("robot/move", [found], names | {"teb/Planner"}) == (
        "robot/move may load teb/Planner, which was not analysed with it"
    )


def test_values_that_name_plugins():
    values = {
        "/move/planner": "teb_planner/TebPlanner",
        "/move/costmap/plugins": [{"name": "static", "type": "costmap_2d::StaticLayer"}],
        "/move/topic": "front/scan",
        "/move/kind": "sensor_msgs/Image",
        "/other/planner": "other/Planner",
    }
    settings = [setting(name, value) for name, value in values.items()]
    assert _classes_in(settings, "/move") == {"teb_planner/TebPlanner", "costmap_2d::StaticLayer"}


# By the columns of events.parquet: of `faces.size() >= max_faces_` all 646 were false, with at most
# one face of six, and the first and the last are 77.08 s apart. `max_aspect_ratio` was false 110
# times, and true 489 times.
def test_a_recording():
    static = StaticInfo.load(EXAMPLE / "static.json")
    found = recorded([EXAMPLE], static)
    assert found.changes == ()
    by_name = {one.parameter: one for one in found.crossings}
    assert len(by_name) == len(found.crossings)
    faces = by_name["/face_detector/max_faces"]
    assert (faces.evaluations, faces.result, faces.threshold, faces.nearest) == (646, False, 6, 5)
    assert faces.seconds == pytest.approx(77.08)
    assert "/face_detector/max_aspect_ratio" not in by_name


@pytest.mark.parametrize("times", [1, 2])
def test_recordings_are_added_up(times: int):
    static = StaticInfo.load(EXAMPLE / "static.json")
    found = recorded([EXAMPLE] * times, static)
    once = recorded([EXAMPLE], static)
    assert [one.evaluations for one in found.crossings] == [
        times * one.evaluations for one in once.crossings
    ]


SPEEDS = """\
#!/usr/bin/env python3
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

class Mission(Node):
    def __init__(self):
        super().__init__('mission')
        self.once = self.declare_parameter('limits.speed', 5.0).value
        self.declare_parameter('limits.rate', 5.0)
        self.out = self.create_publisher(Float64, 'out', 1)
        self.create_subscription(Float64, 'in', self.on_in, 1)

    def on_in(self, message):
        if message.data > self.once and message.data > self.get_parameter('limits.rate').value:
            self.out.publish(message)

rclpy.init()
rclpy.spin(Mission())
"""


# The node takes the speed when it starts, and the rate with each message.
def test_a_recorded_change_without_effect(tmp_path: Path):
    folder = tmp_path / "robot"
    robot_at(folder)
    (folder / "guard.py").write_text(SPEEDS)
    robot = Robot(analyse([folder], load_rules()), NONE, ())
    with Ros2Bag(tmp_path / "bag", "mcap") as bag:
        bag.log(1, "mission", "here")
        for seconds, value in ((2, 5.0), (7, 6.5)):
            values = {"limits.speed": value, "limits.rate": value}
            bag._write(TOPIC, TYPE, seconds, event(seconds, {}, values, []))
    seen = recorded([tmp_path / "bag"], robot.static)
    changed = {one.name: (one.old, one.new) for one in seen.changes}
    assert changed == {f"/robot1/guard/limits.{one}": (5.0, 6.5) for one in ("speed", "rate")}
    node = LaunchNode("/robot1/guard", "robot", "guard.py", tmp_path, 1, 0)
    facts = Facts((), [robot.node(node, [node], frozenset())], changes=seen.changes)
    [found] = [one for one in findings(facts) if one.kind == "no-effect"]
    assert (found.parameter, found.spot.lineno) == ("/robot1/guard/limits.speed", 9)
