"""Nodes of rclpy that report, and a listener on their graph, for tests."""

from __future__ import annotations

import json
import subprocess
import threading
from pathlib import Path
from typing import NamedTuple

from patience import PATIENCE_S, wait_for
from pytpc.ros.node_start import RUN
from ros2_graph import PYTHON, ros2_env

KEY = "00000001-0000-5000-8000-000000000001"
LINE = "    return x > 6.5"
HIGH = f"""\
import os, signal, sys, threading, time
import rclpy
from rclpy.node import Node

def high(x):
{LINE}

def until(done):
    deadline = time.monotonic() + {PATIENCE_S}
    while not done() and time.monotonic() < deadline:
        time.sleep(0.01)
"""
LISTENER = """\
import json, rclpy, sys
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rcl_interfaces.msg import Log
from std_msgs.msg import String

def out(*words):
    print(json.dumps(words), flush=True)

def log(message):
    if message.msg.startswith("threshold_"):
        stamp = message.stamp.sec * 10**9 + message.stamp.nanosec
        out("rosout", message.name, message.msg, stamp, message.level)

rclpy.init()
node = Node("listener")
def batch(message):
    out("topic", message.data)

node.create_subscription(String, "/threshold_information", batch, QoSProfile(depth=512))
node.create_subscription(Log, "/rosout", log, QoSProfile(depth=1000))
out("ready")
rclpy.spin(node)
"""


class Batch(NamedTuple):
    """A message on /threshold_information: its head as a dictionary, and its other lines."""

    head: dict[str, str]
    lines: list[str]


class Listener:
    """What a subscriber in rclpy receives."""

    def __init__(self, domain: dict[str, str], folder: Path) -> None:
        program = folder / "listener.py"
        program.write_text(LISTENER)
        self._got: list[list[str]] = []
        self._process = subprocess.Popen(
            [PYTHON, program],
            env=ros2_env(domain),
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()
        wait_for(lambda: bool(self._got))

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._got.append(json.loads(line))

    def batches(self, node: str) -> list[Batch]:
        """The batches of a node so far."""
        found = []
        for kind, *words in list(self._got):
            if kind != "topic":
                continue
            first, *lines = words[0].split("\n")
            head = dict(part.split(":", 1) for part in first.removeprefix("#").split(","))
            if head["node"] == node:
                found.append(Batch(head, lines))
        return found

    def values(self, node: str) -> list[float]:
        """The compared values of the reports of a node so far."""
        lines = [line for batch in self.batches(node) for line in batch.lines]
        return [float(line.split("cmp:")[1].split(",")[0]) for line in lines if f",{KEY}," in line]

    def logs(self, logger: str) -> list[list[str]]:
        """Text, time in ns and level of each line on /rosout by that logger."""
        return [
            words[1:] for kind, *words in list(self._got) if kind == "rosout" and words[0] == logger
        ]

    def end(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()
        self._thread.join(10)
        if self._process.stdout is not None:
            self._process.stdout.close()


class Program:
    """A program in rclpy, in a folder of its own, with its static information."""

    def __init__(self, folder: Path, domain: dict[str, str], text: str) -> None:
        """``text`` follows `HIGH`, whose one comparison reports."""
        self.path = folder / "mission.py"
        self.reports = folder / "reports"
        self._domain = domain
        text = HIGH + text
        self.path.write_text(text)
        comparison = {
            "key": KEY,
            "relation": ">",
            "file": self.path.name,
            "lineno": text.splitlines().index(LINE) + 1,
            "column": LINE.index("x") + 1,
            "name": None,
            "operand": "right",
            "source_code": LINE.strip(),
        }
        unit = {"link_unit": "mission", "source_root": str(folder), "comparisons": [comparison]}
        self.static = folder / "static.json"
        self.static.write_text(json.dumps({"schema": 1, "units": [unit]}))

    def start(self, *words: str, plain: bool = False, **env: str) -> subprocess.Popen[str]:
        """Start it with reports, or ``plain``; `ended` ends its standard input."""
        more = {"TPC_FOLDER": str(self.reports), "TPC_FILE_RESERVE": "0", **env}
        hook = [] if plain else [RUN, "--static", self.static]
        return subprocess.Popen(
            [PYTHON, *hook, self.path, *words],
            env=ros2_env(self._domain, **more),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def run(self, *words: str, plain: bool = False, **env: str) -> subprocess.CompletedProcess[str]:
        """Run it until it ends."""
        process = self.start(*words, plain=plain, **env)
        return ended(process)


def ended(process: subprocess.Popen[str]) -> subprocess.CompletedProcess[str]:
    """Its status, and what it said."""
    out, said = process.communicate(timeout=PATIENCE_S)
    return subprocess.CompletedProcess(process.args, process.returncode, out, said)
