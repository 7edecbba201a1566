"""A program is killed at random moments while it reports: what was complete is in the file.

The program counts its reports beside the library, in a mapped file of its own, each when log_one
has returned. 200 kills and more: ``pytest -m slow tests/runtime/test_killed.py``.
"""

from __future__ import annotations

import random
import signal
import struct
import subprocess
import time
from pathlib import Path

import log_file
import pytest
from test_file import report

RUNS = 12


def killed_run(
    program: Path, settings: dict[str, str], folder: Path, *, threads: int, pause_us: int, s: float
) -> tuple[log_file.LogFile, list[int]]:
    """Start, kill after a while; the file, and how many reports each thread had made."""
    folder.mkdir()
    counts = folder / "counts"
    process = subprocess.Popen(
        [str(program), "counted", str(counts), str(threads), "20", str(pause_us)],
        env={**settings, "TPC_FOLDER": str(folder)},
        stdout=subprocess.PIPE,
    )
    try:
        assert process.stdout is not None
        process.stdout.readline()
        time.sleep(s)
    finally:
        process.send_signal(signal.SIGKILL)
        process.communicate()
    done = struct.unpack_from(f"<{threads}Q", counts.read_bytes())
    paths = list(folder.glob("*.tpc"))
    if not paths:
        # It was killed before its first report.
        assert sum(done) == 0
        return log_file.LogFile(0, "", 0, 0), list(done)
    file = log_file.read(paths[0])
    paths[0].unlink()
    return file, list(done)


def check_every(file: log_file.LogFile, done: list[int]) -> int:
    """All that was reported is there, in order; returns how many that is."""
    found: dict[float, list[tuple]] = {}
    for reports in file.reports.values():
        for _steady, _site, *rest, _edge in reports:
            found.setdefault(rest[-1], []).append(tuple(rest))
    for thread, count in enumerate(done):
        mine = found.get(float(thread), [])
        # The kill may have come between the record and the count.
        assert count <= len(mine) <= count + 1
        assert mine == [report(n, thread) for n in range(len(mine))]
    assert file.torn <= len(done)
    assert file.state == 0
    return sum(done)


def check_edges(file: log_file.LogFile, done: list[int]) -> int:
    """The summaries have all evaluations, those of the open period as well."""
    total = sum(summary["count"] for summary in file.all_summaries)
    assert sum(done) <= total <= sum(done) + len(done)
    return sum(done)


def kill(program, settings, tmp_path, seed: int) -> int:
    randomly = random.Random(seed)
    policy = randomly.choice(["every", "every", "edges"])
    threads = randomly.choice([1, 2, 4])
    pause_us = randomly.choice([0, 0, 50, 1000])
    file, done = killed_run(
        program,
        {**settings, "TPC_POLICY": policy, "TPC_PERIOD": "0.01"},
        tmp_path / str(seed),
        threads=threads,
        pause_us=pause_us,
        s=randomly.uniform(0, 0.06),
    )
    return (check_edges if policy == "edges" else check_every)(file, done)


def test_nothing_is_lost(program, settings, tmp_path):
    reports = [kill(program, settings, tmp_path, seed) for seed in range(RUNS)]
    assert any(reports), "each was killed before its first report"


@pytest.mark.slow
def test_nothing_is_lost_in_three_hundred_kills(program, settings, tmp_path):
    total = sum(kill(program, settings, tmp_path, seed) for seed in range(1000, 1300))
    assert total > 0
    print(f"300 kills, {total:,} reports, none lost")
