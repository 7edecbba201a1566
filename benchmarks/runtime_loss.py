"""How many reports are lost on their way: sinks rosout, topic and file, at three rates.

A node (tests/ros/sinks/reporter.cpp) reports at a rate for some seconds from its start on, as a
node does; who listens is there before. On the topics two readers listen: a roscpp subscriber with a
queue of 100 messages, as users have it, and pytpc's recorder. In the file the complete records are
counted, here and not by pytpc's reader. A share is of the reports that the node made; what it
managed at a rate is a figure of its own. Medians of interleaved rounds.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from figures import figure
from rosbags.rosbag1 import Reader

from pytpc.base.paths import prefix, project_root
from pytpc.ingest.ros1 import decode_log, decode_string
from pytpc.ros.ros1.graph import GraphProcess, RosGraph

SOURCES = project_root() / "tests" / "ros" / "sinks"
TOPIC = "runtime-cost"
SINKS = ("rosout", "topic", "file")
RATES = (456, 5_000, 50_000)
SECONDS = 4.0
ROUNDS = 3
_HEADER, _CHUNK, _CHUNK_HEADER, _RECORD = 4096, 65_536, 64, 32
_REPORTS, _REPORT = 1, 1


def build(folder: Path) -> None:
    """The nodes, in ``folder``."""
    options = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_COMPILER=clang++-19"]
    configure = ["cmake", "-S", str(SOURCES), "-B", str(folder), *options]
    for command in (
        [*configure, f"-DTPC_PREFIX={prefix()}"],
        ["cmake", "--build", str(folder)],
    ):
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def in_file(folder: Path) -> int:
    """The complete reports in the one file of a folder (docs/reference/formats.md)."""
    (path,) = folder.glob("*.tpc")
    count = 0
    with path.open("rb") as stream:
        stream.seek(_HEADER)
        while len(chunk := stream.read(_CHUNK)) == _CHUNK:
            words = np.frombuffer(chunk, "<u4")
            if words[0] != _REPORTS:
                continue
            kinds = words[_CHUNK_HEADER // 4 :: _RECORD // 4] & 0xFF
            ends = np.flatnonzero(kinds == 0)
            complete = kinds[: ends[0]] if len(ends) else kinds
            count += int(np.count_nonzero(complete == _REPORT))
    return count


def in_bag(path: Path) -> int:
    """The reports in a bag of both topics."""
    count = 0
    with Reader(path) as reader:
        for connection, _, raw in reader.messages():
            if connection.topic == "/rosout":
                count += decode_log(raw).msg.startswith(b"threshold_information:")
            else:
                lines = decode_string(raw).split(b"\n")
                count += sum(not line.startswith(b"#") for line in lines)
    return count


def started_recorder(graph: RosGraph, folder: Path) -> GraphProcess:
    """The recorder, when it is registered."""
    status = folder / "status.json"
    command = [sys.executable, "-m", "pytpc.ros.ros1.recorder", "--bag", str(folder / "all.bag")]
    path = ":".join(part for part in (str(project_root()), os.environ.get("PYTHONPATH")) if part)
    recorder = graph.start(
        "recorder",
        [*command, "--status", str(status), "/rosout", "/threshold_information"],
        env={"PYTHONPATH": path},
        patience_s=30.0,
    )
    until = time.monotonic() + 20.0
    while time.monotonic() < until:
        with contextlib.suppress(OSError, ValueError):
            if json.loads(status.read_text(encoding="utf-8"))["ready"]:
                return recorder
        time.sleep(0.05)
    raise SystemExit("the recorder is not ready")


def number(text: str, pattern: str) -> int:
    """The number that a node says."""
    found = re.search(pattern, text)
    if found is None:
        raise SystemExit(f"a node did not say {pattern}: {text}")
    return int(found[1])


def run(nodes: Path, folder: Path, sink: str, rate: int) -> tuple[dict[str, float], float]:
    """One run: for each reader the lost share in percent, and the reports made in a second."""
    with RosGraph(dict(os.environ), folder / "graph") as graph:
        counter = graph.start("counter", [str(nodes / "counter")])
        recorder = started_recorder(graph, folder)
        time.sleep(0.5)
        node = graph.start(
            "reporter",
            [str(nodes / "reporter"), f"--rate={rate}", f"--seconds={SECONDS}", "--stay=2"],
            env={"TPC_SINK": sink, "TPC_FOLDER": str(folder / "files")},
        )
        node.popen.wait(SECONDS * 10)
        time.sleep(0.5)
        graph.stop(recorder)
        graph.stop(counter)
    made = number(node.log.read_text(encoding="utf-8"), r"running=(\d+)")
    if sink == "file":
        got = {"file": in_file(folder / "files")}
    else:
        said = counter.log.read_text(encoding="utf-8")
        got = {"queue_of_100": number(said, r"got (\d+)"), "recorder": in_bag(folder / "all.bag")}
    return {reader: 100 * (1 - count / made) for reader, count in got.items()}, made / SECONDS


def main() -> None:
    """Prints the lost share for each sink, rate and reader, and the rate that was reached."""
    lost: dict[tuple[str, int, str], list[float]] = {}
    reached: dict[tuple[str, int], list[float]] = {}
    with tempfile.TemporaryDirectory() as scratch:
        nodes = Path(scratch) / "nodes"
        build(nodes)
        for turn in range(ROUNDS):
            for rate in RATES:
                for sink in SINKS:
                    print(f"round {turn + 1} of {ROUNDS}: {sink}, {rate}/s", file=sys.stderr)
                    folder = Path(scratch) / f"{turn}-{rate}-{sink}"
                    folder.mkdir()
                    shares, made = run(nodes, folder, sink, rate)
                    reached.setdefault((sink, rate), []).append(made)
                    for reader, share in shares.items():
                        lost.setdefault((sink, rate, reader), []).append(share)
    for (sink, rate, reader), shares in sorted(lost.items(), key=lambda item: item[0][:2]):
        share = statistics.median(shares)
        # What the thesis's way loses is there to compare with, and has no target.
        target, hit = ("none", True) if sink == "rosout" else ("<=0", share <= 0)
        name = f"lost_{sink}_{rate}_{reader}"
        figure(TOPIC, name, share, unit="%", target=target, hit=hit)
    for (sink, rate), values in sorted(reached.items()):
        share = statistics.median(values) / rate
        target, hit = ("none", True) if sink == "rosout" else (">=0.99", share >= 0.99)
        figure(TOPIC, f"reached_{sink}_{rate}", share, unit="of_rate", target=target, hit=hit)


if __name__ == "__main__":
    main()
