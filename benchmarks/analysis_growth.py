"""How the time and memory of the analysis grow with the link unit, over two orders of magnitude.

Each unit is generated (``large_units``), compiled once, and then goes through ``opt`` with the
whole pass and, for what reading and verifying the bitcode costs anyway, without it.
"""

from __future__ import annotations

import math
import os
import resource
import statistics
import subprocess
import tempfile
from pathlib import Path

from figures import figure
from large_units import large_unit

from pytpc.base.paths import defer_plugin, plugin

STUB = Path(__file__).resolve().parents[1] / "tests" / "lit" / "Inputs" / "include"
SIZES = (200, 2_000, 20_000)
ROUNDS = 3
FLAGS = ("-std=c++17", "-g", "-O2", "-flto=full", f"-fpass-plugin={defer_plugin()}")


def compiled(functions: int, folder: Path) -> Path:
    """The bitcode of a unit of that many functions."""
    source, bitcode = folder / f"{functions}.cpp", folder / f"{functions}.bc"
    source.write_text(large_unit(functions), encoding="utf-8")
    command = ["clang++-19", *FLAGS, "-isystem", str(STUB), "-c", str(source), "-o", str(bitcode)]
    subprocess.run(command, check=True)
    return bitcode


def cost(arguments: list[str]) -> tuple[float, float]:
    """CPU seconds and MiB at most of one run of opt."""
    process = subprocess.Popen(["opt-19", "-disable-output", *arguments])
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise subprocess.CalledProcessError(status, "opt-19")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main() -> None:
    """Prints seconds and memory of the largest unit, and how much worse than n log n it grows."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    library = str(plugin())
    passes = [f"-load={library}", f"-load-pass-plugin={library}", f"-tpc-exclude={STUB}"]
    seconds, memory = {}, {}
    with tempfile.TemporaryDirectory() as scratch:
        for size in SIZES:
            bitcode = str(compiled(size, Path(scratch)))
            found = f"-tpc-static-info={Path(scratch) / 'found.json'}"
            runs = [cost([*passes, "-passes=tpc", found, bitcode]) for _ in range(ROUNDS)]
            plain = [cost(["-passes=verify", bitcode]) for _ in range(ROUNDS)]
            seconds[size] = statistics.median(r[0] for r in runs) - statistics.median(
                r[0] for r in plain
            )
            memory[size] = statistics.median(r[1] for r in runs)
    smallest, _, largest = SIZES
    growth = seconds[largest] / seconds[smallest]
    expected = largest * math.log(largest) / (smallest * math.log(smallest))
    topic = "analysis-cost"
    for name, value, unit, target in (
        ("cpu_of_20000_functions", seconds[largest], "s", 5.0),
        ("memory_of_20000_functions", memory[largest], "MiB", 2048.0),
        ("growth_over_n_log_n_200_to_20000", growth / expected, "ratio", 1.0),
    ):
        figure(topic, name, value, unit=unit, target=f"<={target:g}", hit=value <= target)


if __name__ == "__main__":
    main()
