"""How much is in the files of nodes, while they are written and afterwards."""

from __future__ import annotations

import os

from tpc_file import FULL, TpcFile, report, simulated, site, slot, summary

from pytpc.ingest.file_counts import FileCounter, FileCounts

KEY = "0a1b2c3d-0000-5000-8000-00000000000f"


# Two threads: a full chunk and three reports more; two reports between two times of a simulator.
# One summary that is written, and one whose period is open; an empty slot is none.
def test_reports_and_summaries_are_counted(tmp_path):
    file = TpcFile()
    file.system(site(1, KEY), summary(1))
    file.thread(1, *[report(1, number, 1.0, 2.0) for number in range(FULL)])
    file.thread(2, simulated(5, 1), report(1, 6, 1.0, 2.0), simulated(7, 2), report(1, 8, 1.0, 2.0))
    file.thread(1, *[report(1, FULL + number, 1.0, 2.0) for number in range(3)])
    file.live(slot(summary(1), 1), bytes(192))
    path = file.write(tmp_path / "a.tpc")
    (tmp_path / "b.tpc").write_bytes(b"no such file")
    counter = FileCounter(tmp_path)
    assert counter.count() == FileCounts(2, FULL + 3 + 2, 2)
    # A chunk more of a thread; those before it were counted.
    file.thread(1, report(1, 9000, 1.0, 2.0))
    file.write(path)
    assert counter.count() == FileCounts(2, FULL + 3 + 2 + 1, 2)
    assert FileCounter(tmp_path / "none").count() == FileCounts()


def test_older_files_are_left_out(tmp_path):
    path = TpcFile().write(tmp_path / "a.tpc")
    os.utime(path, ns=(5, 5))
    assert FileCounter(tmp_path, 6).count() == FileCounts()
    assert FileCounter(tmp_path, 5).count() == FileCounts(1)
