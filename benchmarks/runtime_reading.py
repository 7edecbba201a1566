"""Reading recordings: reports a second and peak memory of each format, next to plain loops.

Each measurement is a process of its own, the median of three, without the time that imports take.
The binary file is also read into columns next to numpy copying the same bytes: out of the mapped
file, and from memory to memory (the file is in the cache in all three). These are the least
processor times of some rounds in turn. ``--large GB`` converts a
binary file of this size, and ``--bag GB`` a bag, with the command, and shows the peak memory.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from figures import figure

from pytpc.ingest.binary import _TpcReader
from pytpc.ingest.gathering import Gathering
from pytpc.python_runtime import log_layout as layout
from pytpc_evaluation.report_file import (
    header,
    reports,
    site,
    sync,
    system_chunks,
    thread_chunks,
)

ROOT = Path(__file__).parents[1]
TOPIC = "runtime-cost"
ROUNDS = 3
REPORTS = 300_000
KEYS = [f"{number:08x}-0000-5000-8000-000000000000" for number in range(60)]
BEGIN_NS = 1_700_000_000 * 10**9
STEP_NS = 20_000

ROSBAG_LOOP = """
import rosbag
def go(path):
    count = 0
    for topic, message, stamp in rosbag.Bag(path).read_messages(topics=["/rosout"]):
        if message.msg.startswith("threshold_information:"):
            key, result, cmp, thresh, res = message.msg[22:].split(",")
            float(cmp[4:]), float(thresh[7:]), message.header.stamp.to_nsec(), message.name
            count += 1
    return count
"""
CSV_LOOP = """
import csv
def go(path):
    rows = []
    with open(path, newline="") as stream:
        for at, key, result, cmp, thresh, res in csv.reader(stream):
            values = float(cmp[4:]), float(thresh[7:])
            rows.append((float(at), key, result == "1", *values, res == "res:1"))
    return len(rows)
"""
READ = """
from pathlib import Path
import pyarrow.csv, pyarrow.compute
from pytpc.ingest.reading import read
def go(path):
    return len(read(Path(path)).events)
"""
CONVERT = """
from pytpc.cli.main import main
import pytpc.cli.mission_commands
def go(path):
    main(["convert", path, "-o", path + ".out", "--json"], standalone_mode=False)
    return 0
"""
_TIMED = """
import sys, time
exec(sys.argv[1])
began = time.perf_counter()
count = go(sys.argv[2])
taken = time.perf_counter() - began
peak = next(line for line in open("/proc/self/status") if line.startswith("VmHWM")).split()[1]
print(count, taken, int(peak) / 1024)
"""


def values(count: int, first: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Seeded comparisons: what is compared wanders about its threshold of 0.5."""
    return np.random.default_rng(first).normal(0.5, 1.0, count), np.full(count, 0.5)


