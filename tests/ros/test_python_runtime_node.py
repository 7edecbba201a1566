"""A real rospy node on a real roscore, run with reports: what it makes is received or read."""

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

from pytpc.cli.main import main
from pytpc.ingest.reading import read
from pytpc.ros.ros1.graph import RosGraph

PYTHON = "/usr/bin/python3"
RUN = str(Path(__file__).parents[2] / "pytpc/python_runtime/run.py")
KEY = "00000001-0000-5000-8000-000000000001"
COUNT = 140
# Numbers 0 to 6 in turn, and 140 of them: 3 of each 7 are above 3.
ABOVE = 60
LINE = "        if x > self.limit:"
NODE = f"""\
import rospy
from std_msgs.msg import Float64

class Mission:
    def __init__(self):
        rospy.init_node("mission")
        self.limit = rospy.get_param("~limit", 3.0)
        self.out = rospy.Publisher("out", Float64, queue_size=10)
        self.number = 0
        rospy.sleep(rospy.get_param("~wait", 0.0))
        rospy.Timer(rospy.Duration(0.01), self.step)

    def step(self, _):
        if self.number == {COUNT}:
            rospy.signal_shutdown("done")
            return
        x = float(self.number % 7)
        self.number += 1
{LINE}
            self.out.publish(x)

Mission()
rospy.spin()
"""

probe = subprocess.run([PYTHON, "-c", "import rospy"], check=False, capture_output=True, timeout=60)
if probe.returncode:
    pytest.skip("rospy is not installed", allow_module_level=True)


@pytest.fixture
def graph(tmp_path) -> Iterator[RosGraph]:
    with RosGraph(dict(os.environ), tmp_path / "graph") as graph:
        yield graph


@pytest.fixture
def node(tmp_path) -> Path:
    return analysed(tmp_path, NODE, LINE)


def analysed(tmp_path: Path, text: str, line: str) -> Path:
    """A node of this text, whose comparison of x in this line is in the static information."""
    path = tmp_path / "mission.py"
    path.write_text(text)
    comparison = {
        "key": KEY,
        "relation": ">",
        "file": path.name,
        "lineno": text.splitlines().index(line) + 1,
        "column": line.index("x") + 1,
        "name": None,
        "operand": "right",
        "source_code": line.strip(),
    }
    unit = {"link_unit": "mission", "source_root": str(tmp_path), "comparisons": [comparison]}
    (tmp_path / "static.json").write_text(json.dumps({"schema": 1, "units": [unit]}))
    return path


HIGH = """\
import rospy
from rosgraph_msgs.msg import Clock
def high(x):
    return x > 2
"""
HIGH_LINE = "    return x > 2"


def start(graph: RosGraph, node: Path, *words: str, **env: str) -> subprocess.Popen[str]:
    ours = {
        "ROS_MASTER_URI": graph.uri,
        "ROS_IP": "127.0.0.1",
        "ROS_HOME": str(node.parent / "ros"),
        "TPC_STATIC": str(node.parent / "static.json"),
        "TPC_FOLDER": str(node.parent / "tpc"),
        "TPC_FILE_RESERVE": "0",
    }
    return subprocess.Popen(
        [PYTHON, RUN, str(node), *words],
        env={**os.environ, **ours, **env},
        stderr=subprocess.PIPE,
        text=True,
    )


def ended(process: subprocess.Popen[str]) -> str:
    """What it said on standard error; it must end by itself and well."""
    _, said = process.communicate(timeout=40)
    assert process.returncode == 0, said
    return said


def check(values: list[float], results: list[bool]) -> None:
    assert values == [float(number % 7) for number in range(COUNT)]
    assert sum(results) == ABOVE


def test_the_file(graph, node):
    assert ended(start(graph, node, TPC_SINK="file")) == ""
    found = read(sorted((node.parent / "tpc").glob("*.tpc")))
    check(found.events.cmp.tolist(), found.events.result.tolist())
    assert set(found.events.thresh.tolist()) == {3.0}
    assert found.events.nodes == ("/mission",)
    assert (found.malformed, found.notes) == (0, ())


def has_reports(folder: Path) -> bool:
    files = sorted(folder.glob("*.tpc"))
    return files != [] and len(read(files).events.cmp) > 0


def test_the_file_of_a_node_that_is_killed(graph, node):
    process = start(graph, node, TPC_SINK="file")
    deadline = time.monotonic() + 30
    while not has_reports(node.parent / "tpc"):
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    process.communicate(timeout=20)
    found = read(sorted((node.parent / "tpc").glob("*.tpc")))
    values = found.events.cmp.tolist()
    assert values
    assert values == [float(number % 7) for number in range(len(values))]


