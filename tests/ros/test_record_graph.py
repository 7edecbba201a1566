"""``pytpc record`` on a graph that runs: rosout, batches, marks of observers that come later."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from pytpc.base.errors import MissingToolError
from pytpc.base.signals import Stop
from pytpc.recording.mission import Dropped, load_recording
from pytpc.ros.mission_run import Progress, RecordOptions
from pytpc.ros.ros1.graph import RosGraph
from pytpc.ros.ros1.mission_watch import MissionWatch
from pytpc.values.trace import Trace

ROOT = Path(__file__).parents[2]
KEY = "0a1b2c3d-0000-5000-8000-00000000000f"

# 200 reports on /rosout; 3 messages of 2 reports on the topic, of which the second is not sent (4
# and 5 come after 0 and 1); marks of an observer that comes after 2 s.
NODE = f"""
import rospy
from std_msgs.msg import String, Time
rospy.init_node("talker")
topic = rospy.Publisher("/threshold_information", String, queue_size=100)
def waits(publisher):
    while publisher.get_num_connections() == 0:
        rospy.sleep(0.05)
waits(topic)
rospy.sleep(1)
for number in range(200):
    result = number % 2
    text = "threshold_information:{KEY},%d,cmp:%d,thresh:5,res:%d"
    rospy.loginfo(text, result, number, result)
    rospy.sleep(0.002)
for begin in (0, 4):
    lines = ["#seq:%d,count:2,dropped:%d,pid:7,steady:1.5" % (begin, begin)]
    for number in (begin, begin + 1):
        now = rospy.get_time()
        lines.append("%.7f,{KEY.replace("f", "e")},1,cmp:%d,thresh:5,res:1" % (now, number))
    topic.publish("\\n".join(lines))
rospy.sleep(1)
mark = rospy.Publisher("/marks7/mark_action", Time, queue_size=10)
waits(mark)
mark.publish(rospy.Time.now())
rospy.sleep(0.5)
print("done", flush=True)
"""


def test_parameters_are_awaited_though_the_master_hangs(tmp_path: Path) -> None:
    begun = Trace(Path("x.launch"), {}, {"/set": [{"from": "launch"}]}, [], {})
    with RosGraph({"PATH": "/usr/bin:/bin"}, tmp_path / "ros") as graph:
        graph.call("setParam", "/set", 1)
        master = int(str(graph.call("getPid")))
        os.kill(master, signal.SIGSTOP)
        looks = []

        def look(progress: Progress) -> None:
            looks.append(progress)
            # The first question went unanswered.
            if len(looks) == 2:
                os.kill(master, signal.SIGCONT)

        launched = graph.start("launch", ["sleep", "600"])
        options = RecordOptions(tmp_path, on_progress=look)
        watch = MissionWatch(graph, launched, options, Stop(), time.monotonic())
        watch.wait_for_parameters(begun)
        assert len(looks) >= 2
        assert graph.call("getParamNames") == ["/set"]


def test_a_running_graph(tmp_path: Path) -> None:
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(tmp_path)}
    try:
        graph = RosGraph(environment, tmp_path / "ros").__enter__()
    except MissingToolError:
        pytest.skip("ROS is not installed")
    try:
        out = tmp_path / "out"
        recording = subprocess.Popen(
            [sys.executable, "-m", "pytpc", "record", "-o", str(out), "--parquet"],
            env={**os.environ, **graph.env, "PYTHONPATH": str(ROOT)},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        deadline = time.monotonic() + 20
        while not (out / "mission.bag.active").exists():
            assert time.monotonic() < deadline, "the recorder does not begin"
            assert recording.poll() is None, recording.communicate()
            time.sleep(0.1)
        node = subprocess.run(
            ["/usr/bin/python3", "-c", NODE],
            env=graph.env,
            capture_output=True,
            text=True,
            timeout=40,
            check=False,
        )
        assert "done" in node.stdout, node.stderr
        recording.send_signal(signal.SIGINT)
        said, complaints = recording.communicate(timeout=30)
    finally:
        graph.__exit__(None, None, None)
    assert recording.returncode == 0, complaints
    assert said.startswith("204 reports and 1 mark in ")
    assert "(interrupted)" in said
    assert "warning: 2 log messages lost by the recorder" in complaints
    assert "/marks7/mark_action" in (out / "run.json").read_text()
    assert (out / "params.yaml").is_file()
    mission = load_recording(out)
    assert len(mission.events) == 204
    assert [(mark.type, mark.observer) for mark in mission.marks] == [("I", "marks7")]
    assert mission.lost == {"/talker": 2}
    assert mission.dropped == (Dropped("", "/talker", 4, 0, "unknown"),)
    assert not (out / "mission.bag.active").exists()


def test_no_master(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "pytpc", "record", "-o", str(tmp_path / "out")],
        env={**os.environ, "PYTHONPATH": str(ROOT), "ROS_MASTER_URI": "http://127.0.0.1:9"},
        capture_output=True,
        text=True,
        timeout=30,
        check=False,
    )
    assert done.returncode == 1
    assert "pytpc: error: the ROS master at http://127.0.0.1:9" in done.stderr
    assert "pytpc record WORKSPACE LAUNCH" in done.stderr
    assert "recording http" not in done.stderr
    assert "Traceback" not in done.stderr
