"""A node of rclpy, analysed and run with reports on a graph of its own."""

from __future__ import annotations

from pathlib import Path

from click.testing import CliRunner

from pytpc.cli.main import main
from pytpc.ingest.reading import read
from pytpc.ros.node_start import RUN
from ros2_graph import run_python

# Line 11 compares 0 to 9 with the parameter's 6.5: true for 7, 8 and 9.
NODE = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

rclpy.init()
node = Node("guard", namespace="/robot1")
limit = node.declare_parameter("speed_limit", 6.5).value
publisher = node.create_publisher(Float64, "stop", 10)
for step in range(10):
    speed = float(step)
    if speed > limit:
        publisher.publish(Float64(data=speed))
node.destroy_node()
rclpy.shutdown()
"""


def test_a_node_writes_its_reports_to_a_file(domain: dict[str, str], tmp_path: Path) -> None:
    node, static = tmp_path / "guard.py", tmp_path / "static.json"
    node.write_text(NODE)
    assert CliRunner().invoke(main, ["analyse", str(node), "-o", str(static)]).exit_code == 0
    reports = {"TPC_SINK": "file", "TPC_FOLDER": str(tmp_path / "reports")}
    ran = run_python(RUN, domain, "--static", str(static), str(node), **reports)
    assert (ran.returncode, ran.stderr) == (0, "")
    events = read(tmp_path / "reports").events
    assert events.cmp.tolist() == [float(step) for step in range(10)]
    assert set(events.thresh.tolist()) == {6.5}
    assert events.result.tolist() == [False] * 7 + [True] * 3
