"""Two nodes that talk, on a real graph: the path of a message from recording to diagnosis."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner
from recorded_robot import make_package

from patience import PATIENCE_S
from pytpc.api.building import analyse
from pytpc.cli.main import main
from pytpc.python_analysis.rules_file import load_rules
from pytpc.recording.graph_file import read_graph, read_recorded_graph
from pytpc.static.sources import with_source_digests
from pytpc.static.wiring import GraphTopic

if shutil.which("roslaunch") is None:
    pytest.skip("ROS is not installed", allow_module_level=True)

# After 4 s the coverage is above the limit. The driver hears of that under another name, and
# drives. Neither knows what the launch file calls the topic.
CAMERA = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Bool, Float64

rospy.init_node("camera")
limit = rospy.get_param("~limit", 4.0)
full = rospy.Publisher("full", Float64, queue_size=10)
done = rospy.Publisher("/mission/done", Bool, queue_size=1, latch=True)
begun = rospy.get_time()
while not rospy.is_shutdown():
    coverage = rospy.get_time() - begun
    full.publish(1.0 if coverage > limit else 0.0)
    if coverage >= 8.0:
        done.publish(True)
    rospy.sleep(0.1)
"""
DRIVER = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Float64

class Driver:
    def __init__(self):
        rospy.init_node("driver")
        self.least = rospy.get_param("~least", 0.5)
        self.out = rospy.Publisher("cmd", Float64, queue_size=10)
        rospy.Subscriber("go", Float64, self.on_go)

    def on_go(self, message):
        if message.data > self.least:
            self.out.publish(message.data)

Driver()
rospy.spin()
"""
LAUNCH = """<launch>
  <group ns="left">
    <remap from="full" to="ready"/>
    <node pkg="talk" type="camera.py" name="camera"/>
    <node pkg="talk" type="driver.py" name="driver"><remap from="go" to="/left/ready"/></node>
  </group>
</launch>
"""
PATH = (
    "~limit (left/camera) -> /left/ready -> left/driver: scripts/driver.py:13 ~least -> /left/cmd"
)


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("talking")
    files = {
        "scripts/camera.py": CAMERA,
        "scripts/driver.py": DRIVER,
        "launch/talk.launch": LAUNCH,
    }
    make_package(folder / "src", "talk", files)
    install = folder / ".tpc/install"
    install.mkdir(parents=True)
    packages = f"export ROS_PACKAGE_PATH={folder / 'src'}:/usr/share\n"
    (install / "setup.bash").write_text(packages)
    static = analyse([folder / "src/talk"], load_rules("default", None))
    with_source_digests(static).save(folder / ".tpc/static.json")
    return folder


@pytest.fixture(scope="module")
def mission(workspace: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("mission") / "out"
    command = ["record", str(workspace), "talk", "talk.launch", "-o", str(out)]
    options = ["--until", "/mission/done", "--wall-time", "--timeout", str(PATIENCE_S)]
    done = CliRunner().invoke(main, [*command, *options])
    assert done.exit_code == 0, done.output
    return out


def invoke(*words: str | Path) -> str:
    done = CliRunner().invoke(main, [str(word) for word in words])
    assert done.exit_code == 0, done.output
    return done.output


def test_explain_knows_the_names_of_a_launch_file(workspace: Path) -> None:
    launch = workspace / "src/talk/launch/talk.launch"
    said = invoke("explain", workspace, "~limit", "--launch", launch)
    assert " ".join(said.split()).endswith(f"goes on to {PATH}")
    assert "goes on to" not in invoke("explain", workspace, "~limit")


def test_a_recording_knows_who_spoke_to_whom(workspace: Path, mission: Path) -> None:
    nodes = json.loads((mission / "origins.json").read_text())["nodes"]
    assert [node["remaps"] for node in nodes] == [
        [["full", "ready"]],
        [["full", "ready"], ["go", "/left/ready"]],
    ]
    ends = frozenset({"/left/camera"}), frozenset({"/left/driver"})
    assert read_graph(mission)["/left/ready"] == GraphTopic("std_msgs/Float64", *ends)
    services = read_recorded_graph(mission).services
    assert services["/left/camera/get_loggers"] == {"/left/camera"}
    said = invoke("explain", workspace, "~limit", "--mission", mission)
    assert " ".join(said.split()).endswith(f"goes on to {PATH}")


def test_the_diagnosis_names_the_path(workspace: Path, mission: Path) -> None:
    asked = ["rank", mission, "--static", workspace, "--at", "7", "--json"]
    answer = json.loads(invoke(*asked))
    suspects = answer[0]["diagnosis"]["suspects"]
    followed = {one["parameter"]: one["followed"] for one in suspects}

    assert [one["text"] for one in followed["~limit"]] == [PATH]
    assert 0 <= followed["~limit"][0]["after_s"] < 1.5
    assert followed["~least"] == []
    turned = f"turned at {followed['~limit'][0]['turned_s']:.1f} s, and"
    assert f"~limit {turned}" in " ".join(invoke(*asked[:-1]).split())

    marks, page = mission.parent / "marked.csv", mission.parent / "report.html"
    marks.write_text(f"time_ns,type,observer,note\n{answer[0]['time_ns']},I,,\n")
    invoke("report", mission, "--static", workspace, "--marks", marks, "-o", page)
    assert suspects[0]["parameter"] == "~limit"
    assert f"it {turned}" in page.read_text()
