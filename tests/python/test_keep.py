"""``pytpc keep`` on folders: which files of rings are kept, and how."""

from __future__ import annotations

import io
import json
import os
import signal
import socket
import subprocess
import sys
import textwrap
import time
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner
from test_python_runtime_file import PRELUDE, ROOT

from patience import PATIENCE_S, wait_for
from pytpc.api import keeping
from pytpc.api.keeping import KeepOptions, Listening, keep
from pytpc.api.record import node_files
from pytpc.base.errors import InputError, RunError
from pytpc.cli.main import main
from pytpc.ingest.reading import read
from pytpc.ingest.ring_files import Now, copy_written, remove_ended, rings_in
from pytpc.python_runtime import log_layout as layout
from pytpc.ros.source import Source

S = 10**9
HERE = socket.gethostname()
# Nobody's: the largest number of a process is 2^22.
NOBODY = (1 << 22) + 1
KEY = b"00000001-0000-5000-8000-000000000001"


def segment(
    folder: Path,
    number: int,
    steady_s: float,
    *,
    real_s: float,
    last_s: float | None = None,
    pid: int = NOBODY,
    host: str = HERE,
    state: int = layout.CLOSED,
) -> Path:
    """A file of a ring that began at these times, and noted both clocks at ``last_s`` (steady)."""
    header = layout.HEADER.pack(
        layout.MAGIC,
        *(layout.HEADER_BYTES, layout.RECORD_BYTES, layout.CHUNK_BYTES, pid),
        *(round(steady_s * S), round(real_s * S), state, 0, 0, 0, number),
        *(b"/guard", host.encode(), b"/bin/guard"),
    )
    chunk = bytearray(layout.CHUNK_BYTES)
    layout.CHUNK.pack_into(chunk, 0, layout.SYSTEM_CHUNK, 0, 0)
    at = steady_s if last_s is None else last_s
    shift = real_s - steady_s
    layout.pack_integers(chunk, 68, 0, round(at * S), round((at + shift) * S), 0)
    chunk[64] = layout.SYNC
    path = folder / f"guard-{pid}-{int(real_s - steady_s)}-{number:04}.tpc"
    path.write_bytes(header.ljust(layout.HEADER_BYTES, b"\0") + chunk)
    return path


def now(steady_s: float, real_s: float) -> Now:
    return Now(round(real_s * S), round(steady_s * S), HERE)


def numbers(found) -> list[int]:
    return [one.header.segment for one in found.segments]


# --- which files have the last minutes


def test_the_last_minutes(tmp_path):
    """Files of 60 s each from 1000 s on; the last one was written until 1200 s, and it is 1210 s.

    The first ended 150 s ago, the second 90 s, the third 30 s (its process died then) or 10 s.
    """
    for number, begin in enumerate((1000, 1060, 1120), 1):
        last = 1200 if number == 3 else None
        segment(tmp_path, number, begin, real_s=50_000 + begin, last_s=last)
    found = rings_in(tmp_path, now(1210, 51_210))
    assert [round(one.ended_ago_ns / S) for one in found.segments] == [150, 90, 10]
    assert numbers(found.recent(None)) == [1, 2, 3]
    assert numbers(found.recent(2)) == [2, 3]
    assert numbers(found.recent(0.5)) == [3]
    assert numbers(found.recent(0.1)) == []
    assert found.processes == 1


def test_the_files_of_yesterday(tmp_path):
    """Without --minutes: the last run, and one that crashed 8 minutes before its end; not older.

    One of 60 s ended 5000 s ago; one of 60 s ended 490 s ago; the last one was written 10 s ago.
    """
    segment(tmp_path, 1, 1000, real_s=50_000, last_s=1060, pid=NOBODY)
    segment(tmp_path, 1, 5510, real_s=54_510, last_s=5570, pid=NOBODY + 1)
    segment(tmp_path, 1, 5990, real_s=54_990, last_s=6050, pid=NOBODY + 2)
    found = rings_in(tmp_path, now(6060, 55_060))
    assert [round(one.ended_ago_ns / S) for one in found.recent(None).segments] == [490, 10]
    assert len(found.recent(1000).segments) == 3
    # An hour after the last one ended, it is still the last one.
    found = rings_in(tmp_path, now(9650, 58_650))
    assert [round(one.ended_ago_ns / S) for one in found.recent(None).segments] == [4080, 3600]


