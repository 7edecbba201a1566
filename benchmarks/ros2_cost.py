"""Reports under ROS 2: what one costs the node beside ROS 1, and how many are lost.

The same loop reports to the file sink as a node of ROS 1 and of ROS 2: in C++ (runtime/Reports.cpp)
by the wall's clock, in Python by the processor's time of all threads, less that of the plain loop.
They take turns; a ratio is the median of the rounds. Then a node in C++ reports 5,000 times a
second to `pytpc record`, and one is killed (SIGKILL) behind its last report to a file.
"""

from __future__ import annotations

import os
import shlex
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from figures import figure
from loop_static import static_of

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from pytpc.base.paths import prefix  # noqa: E402
from pytpc.ingest.reading import read  # noqa: E402
from pytpc.ros.node_start import RUN  # noqa: E402
from pytpc.ros.ros1.graph import RosGraph  # noqa: E402
from pytpc_evaluation.demo.ros2_robot import own_domain  # noqa: E402
from ros2_commands import interrupted, recorder  # noqa: E402
from ros2_dialogue import Dialogue  # noqa: E402
from ros2_graph import PYTHON, compile_on_rcl, ros2_env, wheels_env  # noqa: E402

TOPIC = "ros2-cost"
ROUNDS = 5
RATE = 5_000
REPORTS = 40_000
FILE = {"TPC_SINK": "file", "TPC_POLICY": "every"}
LINE = "        if number > limit:"
LOOP = f"""\
import sys, time
{{start}}
limit = 50.0
numbers = [float(number) for number in range(100)]
def compare():
    hits = 0
    for number in numbers:
{LINE}
            hits += 1
    return hits
compare()
time.sleep(1.0)
begin = time.process_time_ns()
for _ in range(5_000):
    compare()
print((time.process_time_ns() - begin) / 500_000, flush=True)
"""
STARTS = {
    "ros1": "import rospy\nrospy.init_node('loop', anonymous=True)",
    "ros2": "import rclpy\nrclpy.init()\nnode = rclpy.create_node('loop')",
}


class Nodes:
    """The nodes of both systems, and their environments."""

    def __init__(self, folder: Path, ros1: dict[str, str], domain: dict[str, str]) -> None:
        """Build them in ``folder``."""
        self.folder = folder
        self.env = {"ros1": ros1, "ros2": ros2_env(domain)}
        self.in_cpp = {"ros1": ros1, "ros2": ros2_env(domain, **wheels_env())}
        self.python = {"ros1": "/usr/bin/python3", "ros2": str(PYTHON)}
        source = ROOT / "benchmarks/runtime/Reports.cpp"
        compile_on_rcl(source, folder / "ros2")
        found = subprocess.run(
            ["pkg-config", "--cflags", "--libs", "roscpp"],
            check=True,
            capture_output=True,
            text=True,
        )
        place = [f"-I{prefix()}/include/tpc", f"-L{prefix()}/lib", f"-Wl,-rpath,{prefix()}/lib"]
        words = ["-DROS1", *place, "-ltpc_log", *shlex.split(found.stdout)]
        clang = ["clang++-19", "-std=c++17", "-O2", "-pthread", str(source)]
        subprocess.run([*clang, "-o", str(folder / "ros1"), *words], check=True)
        for system, start in STARTS.items():
            script = folder / f"{system}.py"
            text = LOOP.format(start=start)
            script.write_text(text)
            (folder / f"{system}.json").write_text(static_of(script, text, LINE))

    def cpp(self, system: str) -> float:
        """Nanoseconds of a report."""
        return self._told([str(self.folder / system)], self.in_cpp[system])

    def python_report(self, system: str) -> float:
        """The same, of the processor's time."""
        script, static = (str(self.folder / f"{system}.{kind}") for kind in ("py", "json"))
        python, env = self.python[system], self.env[system]
        plain = self._told([python, script], env)
        return self._told([python, str(RUN), "--static", static, script], env) - plain

    def _told(self, words: list[str], env: dict[str, str]) -> float:
        with tempfile.TemporaryDirectory() as reports:
            done = subprocess.run(
                words,
                env={**env, **FILE, "TPC_FOLDER": reports},
                check=True,
                capture_output=True,
                text=True,
                timeout=300,
            )
        return float(done.stdout.split()[-1])


def lost(folder: Path, domain: dict[str, str]) -> tuple[int, int]:
    """The reports that `pytpc record` has not got, and those that are not in a killed node's file.

    The node makes `REPORTS` of them, the first at `RATE` a second.
    """
    program = compile_on_rcl(ROOT / "tests/ros2/reporter.cpp", folder / "reporter")

    def start(name: str, **settings: str) -> Dialogue:
        env = ros2_env(domain, TPC_POLICY="every", **settings, **wheels_env())
        return Dialogue([str(program), name, "/"], env, folder / f"{name}.err")

    runtime = folder / "run"
    runtime.mkdir(mode=0o700)
    env = ros2_env(domain, XDG_RUNTIME_DIR=str(runtime), HOME=str(folder))
    with recorder(env, folder) as recording:
        node = start("reports", TPC_SINK="topic")
        node.say(f"report {REPORTS} {1_000_000 // RATE}")
        node.finish()
        interrupted(recording)
    killed = start("killed", TPC_SINK="file", TPC_FOLDER=str(folder / "files"))
    killed.say(f"report {REPORTS} 0")
    killed.process.kill()
    killed.process.wait()
    got = [len(read(folder / place).events.cmp) for place in ("mission", "files")]
    return REPORTS - got[0], REPORTS - got[1]


def main() -> None:
    """Measure all, and print a line for each figure."""
    ratios: dict[str, list[float]] = {"cpp": [], "python": []}
    with tempfile.TemporaryDirectory() as scratch, own_domain() as domain:
        folder = Path(scratch)
        with RosGraph(dict(os.environ), folder / "graph") as graph:
            nodes = Nodes(folder, dict(graph.env), domain)
            for turn in range(ROUNDS):
                ways = {"cpp": nodes.cpp, "python": nodes.python_report}
                took = {way: [ask("ros1"), ask("ros2")] for way, ask in ways.items()}
                print(f"round {turn + 1} of {ROUNDS}: {took} ns", file=sys.stderr)
                for way, (ros1, ros2) in took.items():
                    ratios[way].append(ros2 / ros1)
        not_recorded, not_in_file = lost(folder, domain)
    for way, values in ratios.items():
        ratio = statistics.median(values)
        name = f"{way}_file_over_ros1"
        figure(TOPIC, name, ratio, unit="ratio", target="<=1.1", hit=ratio <= 1.1)
    for name, count in (
        (f"lost_topic_{RATE}_recorder", not_recorded),
        ("lost_file_killed", not_in_file),
    ):
        figure(TOPIC, name, count, unit="reports", target="0", hit=count == 0)


if __name__ == "__main__":
    main()
