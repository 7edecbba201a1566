"""Runs the programs of examples/rclcpp_nodes on a graph, and feeds them from rclpy."""

from __future__ import annotations

import json
import re
import signal
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from patience import PATIENCE_S
from ros2_graph import PYTHON, ros2_env
from suite.expectations import RCLCPP_PACKAGE
from suite.reported import raw

FEEDER = Path(__file__).with_name("rclcpp_feeder.py")
INPUT = [-6.0, -2.0, 1.0, 3.0, 6.0, 9.0]
AT_ONCE = 8
_KINDS = {
    "many": "std_msgs/msg/Float64MultiArray",
    "transform": "geometry_msgs/msg/TransformStamped",
}
_SUBSCRIBES = re.compile(r"create_subscription<Float64>\(\s*(?:\"input\"|topic)")

Heard = dict[str, list[str]]


def run_nodes(
    programs: Mapping[str, Path], env: Mapping[str, str], domain: dict[str, str], folder: Path
) -> tuple[Heard, dict[str, int]]:
    """Run all programs, some at once; what each topic got, and the status of each program.

    Raises:
        AssertionError: the feeder fails.
    """
    heard: Heard = {}
    status: dict[str, int] = {}
    names = sorted(programs)
    folder.mkdir()
    for first in range(0, len(names), AT_ONCE):
        some = names[first : first + AT_ONCE]
        ours = {name: programs[name] for name in some}
        heard |= _run_together(ours, env, domain, folder / f"{first}", status)
    return heard, status


def _run_together(
    programs: Mapping[str, Path],
    env: Mapping[str, str],
    domain: dict[str, str],
    place: Path,
    status: dict[str, int],
) -> Heard:
    config, output = place.with_suffix(".json"), place.with_suffix(".out")
    config.write_text(json.dumps(_config(sorted(programs))), "utf-8")
    with place.with_suffix(".log").open("w+") as log:
        feeder = subprocess.Popen(
            [PYTHON, FEEDER, config, output],
            env=ros2_env(domain),
            stdout=subprocess.PIPE,
            stderr=log,
            text=True,
        )
        assert feeder.stdout is not None
        running: dict[str, subprocess.Popen[bytes]] = {}
        try:
            assert feeder.stdout.readline() == "listens\n"
            for name, program in programs.items():
                running[name] = subprocess.Popen(
                    [program, *_words(name)], env={**env, **domain}, stdout=log, stderr=log
                )
            ended = feeder.wait(PATIENCE_S)
        finally:
            feeder.send_signal(signal.SIGINT)
            for process in running.values():
                process.send_signal(signal.SIGINT)
            for name, process in running.items():
                status[name] = process.wait(PATIENCE_S)
            feeder.stdout.close()
            feeder.wait(PATIENCE_S)
        log.seek(0)
        assert ended == 0, log.read()[-2000:]
    found: Heard = json.loads(output.read_text("utf-8"))
    return found


def _words(name: str) -> list[str]:
    params = raw(name, RCLCPP_PACKAGE).get("params", {})
    words = [
        word for key, value in params.items() for word in ("-p", f"{key}:={json.dumps(value)}")
    ]
    return ["--ros-args", *words] if words else []


def _config(names: Sequence[str]) -> dict[str, object]:
    """What the feeder is to do for these nodes."""
    nodes = {
        name: {
            topic: (_KINDS.get(topic, "std_msgs/msg/Float64"), count)
            for topic, count in raw(name, RCLCPP_PACKAGE)["messages"].items()
        }
        for name in names
    }
    sources = [(RCLCPP_PACKAGE / f"nodes/{name}.cpp").read_text("utf-8") for name in names]
    subscriptions = sum(len(_SUBSCRIBES.findall(source)) for source in sources)
    return {"input": INPUT, "nodes": nodes, "subscriptions": subscriptions}
