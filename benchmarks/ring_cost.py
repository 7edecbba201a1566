"""What a ring costs: a report with it and without, bytes on the disk, reports lost by kill -9.

A loop (runtime/Ring.cpp) reports blocks of 20,000 comparisons. With a ring of 3 s, which turns
every 0.4 s, and without one take turns, round after round; the figure is the median over the rounds
of the ratios of the median blocks. The policies are those that somebody has on: `every` in files,
and the default beside which the ring runs. Then programs that report in two threads are killed
while their rings turn: what they had counted is compared with what their files have.
"""

from __future__ import annotations

import os
import random
import signal
import statistics
import struct
import subprocess
import tempfile
import time
from pathlib import Path

from figures import figure

from pytpc.base.paths import prefix
from pytpc.ingest.reading import read

ROOT = Path(__file__).resolve().parents[1]
ROUNDS = 9
# About 0.8 s, in which a ring turns twice.
WORDS = ("120", "20000", "5000")
RING = {"TPC_RING": "0.05", "TPC_RING_BUDGET": "2048"}
WAYS = {"every in files": {"TPC_SINK": "file"}, "the default": {"TPC_SINK": "auto"}}
# The least: two threads that pause for a microsecond fill it several times in the time below.
BUDGET_MIB = 4
FILL_S = 15
KILLS = 20


def built(folder: Path, source: Path) -> Path:
    """A program with the log library."""
    program = folder / source.stem
    lib = prefix() / "lib"
    command = ["clang++-19", "-std=c++17", "-O2", "-pthread", f"-I{prefix()}/include"]
    command += [f"-I{prefix()}/include/tpc", str(source), "-o", str(program)]
    subprocess.run([*command, f"-L{lib}", "-ltpc_log", f"-Wl,-rpath,{lib}"], check=True)
    return program


def block_ns(program: Path, folder: Path, **env: str) -> float:
    """Nanoseconds of a report: the median of the blocks, without the first tenth."""
    with tempfile.TemporaryDirectory(dir=folder) as tpc:
        said = subprocess.run(
            [str(program), *WORDS],
            env={**os.environ, **env, "TPC_FOLDER": tpc, "TPC_FILE_LIMIT": "0"},
            check=True,
            capture_output=True,
            text=True,
        ).stdout
    blocks = [float(line) for line in said.split()]
    return statistics.median(blocks[len(blocks) // 10 :])


def cost(program: Path, folder: Path) -> None:
    """A report with a ring over one without."""
    for name, env in WAYS.items():
        ratios, plain = [], []
        for turn in range(ROUNDS):
            order = (RING, {}) if turn % 2 else ({}, RING)
            found = {bool(one): block_ns(program, folder, **env, **one) for one in order}
            ratios.append(found[True] / found[False])
            plain.append(found[False])
        ratio = statistics.median(ratios)
        print(f"{name}: {statistics.median(plain):.2f} ns without a ring, ratios {ratios}")
        figure("ring", f"report ({name})", ratio, unit="ratio", target="<=1.1", hit=ratio <= 1.1)


def counted(program: Path, folder: Path, pause_us: int, **ring: str) -> subprocess.Popen[str]:
    """A program of two threads that count what they report, in the file `counts`."""
    (folder / "tpc").mkdir()
    process = subprocess.Popen(
        [str(program), "counted", str(folder / "counts"), "2", "20", str(pause_us)],
        env={
            **os.environ,
            **RING,
            **ring,
            "TPC_SINK": "file",
            "TPC_FOLDER": str(folder / "tpc"),
        },
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    process.stdout.readline()
    return process


def size_of(folder: Path) -> int:
    """Bytes that the files take on the disk now."""
    total = 0
    for path in folder.glob("*"):
        try:
            total += path.stat().st_blocks * 512
        except FileNotFoundError:
            continue
    return total


def disk(program: Path, folder: Path) -> None:
    """The largest size of a ring that is left by bytes, over its budget."""
    with tempfile.TemporaryDirectory(dir=folder) as place:
        ring = {"TPC_RING": "60", "TPC_RING_BUDGET": str(BUDGET_MIB)}
        process = counted(program, Path(place), 1, **ring)
        most, until = 0, time.monotonic() + FILL_S
        while time.monotonic() < until:
            most = max(most, size_of(Path(place) / "tpc"))
            time.sleep(0.001)
        last = max(int(path.stem[-4:]) for path in (Path(place) / "tpc").glob("*.tpc"))
        process.kill()
        process.communicate()
    print(f"{last} files in {FILL_S} s, of which {BUDGET_MIB} MiB are kept")
    share = most / (BUDGET_MIB << 20)
    figure("ring", "bytes on the disk", share, unit="of the budget", target="<=1", hit=share <= 1)


def kills(program: Path, folder: Path) -> None:
    """Reports that were counted and are in no file, over all kills."""
    lost = total = 0
    for seed in range(KILLS):
        with tempfile.TemporaryDirectory(dir=folder) as place:
            process = counted(program, Path(place), 100)
            time.sleep(random.Random(seed).uniform(0.3, 1.2))
            process.send_signal(signal.SIGKILL)
            process.communicate()
            done = struct.unpack_from("<2Q", (Path(place) / "counts").read_bytes())
            events = read(sorted((Path(place) / "tpc").glob("*.tpc"))).events
            for thread, count in enumerate(done):
                numbers = events.cmp[events.thresh == thread].tolist()
                total += count
                lost += count - len(set(numbers) & set(map(float, range(count))))
    print(f"{KILLS} kills, {total:,} reports")
    figure("ring", "reports lost by kill -9", lost, unit="reports", target="0", hit=not lost)


def main() -> None:
    """Print the figures."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        cost(built(folder, ROOT / "benchmarks/runtime/Ring.cpp"), folder)
        drive = built(folder, ROOT / "tests/runtime/drive.cpp")
        disk(drive, folder)
        kills(drive, folder)


if __name__ == "__main__":
    main()
