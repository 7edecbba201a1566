"""How much later a Python node of ROS 2 is up with reports than without.

The node imports rclpy, makes a node with a parameter, compares, and prints a line in its first
timer; its start-up ends at that line. It runs plainly and with each sink, in turns, on a graph of
its own. The figure is the median of the differences within the rounds. The static information has
a thousand comparisons in a hundred files, as that of a workspace has; one is the node's.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path

from figures import figure
from loop_static import static_of

from pytpc_evaluation.demo.ros2_robot import own_domain

TOPIC = "python-start-ros2"
ROOT = Path(__file__).resolve().parents[1]
RUN = str(ROOT / "pytpc/python_runtime/run.py")
PYTHON = ROOT / ".venv-ros2/bin/python"
ROUNDS = 21
MOST_MS = 50.0
OTHERS = [(f"other_{file}.py", 10 * number + 1, 5) for file in range(100) for number in range(10)]
LINE = "    return speed > limit"
NODE = f"""\
import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool

def is_fast(speed, limit):
{LINE}

rclpy.init()
node = Node("starter")
limit = node.declare_parameter("limit", 1.5).value
publisher = node.create_publisher(Bool, "fast", 1)

def tick():
    publisher.publish(Bool(data=is_fast(2.0, limit)))
    print("up", flush=True)

node.create_timer(0.001, tick)
rclpy.spin(node)
"""
# "" is the plain node.
SINKS = ("", "auto", "topic", "file")


def milliseconds(folder: Path, env: Mapping[str, str], sink: str) -> float:
    """Until the node is up."""
    words = [str(PYTHON), str(folder / "starter.py")]
    if sink:
        words[1:1] = [RUN, "--static", str(folder / "static.json")]
    settings = {**env, "TPC_SINK": sink, "TPC_FOLDER": str(folder / "tpc")} if sink else env
    begin = time.monotonic()
    with subprocess.Popen(words, env=settings, stdout=subprocess.PIPE) as node:
        assert node.stdout is not None
        if not node.stdout.readline():
            raise SystemExit(f"the node ended with status {node.wait()}")
        took = time.monotonic() - begin
        node.kill()
    return took * 1e3


def main() -> None:
    """Measure all, and print a line for each figure."""
    if not PYTHON.exists():
        raise SystemExit(f"{PYTHON} is missing: tools/setup test installs it")
    rounds: dict[str, list[float]] = defaultdict(list)
    with tempfile.TemporaryDirectory() as name, own_domain() as domain:
        folder = Path(name)
        (folder / "starter.py").write_text(NODE)
        (folder / "static.json").write_text(static_of(folder / "starter.py", NODE, LINE, OTHERS))
        env = {"PATH": os.defpath, "HOME": name, **domain}
        # The first ones write what Python caches.
        for sink in SINKS:
            milliseconds(folder, env, sink)
        for number in range(ROUNDS):
            took = {sink: milliseconds(folder, env, sink) for sink in SINKS}
            print(f"round {number + 1}: {took}", file=sys.stderr)
            rounds["plain"].append(took[""])
            for sink in SINKS[1:]:
                rounds[sink].append(took[sink] - took[""])
    for name, values in rounds.items():
        value = statistics.median(values)
        is_plain = name == "plain"
        figure(
            TOPIC,
            name if is_plain else f"{name}_added",
            value,
            unit="ms",
            target="none" if is_plain else f"<={MOST_MS:g}",
            hit=is_plain or value <= MOST_MS,
        )


if __name__ == "__main__":
    main()
