"""The ring: the last minutes in several files of one process."""

from __future__ import annotations

import random
import signal
import struct
import subprocess
import time
from pathlib import Path

import log_file
import pytest
from log_file import LogFile
from test_file import report

from patience import wait_for

# The shortest one: 3 s, so a file has 0.375 s.
SHORT = "0.05"
# 12 s, so a file has 1.5 s: the first three stay, however slow the machine is.
LONGER = "0.2"
THIRD = "-0003.tpc"


def segments(folder: Path) -> list[LogFile]:
    """The files of one process, in order."""
    return [log_file.read(path) for path in sorted(folder.glob("*.tpc"))]


class Counted:
    """A program that reports until it is killed, and counts its reports in a file of its own."""

    def __init__(
        self, program: Path, settings: dict[str, str], folder: Path, threads: int, pause_us: int
    ) -> None:
        folder.mkdir()
        self.folder, self.threads = folder, threads
        self._counts = folder / "counts"
        self._process = subprocess.Popen(
            [str(program), "counted", str(self._counts), str(threads), "20", str(pause_us)],
            env={"TPC_RING": SHORT, **settings, "TPC_FOLDER": str(folder)},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        assert self._process.stdout is not None
        self._process.stdout.readline()
        self.pid = self._process.pid

    def kill(self) -> str:
        """What it said on standard error; ``killed_ns`` is when it was gone, in steady time."""
        self._process.send_signal(signal.SIGKILL)
        said = self._process.communicate()[1].decode()
        self.killed_ns = time.monotonic_ns()
        return said

    def has_the_minutes(self, files: list[LogFile]) -> bool:
        """Whether nothing of the last 3 s was removed."""
        return files[0].segment == 1 or self.killed_ns - files[0].steady_ns >= 3 * 10**9

    @property
    def done(self) -> list[int]:
        return list(struct.unpack_from(f"<{self.threads}Q", self._counts.read_bytes()))


def numbers_of(files: list[LogFile], threads: int) -> list[list[float]]:
    """The reports of each thread of ``counted`` by their numbers; each has what it should have."""
    found: list[list[float]] = [[] for _ in range(threads)]
    for file in files:
        for reports in file.reports.values():
            for _steady, _site, *rest, _edge in reports:
                number, thread = int(rest[2]), int(rest[3])
                assert tuple(rest) == report(number, thread)
                found[thread].append(number)
    return found


@pytest.mark.parametrize("seed", range(6))
def test_killed_while_it_turns(program, settings, tmp_path, seed):
    """Whenever it is killed, the files have every report of the last seconds, in order."""
    randomly = random.Random(seed)
    threads = randomly.choice([1, 2, 4])
    # With 4 MiB, a file is left when it has 0.5 MiB.
    budget = randomly.choice(["4", "4096"])
    counted = Counted(
        program,
        {**settings, "TPC_RING_BUDGET": budget},
        tmp_path / "log",
        threads,
        randomly.choice([0, 20, 200]) if budget == "4" else 100,
    )
    wait_for(lambda: len(list(counted.folder.glob("*.tpc"))) > 1)
    time.sleep(randomly.uniform(0, 0.6))
    counted.kill()
    files = segments(counted.folder)
    lost = sum(file.not_recorded for file in files)
    for done, numbers in zip(counted.done, numbers_of(files, threads), strict=True):
        if not numbers:
            # It had no processor while another thread filled the budget.
            assert budget == "4"
            assert files[0].segment > 1
            continue
        # Without gaps, from the first one kept to the last one made; the kill may have come
        # between the record and the count. If the thread of the ring gets no processor for so long
        # that a file has the whole budget, what comes meanwhile is counted as not recorded.
        assert -1 <= done - 1 - numbers[-1] <= lost or numbers[-1] == done
        assert lost or numbers == list(range(numbers[0], numbers[-1] + 1))
        if files[0].segment == 1:
            assert numbers[0] == 0
    if budget == "4096":
        assert lost == 0
        assert counted.has_the_minutes(files)


def test_within_the_budget_of_bytes(program, settings, tmp_path):
    """The files take no more than 4 MiB together, while it reports without end."""
    counted = Counted(program, {**settings, "TPC_RING_BUDGET": "4"}, tmp_path / "log", 1, 1)
    folder = counted.folder
    most = 0
    seen: set[str] = set()
    while len(seen) < 8:
        sizes = {}
        for path in folder.glob("*.tpc"):
            try:
                sizes[path.name] = path.stat().st_blocks * 512
            except FileNotFoundError:
                continue
        seen |= set(sizes)
        most = max(most, sum(sizes.values()))
    counted.kill()
    assert 1 << 20 < most <= 4 << 20


class Stuck:
    """A program whose main thread can be held where it is, inside a report for the most part."""

    def __init__(self, program: Path, settings: dict[str, str], folder: Path) -> None:
        folder.mkdir()
        self.folder = folder
        self._stays = folder / "stays"
        self._errors = folder / "errors"
        with self._errors.open("wb") as errors:
            self._process = subprocess.Popen(
                [str(program), "stuck", str(self._stays)],
                env={**settings, "TPC_FOLDER": str(folder)},
                stdout=subprocess.PIPE,
                stderr=errors,
            )
        assert self._process.stdout is not None
        self._process.stdout.readline()

    def hold(self) -> None:
        """Until the main thread stays."""
        before = self._times()[0]
        self._process.send_signal(signal.SIGUSR1)
        wait_for(lambda: self._times()[0] > before)

    def let_go(self) -> None:
        with self._stays.open("r+b") as stays:
            stays.seek(8)
            stays.write(struct.pack("<Q", self._times()[0]))

    def said(self) -> str:
        return self._errors.read_text()

    def kill(self) -> None:
        self._process.kill()
        self._process.communicate()

    def sizes(self) -> dict[int, int]:
        """The bytes that each file has on the disk, by its number."""
        found = {}
        for path in self.folder.glob("*-????.tpc"):
            try:
                found[int(path.stem[-4:])] = path.stat().st_blocks * 512
            except FileNotFoundError:
                continue
        return found

    def _times(self) -> tuple[int, int]:
        times, may_go_on = struct.unpack("<QQ", self._stays.read_bytes())
        return times, may_go_on


def test_a_thread_that_is_stuck_in_a_report(program, settings, tmp_path):
    """The files take no more than twice the budget of 4 MiB; the ring goes on when it can."""
    # With a cap, the main thread is nearly always inside a report, and writes little.
    caps = {"TPC_RING": "10080", "TPC_RING_BUDGET": "4", "TPC_SITE_CAP": "10000"}
    stuck = Stuck(program, {**settings, **caps}, tmp_path / "log")
    wait_for(lambda: len(stuck.sizes()) > 1)

    def is_held_up() -> bool:
        sizes = stuck.sizes()
        oldest = min(stuck.sizes())
        # The oldest file goes first: if it is still there, all of them were there at once.
        if oldest in sizes:
            assert sum(sizes.values()) <= 8 << 20
        if stuck.said():
            return True
        if oldest > held:
            # It was between two reports: the file that was written then is gone.
            hold()
        return False

    def hold() -> None:
        nonlocal held
        stuck.let_go()
        stuck.hold()
        held = max(stuck.sizes())

    held = 0
    hold()
    wait_for(is_held_up)
    last = max(stuck.sizes())
    newest = next(stuck.folder.glob(f"*-{last:04}.tpc"))
    # What is reported meanwhile is counted in the file that is full.
    wait_for(lambda: log_file.read(newest).not_recorded > 0)
    sizes = stuck.sizes()
    assert min(sizes) <= held
    assert max(sizes) == last
    assert 4 << 20 < sum(sizes.values()) <= 8 << 20
    stuck.let_go()
    wait_for(lambda: min(stuck.sizes()) > last + 1)
    wait_for(lambda: sum(stuck.sizes().values()) <= 4 << 20)
    stuck.kill()
    said = stuck.said().splitlines()
    assert len(said) == 1
    assert said[0].startswith(f"tpc: {newest}".removesuffix(f"{last:04}.tpc"))
    assert said[0].endswith(
        ".tpc: a thread does not finish a report to this file, so the file cannot be removed; "
        "no further file is begun until it can"
    )


def test_within_the_minutes(program, settings, tmp_path):
    """Files of 3 s and an eighth of it stay: ten, one of them just left and one just begun."""
    counted = Counted(program, settings, tmp_path / "log", 1, 1000)
    wait_for(lambda: not (list(counted.folder.glob("*-0002.tpc"))) and _has(counted.folder, 12))
    counted.kill()
    names = sorted(path.name for path in counted.folder.glob("*.tpc"))
    assert len(names) <= 12
    assert all(f"-{counted.pid}-" in name for name in names)
    assert counted.has_the_minutes(segments(counted.folder))


def _has(folder: Path, number: int) -> bool:
    return any(int(path.stem[-4:]) >= number for path in folder.glob("*-????.tpc"))


def test_only_own_files_are_removed(program, settings, tmp_path):
    """Another file under the name of an old one, and other processes' files, stay."""
    folder = tmp_path / "log"
    counted = Counted(program, settings, folder, 1, 1000)
    wait_for(lambda: _has(folder, 2))
    first = next(folder.glob("*-0001.tpc"))
    others = [folder / "guard-1-1-0001.tpc", folder / f"drive-{counted.pid}-1.tpc"]
    for other in others:
        other.write_bytes(b"another's")
    first.unlink()
    first.write_bytes(b"mine")
    wait_for(lambda: not list(folder.glob("*-0002.tpc")))
    counted.kill()
    assert first.read_bytes() == b"mine"
    assert all(other.read_bytes() == b"another's" for other in others)


def test_memory_of_old_files_is_given_back(program, settings, tmp_path):
    """A file whose name is gone is not mapped any more, or it would still take the disk."""
    counted = Counted(program, {**settings, "TPC_RING_BUDGET": "4"}, tmp_path / "log", 2, 1)
    wait_for(lambda: _has(counted.folder, 12))

    def gone() -> int:
        maps = Path(f"/proc/{counted.pid}/maps").read_text().splitlines()
        return len({line.split()[4] for line in maps if "(deleted)" in line and ".tpc" in line})

    # What was removed this moment may be mapped until the next second.
    wait_for(lambda: gone() <= 2)
    files = [p for p in Path(f"/proc/{counted.pid}/fd").iterdir() if ".tpc" in str(p.readlink())]
    counted.kill()
    assert len(files) <= 6


def test_the_folder_is_removed(program, settings, tmp_path):
    """The next file is written to a new one."""
    counted = Counted(program, settings, tmp_path / "log", 1, 1000)
    wait_for(lambda: _has(counted.folder, 1))
    moved = counted.folder.rename(tmp_path / "elsewhere")
    wait_for(lambda: _has(counted.folder, 2))
    counted._counts = moved / "counts"
    said = counted.kill()
    assert said == ""


def test_a_disk_that_is_full(program, settings, tmp_path):
    """It says once that the ring stops; the program goes on."""
    none_left = str(1 << 39)  # MiB to leave free
    counted = Counted(
        program,
        {**settings, "TPC_SINK": "auto", "TPC_FILE_RESERVE": none_left},
        tmp_path / "log",
        1,
        1000,
    )
    before = counted.done[0]
    wait_for(lambda: counted.done[0] > before + 1000)
    said = counted.kill()
    assert said.count("\n") == 1
    assert "TPC_FILE_RESERVE" in said


def test_a_fork_has_a_ring_of_its_own(drive, files):
    """The parent's files and the child's do not mix, and none is removed by the other."""
    assert drive("forked", 50, ring=SHORT).returncode == 0
    pids = {path.stem.split("-")[-3] for path in files()}
    assert len(pids) == 3


@pytest.mark.parametrize(
    ("variable", "value", "why"),
    [
        ("ring", "-1", "it must be a number of minutes, 0 or from 0.05 to 10080"),
        ("ring", "0.01", "it must be a number of minutes, 0 or from 0.05 to 10080"),
        ("ring_budget", "3", "it must be a whole number of MiB from 4"),
    ],
)
def test_settings_that_are_none(drive, files, variable, value, why):
    run = drive("threads", 1, 1, 10, **{variable: value})
    assert run.stderr == f"tpc: TPC_{variable.upper()}={value} is ignored: {why}\n"
    assert len(files()) == 1


@pytest.mark.parametrize("policy", ["edges", "light"])
def test_what_the_last_file_says_alone(drive, files, policy):
    """It says of each comparison what held before: the files that said so may be gone.

    Key 1 was true once (3 > 2), files ago, and is false (1 > 2) at the end. Key 0 stays true (5 >
    1), so its first evaluation in the file is all that is reported of it.
    """
    assert drive("seldom", 50, THIRD, policy=policy, ring=LONGER).returncode == 0
    parts = [log_file.read(path) for path in files()]
    assert len(parts) > 2
    # One more may have been begun before the last evaluation, or after it.
    last = [of for of in map(_of_keys, parts) if 1 in of][-1]
    assert last[1] == [(True, True, 3, 2), (False, False, 1, 2)]
    assert last.get(0, []) in ([], [(True, True, 5, 1)])
    assert _of_keys(parts[1])[0] == [(True, True, 5, 1)]
    # Read one after the other: one flop of key 1, none of key 0.
    joined = [one for part in parts for one in _of_keys(part).get(1, [])]
    assert [result for result, *_ in joined].count(False) == 1
    assert joined[-1][0] is False
    assert all(result for part in parts for result, *_ in _of_keys(part).get(0, []))
    flops = {0: 0, 1: 0}
    for part in parts:
        for summary in part.all_summaries:
            flops[int(part.keys[summary["site"]][:8], 16)] += summary["flops"]
    assert flops == {0: 0, 1: 1}


@pytest.mark.parametrize("policy", ["every", "edges", "light"])
def test_all_files_together(drive, files, policy):
    """1 + 1 evaluations of key 1; those of key 0 are counted by the program, on its output."""
    run = drive("seldom", 50, THIRD, policy=policy, ring=LONGER)
    counts = {0: 0, 1: 0}
    for path in files():
        part = log_file.read(path)
        assert part.policies[0][0] == ("every", "edges", "light").index(policy)
        assert part.state == 1
        for summary in part.all_summaries:
            counts[int(part.keys[summary["site"]][:8], 16)] += summary["count"]
        if policy == "every":
            for key, reports in _of_keys(part).items():
                counts[key] += len(reports)
    assert counts == {0: int(run.stdout), 1: 2}


def test_beside_the_default_sink(drive, files):
    """A program without ROS reports nowhere, but to its ring, with the policy of its sink."""
    run = drive("seldom", 50, THIRD, sink="auto", ring=LONGER)
    parts = [log_file.read(path) for path in files()]
    assert len(parts) > 1
    assert {policy for part in parts for policy, _ in part.policies} == {2}
    count = sum(s["count"] for part in parts for s in part.all_summaries)
    assert count == int(run.stdout) + 2


def test_off_is_off(drive, files):
    drive("seldom", 50, sink="off", ring=SHORT)
    assert files() == []


def _of_keys(file: LogFile) -> dict[int, list[tuple]]:
    """The reports of each key by its number: result, res, compared, threshold."""
    found: dict[int, list[tuple]] = {}
    for reports in file.reports.values():
        for _steady, site, *rest, _edge in sorted(reports):
            found.setdefault(int(file.keys[site][:8], 16), []).append(tuple(rest))
    return found
