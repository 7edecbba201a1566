"""``pytpc keep`` on a real graph: the last minutes of nodes that are killed, marked and ranked."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from patience import PATIENCE_S, wait_for
from pytpc.cli.main import main
from pytpc.ingest.reading import read
from pytpc.ingest.ring_files import rings_in
from pytpc.recording.parameter_values import ParameterValues
from pytpc.ros.ros1.graph import RosGraph

ROOT = Path(__file__).parents[2]
PYTHON = "/usr/bin/python3"
RUN = str(ROOT / "pytpc/python_runtime/run.py")
# 100 a second: x is 0 until the file `go` is there, and 5 from then on: above ~limit (3), below
# ~other (90).
NODE = """\
import os
import rospy
from std_msgs.msg import Float64

rospy.init_node("mission")
limit = rospy.get_param("~limit", 3.0)
other = rospy.get_param("~other", 90.0)
rospy.set_param("~limit", limit)
out = rospy.Publisher("out", Float64, queue_size=10)
away = rospy.Publisher("away", Float64, queue_size=10)
rate = rospy.Rate(100)
print("ready", flush=True)
while not rospy.is_shutdown():
    x = 5.0 if os.path.exists("go") else 0.0
    if x > limit:
        out.publish(x)
    if x > other:
        away.publish(x)
    rate.sleep()
"""
MARK = """\
import rospy, time
from std_msgs.msg import Time
rospy.init_node("observer")
mark = rospy.Publisher("/ana/mark_action", Time, queue_size=10)
while not mark.get_num_connections():
    time.sleep(0.05)
mark.publish(rospy.Time.now())
time.sleep(0.5)
"""

# COUNT marks, PAUSE seconds apart, told once, and only to who listens then.
MARKS = """\
import rospy, sys, time
from std_msgs.msg import Time
rospy.init_node("observer", anonymous=True)
mark = rospy.Publisher("/ana/mark_action", Time, queue_size=1000)
while not mark.get_num_connections():
    time.sleep(0.05)
for number in range(int(sys.argv[1])):
    mark.publish(rospy.Time(1000 + number))
    time.sleep(float(sys.argv[2]))
time.sleep(0.5)
"""

# 120,000 reports of 32 bytes, in a ring: 3.7 MiB.
MUCH = """\
from pytpc.python_runtime.find import ListedPlace
from pytpc.python_runtime.listed import Listed
from pytpc.python_runtime.runtime import RUNTIME
from pytpc.python_runtime.sites import ComparisonSite
listed = Listed("much", ">", 1, 1, None, None, None, "right", None)
site = ComparisonSite("Gt", (RUNTIME.register(ListedPlace(listed, False)),))
for number in range(120_000):
    next(site.compare(float(number), 2.0))
