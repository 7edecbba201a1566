"""The binary file of Python nodes, read by the common reader of binary files."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from patience import PATIENCE_S
from pytpc.ingest.reading import read
from pytpc.recording.mission import Recording

ROOT = Path(__file__).parents[2]
PRELUDE = """\
import os, sys, threading, time
sys.path.insert(0, {root!r})
from pytpc.python_runtime.find import ListedPlace
from pytpc.python_runtime.listed import Listed
from pytpc.python_runtime.runtime import RUNTIME
from pytpc.python_runtime.sites import ComparisonSite
def site(key, operator="Gt"):
    listed = Listed(key, ">", 1, 1, None, None, None, "right", None)
    return ComparisonSite(operator, (RUNTIME.register(ListedPlace(listed, False)),))
def over(site, a, b):
    return site.compare(a, b).__next__()
"""


def run(folder: Path, program: str, **env: str) -> subprocess.CompletedProcess[str]:
    """Run a program with the runtime, whose files are in ``folder``."""
    text = PRELUDE.format(root=str(ROOT)) + textwrap.dedent(program)
    settings = {"TPC_SINK": "file", "TPC_FOLDER": str(folder), "TPC_FILE_RESERVE": "0", **env}
    return subprocess.run(
        [sys.executable, "-c", text],
        env={**os.environ, **settings},
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )


def files(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.tpc"))


def recording(folder: Path) -> Recording:
    return read(files(folder))


def rows(folder: Path) -> list[tuple[str, bool, float, float]]:
    """Key, result, cmp and thresh of all reports in order."""
    events = recording(folder).events
    keys = [events.keys[code] for code in events.key]
    columns = (events.result.tolist(), events.cmp.tolist(), events.thresh.tolist())
    return list(zip(keys, *columns, strict=True))


@pytest.mark.usefixtures("python")
def test_reports_are_read_by_ingest(tmp_path):
    done = run(
        tmp_path,
        """
        one, two = site("one"), site("two")
        over(one, 1.5, 2)
        over(two, 3, 2)
        over(one, 4, 2)
        """,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    found = recording(tmp_path)
    assert rows(tmp_path) == [
        ("one", False, 1.5, 2.0),
        ("two", True, 3.0, 2.0),
        ("one", True, 4.0, 2.0),
    ]
    assert (found.malformed, found.lost, found.notes, found.dropped) == (0, {}, (), ())
    # A header, a chunk of the system and one of the thread: what was not used was given back.
    assert files(tmp_path)[0].stat().st_size == 4096 + 2 * 65536


@pytest.mark.usefixtures("python")
def test_nothing_is_lost_by_kill_9(tmp_path):
    done = run(
        tmp_path,
        """
        one = site("one")
        for number in range(5000):
            over(one, number, 2500)
        os.kill(os.getpid(), 9)
        """,
    )
    assert done.returncode == -signal.SIGKILL
    found = rows(tmp_path)
    assert [cmp for _, _, cmp, _ in found] == list(range(5000))
    # 0 to 2500 are not above 2500.
    assert sum(result for _, result, _, _ in found) == 2499


@pytest.mark.usefixtures("python")
def test_each_thread_has_its_reports_in_order(tmp_path):
    run(
        tmp_path,
        """
        sites = [site(f"thread {number}") for number in range(8)]
        def work(number):
            for value in range(3000):
                over(sites[number], value, 0)
        threads = [threading.Thread(target=work, args=(number,)) for number in range(8)]
        for thread in threads: thread.start()
        for thread in threads: thread.join()
        """,
    )
    found = rows(tmp_path)
    assert len(found) == 8 * 3000
    for number in range(8):
        values = [cmp for key, _, cmp, _ in found if key == f"thread {number}"]
        assert values == list(range(3000))


@pytest.mark.usefixtures("python")
def test_threads_that_follow_one_another_share_a_place(tmp_path):
    run(
        tmp_path,
        """
        one = site("one")
        for number in range(50):
            thread = threading.Thread(target=over, args=(one, number, 0))
            thread.start(); thread.join()
        """,
    )
    assert len(rows(tmp_path)) == 50
    # The system's chunk, and fewer than one for each thread: 50 chunks would be 3 MB.
    assert files(tmp_path)[0].stat().st_size <= 4096 + 4 * 65536


@pytest.mark.usefixtures("python")
def test_a_child_after_a_fork_has_a_file_of_its_own(tmp_path):
    run(
        tmp_path,
        """
        one = site("one")
        over(one, 1, 0)
        child = os.fork()
        over(one, 10 if child else 20, 0)
        if not child:
            RUNTIME.end()
            os._exit(0)
        os.waitpid(child, 0)
        over(one, 11, 0)
        """,
    )
    assert len(files(tmp_path)) == 2
    by_file = [
        [cmp for *_, cmp in zip(*[read([path]).events.cmp.tolist()], strict=True)]
        for path in files(tmp_path)
    ]
    assert sorted(by_file) == [[1.0, 10.0, 11.0], [20.0]]


@pytest.mark.usefixtures("python")
def test_a_report_within_a_report_by_a_signal(tmp_path):
    done = run(
        tmp_path,
        """
        import signal
        one, two = site("one"), site("two")
        signal.signal(signal.SIGALRM, lambda *_: over(two, 1, 0))
        signal.setitimer(signal.ITIMER_REAL, 0.0005, 0.0005)
        for number in range(100000):
            over(one, number, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        """,
    )
    assert done.returncode == 0, done.stderr
    found = rows(tmp_path)
    assert [cmp for key, _, cmp, _ in found if key == "one"] == list(range(100000))
    assert any(key == "two" for key, *_ in found)
    assert recording(tmp_path).malformed == 0


@pytest.mark.usefixtures("python")
def test_a_pause_while_both_clocks_are_read_changes_no_times(tmp_path):
    done = run(
        tmp_path,
        """
        from pytpc.python_runtime import log_file
        one, real, calls = site("one"), log_file.time_ns, []
        def late():
            calls.append(1)
            if len(calls) % 5 == 0:
                time.sleep(0.02)
            return real()
        over(one, 0, 0)
        log_file.time_ns = late
        for number in range(1, 30):
            RUNTIME.file._sync_at = RUNTIME.file._look_at = 0
            over(one, number, 0)
        """,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert [cmp for _, _, cmp, _ in rows(tmp_path)] == list(range(30))


@pytest.mark.usefixtures("python")
def test_a_limit_stops_the_recording_and_not_the_program(tmp_path):
    # 1 MiB has room for 16 chunks; one is the system's, so 15 of 2046 reports fit.
    done = run(
        tmp_path,
        """
        one = site("one")
        for number in range(40000):
            over(one, number, 0)
        print("went on")
        """,
        TPC_FILE_LIMIT="2",
    )
    assert done.stdout == "went on\n"
    assert "TPC_FILE_LIMIT" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    found = recording(tmp_path)
    assert len(found.events.cmp) == 15 * 2046
    assert [(drop.count, drop.why) for drop in found.dropped] == [(40000 - 15 * 2046, "stopped")]


@pytest.mark.usefixtures("python")
def test_a_folder_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    done = run(tmp_path / "file" / "x", 'over(site("one"), 1, 0)\nprint("went on")')
    assert done.stdout == "went on\n"
    assert "no reports are written" in done.stderr


@pytest.mark.usefixtures("python")
def test_edges_keeps_flops_and_summaries(tmp_path):
    run(
        tmp_path,
        """
        one = site("one")
        for number in (1, 2, 5, 6, 2, float("nan")):
            over(one, number, 3)
        """,
        TPC_POLICY="edges",
        TPC_PERIOD="3600",
    )
    found = recording(tmp_path)
    # False, false, true, true, false, false: the first, and two flops.
    assert [cmp for _, _, cmp, _ in rows(tmp_path)] == [1.0, 5.0, 2.0]
    ((count, flops, odd, far),) = zip(
        *(getattr(found.summaries, name).tolist() for name in ("count", "flops", "odd", "far")),
        strict=True,
    )
    assert (count, flops, odd, far) == (6, 2, 1, 5)
    # cmp - 3: -2, -1, 2, 3, -1; their sum is 1, of their sizes 9, over 5 of them.
    assert found.summaries.diff_min.tolist() == [-2.0]
    assert found.summaries.diff_max.tolist() == [3.0]
    assert found.summaries.diff_mean.tolist() == [pytest.approx(0.2)]
    assert found.summaries.abs_mean.tolist() == [pytest.approx(1.8)]
    assert (found.summaries.low.tolist(), found.summaries.high.tolist()) == ([1.0], [6.0])


@pytest.mark.usefixtures("python")
def test_edges_lose_nothing_by_kill_9(tmp_path):
    run(
        tmp_path,
        """
        one = site("one")
        for number in (1, 2, 5):
            over(one, number, 3)
        os.kill(os.getpid(), 9)
        """,
        TPC_POLICY="edges",
        TPC_PERIOD="3600",
    )
    found = recording(tmp_path)
    assert found.summaries.count.tolist() == [3]
    assert found.summaries.flops.tolist() == [1]


@pytest.mark.usefixtures("python")
def test_edges_killed_in_the_middle_of_a_summary(tmp_path):
    run(
        tmp_path,
        """
        one = site("one")
        over(one, 1, 3)
        (kept,) = RUNTIME._edges._open.values()
        class Bytes:
            # Struct's `pack_into` asks for a buffer, and a slice is the summary itself.
            def __init__(self, real): self.real = real
            def __setitem__(self, at, raw):
                self.real[at] = raw
                os.kill(os.getpid(), 9)
        import struct
        from pytpc.python_runtime import sinks
        real = kept.slot._bytes
        sinks.struct = type("", (), {"pack_into": staticmethod(
            lambda form, where, at, value: struct.pack_into(form, real, at, value))})
        kept.slot._bytes = Bytes(real)
        over(one, 2, 3)
        """,
        TPC_POLICY="edges",
        TPC_PERIOD="3600",
    )
    found = recording(tmp_path)
    assert found.malformed == 0
    assert found.summaries.count.tolist() == [2]
    # 1 - 3 and 2 - 3.
    assert found.summaries.diff_mean.tolist() == [-1.5]


@pytest.mark.usefixtures("python")
def test_caps_count_what_they_drop(tmp_path):
    run(
        tmp_path,
        """
        one = site("one")
        # In the begin of a second, so that all are in the same.
        while time.monotonic() % 1 > 0.3: time.sleep(0.01)
        for number in (5, 5, 1, 1, 5):
            over(one, number, 3)
        """,
        TPC_SITE_CAP="2",
    )
    found = recording(tmp_path)
    assert len(found.events.cmp) == 2
    # Three are too many, and two of them are flops.
    assert [(d.key, d.count, d.flops, d.why) for d in found.dropped] == [("one", 3, 2, "site")]


@pytest.mark.usefixtures("python")
def test_a_wrong_setting_is_said_and_left_out(tmp_path):
    done = run(tmp_path, 'over(site("one"), 1, 0)', TPC_POLICY="sometimes")
    warning = "tpc: TPC_POLICY=sometimes is ignored: it must be one of every, edges, light\n"
    assert done.stderr == warning
    assert len(rows(tmp_path)) == 1


@pytest.mark.usefixtures("python")
def test_off_writes_nothing(tmp_path):
    done = run(tmp_path, 'print(over(site("one"), 1, 0))', TPC_SINK="off")
    assert done.stdout == "True\n"
    assert files(tmp_path) == []