def test_the_minutes_of_the_longest_ring(tmp_path):
    """One of 2000 s ended 1500 s ago, and runs again since 100 s."""
    segment(tmp_path, 1, 1000, real_s=50_000, pid=NOBODY)
    segment(tmp_path, 2, 2000, real_s=51_000, last_s=3000, pid=NOBODY)
    segment(tmp_path, 1, 4400, real_s=53_400, last_s=4500, pid=NOBODY + 1)
    found = rings_in(tmp_path, now(4500, 53_500)).recent(None)
    # The first ended 2500 s ago.
    assert [(one.header.pid - NOBODY, one.header.segment) for one in found.segments] == [
        (0, 2),
        (1, 1),
    ]


def test_a_clock_that_was_set_back(tmp_path):
    """By an hour, while the second file was written; the steady clock says how old they are."""
    segment(tmp_path, 1, 1000, real_s=50_000)
    path = segment(tmp_path, 2, 1100, real_s=50_100, last_s=1190)
    data = bytearray(path.read_bytes())
    layout.pack_integers(data, 4096 + 68, 0, 1190 * S, 46_590 * S, 0)
    path.write_bytes(data)
    found = rings_in(tmp_path, now(1200, 46_600))
    assert [round(one.ended_ago_ns / S) for one in found.segments] == [100, 10]
    # The last note of a file is the one that was written last, whatever the wall clock said.
    assert numbers(found.recent(1)) == [2]


def test_two_nodes_of_one_name(tmp_path):
    """Both write at the same time, and in containers of one host even under one number."""
    for number in (1, 2):
        segment(tmp_path, number, 1000, real_s=50_000, pid=NOBODY)
    for number in (3, 4):
        path = segment(tmp_path, number, 1000, real_s=50_000, pid=NOBODY)
        data = path.read_bytes().replace(b"/bin/guard", b"/bin/other")
        path.write_bytes(data)
    segment(tmp_path, 1, 1000, real_s=50_000, pid=NOBODY + 1)
    found = rings_in(tmp_path, now(1010, 50_010))
    assert found.processes == 3
    assert len(found.recent(1).segments) == 5


def test_a_clock_that_was_set_forward(tmp_path):
    """The clock said 1970 until the robot had a network: 1100 s of uptime are 1100 s of 1970."""
    segment(tmp_path, 1, 1000, real_s=1000)
    path = segment(tmp_path, 2, 1100, real_s=1100, last_s=1190)
    # From 1150 s on it is 2020: what was noted last says so.
    data = bytearray(path.read_bytes())
    real = 1_577_836_800
    layout.pack_integers(data, 4096 + 68, 0, 1190 * S, (real + 40) * S, 0)
    path.write_bytes(data)
    found = rings_in(tmp_path, now(1200, real + 50))
    assert [round(one.ended_ago_ns / S) for one in found.segments] == [100, 10]


def test_a_machine_that_was_started_again(tmp_path):
    """A file of 100 s of uptime; the machine was started an hour later, and is up for 120 s."""
    segment(tmp_path, 1, 80, real_s=50_080, last_s=100)
    (one,) = rings_in(tmp_path, now(120, 53_720)).segments
    assert round(one.ended_ago_ns / S) == 3620


def test_another_machine(tmp_path):
    """Its steady clock says nothing here."""
    segment(tmp_path, 1, 1190, real_s=50_000, last_s=1195, host="elsewhere")
    (one,) = rings_in(tmp_path, now(1200, 50_305)).segments
    assert round(one.ended_ago_ns / S) == 300


def test_what_is_no_ring(tmp_path):
    segment(tmp_path, 0, 1000, real_s=50_000)
    (tmp_path / "half.tpc").write_bytes(b"TPCLOG1\n")
    (tmp_path / "guard.tpc.new").write_bytes(b"")
    found = rings_in(tmp_path, now(1210, 50_210))
    assert (found.segments, found.others, found.broken) == ((), 1, ("half.tpc",))
    assert rings_in(tmp_path / "none").segments == ()


def test_two_processes_of_one_number(tmp_path):
    """Before and after the machine was started again; the order is by process."""
    segment(tmp_path, 1, 1000, real_s=50_000)
    segment(tmp_path, 2, 1060, real_s=50_060)
    segment(tmp_path, 1, 10, real_s=60_000)
    found = rings_in(tmp_path, now(70, 60_060))
    assert found.processes == 2
    assert sorted(round(one.ended_ago_ns / S) for one in found.segments) == [60, 10_000, 10_000]


