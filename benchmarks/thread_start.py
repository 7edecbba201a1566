"""How long the first evaluations of one of a thousand threads take that begin at once.

The program (tests/runtime/drive.cpp) runs outside of ROS; each thread evaluates the same eight
comparisons once. The figure is the slowest thread of a run, the median of the rounds; the policies
take turns. The program has real-time priority where the user may, so that it waits for no other.
With far more threads than processors much of a figure is the wait for a processor, so what counts
is the difference from `off`. Under `every` each thread begins 64 KiB of the file, 64 MB in all.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from figures import figure

from pytpc.base.paths import project_root

TESTS = project_root() / "tests" / "runtime"
sys.path.append(str(TESTS))
from compiling import compile_program  # noqa: E402

WAYS = {
    "off": {"TPC_SINK": "off"},
    "every": {"TPC_SINK": "file", "TPC_POLICY": "every"},
    "edges": {"TPC_SINK": "file", "TPC_POLICY": "edges"},
    "light": {"TPC_SINK": "file", "TPC_POLICY": "light"},
    "auto": {"TPC_SINK": "auto"},
}
THREADS, SITES, ROUNDS = 1000, 8, 9
MOST_MS = 500.0


def hurry() -> None:
    """Give this process real-time priority, if that is allowed."""
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))


def longest_ms(program: Path, settings: dict[str, str], folder: Path) -> float:
    """The slowest thread of one run; on standard output there is nothing but its time."""
    kept = {name: text for name, text in os.environ.items() if not name.startswith("TPC_")}
    ran = subprocess.run(
        [str(program), "together", str(THREADS), str(SITES)],
        env={**kept, **settings, "TPC_FOLDER": str(folder)},
        capture_output=True,
        text=True,
        check=True,
        preexec_fn=hurry,
    )
    for path in folder.glob("*.tpc"):
        path.unlink()
    return float(ran.stdout)


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    rounds = parser.parse_args().rounds
    with tempfile.TemporaryDirectory(prefix="tpc-") as name:
        folder = Path(name)
        program = compile_program(TESTS / "drive.cpp", folder / "drive")
        took: dict[str, list[float]] = {way: [] for way in WAYS}
        for _ in range(rounds):
            for way, settings in WAYS.items():
                took[way].append(longest_ms(program, settings, folder))
    off = statistics.median(took["off"])
    figure("thread-start", "off", off, unit="ms", target="none", hit=True)
    for way in [each for each in WAYS if each != "off"]:
        more = statistics.median(took[way]) - off
        target = f"<={MOST_MS:g}"
        figure("thread-start", f"{way}-more", more, unit="ms", target=target, hit=more <= MOST_MS)
        longest = max(took[way])
        figure("thread-start", f"{way}-longest", longest, unit="ms", target="none", hit=True)


if __name__ == "__main__":
    main()