def test_rosout_and_topic(graph, node, tmp_path):
    """A recorder hears what the two sinks send."""
    for sink in ("rosout", "topic"):
        out = tmp_path / sink
        recorder = subprocess.Popen(
            [sys.executable, "-m", "pytpc", "record", "-o", str(out), "--timeout", "60"],
            env={**os.environ, "ROS_MASTER_URI": graph.uri, "ROS_IP": "127.0.0.1"},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            time.sleep(2.0)
            said = ended(start(graph, node, "_wait:=1.5", TPC_SINK=sink))
        finally:
            recorder.send_signal(signal.SIGINT)
            recorder.wait(30)
        assert said == ""
        found = read([out / "mission.bag"])
        check(found.events.cmp.tolist(), found.events.result.tolist())
        assert found.events.keys == (KEY,)
        assert found.malformed == 0
        assert sum(found.lost.values()) == 0


def test_settings_are_changed_while_it_runs(graph, node, monkeypatch):
    monkeypatch.setenv("ROS_MASTER_URI", graph.uri)
    process = start(graph, node, TPC_SINK="off")
    deadline = time.monotonic() + 20
    said = []
    while not said and time.monotonic() < deadline:
        time.sleep(0.2)
        done = CliRunner().invoke(main, ["sink", "--sink", "file", "--json"])
        if done.exit_code == 0:
            said = json.loads(done.output)
    assert [(status["node"], status["success"]) for status in said] == [("/mission", True)]
    assert said[0]["values"]["sink"] == "file"
    ended(process)
    found = read(sorted((node.parent / "tpc").glob("*.tpc")))
    # Its first evaluations went nowhere.
    assert 0 < len(found.events.cmp) < COUNT


def test_a_parameter_of_the_node_counts_more_than_the_environment(graph, node):
    assert ended(start(graph, node, "_wait:=1.0", "_tpc/sink:=file", TPC_SINK="off")) == ""
    found = read(sorted((node.parent / "tpc").glob("*.tpc")))
    assert 0 < len(found.events.cmp) < COUNT


def test_simulated_time(tmp_path, node):
    with RosGraph(dict(os.environ), tmp_path / "simulated", use_sim_time=True) as graph:
        clock = subprocess.Popen(
            [
                PYTHON,
                "-c",
                "import rospy, time\n"
                "from rosgraph_msgs.msg import Clock\n"
                "rospy.init_node('clock', disable_signals=True)\n"
                "pub = rospy.Publisher('/clock', Clock, queue_size=1)\n"
                "for n in range(1, 6000):\n"
                "    pub.publish(Clock(rospy.Time(1000, 0) + rospy.Duration(n * 0.01)))\n"
                "    time.sleep(0.005)\n",
            ],
            env={**os.environ, "ROS_MASTER_URI": graph.uri, "ROS_IP": "127.0.0.1"},
        )
        try:
            ended(start(graph, node, TPC_SINK="file"))
        finally:
            clock.kill()
            clock.wait()
    found = read(sorted((node.parent / "tpc").glob("*.tpc")))
    check(found.events.cmp.tolist(), found.events.result.tolist())
    seconds = found.events.time_ns / 1e9
    # The simulated clock begins at 1000 s and goes on for a minute; a step is 10 ms of it.
    assert seconds.min() >= 1000.0
    assert seconds.max() <= 1060.0
    assert seconds.max() - seconds.min() >= 1.0


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("high(1)\nhigh(3)\n", "mission.py ({})"),
        ("high(1)\nrospy.init_node('late')\nrospy.sleep(1.5)\nhigh(3)\n", "/late"),
    ],
)
def test_a_node_that_begins_late_or_never(graph, tmp_path, text, name):
    process = start(graph, analysed(tmp_path, HIGH + text, HIGH_LINE), TPC_SINK="file")
    assert ended(process) == ""
    found = read(sorted((tmp_path / "tpc").glob("*.tpc")))
    assert found.events.cmp.tolist() == [1.0, 3.0]
    assert found.events.result.tolist() == [False, True]
    # Without a node it is the program that is named.
    assert found.events.nodes == (name.format(process.pid),)


def test_the_first_of_two_nodes_of_one_name(graph, tmp_path):
    text = "rospy.init_node('twice')\nprint('up', flush=True)\nhigh(1)\nrospy.spin()\nhigh(3)\n"
    node = analysed(tmp_path, HIGH + text, HIGH_LINE)
    first = start(graph, node, TPC_SINK="file", TPC_FOLDER=str(tmp_path / "first"))
    time.sleep(3.0)
    second = start(graph, node, TPC_SINK="file", TPC_FOLDER=str(tmp_path / "second"))
    # The master has the first one shut down, which goes on behind `spin`.
    said = ended(first)
    assert "Traceback" not in said
    assert "pytpc" not in said
    assert second.poll() is None
    second.send_signal(signal.SIGINT)
    ended(second)
    for folder in ("first", "second"):
        found = read(sorted((tmp_path / folder).glob("*.tpc")))
        assert found.events.cmp.tolist() == [1.0, 3.0]
        assert found.events.nodes == ("/twice",)


def test_simulated_time_that_goes_backwards(tmp_path):
    text = """\
rospy.init_node("back")
clock = rospy.Publisher("/clock", Clock, queue_size=1)
for number, second in enumerate((1000, 1010, 500, 505)):
    while rospy.get_rostime().secs != second:
        clock.publish(Clock(rospy.Time(second)))
        rospy.rostime.wallsleep(0.01)
    high(number)
"""
    node = analysed(tmp_path, HIGH + text, HIGH_LINE)
    with RosGraph(dict(os.environ), tmp_path / "simulated", use_sim_time=True) as graph:
        ended(start(graph, node, TPC_SINK="file"))
    found = read(sorted((tmp_path / "tpc").glob("*.tpc")))
    seconds = (found.events.time_ns // 10**9).tolist()
    pairs = sorted(zip(found.events.cmp.tolist(), seconds, strict=True))
    assert pairs == [(0.0, 1000), (1.0, 1010), (2.0, 500), (3.0, 505)]
    assert (found.malformed, found.notes) == (0, ())