def test_remove_ended(tmp_path):
    """Of processes that ended two hours ago and a minute ago, and of one that writes."""
    real, steady = time.time(), time.monotonic()
    old = segment(tmp_path, 1, steady - 7300, real_s=real - 7300, pid=NOBODY)
    late = segment(tmp_path, 1, steady - 300, real_s=real - 300, pid=NOBODY + 1)
    fresh = segment(tmp_path, 1, steady - 2, real_s=real - 2, pid=NOBODY + 2, state=layout.OPEN)
    other = tmp_path / "mission.tpc"
    other.write_bytes(b"no ring")
    assert remove_ended(tmp_path, 1)[0] == 1
    assert not old.exists()
    assert remove_ended(tmp_path, 0)[0] == 1
    assert not late.exists()
    assert fresh.exists()
    assert other.exists()


def test_remove_what_a_kill_left_unfinished(tmp_path):
    """A file that was being made an hour ago; not one of this moment, nor another's."""
    old = tmp_path / "guard-7-1000-0002.tpc.new"
    fresh = tmp_path / "guard-8-1000-0002.tpc.new"
    other = tmp_path / "mine.tpc.new"
    for path in (old, fresh, other):
        path.write_bytes(b"TPCLOG1")
    for path in (old, other):
        os.utime(path, (time.time() - 3600, time.time() - 3600))
    assert remove_ended(tmp_path, 2)[0] == 0
    assert remove_ended(tmp_path, 0)[0] == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == [fresh.name, other.name]


# --- keeping them


def test_keeping(tmp_path):
    """A closed file is linked; the recording is read like any other, and no half is left."""
    tpc = tmp_path / "tpc"
    run(tpc, "one = site('one')\nfor n in range(100): over(one, n, 50)")
    kept = keep(KeepOptions(tpc), tmp_path / "out/kept")
    assert (kept.files, kept.processes, kept.reports, kept.marks) == (1, 1, 100, 0)
    assert kept.missing == ("no marks and no values of parameters: no graph answers",)
    (file,) = (tmp_path / "out/kept/tpc").iterdir()
    assert file.stat().st_nlink == 2
    document = json.loads((tmp_path / "out/kept/run.json").read_text())
    assert (document["ended"], document["reports_in_files"]) == ("kept", 100)
    recording = read(tmp_path / "out/kept")
    assert recording.events.cmp.tolist() == list(range(100))
    assert [one.name for one in (tmp_path / "out").iterdir()] == ["kept"]
    assert sorted(one.name for one in (tmp_path / "out/kept").iterdir()) == ["run.json", "tpc"]


def test_a_name_that_is_taken(tmp_path):
    tpc = tmp_path / "tpc"
    run(tpc, "over(site('one'), 1, 2)")
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept/mine").write_text("")
    with pytest.raises(RunError, match="is there already; give another folder with -o"):
        keep(KeepOptions(tpc), tmp_path / "kept")
    assert [one.name for one in (tmp_path / "kept").iterdir()] == ["mine"]


def test_no_ring(tmp_path):
    with pytest.raises(InputError, match=r"no ring here; start the nodes with one"):
        keep(KeepOptions(tmp_path / "none"), tmp_path / "kept")
    run(tmp_path / "tpc", "over(site('one'), 1, 2)", TPC_RING="")
    with pytest.raises(InputError, match=r"1 file of reports of no ring; no ring here"):
        keep(KeepOptions(tmp_path / "tpc"), tmp_path / "kept")
    assert not (tmp_path / "kept").exists()


def test_files_of_no_ring_are_named(tmp_path):
    tpc = tmp_path / "tpc"
    run(tpc, "over(site('one'), 1, 2)", TPC_RING="")
    run(tpc, "over(site('one'), 1, 2)")
    kept = keep(KeepOptions(tpc), tmp_path / "kept")
    assert kept.files == 1
    assert kept.missing[1].startswith(f"1 file in {tpc} of no ring")


def test_record_does_not_ask_for_files_of_rings(tmp_path, monkeypatch):
    """What is in them came over the graph as well."""
    run(tmp_path, "over(site('one'), 1, 2)")
    monkeypatch.setenv("TPC_FOLDER", str(tmp_path))
    assert node_files(0).files == 0
    run(tmp_path, "over(site('one'), 1, 2)", TPC_RING="")
    assert node_files(0).files == 1


