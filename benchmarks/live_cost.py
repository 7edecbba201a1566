"""What `pytpc live` costs the robot, and how smooth its page is.

A roscpp node compares 200 values with parameters at 10 Hz, each before a publish; it is built with
TPC and has the default sink. In turns, it runs with nobody who listens, and with `pytpc live` and
an open page in Chromium. CPU is read from /proc, and given in percent of a core; the robot's side
is what the node takes more with the page than without, the median of the rounds. In the
last round the page counts the time between its frames for a minute. Two comparisons turn each
second; a tenth of the values is near its threshold.
"""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from figures import figure
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

from pytpc.base.paths import installed
from pytpc.ros.ros1.graph import RosGraph
from pytpc.static.static_info import StaticInfo, load_link_unit

COMPARISONS, RATE_HZ = 200, 10
ROUNDS, SECONDS, FRAMES_S = 3, 30.0, 60.0
SETTLE_S = 5.0
MOST_PERCENT, LONGEST_GAP_S = 5.0, 1.0
_TICKS = os.sysconf("SC_CLK_TCK")
ENVIRONMENT = {**os.environ, "PATH": "/usr/bin:/bin"}


def source() -> str:
    """The node, in C++."""
    fields = "\n".join(f"  double limit{n};" for n in range(COMPARISONS))
    reads = "\n".join(f'  nh.param("limit{n}", limits.limit{n}, 10.0);' for n in range(COMPARISONS))
    steps = "\n".join(
        f"    if (value(t, {n}) > limits.limit{n})\n      publisher.publish(message);"
        for n in range(COMPARISONS)
    )
    return f"""#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
struct Limits {{
{fields}
}};
static double value(double t, int n) {{
  double reach = n < 2 ? 11 : n % 10 == 0 ? 9.9 : 5;
  return reach * std::sin(3.14 * t + n);
}}
int main(int argc, char **argv) {{
  ros::init(argc, argv, "many");
  ros::NodeHandle nh("~");
  ros::Publisher publisher = nh.advertise<std_msgs::Float64>("out", 10);
  std_msgs::Float64 message;
  Limits limits;
{reads}
  ros::WallRate rate({RATE_HZ});
  for (double t = 0; ros::ok(); t += 1.0 / {RATE_HZ}) {{
{steps}
    ros::spinOnce();
    rate.sleep();
  }}
}}
"""


def built(folder: Path) -> tuple[Path, Path]:
    """The program, and its static information."""
    (folder / "many.cpp").write_text(source(), encoding="utf-8")
    config = ["pkg-config", "--cflags", "--libs", "roscpp", "std_msgs"]
    found = subprocess.run(config, env=ENVIRONMENT, check=True, capture_output=True, text=True)
    command = [str(installed("bin/tpc-clang++")), "-O2", "many.cpp", "-o", "many"]
    env = {**ENVIRONMENT, "TPC_STATIC_INFO": str(folder / "static")}
    subprocess.run([*command, *shlex.split(found.stdout)], cwd=folder, env=env, check=True)
    files = [
        one for one in (folder / "static").rglob("*.json") if not one.name.endswith(".link.json")
    ]
    units = [load_link_unit(file) for file in files]
    static = StaticInfo.of(units)
    if len(static.thresholds) != COMPARISONS:
        sys.exit(f"{COMPARISONS} comparisons were to be found, not {len(static.thresholds)}")
    static.save(folder / "static.json")
    return folder / "many", folder / "static.json"


def cpu_s(*pids: int) -> float:
    """Processor seconds of processes so far, user and system."""
    total = 0.0
    for pid in pids:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        total += (int(fields[11]) + int(fields[12])) / _TICKS
    return total


def percent(seconds: float, *pids: int) -> float:
    """Percent of a core that processes take, over so many seconds."""
    began, before = time.monotonic(), cpu_s(*pids)
    time.sleep(seconds)
    return 100 * (cpu_s(*pids) - before) / (time.monotonic() - began)


