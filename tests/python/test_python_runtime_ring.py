"""The ring of Python nodes: the last minutes in several files, read by the common reader."""

from __future__ import annotations

import random
import signal
import subprocess
import textwrap
from pathlib import Path

import pytest
from test_python_runtime_file import files, recording, rows
from test_python_runtime_file import run as run_plainly

from pytpc.ingest.binary_chunks import FileHeader
from pytpc.ingest.reading import read

# 3 s, so a file has 0.375 s.
SHORT = {"TPC_RING": "0.05"}
# A file is left when it has 8 MiB, which is 260,000 reports.
BYTES = {"TPC_RING": "10", "TPC_RING_BUDGET": "64"}
# A file is left when it has 1 MiB, which is 32,000 reports.
SMALL = {"TPC_RING": "10", "TPC_RING_BUDGET": "4"}
# Goes on until the process writes its file with this number.
TURNED = """\
def turned(count):
    until = time.monotonic() + 600
    while RUNTIME.file is None or RUNTIME.file._segment < count:
        assert time.monotonic() < until
        yield
"""


def run(folder: Path, program: str, **env: str) -> subprocess.CompletedProcess[str]:
    return run_plainly(folder, TURNED + textwrap.dedent(program), **env)


def headers(folder: Path) -> list[FileHeader]:
    return [FileHeader.of(path.read_bytes()[:4096]) for path in files(folder)]


@pytest.mark.parametrize("seed", range(4))
def test_killed_while_it_turns(tmp_path, seed):
    """Every report up to the kill is in the files, in order; the kill is in one of four turns.

    Where the machine is so slow that the first file was removed, those from the second one on.
    """
    last = random.Random(seed).randrange(2, 6)
    done = run(
        tmp_path,
        f"""
        one = site("one")
        count = 0
        for _ in turned({last}):
            over(one, count, 0)
            count += 1
        print(count, flush=True)
        os.kill(os.getpid(), 9)
        """,
        **(BYTES if seed % 2 else SHORT),
    )
    assert done.returncode == -signal.SIGKILL, done.stderr
    assert len(files(tmp_path)) >= 2
    numbers = [int(cmp) for _, _, cmp, _ in rows(tmp_path)]
    assert numbers == list(range(numbers[0], int(done.stdout)))
    if headers(tmp_path)[0].segment == 1:
        assert numbers[0] == 0
    found = recording(tmp_path)
    assert (found.malformed, found.lost, found.dropped) == (0, {}, ())


def test_within_the_budget_of_bytes(tmp_path):
    """4 MiB, and what one file grows by while the thread of the ring waits for the processor."""
    done = run(
        tmp_path,
        """
        one = site("one")
        most = 0
        folder = os.environ["TPC_FOLDER"]
        for _ in turned(8):
            for number in range(1000):
                over(one, number, 0)
            time.sleep(0.002)
            sizes = []
            for name in os.listdir(folder):
                try:
                    sizes.append(os.stat(os.path.join(folder, name)).st_size)
                except FileNotFoundError:
                    pass
            most = max(most, sum(sizes))
        print(most)
        """,
        **SMALL,
    )
    assert done.stderr == ""
    assert 1 << 20 < int(done.stdout) <= 5 << 20
    assert len(files(tmp_path)) <= 4
    # Nothing is lost between the files that stay.
    found = recording(tmp_path)
    assert (found.lost, found.dropped) == ({}, ())
    segments = [head.segment for head in headers(tmp_path)]
    assert segments == list(range(segments[0], segments[0] + len(segments)))