def test_while_it_is_written(tmp_path):
    """Ten recordings of a process that reports: all of one file after the other, none lost."""
    tpc = tmp_path / "tpc"
    process = started(
        tpc,
        """
        one, count = site("one"), 0
        while True:
            # A key that is new in nearly each moment.
            over(site("key %d" % (count // 50)), count, 0)
            over(one, count, 0)
            count += 1
            if count % 10 == 0:
                time.sleep(0.001)
        """,
    )
    try:
        wait_for(lambda: len(rings_in(tpc).segments) > 2)
        for number in range(10):
            kept = keep(KeepOptions(tpc), tmp_path / f"kept{number}")
            recording = read(kept.folder)
            assert (recording.malformed, recording.lost) == (0, {})
            events = recording.events
            of_one = events.cmp[events.key == events.keys.index("one")].tolist()
            assert of_one == list(range(int(of_one[0]), int(of_one[-1]) + 1))
            assert len(of_one) > 10
    finally:
        process.kill()
        process.communicate()


def test_a_copy_does_not_go_on(tmp_path):
    """The file that is written is copied; what is reported later is not in the recording."""
    tpc = tmp_path / "tpc"
    process = started(
        tpc,
        """
        one, count = site("one"), 0
        while True:
            over(one, count, 0)
            count += 1
            time.sleep(0.001)
        """,
        TPC_RING="60",
    )
    try:
        wait_for(lambda: len(rings_in(tpc).segments) == 1)
        (one,) = rings_in(tpc).segments
        assert one.is_written
        kept = keep(KeepOptions(tpc), tmp_path / "kept")
        (file,) = (kept.folder / "tpc").iterdir()
        assert file.stat().st_nlink == 1
        before = len(read(kept.folder).events)
        wait_for(lambda: len(read([one.path]).events) > before + 100)
        assert len(read(kept.folder).events) == before
    finally:
        process.send_signal(signal.SIGKILL)
        process.communicate()
    # The process is gone, and its last file is whole.
    later = keep(KeepOptions(tpc), tmp_path / "later")
    assert later.reports > before + 100


def test_the_copy_has_the_chunks_of_one_moment(tmp_path):
    """While it copies the first chunk, the process begins two more, of a thread and of the system.

    That of the thread is left out, as the chunk before it was copied before it was full. That of
    the system may have the key of a report that was copied.
    """
    source = tmp_path / "source"
    data = bytearray(4096 + 4 * 65536)
    layout.CHUNK.pack_into(data, 4096, layout.THREAD_CHUNK, 1, 0)
    layout.CHUNK.pack_into(data, 4096 + 65536, layout.SYSTEM_CHUNK, 0, 0)
    source.write_bytes(data)
    places = [4096 + number * 65536 for number in range(4)]

    class Copy(io.BytesIO):
        def seek(self, place: int, whence: int = 0) -> int:
            if place == places[0]:
                layout.CHUNK.pack_into(data, places[2], layout.THREAD_CHUNK, 1, 2046)
                layout.CHUNK.pack_into(data, places[3], layout.SYSTEM_CHUNK, 0, 2046)
                source.write_bytes(data)
            return super().seek(place, whence)

    copy = Copy()
    with source.open("rb", buffering=0) as stream:
        copy_written(stream, copy)
    kinds = [copy.getvalue()[place] for place in places]
    assert kinds == [layout.THREAD_CHUNK, layout.SYSTEM_CHUNK, 0, layout.SYSTEM_CHUNK]


def test_a_mark_that_is_latched(tmp_path):
    """It comes again to each listener, and makes one recording; a new one makes another."""

    def source(topic: str, node: str, *, latched: bool) -> Source:
        return Source(topic, node, "std_msgs/Time", "", "", latched=latched)

    again, once = source("/mark_action", "/a", latched=True), source("/m", "/b", latched=False)
    first = Listening(KeepOptions(tmp_path), tmp_path)
    first._hear(again, 7 * S)
    assert first.marks == 1
    second = Listening(KeepOptions(tmp_path), tmp_path, first.latched)
    second._hear(again, 7 * S)
    assert second.marks == 0
    third = Listening(KeepOptions(tmp_path), tmp_path, second.latched)
    third._hear(again, 8 * S)
    assert third.marks == 1
    for _ in range(2):
        third._hear(replace(once, topic="/ana/mark_action"), 0)
    assert third.marks >= 2