"""

probe = subprocess.run([PYTHON, "-c", "import rospy"], check=False, capture_output=True, timeout=60)
if probe.returncode:
    pytest.skip("rospy is not installed", allow_module_level=True)


class Robot:
    """A node with a ring of 12 s and the default sink, and its static information."""

    def __init__(self, graph: RosGraph, folder: Path) -> None:
        self.graph, self.folder = graph, folder
        (folder / "mission.py").write_text(NODE)
        done = CliRunner().invoke(
            main, ["analyse", str(folder / "mission.py"), "-o", str(folder / "static.json")]
        )
        assert done.exit_code == 0, done.output
        self.tpc = folder / "tpc"
        self.env = {
            **os.environ,
            "PYTHONPATH": str(ROOT),
            "HOME": str(folder),
            "ROS_MASTER_URI": graph.uri,
            "ROS_IP": "127.0.0.1",
            "ROS_HOME": str(folder / "ros"),
            "TPC_STATIC": str(folder / "static.json"),
            "TPC_FOLDER": str(self.tpc),
            "TPC_FILE_RESERVE": "0",
            "TPC_RING": "0.2",
        }
        self.node = subprocess.Popen(
            [PYTHON, RUN, str(folder / "mission.py")],
            env=self.env,
            cwd=folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert self.node.stdout is not None
        assert self.node.stdout.readline() == "ready\n"

    def pytpc(self, *words: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [sys.executable, "-m", "pytpc", *words],
            env=self.env,
            cwd=self.folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def told(self, *words: str) -> str:
        process = self.pytpc(*words)
        out, said = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == 0, said
        return out

    def marks(self, count: int, pause_s: float) -> None:
        words = [PYTHON, "-c", MARKS, str(count), str(pause_s)]
        subprocess.run(words, env=self.env, check=True, timeout=PATIENCE_S)

    def mark(self) -> None:
        subprocess.run([PYTHON, "-c", MARK], env=self.env, check=True, timeout=PATIENCE_S)


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[Robot]:
    with RosGraph(dict(os.environ), tmp_path / "graph") as graph:
        robot = Robot(graph, tmp_path)
        try:
            wait_for(lambda: len(rings_in(robot.tpc).segments) > 2)
            yield robot
        finally:
            robot.node.kill()
            robot.node.communicate()


def test_now(robot: Robot) -> None:
    """The recording has the values of the graph, and reads like any other."""
    found = json.loads(robot.told("keep", "-o", "kept", "--json"))
    assert (found["processes"], found["marks"], found["missing"]) == (1, 0, [])
    folder = robot.folder / "kept"
    run = json.loads((folder / "run.json").read_text())
    assert (run["ended"], run["files"]) == ("kept", found["files"])
    for name in ("params.yaml", "params_start.yaml", "graph.json", "origins.json", "static.json"):
        assert (folder / name).is_file(), name
    recording = read(folder)
    assert recording.events.nodes == ("/mission",)
    assert recording.malformed == 0
    # Nothing came over /rosout, or it would be there twice.
    assert found["reports"] == len(recording.events)
    assert found["summaries"] == len(recording.summaries)
    assert ParameterValues(recording.values) is not None
    assert "limit: 3.0" in (folder / "params.yaml").read_text()


def test_after_a_mark(robot: Robot) -> None:
    """The node turns, is killed, and then somebody marks it: `rank` names the parameter."""
    keeping = robot.pytpc("keep", "--on-marks", "--after", "1", "-o", "kept", "--json")
    try:
        wait_for(lambda: list(robot.folder.glob("kept/.keep-*/mission.bag.active")))
        (robot.folder / "go").touch()
        wait_for(_has_turned(robot))
        robot.node.send_signal(signal.SIGKILL)
        robot.node.wait()
        robot.mark()
        wait_for(lambda: list(robot.folder.glob("kept/keep-*")))
        keeping.send_signal(signal.SIGINT)
        out, said = keeping.communicate(timeout=PATIENCE_S)
    finally:
        keeping.kill()
    assert keeping.returncode == 0, said
    found = json.loads(out)
    assert found["marks"] == 1
    (folder,) = robot.folder.glob("kept/*")
    # What was not complete is gone.
    assert list(robot.folder.glob("kept/.keep-*")) == []
    recording = read(folder)
    assert [(mark.type, mark.observer) for mark in recording.marks] == [("I", "ana")]
    ranked = json.loads(robot.told("rank", str(folder), "--json"))
    assert ranked[0]["diagnosis"]["suspects"][0]["parameter"] == "~limit"


def test_marks_while_it_keeps(robot: Robot) -> None:
    """Thirty, over 12 s in which several recordings are made; SIGTERM keeps the last ones."""
    keeping = robot.pytpc("keep", "--on-marks", "--after", "0.3", "-o", "kept", "--json")
    try:
        wait_for(lambda: list(robot.folder.glob("kept/.keep-*/mission.bag.active")))
        robot.marks(30, 0.4)
        keeping.terminate()
        _, said = keeping.communicate(timeout=PATIENCE_S)
    finally:
        keeping.kill()
    assert (keeping.returncode, "error" in said) == (0, False), said
    folders = list(robot.folder.glob("kept/keep-*"))
    assert len(folders) > 1
    assert list(robot.folder.glob("kept/.keep-*")) == []
    found = {mark.time_ns // 10**9 for folder in folders for mark in read(folder).marks}
    assert found == set(range(1000, 1030))


def test_no_more_than_most(robot: Robot) -> None:
    """Three marks at once make one recording; a later one is told, and not kept."""
    words = ["keep", "--on-marks", "--after", "3", "--most", "1", "-o", "kept", "--json"]
    keeping = robot.pytpc(*words)
    try:
        wait_for(lambda: list(robot.folder.glob("kept/.keep-*/mission.bag.active")))
        robot.marks(3, 0)
        wait_for(lambda: list(robot.folder.glob("kept/keep-*")))
        robot.mark()
        keeping.send_signal(signal.SIGINT)
        out, said = keeping.communicate(timeout=PATIENCE_S)
    finally:
        keeping.kill()
    assert json.loads(out)["marks"] == 3
    assert "1 mark without a recording: there are 1 recording with" in said
    assert len(list(robot.folder.glob("kept/*"))) == 1


def test_no_more_than_most_mib(robot: Robot) -> None:
    """Each recording has 3.7 MiB and some more; two have 6 MiB: the third mark is told only."""
    env = {**robot.env, "TPC_SINK": "file"}
    subprocess.run([sys.executable, "-c", MUCH], env=env, check=True, timeout=PATIENCE_S)
    words = ["keep", "--on-marks", "--after", "0", "--most-mib", "6", "-o", "kept", "--json"]
    keeping = robot.pytpc(*words)
    try:
        for count in range(2):
            wait_for(lambda: list(robot.folder.glob("kept/.keep-*/mission.bag.active")))
            robot.mark()
            wait_for(lambda count=count: len(list(robot.folder.glob("kept/keep-*"))) > count)
        robot.mark()
        keeping.send_signal(signal.SIGINT)
        out, said = keeping.communicate(timeout=PATIENCE_S)
    finally:
        keeping.kill()
    assert out.count('"marks": 1,') == 2
    assert "1 mark without a recording: there are 2 recordings with" in said
    assert len(list(robot.folder.glob("kept/*"))) == 2


def test_with_the_bag_of_the_same_node(robot: Robot) -> None:
    """What the node told to both is counted once: no more than it evaluated, 100 a second."""
    recording = robot.pytpc("record", "-o", "bag")
    try:
        wait_for(lambda: list(robot.folder.glob("bag/mission.bag.active")))
        (robot.folder / "go").touch()
        wait_for(_has_turned(robot))
        robot.told("keep", "-o", "kept")
        recording.send_signal(signal.SIGINT)
        recording.communicate(timeout=PATIENCE_S)
    finally:
        recording.kill()
    bag, kept = (read(robot.folder / name).summaries for name in ("bag", "kept"))
    both = read([robot.folder / "bag", robot.folder / "kept"])
    # All of the bag but what came after the files were kept.
    later = int((bag.begin_ns >= kept.begin_ns.max() + 10**6).sum())
    earlier = int((kept.begin_ns < bag.begin_ns.min() - 10**6).sum())
    assert len(both.summaries) == len(kept) + later
    assert earlier + len(bag) - later <= len(kept)
    assert any("counted once" in note for note in both.notes)


def _has_turned(robot: Robot):
    """Whether the ring has the flop."""

    def has() -> bool:
        events = read([one.path for one in rings_in(robot.tpc).segments]).events
        return bool((events.cmp == 5.0).any())

    return has


def test_what_sink_says(robot: Robot) -> None:
    wait_for(lambda: "mission" in robot.told("sink", "--json"))
    (node,) = json.loads(robot.told("sink", "--json"))
    values = node["values"]
    assert (values["sink"], values["policy"], values["ring"]) == ("auto", "light", "0.2")
    assert values["ring_folder"] == str(robot.tpc)
    assert values["ring_mib"].endswith("/64")


def test_without_a_master(robot: Robot) -> None:
    """The files are kept all the same, and what is missing is said."""
    robot.env["ROS_MASTER_URI"] = "http://127.0.0.1:9"
    process = robot.pytpc("keep", "-o", "kept")
    out, said = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0
    assert "of 1 process in the last" in out
    assert "warning: no marks and no values of parameters: no graph answers" in said
    assert len(read(robot.folder / "kept").summaries) > 0
    marking = robot.pytpc("keep", "--on-marks", "-o", "more")
    _, said = marking.communicate(timeout=PATIENCE_S)
    assert marking.returncode == 1
    assert (
        "pytpc: error: no ROS master answers at http://127.0.0.1:9, and marks come from a graph"
        in said
    )


def test_killed_while_it_keeps(robot: Robot) -> None:
    """At no moment is there half a recording under its name; the next one clears up."""
    for delay_s in (0.3, 0.9, 1.5, 2.1, 2.7, 3.3):
        process = robot.pytpc("keep", "-o", f"kept/{delay_s}")
        time.sleep(delay_s)
        process.kill()
        process.communicate()
    for folder in robot.folder.glob("kept/[0-9]*"):
        assert json.loads((folder / "run.json").read_text())["ended"] == "kept"
        assert len(read(folder).summaries) > 0
    for left in robot.folder.glob("kept/.keep-*"):
        os.utime(left, (0, 0))
    robot.told("keep", "-o", "kept/last")
    assert list(robot.folder.glob("kept/.keep-*")) == []
