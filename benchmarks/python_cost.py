"""What a report costs a Python node: by the hook's sinks, and by a publish per comparison.

One loop compares numbers with a parameter. It runs plainly, under the hook with each sink, and with
a report in the source that makes and publishes a std_msgs/String each, as the thesis's Python nodes
do. All are rospy nodes on one roscore, with one subscriber on /threshold_information. A cost is the
processor's time, of all threads of the node, for a comparison, less that of the plain loop in the
same round; the figure is the median of the rounds, which take turns. Start-up is a script that does
nothing, and one that imports rospy, with the hook and without it.
"""

from __future__ import annotations

import contextlib
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path

from figures import figure
from loop_static import key, static_of

from pytpc.ros.ros1.graph import RosGraph

TOPIC = "python-cost"
ROOT = Path(__file__).resolve().parents[1]
RUN = str(ROOT / "pytpc/python_runtime/run.py")
# The interpreter that Debian's rospy is for.
PYTHON = "/usr/bin/python3"
ROUNDS = 5
STARTS = 15
STARTED = {"start": "pass\n", "start_rospy": "import rospy\n"}
LINE = "        if number > limit:"
LOOP = f"""\
import sys, time
import rospy
from std_msgs.msg import String
rospy.init_node("loop")
limit = rospy.get_param("~limit", 50.0)
count, numbers = int(sys.argv[1]), [float(number) for number in range(100)]
def compare():
    hits = 0
    for number in numbers:
{LINE}
            hits += 1
    return hits
publisher = rospy.Publisher("/threshold_information", String, queue_size=100)
def publish(number, outcome):
    publisher.publish(String("%.7f,{key(1)},%s,cmp:%r,thresh:%r,res:%s"
                             % (time.time(), outcome, number, limit, outcome)))
    return outcome
def by_publish():
    hits = 0
    for number in numbers:
        if publish(number, number > limit):
            hits += 1
    return hits
body = by_publish if len(sys.argv) > 2 else compare
body()
if len(sys.argv) > 2:
    while not publisher.get_num_connections():
        time.sleep(0.01)
else:
    time.sleep(1.0)
begin = time.process_time_ns()
for _ in range(count // 100):
    body()
print((time.process_time_ns() - begin) / (count // 100 * 100))
"""
LISTENER = """\
import rospy
from std_msgs.msg import String
rospy.init_node("listener")
rospy.Subscriber("/threshold_information", String, lambda message: None, queue_size=1000)
rospy.spin()
"""
# Name -> (sink, policy, comparisons); "" is the plain loop, None the publish in the source.
WAYS: Mapping[str, tuple[str | None, str, int]] = {
    "plain": ("", "", 2_000_000),
    "off": ("off", "every", 1_000_000),
    "file": ("file", "every", 500_000),
    "file_edges": ("file", "edges", 100_000),
    "topic": ("topic", "every", 50_000),
    "rosout": ("rosout", "every", 10_000),
    "publish": (None, "", 10_000),
}


def nanoseconds(folder: Path, env: Mapping[str, str], way: str) -> float:
    """Of one comparison, in a process of its own."""
    sink, policy, count = WAYS[way]
    words = [str(folder / "loop.py"), str(count)]
    settings = dict(env)
    if sink is None:
        words.append("publish")
    elif sink:
        words = [RUN, "--static", str(folder / "static.json"), *words]
        settings.update(TPC_SINK=sink, TPC_POLICY=policy, TPC_FOLDER=str(folder / "tpc"))
    done = subprocess.run(
        [PYTHON, *words], env=settings, check=True, capture_output=True, text=True, timeout=300
    )
    return float(done.stdout.split()[-1])


@contextlib.contextmanager
def listening(env: Mapping[str, str]) -> Iterator[None]:
    """A subscriber, as long as the ``with`` lasts."""
    with subprocess.Popen([PYTHON, "-c", LISTENER], env=env) as listener:
        time.sleep(1.0)
        try:
            yield
        finally:
            listener.terminate()


def starting(folder: Path, text: str) -> tuple[float, float]:
    """The processor's milliseconds of a script: plainly, and under the hook (medians)."""
    script = folder / "start.py"
    script.write_text(text)
    static = str(folder / "static.json")
    ways = ([PYTHON, str(script)], [PYTHON, RUN, "--static", static, str(script)])
    took: tuple[list[float], list[float]] = ([], [])
    for _ in range(STARTS):
        for command, times in zip(ways, took, strict=True):
            begin = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run(command, check=True)
            end = resource.getrusage(resource.RUSAGE_CHILDREN)
            used = end.ru_utime + end.ru_stime - begin.ru_utime - begin.ru_stime
            times.append(used * 1e3)
    return statistics.median(took[0]), statistics.median(took[1])


def main() -> None:
    """Measure all, and print a line for each figure."""
    costs: dict[str, list[float]] = defaultdict(list)
    ratios: list[float] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "loop.py").write_text(LOOP)
        (folder / "static.json").write_text(static_of(folder / "loop.py", LOOP, LINE))
        starts = {name: starting(folder, text) for name, text in STARTED.items()}
        with RosGraph(dict(os.environ), folder / "graph") as graph:
            env = {**os.environ, "ROS_MASTER_URI": graph.uri, "ROS_IP": "127.0.0.1"}
            with listening(env):
                for number in range(ROUNDS):
                    took = {way: nanoseconds(folder, env, way) for way in WAYS}
                    print(f"round {number + 1}: {took}", file=sys.stderr)
                    for way, ns in took.items():
                        costs[way].append(ns - took["plain"] if way != "plain" else ns)
                    ratios.append(costs["file"][-1] / costs["publish"][-1])
    for way, values in costs.items():
        figure(TOPIC, way, statistics.median(values), unit="ns", target="none", hit=True)
    ratio = statistics.median(ratios)
    figure(TOPIC, "file_to_publish", ratio, unit="ratio", target="<=0.1", hit=ratio <= 0.1)
    for name, (plain_ms, hook_ms) in starts.items():
        figure(TOPIC, f"{name}_plain", plain_ms, unit="ms", target="none", hit=True)
        figure(TOPIC, f"{name}_added", hook_ms - plain_ms, unit="ms", target="none", hit=True)


if __name__ == "__main__":
    main()