def test_joining_a_graph_may_take_longer_than_listening(tmp_path, monkeypatch):
    """It listens from when it has joined: values of parameters come only then."""
    was_asked_to_end = []

    class Late(Listening):
        def run(self) -> None:
            time.sleep(0.5)
            was_asked_to_end.append(self._stop_asked.is_set())
            self.has_begun = True
            self._stop_asked.wait()

    monkeypatch.setattr(keeping, "Listening", Late)
    monkeypatch.setattr(keeping, "_HEARD_S", 0.05)
    run(tmp_path / "tpc", "over(site('one'), 1, 2)")
    keep(KeepOptions(tmp_path / "tpc", ros=1), tmp_path / "kept")
    assert was_asked_to_end == [False]


def test_left_folders_of_killed_runs(tmp_path):
    """Those of runs that are gone are removed; one that is made this moment stays."""
    run(tmp_path / "tpc", "over(site('one'), 1, 2)")
    old, new = tmp_path / "out/.keep-1", tmp_path / "out/.keep-2"
    for one in (old, new):
        (one / "tpc").mkdir(parents=True)
    os.utime(old, (0, 0))
    keep(KeepOptions(tmp_path / "tpc"), tmp_path / "out/kept")
    assert not old.exists()
    assert new.exists()


# --- the command


def test_the_command(tmp_path, monkeypatch):
    tpc = tmp_path / "tpc"
    run(tpc, "one = site('one')\nfor n in range(100): over(one, n, 50)")
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:9")
    monkeypatch.setenv("TPC_ROS", "1")
    monkeypatch.chdir(tmp_path)
    words = ["keep", "--folder", str(tpc), "-o", "kept"]
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 0, done.output
    assert "100 reports, 0 summaries and 0 marks of 1 process in the last" in done.output
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 1
    assert "kept: is there already; give another folder with -o" in done.output
    done = CliRunner().invoke(main, ["keep", "--folder", "none", "-o", "more"])
    assert "pytpc: error: none: no ring here; start the nodes with one: export TPC_RING=10" in (
        done.output
    )
    done = CliRunner().invoke(main, ["keep", "--remove-ended", "1", "--folder", str(tpc)])
    assert f"removed 0 files, 0 MiB, from {tpc}" in done.output
    done = CliRunner().invoke(main, ["doctor", "--json"], env={"TPC_FOLDER": str(tpc)})
    found = [one["what"] for one in json.loads(done.stdout) if "ring" in one["what"]]
    assert found == ["1 file of rings of 1 process that ended, 1 MiB"]


def test_settings_of_the_shell(tmp_path, monkeypatch):
    (tmp_path / "static.json").write_text('{"schema": 1, "units": []}')
    for name in ("TPC_RING", "TPC_RING_BUDGET"):
        monkeypatch.delenv(name, raising=False)
    words = ["env", str(tmp_path / "static.json"), "--ring", "10"]
    done = CliRunner().invoke(main, words)
    assert "export TPC_RING=10" in done.output, done.output
    assert "TPC_RING_BUDGET" not in done.output
    done = CliRunner().invoke(main, [*words, "--ring-budget", "32"])
    assert "export TPC_RING_BUDGET=32" in done.output
    monkeypatch.setenv("TPC_RING", "10")
    assert "unset TPC_RING" in CliRunner().invoke(main, ["env", "--off"]).output
    done = CliRunner().invoke(main, ["env", "--ring-budget", "32"])
    assert "--ring-budget needs --ring MINUTES" in done.output


def text_of(program: str) -> str:
    return PRELUDE.format(root=str(ROOT)) + textwrap.dedent(program)


def env_of(folder: Path, **env: str) -> dict[str, str]:
    settings = {"TPC_SINK": "file", "TPC_FOLDER": str(folder), "TPC_FILE_RESERVE": "0"}
    return {**os.environ, **settings, "TPC_RING": "0.05", "TPC_RING_BUDGET": "1024", **env}


def run(folder: Path, program: str, **env: str) -> None:
    """Run a program that reports to a ring in ``folder``."""
    done = subprocess.run(
        [sys.executable, "-c", text_of(program)],
        env=env_of(folder, **env),
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")


def started(folder: Path, program: str, **env: str) -> subprocess.Popen[bytes]:
    """The same, without waiting for its end."""
    return subprocess.Popen([sys.executable, "-c", text_of(program)], env=env_of(folder, **env))