def test_memory_of_old_files_is_given_back(tmp_path):
    """A file whose name is gone is not mapped any more, or it would still take the disk."""
    done = run(
        tmp_path,
        """
        import gc
        gc.disable()
        one, idle = site("one"), site("idle")
        over(idle, 1, 2)
        for _ in turned(9):
            for number in range(1000):
                over(one, number, 0)
            time.sleep(0.002)
        until = time.monotonic() + 600
        def gone():
            with open("/proc/self/maps") as maps:
                lines = [line.split() for line in maps if "(deleted)" in line and ".tpc" in line]
            return len(set(line[4] for line in lines))
        while gone() > 2:
            assert time.monotonic() < until, "they stay mapped"
            time.sleep(0.05)
        """,
        **SMALL,
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("policy", ["edges", "light"])
def test_what_the_last_file_says_alone(tmp_path, policy):
    """It says what held before: ``turns`` was true (3 > 2), and is false at the end (1 > 2)."""
    done = run(
        tmp_path,
        """
        steady, turns = site("steady"), site("turns")
        over(turns, 3, 2)
        count = 0
        for _ in turned(4):
            over(steady, 5, 1)
            count += 1
            time.sleep(0.002)
        over(turns, 1, 2)
        print(count)
        """,
        TPC_POLICY=policy,
        **SHORT,
    )
    assert done.stderr == ""
    parts = [read([path]) for path in files(tmp_path)]
    last = parts[-1].events
    reports = sorted(
        (last.keys[key], bool(result), float(cmp), float(thresh))
        for key, result, cmp, thresh in zip(
            last.key, last.result, last.cmp, last.thresh, strict=True
        )
    )
    # The thread may turn once more before the last evaluation; then nothing is said of ``steady``.
    assert [one for one in reports if one[0] == "turns"] == [
        ("turns", False, 1.0, 2.0),
        ("turns", True, 3.0, 2.0),
    ]
    assert {one for one in reports if one[0] == "steady"} <= {("steady", True, 5.0, 1.0)}
    whole = recording(tmp_path)
    found = whole.events
    of_turns = [
        bool(result)
        for key, result in zip(found.key, found.result, strict=True)
        if found.keys[key] == "turns"
    ]
    assert of_turns[-1] is False
    assert of_turns.count(False) == 1
    table = whole.summaries
    counts = {
        key: sum(
            int(count)
            for code, count in zip(table.key, table.count, strict=True)
            if table.keys[code] == key
        )
        for key in table.keys
    }
    assert counts == {"steady": int(done.stdout), "turns": 2}
    assert sum(int(one) for one in table.flops) == 1


def test_beside_the_default_sink(tmp_path):
    """A program without ROS reports nowhere, but to its ring, with the policy of its sink."""
    done = run(
        tmp_path,
        """
        one = site("one")
        for _ in turned(3):
            over(one, 5, 1)
            time.sleep(0.002)
        print(RUNTIME.status())
        """,
        TPC_SINK="auto",
        **SHORT,
    )
    assert done.stderr == ""
    assert "sink=auto policy=light" in done.stdout
    assert "ring=0.05 ring_files=" in done.stdout
    assert f"ring_folder={tmp_path}" in done.stdout
    found = recording(tmp_path)
    assert len(found.events) >= 1
    assert len(found.summaries) >= 1


def test_a_fork_has_a_ring_of_its_own(tmp_path):
    done = run(
        tmp_path,
        """
        one = site("one")
        over(one, 1, 2)
        child = os.fork()
        for _ in turned(3):
            over(one, 1, 2)
            time.sleep(0.001)
        if child:
            assert os.waitpid(child, 0)[1] == 0
            print(child, os.getpid())
        """,
        **SHORT,
    )
    assert done.stderr == ""
    assert {head.pid for head in headers(tmp_path)} == {int(one) for one in done.stdout.split()}


def test_only_its_own_files_are_removed(tmp_path):
    """Another file under the name of an old one stays."""
    done = run(
        tmp_path,
        """
        one = site("one")
        def work(count):
            for _ in turned(count):
                over(one, 1, 2)
                time.sleep(0.002)
        work(2)
        first = next(name for name in os.listdir(os.environ["TPC_FOLDER"]) if "-0001." in name)
        path = os.path.join(os.environ["TPC_FOLDER"], first)
        os.unlink(path)
        with open(path, "w") as other:
            other.write("mine")
        work(15)
        """,
        **SHORT,
    )
    assert done.stderr == ""
    assert files(tmp_path)[0].read_text() == "mine"
    assert not list(tmp_path.glob("*-0002.tpc"))


def test_a_folder_that_cannot_be_written(tmp_path):
    """It is said once, and the program goes on."""
    (tmp_path / "file").write_text("")
    done = run(
        tmp_path / "file",
        """
        one = site("one")
        for _ in range(300):
            over(one, 1, 2)
            time.sleep(0.001)
        """,
        TPC_SINK="auto",
        **SHORT,
    )
    assert done.returncode == 0
    assert done.stderr.count("the ring stops until a file can be written") == 1
    assert len(done.stderr.splitlines()) == 1


def test_a_folder_that_can_be_written_later(tmp_path):
    """The ring begins then; the comparison is not reported again as if it were a new one."""
    (tmp_path / "file").write_text("")
    done = run(
        tmp_path / "file",
        """
        import pytpc.python_runtime.ring as ring
        ring._AGAIN_NS = 1
        one = site("one")
        for _ in range(300):
            over(one, 1, 2)
            time.sleep(0.001)
        policy = RUNTIME._edges
        os.unlink(os.environ["TPC_FOLDER"])
        while RUNTIME.file is None:
            assert RUNTIME._edges is policy or RUNTIME.file
            time.sleep(0.001)
        for _ in turned(2):
            over(one, 1, 2)
            time.sleep(0.001)
        """,
        TPC_SINK="auto",
        **SHORT,
    )
    assert done.returncode == 0, done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert len(files(tmp_path / "file")) >= 2


@pytest.mark.parametrize(
    ("name", "text", "why"),
    [
        ("ring", "-1", "it must be a number of minutes, 0 or from 0.05 to 10080"),
        ("ring", "many", "it must be a number of minutes, 0 or from 0.05 to 10080"),
        ("ring_budget", "3", "it must be a whole number of MiB from 4"),
    ],
)
def test_settings_that_are_none(tmp_path, name, text, why):
    done = run(tmp_path, 'over(site("one"), 1, 2)', **{f"TPC_{name.upper()}": text})
    assert done.stderr.splitlines() == [f"tpc: TPC_{name.upper()}={text} is ignored: {why}"]
    assert len(files(tmp_path)) == 1
