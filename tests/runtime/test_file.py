"""The file sink: what is in the file is what was reported, whoever reports and however it ends."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections import Counter
from itertools import pairwise
from pathlib import Path

import log_file
import pytest
from compiling import compile_program


def report(number: int, thread: int) -> tuple:
    """What drive.cpp reports as its report ``number`` in a thread: (result, res, cmp, thresh)."""
    result = number // 7 % 2 == 1
    return (result, not result, float(number), float(thread))


def key(number: int) -> str:
    return f"{number:08x}-0000-5000-8000-000000000000"


# Threads take the places of those that have ended, so that one place may hold several in a row.
def test_every_report_of_every_thread(drive, files):
    assert drive("threads", 4, 5, 10_000).returncode == 0
    (path,) = files()
    file = log_file.read(path)
    assert (file.state, file.torn, file.not_recorded) == (1, 0, 0)
    assert sorted(file.keys.values()) == [key(n) for n in range(5)]
    by_thread: dict[float, list[tuple]] = {}
    for reports in file.reports.values():
        for _steady, site, *rest, _edge in reports:
            by_thread.setdefault(rest[-1], []).append((file.keys[site], tuple(rest)))
        steady = [report[0] for report in reports]
        assert steady == sorted(steady)
    assert sorted(by_thread) == [0, 1, 2, 3]
    for thread, found in by_thread.items():
        assert found == [(key(n % 5), report(n, int(thread))) for n in range(10_000)]


def test_sixteen_threads_and_ten_thousand_sites(drive, files):
    assert drive("threads", 16, 10_000, 20_000).returncode == 0
    file = log_file.read(files()[0])
    assert len(file.keys) == 10_000
    assert Counter(file.keys[r[1]] for r in file.all_reports) == Counter(
        {key(n): 16 * 2 for n in range(10_000)}
    )


def test_forked_processes_have_files_of_their_own(drive, files):
    assert drive("forked", 3000).returncode == 0
    found = {}
    for path in files():
        file = log_file.read(path)
        assert file.state == 1
        counts = Counter(report[5] for report in file.all_reports)
        others = counts.pop(100.0, 0)
        assert bool(others) == (1.0 in counts)
        found.update(counts)
    assert found == {1.0: 6000, 2.0: 3000, 3.0: 3000}


def test_before_main_and_after_it(drive, files, settings):
    settings["DRIVE_EARLY"] = "1"
    assert drive("threads", 1, 1, 10).returncode == 0
    file = log_file.read(files()[0])
    names = [file.keys[r[1]][:4] for r in sorted(file.all_reports)]
    # The report after main comes when the file is closed, into the chunk that its thread has.
    assert names == ["eeee", *["0000"] * 10, "ffff"]


# 50 threads, one after the other, each with a report in the destructor of a thread_local; a thread
# that still reports when main has ended.
def test_the_ends_of_threads_and_of_main(drive, files):
    assert drive("ends").returncode == 0
    file = log_file.read(files()[0])
    assert file.torn == 0
    values = [r[4] for r in file.all_reports if r[5] != 9]
    assert sorted(values) == [3.0] * 50 + [4.0] * 50
    rest = [r[4] for r in file.all_reports if r[5] == 9]
    assert rest == [float(n) for n in range(len(rest))]
    assert rest


def test_reports_from_a_signal_handler(drive, files):
    ran = drive("signals", 100)
    assert ran.returncode == 0
    own, in_handler = map(int, ran.stdout.split())
    file = log_file.read(files()[0])
    counts = Counter(file.keys[r[1]] for r in file.all_reports)
    assert counts[key(0)] == own
    nested = sum(count for why, site, count, _ in file.dropped if (why, site) == (3, 0))
    # One report with -1 stands before the handler's.
    assert counts[key(1)] - 1 + nested == in_handler
    assert in_handler > 0


@pytest.mark.parametrize("policy", ["every", "edges", "light"])
def test_a_handler_ends_the_process_inside_a_report(drive, files, policy):
    for turn in range(1, 6):
        assert drive("exits", policy=policy).returncode == 0
        assert len(files()) == turn
        assert log_file.read(files()[-1]).keys


# Files are made and the console is written to in places where a thread may be cancelled: an
# exception that must not end within the library, or the process is aborted.
@pytest.mark.parametrize("policy", ["every", "edges"])
@pytest.mark.parametrize("sink", ["file", "rosout"])
def test_threads_are_cancelled(drive, files, sink, policy):
    ran = drive("cancelled", 40, sink=sink, policy=policy)
    assert ran.returncode == 0
    told = [] if sink == "file" else ["not sent on /rosout: nobody listened"]
    lines = ran.stderr.splitlines()
    assert len(lines) == len(told) and all(map(str.__contains__, lines, told))
    assert all(log_file.read(path).torn == 0 for path in files())


def test_a_program_that_closes_all_descriptors_keeps_its_own_files(drive, files, tmp_path):
    own = tmp_path / "own"
    ran = drive("closed", own, 200_000)
    assert ran.returncode == 0
    assert own.read_bytes() == b"mine"
    assert "the program has closed its descriptor" in ran.stderr
    file = log_file.read(files()[0])
    assert file.state == 2
    assert len(file.all_reports) + file.not_recorded == 200_000


# Containers have process numbers of their own, and may share a folder: the shell's number is the
# program's, and another one with it has begun a file in this second and the next ones.
def test_the_file_of_another_with_the_same_name_is_left_alone(program, settings, tmp_path):
    folder = tmp_path / "log"
    shell = (
        f"mkdir {folder}; s=$(date +%s); for i in 0 1 2 3 4 5; do"
        f" printf other > {folder}/drive-$$-$((s + i)).tpc.new; done;"
        f" exec {program} threads 1 1 10"
    )
    subprocess.run(["/bin/sh", "-c", shell], env=settings, check=True, timeout=60)
    assert {path.read_text() for path in folder.glob("*.new")} == {"other"}
    (path,) = folder.glob("*.tpc")
    assert path.name.endswith("-2.tpc")
    assert len(log_file.read(path).all_reports) == 10


def test_keys_that_are_none(drive, files):
    assert drive("names").returncode == 0
    file = log_file.read(files()[0])
    reported = [(file.keys[r[1]], r[4]) for r in file.all_reports]
    assert reported == [
        ("x", 1.0),
        ("", 1.0),
        ("k" * 4096, 1.0),
        ("x", 1.0),
        *[(key(500 + n), float(n)) for n in range(3)],
    ]


def test_clocks(drive, files):
    assert drive("paced", 200, 1500, 1).returncode == 0
    file = log_file.read(files()[0])
    assert len(file.syncs) >= 2
    offsets = [real - steady for steady, real, _ros in file.syncs]
    assert max(offsets) - min(offsets) < 1_000_000
    steady = [r[0] for r in file.all_reports]
    assert 1.2e9 < steady[-1] - steady[0] < 3e9
    gaps = sorted(b - a for a, b in pairwise(steady))
    assert 4e6 < gaps[len(gaps) // 2] < 6e6


# A cap of 50 a second at 500 a second for 1.5 s, which touch 2 or 3 seconds of the clock.
@pytest.mark.parametrize(("cap", "reason"), [("site_cap", 1), ("process_cap", 2)])
def test_caps(drive, files, cap, reason):
    assert drive("paced", 500, 1500, 2, **{cap: 50}).returncode == 0
    file = log_file.read(files()[0])
    sites = 2 if cap == "site_cap" else 1
    kept = len(file.all_reports)
    assert 50 * sites <= kept <= 3 * 50 * sites
    assert {why for why, *_ in file.dropped} == {reason}
    dropped = sum(count for _why, _site, count, _flops in file.dropped)
    last = max(r[4] for r in file.all_reports)
    assert kept + dropped >= last + 1
    # 750 reports are made where the machine is not held up.
    assert 300 < kept + dropped <= 752
    # Every 7th report changes the result, so that a site's flops are about a seventh.
    flops = sum(flops for *_, flops in file.dropped)
    assert 0 < flops < dropped


@pytest.mark.parametrize(
    ("settings_", "said"),
    [
        ({"file_limit": 3}, "its limit of 3 MiB (TPC_FILE_LIMIT) is reached"),
        ({"file_reserve": 1 << 30}, "the disk has less than"),
    ],
)
def test_a_limit_stops_the_recording_and_not_the_program(drive, files, settings_, said):
    ran = drive("threads", 2, 3, 200_000, **settings_)
    assert ran.returncode == 0
    assert ran.stderr.count("\n") == 1
    assert said in ran.stderr
    for path in files():
        file = log_file.read(path)
        assert file.state == 2
        assert len(file.all_reports) + file.not_recorded == 400_000
        assert len(file.all_reports) > 60_000


def test_ulimit_sends_no_signal(program, settings, files):
    shell = f"ulimit -f 3000; exec {program} threads 2 3 200000"
    ran = subprocess.run(
        ["/bin/bash", "-c", shell], env=settings, capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0
    assert "(ulimit -f)" in ran.stderr
    assert log_file.read(files()[0]).state == 2


def test_a_full_disk(program, settings, tmp_path):
    folder = tmp_path / "disk"
    folder.mkdir()
    mounts = ["unshare", "-m"] if os.geteuid() == 0 else ["unshare", "-rm"]
    if subprocess.run([*mounts, "true"], capture_output=True, check=False).returncode:
        pytest.skip("no file system can be mounted here")
    copy = tmp_path / "copy.tpc"
    shell = (
        f"mount -t tmpfs -o size=5m none {folder} &&"
        f" {program} threads 2 3 200000; status=$?; cp {folder}/*.tpc {copy}; exit $status"
    )
    ran = subprocess.run(
        [*mounts, "/bin/sh", "-c", shell],
        env={**settings, "TPC_FOLDER": str(folder), "TPC_FILE_RESERVE": "0"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    assert "No space left on device" in ran.stderr
    assert ran.stderr.count("\n") == 1
    file = log_file.read(copy)
    assert file.state == 2
    assert len(file.all_reports) + file.not_recorded == 400_000


def test_no_folder_no_file(drive, tmp_path):
    (tmp_path / "file").write_text("")
    ran = drive("threads", 2, 3, 1000, folder=tmp_path / "file" / "below")
    assert ran.returncode == 0
    (line,) = ran.stderr.splitlines()
    assert line.startswith(f"tpc: {tmp_path}/file/below: Not a directory")


def test_wrong_settings_are_said_and_left(drive, files):
    ran = drive("threads", 1, 1, 5, policy="all", period="0", site_cap="-1", file_limit="2x")
    assert ran.returncode == 0
    assert sorted(line.split()[1] for line in ran.stderr.splitlines()) == [
        "TPC_FILE_LIMIT=2x",
        "TPC_PERIOD=0",
        "TPC_POLICY=all",
        "TPC_SITE_CAP=-1",
    ]
    assert len(log_file.read(files()[0]).all_reports) == 5


@pytest.fixture
def drive_with(program, settings, tmp_path):
    """Run the driver with a library in front of all others, from its C++ source."""

    def run(source: str, *words: str) -> None:
        path = tmp_path / "shim.cpp"
        path.write_text(source)
        shim = compile_program(path, path.with_suffix(".so"), "-shared", "-fPIC", "-ldl")
        environment = {**settings, "LD_PRELOAD": str(shim)}
        subprocess.run([str(program), *words], env=environment, check=True, timeout=60)

    return run


# The helper thread must not be in the middle of anything that its copy would wait for.
def test_a_fork_while_the_kernel_is_asked_for_its_clock(drive_with, files):
    drive_with(
        """
        #include <dlfcn.h>
        #include <stdio.h>
        #include <string.h>
        #include <unistd.h>
        extern "C" FILE *fopen(const char *path, const char *mode) {
          using Open = FILE *(*)(const char *, const char *);
          static Open real = (Open)dlsym(RTLD_NEXT, "fopen");
          if (strstr(path, "clocksource"))
            usleep(300000);
          return real(path, mode);
        }
        """,
        "forked",
        "10",
    )
    assert [log_file.read(path).state for path in files()] == [1, 1, 1]


# A signal that comes while it is blocked here would go to a thread of roscpp, and there a handler
# that calls ros::shutdown() ends the node with an exception.
def test_a_thread_that_reports_blocks_no_signals(drive_with, files):
    drive_with(
        """
        #include <signal.h>
        #include <stdlib.h>
        extern "C" int pthread_sigmask(int, const sigset_t *, sigset_t *) { abort(); }
        """,
        "threads",
        "1",
        "3",
        "10",
    )
    assert len(log_file.read(files()[0]).all_reports) == 10


# The library's only call of clock_gettime is what the preloaded one answers.
def test_the_wall_clock_is_set_back(drive_with, files):
    drive_with(
        """
        #include <dlfcn.h>
        #include <time.h>
        extern "C" int clock_gettime(clockid_t id, timespec *t) {
          using Get = int (*)(clockid_t, timespec *);
          static Get real = (Get)dlsym(RTLD_NEXT, "clock_gettime");
          static timespec start;
          int result = real(id, t);
          if (id == CLOCK_MONOTONIC && !start.tv_sec)
            start = *t;
          timespec now;
          real(CLOCK_MONOTONIC, &now);
          if (id == CLOCK_REALTIME && start.tv_sec && now.tv_sec - start.tv_sec >= 2)
            t->tv_sec -= 3600;
          return result;
        }
        """,
        "paced",
        "100",
        "4500",
        "1",
    )
    file = log_file.read(files()[0])
    hours = [round((real - steady) / 3.6e12) for steady, real, _ in file.syncs]
    assert set(hours) == {hours[0], hours[0] - 1}
    steady = [r[0] for r in file.all_reports]
    assert steady == sorted(steady)
    assert [r[4] for r in file.all_reports] == [float(n) for n in range(len(steady))]


def test_a_program_without_the_reader_next_to_it(drive, files, tmp_path):
    """A file says all by itself: it is read in another place."""
    drive("threads", 1, 2, 100)
    moved = tmp_path / "elsewhere" / "x"
    moved.parent.mkdir()
    shutil.copy(files()[0], moved)
    assert len(log_file.read(moved).all_reports) == 100
    assert Path(files()[0]).name.startswith("drive-")