def write_tpc(path: Path, chunks: int, threads: int = 1) -> int:
    """A binary file of so many chunks of reports; how many reports."""
    system = [site(number, key) for number, key in enumerate(KEYS, start=1)]
    for second in range(chunks * layout.RECORDS_OF_CHUNK * STEP_NS // 10**9 + 2):
        at = second * 10**9
        # Real time gains a microsecond a second.
        system.append(sync(at, BEGIN_NS + at + 1000 * second))
    cmp, thresh = values(layout.RECORDS_OF_CHUNK)
    records = reports(cmp.size, cmp > thresh)
    records["cmp"], records["thresh"] = cmp, thresh
    records["site"] = np.arange(records.size) % len(KEYS) + 1
    with path.open("wb") as stream:
        stream.write(header("/uav", real_ns=BEGIN_NS))
        stream.write(system_chunks(system))
        # Threads take turns; each chunk of one covers the time of one chunk of all others.
        for chunk in range(chunks):
            turn, thread = divmod(chunk, threads)
            first = turn * records.size
            steady = np.arange(first, first + records.size) * threads + thread
            records["steady"] = steady * STEP_NS
            stream.write(thread_chunks(thread + 1, records, first).data)
    return chunks * layout.RECORDS_OF_CHUNK


def write_bag(path: Path, reports: int) -> None:
    """A bag of reports, as rosbag itself writes it."""
    program = f"""
import random, rosbag, rospy
from rosgraph_msgs.msg import Log
random.seed(1)
with rosbag.Bag({str(path)!r}, "w") as bag:
    log = Log(level=2, name="/uav", file="node.cpp", function="Node::step", line=12)
    log.topics = ["/rosout", "/cmd"]
    for number in range({reports}):
        log.header.seq = number
        stamp = rospy.Time({BEGIN_NS // 10**9} + number // 5000, number % 5000 * 200000)
        log.header.stamp = stamp
        value = random.gauss(0.5, 1)
        key = "%08x-0000-5000-8000-000000000000" % (number % {len(KEYS)})
        result = value > 0.5
        text = "threshold_information:%s,%d,cmp:%r,thresh:0.5,res:%d"
        log.msg = text % (key, result, value, result)
        bag.write("/rosout", log, stamp)
"""
    subprocess.run(["/usr/bin/python3", "-c", program], check=True, env={"PATH": "/usr/bin:/bin"})


def write_lines(path: Path, reports: int, line: Callable[[int, int, str], str]) -> None:
    """Text: ``line`` makes each one from the seconds, nanoseconds and text of a report."""
    cmp, _ = values(reports)
    with path.open("w", encoding="ascii") as stream:
        for number, value in enumerate(cmp.tolist()):
            result = int(value > 0.5)
            seconds, rest = divmod(number * 200_000, 10**9)
            text = f"{KEYS[number % len(KEYS)]},{result},cmp:{value!r},thresh:0.5,res:{result}"
            stream.write(line(BEGIN_NS // 10**9 + seconds, rest, text) + "\n")


def write_csv(path: Path, reports: int) -> None:
    """The thesis's form."""
    write_lines(path, reports, lambda s, ns, text: f"{s}.{ns // 100:07d},{text}")


def write_log(path: Path, reports: int) -> None:
    """What roscpp prints."""

    def line(s: int, ns: int, text: str) -> str:
        return f"\x1b[0m[ INFO] [{s}.{ns:09d}]: threshold_information:{text}\x1b[0m"

    write_lines(path, reports, line)


def write_ros2(folder: Path, kind: str, reports: int) -> Path:
    """An .mcap or .db3 file."""
    sys.path[:0] = [str(ROOT / "tests/python")]
    from ros2_bags import Ros2Bag  # noqa: PLC0415

    cmp, _ = values(reports)
    with Ros2Bag(folder / kind, kind) as bag:
        for number, value in enumerate(cmp.tolist()):
            result = int(value > 0.5)
            text = f"{KEYS[number % len(KEYS)]},{result},cmp:{value!r},thresh:0.5,res:{result}"
            seconds = BEGIN_NS // 10**9 + number * 0.0002
            bag.log(seconds, "uav", f"threshold_information:{text}")
    return bag.file


def timed(program: str, path: Path, python: str = sys.executable) -> tuple[int, float, float]:
    """Reports, median seconds and largest peak in MB of a program that prints how many it read."""
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    if python != sys.executable:
        env = {"PATH": "/usr/bin:/bin"}
    runs = []
    for _ in range(ROUNDS):
        done = subprocess.run(
            [python, "-c", _TIMED, program, str(path)],
            capture_output=True,
            text=True,
            check=True,
            env=env,
        )
        count, taken, peak = (float(word) for word in done.stdout.split())
        runs.append((int(count), taken, peak))
    return runs[0][0], statistics.median(run[1] for run in runs), max(run[2] for run in runs)


def show(name: str, path: Path, program: str = READ, python: str = sys.executable) -> float:
    """Prints reports a second and peak memory; returns the former."""
    count, seconds, peak = timed(program, path, python)
    rate = count / seconds
    figure(TOPIC, f"reading_{name}_per_s", rate, unit="reports/s", target="none", hit=True)
    figure(TOPIC, f"reading_{name}_peak", peak, unit="MB", target="none", hit=True)
    return rate


def against_copying(path: Path) -> tuple[float, float, float]:
    """Least processor seconds to read a binary file into columns, to copy its bytes with numpy out
    of the mapped file, and from memory to memory."""
    data = np.fromfile(path, np.uint8)
    target = np.empty_like(data)
    reading, mapped, copying = [], [], []
    for _ in range(2 * ROUNDS + 1):
        began = time.thread_time()
        np.copyto(target, data)
        copying.append(time.thread_time() - began)
        began = time.thread_time()
        np.copyto(target, np.memmap(path, np.uint8, "r"))
        mapped.append(time.thread_time() - began)
        began = time.thread_time()
        with path.open("rb", buffering=0) as stream:
            reader = _TpcReader(path, stream, Gathering(), None)  # type: ignore[arg-type]
            count = sum(len(block) for block in reader.blocks())
        reading.append(time.thread_time() - began)
    assert count == (data.size - 4096 - 65536) // 65536 * layout.RECORDS_OF_CHUNK
    return min(reading), min(mapped), min(copying)


def convert(path: Path) -> tuple[int, float, float]:
    """Reports, seconds and peak in MB of the command ``pytpc convert``."""
    done = subprocess.run(
        [sys.executable, "-c", _TIMED, CONVERT, str(path)],
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    summary, measured = done.stdout.splitlines()
    _, seconds, peak = (float(word) for word in measured.split())
    return int(json.loads(summary)["reports"]), seconds, peak


def main() -> None:
    """Prints all figures; files stand below ``--folder`` and are removed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--large", type=float, default=0.0, metavar="GB")
    parser.add_argument("--bag", type=float, default=0.0, metavar="GB")
    parser.add_argument("--folder", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=arguments.folder) as name:
        folder = Path(name)
        if arguments.large:
            _converted(folder, "tpc", arguments.large)
        if arguments.bag:
            _converted(folder, "bag", arguments.bag)
        if not arguments.large and not arguments.bag:
            _formats(folder)


def _converted(folder: Path, kind: str, gigabytes: float) -> None:
    path = folder / f"large.{kind}"
    if kind == "tpc":
        write_tpc(path, int(gigabytes * 2**30 / 65536), threads=4)
    else:
        write_bag(path, int(gigabytes * 2**30 / 240))
    size = path.stat().st_size / 2**30
    count, seconds, peak = convert(path)
    figure(TOPIC, f"convert_{kind}_size", size, unit="GiB", target="none", hit=True)
    figure(TOPIC, f"convert_{kind}_reports", count, unit="reports", target="none", hit=True)
    figure(
        TOPIC, f"convert_{kind}_per_s", count / seconds, unit="reports/s", target="none", hit=True
    )
    figure(TOPIC, f"convert_{kind}_peak", peak, unit="MB", target="<1000", hit=peak < 1000)


def _formats(folder: Path) -> None:
    tpc, bag, csv, log = (folder / f"m.{kind}" for kind in ("tpc", "bag", "csv", "log"))
    write_tpc(tpc, REPORTS // layout.RECORDS_OF_CHUNK * 10)
    reading, mapped, copying = against_copying(tpc)
    for name, base in (("copying_the_file", mapped), ("copying_memory", copying)):
        ratio = reading / base
        figure(TOPIC, f"reading_tpc_to_{name}", ratio, unit="ratio", target="<2", hit=ratio < 2)
    show("tpc", tpc)
    write_bag(bag, REPORTS)
    ours = show("bag", bag)
    theirs = show("bag_by_rosbag_api", bag, ROSBAG_LOOP, "/usr/bin/python3")
    figure(
        TOPIC, "bag_to_rosbag_api", ours / theirs, unit="ratio", target=">5", hit=ours > 5 * theirs
    )
    write_csv(csv, REPORTS)
    ours = show("csv", csv)
    theirs = show("csv_by_csv_module", csv, CSV_LOOP)
    figure(TOPIC, "csv_to_csv_module", ours / theirs, unit="ratio", target=">1", hit=ours > theirs)
    write_log(log, REPORTS)
    show("log", log)
    for kind in ("mcap", "db3"):
        show(kind, write_ros2(folder, kind, REPORTS // 3))


if __name__ == "__main__":
    main()