@contextmanager
def page(graph: RosGraph, static: Path) -> Iterator[tuple[int, Any]]:
    """`pytpc live` with an open page: its process, and the browser."""
    command = [sys.executable, "-m", "pytpc", "live", "--static", str(static), "--no-browser"]
    server = subprocess.Popen(
        [*command, "-o", str(static.parent / "marks.csv")],
        env={**ENVIRONMENT, **graph.env, "PYTHONPATH": os.pathsep.join(sys.path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    options = webdriver.ChromeOptions()
    options.binary_location = str(shutil.which("chromium"))
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu"):
        options.add_argument(argument)
    driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
    try:
        assert server.stdout is not None
        driver.get(server.stdout.readline().strip())
        until = time.monotonic() + 60
        count = "return document.querySelectorAll('[data-part=near] li').length"
        while driver.execute_script(count) == 0:
            if time.monotonic() > until:
                sys.exit("no comparison appeared on the page")
            time.sleep(0.2)
        yield server.pid, driver
    finally:
        driver.quit()
        server.terminate()
        server.wait(20)


def longest_gap_s(driver: Any, seconds: float) -> tuple[float, int]:  # noqa: ANN401
    """The longest time between two frames of the page, and how many boards were drawn."""
    boards = "return Number(document.documentElement.dataset.boards ?? 0)"
    before = driver.execute_script(boards)
    driver.execute_script(
        "window.gap = 0; let last = performance.now();"
        "const next = (now) => { window.gap = Math.max(window.gap, now - last); last = now;"
        " requestAnimationFrame(next); }; requestAnimationFrame(next);"
    )
    time.sleep(seconds)
    return driver.execute_script("return window.gap") / 1000, driver.execute_script(boards) - before


def main() -> None:
    """Prints the figures."""
    parser = argparse.ArgumentParser(description="What `pytpc live` costs.")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--seconds", type=float, default=SECONDS)
    parser.add_argument("--frames", type=float, default=FRAMES_S)
    given = parser.parse_args()
    alone: list[float] = []
    more: list[float] = []
    servers: list[float] = []
    with tempfile.TemporaryDirectory() as scratch:
        program, static = built(Path(scratch))
        with RosGraph(dict(ENVIRONMENT), Path(scratch) / "graph") as graph:
            node = graph.start("many", [str(program)], env={"TPC_FOLDER": f"{scratch}/tpc"})
            pid = node.popen.pid
            time.sleep(SETTLE_S)
            for turn in range(given.rounds):
                nobody = percent(given.seconds, pid)
                with page(graph, static) as (server, driver):
                    time.sleep(SETTLE_S)
                    began, before = time.monotonic(), cpu_s(server)
                    watched = percent(given.seconds, pid)
                    servers.append(100 * (cpu_s(server) - before) / (time.monotonic() - began))
                    if turn == given.rounds - 1:
                        gap_s, boards = longest_gap_s(driver, given.frames)
                        driver.get("about:blank")
                        blank_s, _ = longest_gap_s(driver, given.frames)
                alone.append(nobody)
                more.append(watched - nobody)
                print(f"round {turn + 1}: {nobody:.2f} % alone, {watched:.2f} %", file=sys.stderr)
            graph.stop(node)
    robot = statistics.median(more)
    target = f"<={MOST_PERCENT:g}"
    figure("live", "robot_more", robot, unit="%core", target=target, hit=robot <= MOST_PERCENT)
    every = statistics.median(alone)
    figure("live", "robot_alone", every, unit="%core", target="none", hit=True)
    figure("live", "server", statistics.median(servers), unit="%core", target="none", hit=True)
    gap = f"<{LONGEST_GAP_S:g}"
    figure("live", "longest_gap", gap_s, unit="s", target=gap, hit=gap_s < LONGEST_GAP_S)
    # What this machine makes of a page that does nothing.
    figure("live", "longest_gap_of_blank_page", blank_s, unit="s", target="none", hit=True)
    rate = boards / given.frames
    figure("live", "boards_drawn", rate, unit="/s", target="<=10", hit=0 < rate <= 10.5)


if __name__ == "__main__":
    main()
