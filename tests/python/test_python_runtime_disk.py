"""The binary file of Python nodes on a full disk, and written by several threads."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from test_python_runtime_file import PRELUDE, ROOT, recording, rows, run

MANY = """
one = site("one")
for number in range(300_000):
    over(one, number, 0)
print("went on")
"""
# Each thread has a key of its own, and one with all others.
THREADS = """
def each(number):
    own, common = site(f"own {number}"), site("common")
    for turn in range(2000):
        value = turn * (2 * number + 1) % 8
        over(own, value, 3.5 - number)
        over(common, value, 3.5)
threads = [threading.Thread(target=each, args=(number,)) for number in range(3)]
for thread in threads: thread.start()
for thread in threads: thread.join()
"""


def on_a_disk(tmp_path: Path, options: str) -> tuple[subprocess.CompletedProcess[str], Path]:
    """Run `MANY` with its folder on a file system of its own, and copy what it wrote."""
    disk, copy = tmp_path / "disk", tmp_path / "copy"
    disk.mkdir()
    copy.mkdir()
    mounts = ["unshare", "-m"] if os.geteuid() == 0 else ["unshare", "-rm"]
    can = shutil.which("unshare") and not subprocess.run([*mounts, "true"], check=False).returncode
    if not can:
        pytest.skip("no file system can be mounted here")
    program = tmp_path / "program.py"
    program.write_text(PRELUDE.format(root=str(ROOT)) + MANY)
    shell = (
        f"mount -t tmpfs -o {options} none {disk} && {sys.executable} {program}; status=$?;"
        f" cp {disk}/* {copy} 2> /dev/null; exit $status"
    )
    done = subprocess.run(
        [*mounts, "/bin/sh", "-c", shell],
        env={**os.environ, "TPC_SINK": "file", "TPC_FOLDER": str(disk), "TPC_FILE_RESERVE": "0"},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    return done, copy


def test_a_full_disk(tmp_path: Path) -> None:
    done, copy = on_a_disk(tmp_path, "size=5m")
    assert (done.returncode, done.stdout) == (0, "went on\n")
    assert "No space left on device" in done.stderr
    assert done.stderr.count("\n") == 1
    found = recording(copy)
    # The header's page, extents of 1, 1 and 2 MiB: 64 chunks of 64 KiB, and one is the system's.
    # The next extent of 4 MiB finds no room.
    assert len(found.events.cmp) == 63 * 2046
    assert found.events.cmp[-1] == 63 * 2046 - 1
    assert [(drop.count, drop.why) for drop in found.dropped] == [(300_000 - 63 * 2046, "stopped")]


def test_a_disk_that_is_full_from_the_start(tmp_path: Path) -> None:
    done, copy = on_a_disk(tmp_path, "size=64k")
    assert (done.returncode, done.stdout) == (0, "went on\n")
    assert "No space left on device; no reports are written to a file" in done.stderr
    assert done.stderr.count("\n") == 1
    # Nor is a part of a file left.
    assert list(copy.iterdir()) == []


def test_a_folder_that_may_only_be_read(tmp_path: Path) -> None:
    done, copy = on_a_disk(tmp_path, "ro")
    assert (done.returncode, done.stdout) == (0, "went on\n")
    assert "Read-only file system; no reports are written to a file" in done.stderr
    assert done.stderr.count("\n") == 1
    assert list(copy.iterdir()) == []


def test_threads_under_edges_and_every(tmp_path: Path) -> None:
    every, edges = tmp_path / "every", tmp_path / "edges"
    run(every, THREADS)
    run(edges, THREADS, TPC_POLICY="edges", TPC_PERIOD="3600")
    reported: dict[str, list[bool]] = {}
    for key, result, _, _ in rows(every):
        reported.setdefault(key, []).append(result)
    found = recording(edges)
    keys = [found.summaries.keys[code] for code in found.summaries.key]
    counts: dict[str, list[int]] = {}
    for key, count, flops in zip(keys, found.summaries.count, found.summaries.flops, strict=True):
        counts.setdefault(key, [0, 0])[0] += int(count)
        counts[key][1] += int(flops)
    for number in range(3):
        own = reported[f"own {number}"]
        flops = sum(now != last for last, now in pairwise(own))
        assert counts[f"own {number}"] == [2000, flops]
    # Of what all have in common the order is another in each run: what is kept are its edges, the
    # first and each flop, and one follows upon the other.
    common = [result for key, result, _, _ in rows(edges) if key == "common"]
    assert counts["common"] == [6000, len(common) - 1]
    assert all(now != last for last, now in pairwise(common))
    # Steps of 1, 3 and 5 modulo 8 meet 4, 5, 6 and 7 in half of all turns.
    assert sum(reported["common"]) == 3000
