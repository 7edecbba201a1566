"""Fleets: what it takes to add missions and to ask all of them, here and on a cluster.

A fleet is made (``pytpc study fleet-world``), added and asked by the command line. Raw files are
made, added and removed in batches, so that a thousand missions of a million reports (32 GB) need
a tenth of that: ``--missions 1000 --reports 1000000``.

Rates are of processor time, and of the missions behind the first: what a start takes is shown by
itself. ``two_workers`` compares the time on the wall of one worker process and of two, also behind
the first mission. A scheduler of Dask runs in a network of its own (``unshare``), whose bytes are
counted; where that is not possible, these figures are left out. The last lines are calculated:
10,000 missions on 100 workers, from what a task and a message took. Each says what it is made of.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from figures import figure

from pytpc_evaluation.fleet.generating import generate, mission_folder
from pytpc_evaluation.fleet.world import World, WorldSettings

ROOT = Path(__file__).parents[1]
TOPIC = "fleet"
ROUNDS = 3
KEPT = 24
"""So many missions are added again for the comparisons."""
RAW_BYTES = 32
MANY, WORKERS = 10_000, 100
"""What is calculated."""
_PYTPC = (sys.executable, "-m", "pytpc")
_ENV = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (ROOT, ROOT / "evaluation")))}


@dataclass(frozen=True)
class Ran:
    """What a command took: seconds on the wall, processor seconds with those of its processes."""

    wall: float
    processor: float
    peak_mb: float
    output: str


def pytpc(*words: str) -> Ran:
    """Run a command of pytpc."""
    with tempfile.TemporaryFile() as output:
        began = time.monotonic()
        process = subprocess.Popen(
            [*_PYTPC, *words], stdout=output, stderr=subprocess.DEVNULL, env=_ENV
        )
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.monotonic() - began
        process.returncode = os.waitstatus_to_exitcode(status)
        if status:
            raise SystemExit(f"pytpc {' '.join(words)}: exit status {process.returncode}")
        output.seek(0)
        text = output.read().decode()
    return Ran(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, text)


def show(name: str, value: float, unit: str) -> None:
    """A figure without a target."""
    figure(TOPIC, name, value, unit=unit, target="none", hit=True)


def size_of(folder: Path) -> int:
    """Bytes of all files below a folder."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def digest_of(folder: Path) -> str:
    """A digest of all files below a folder, with their names."""
    found = hashlib.sha256()
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        found.update(f"{path.relative_to(folder)}\n".encode() + path.read_bytes())
    return found.hexdigest()


def reports_in(ran: Ran) -> int:
    """The reports of the missions that a command has added."""
    return sum(one["reports"] for one in json.loads(ran.output))


def add(fleet: Path, raw: Path, *words: str) -> Ran:
    """Add all missions below a folder, or one mission."""
    return pytpc("fleet", "add", str(fleet), str(raw), "--json", *words)


@dataclass
class Measured:
    """What the calculations are made of, of one mission each."""

    reports: float = 0.0
    stored: float = 0.0
    raw: float = 0.0


def whole(settings: WorldSettings, folder: Path, batch: int) -> Measured:
    """Add all missions in batches, and ask after half of them and all of them.

    The first mission stays in ``one``, the first ``KEPT`` in ``kept``, all of them in ``fleet``.
    """
    world = World(settings)
    fleet, raw = folder / "fleet", folder / "raw"
    generate(settings, folder / "one", range(1))
    first = add(folder / "first", folder / "one")
    show("add_start", first.processor, "s")
    processor, reports, raw_bytes, begun = 0.0, 0, 0, 0
    while begun < settings.missions:
        numbers = range(begun, min(settings.missions, begun + batch))
        generate(settings, raw, numbers, jobs=os.cpu_count() or 1)
        ran = add(fleet, raw)
        processor += (ran.processor - first.processor) * len(numbers) / max(1, len(numbers) - 1)
        reports += reports_in(ran)
        for number in numbers:
            place = mission_folder(world, number)
            raw_bytes += size_of(raw / place / "tpc")
            if number < KEPT:
                (folder / "kept" / place).parent.mkdir(parents=True, exist_ok=True)
                (raw / place).rename(folder / "kept" / place)
        shutil.rmtree(raw)
        if begun * 2 < settings.missions <= numbers.stop * 2 and numbers.stop < settings.missions:
            asked(fleet, numbers.stop)
        begun = numbers.stop
    rate = reports / processor
    figure(TOPIC, "add_per_core", rate, unit="reports/s", target=">=3e6", hit=rate >= 3e6)
    size = size_of(fleet)
    each = size / reports
    figure(TOPIC, "bytes_per_report", each, unit="B", target="<=3", hit=each <= 3)
    show("raw_bytes_per_report", raw_bytes / reports, "B")
    asked(fleet, settings.missions)
    count = settings.missions
    return Measured(reports / count, size / count, raw_bytes / count)


def asked(fleet: Path, missions: int) -> None:
    """Ask which parameter it is, by threads."""
    ran = pytpc("fleet", "rank", str(fleet), "--json")
    name, is_large = f"rank_{missions}", missions >= 1000
    target = "<30" if is_large else "none"
    figure(TOPIC, name, ran.wall, unit="s", target=target, hit=not is_large or ran.wall < 30)
    show(f"{name}_processor", ran.processor, "s")


def two_workers(folder: Path) -> None:
    """One worker process against two: time on the wall behind the first mission."""
    one, raw = folder / "one", folder / "kept"
    questions = {
        "add": (lambda n: add_alone(folder, one, n), lambda n: add_alone(folder, raw, n)),
        "rank": (
            lambda n: pytpc("fleet", "list", str(folder / "fleet"), *local(n)),
            lambda n: pytpc("fleet", "rank", str(folder / "fleet"), *local(n)),
        ),
    }
    for name, (start, work) in questions.items():
        taken: dict[int, list[float]] = {1: [], 2: []}
        for _ in range(ROUNDS):
            for workers, found in taken.items():
                found.append(work(workers).wall - start(workers).wall)
        ratio = min(taken[1]) / min(taken[2])
        figure(TOPIC, f"two_workers_{name}", ratio, unit="ratio", target=">=1.8", hit=ratio >= 1.8)


def local(workers: int) -> tuple[str, ...]:
    """Options: so many worker processes."""
    return "--cluster", "local", "--workers", str(workers), "--json"


def add_alone(folder: Path, raw: Path, workers: int) -> Ran:
    """Add missions to a fleet that is made for that."""
    fleet = folder / "alone"
    shutil.rmtree(fleet, ignore_errors=True)
    return pytpc("fleet", "add", str(fleet), str(raw), *local(workers))


def cluster(folder: Path, measured: Measured, missions: int) -> None:
    """The same by threads, processes and a scheduler; messages, memory and what follows."""
    one, raw, fleet = folder / "one", folder / "kept", folder / "fleet"
    kept = sum(1 for _ in raw.glob("r*/*"))
    for name, words in (("threads", ()), ("processes", local(2)[:-1])):
        add(folder / name, raw, *words)
    ranks = {
        name: pytpc("fleet", "rank", str(folder / "threads"), "--json", *words).output
        for name, words in (("threads", ()), ("processes", local(2)[:-1]))
    }
    there = ("--cluster", "ADDRESS", "--json")
    commands = [
        [*_PYTPC, "fleet", "add", str(folder / "scheduled_one"), str(one), *there],
        [*_PYTPC, "fleet", "add", str(folder / "scheduled"), str(raw), *there],
        [*_PYTPC, "fleet", "rank", str(folder / "threads"), *there],
        [*_PYTPC, "fleet", "rank", str(fleet), *there],
    ]
    job = json.dumps({"workers": 2, "commands": commands})
    script = [sys.executable, str(Path(__file__).with_name("fleet_cluster.py"))]
    alone = ["unshare", "--user", "--map-root-user", "--net"]
    is_alone = subprocess.run([*alone, "true"], capture_output=True, check=False).returncode == 0
    done = subprocess.run(
        [*(alone if is_alone else ()), *script],
        input=job,
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        env=_ENV,
    )
    found = json.loads(done.stdout)
    first, added, few, asked_all = found["commands"]
    digests = {digest_of(folder / name) for name in ("threads", "processes", "scheduled")}
    same = len(digests) == 1 and len({*ranks.values(), few["output"]}) == 1
    figure(TOPIC, "same_results", float(same), unit="bool", target="1", hit=same)
    peak = found["peak_mb"]
    figure(TOPIC, "worker_peak", peak, unit="MB", target="<=2000", hit=peak <= 2000)
    per = {
        name: (added[name] - first[name]) / (kept - 1)
        for name in ("bytes", "workers_s", "scheduler_s")
    }
    show("add_task", per["workers_s"], "s")
    show("add_scheduler_per_task", per["scheduler_s"], "s")
    if is_alone:
        show("add_messages_per_mission", per["bytes"], "B")
        show("rank_messages", asked_all["bytes"], "B")
    else:
        print("no network of its own (unshare): bytes are not counted", file=sys.stderr)
    calculated(measured, per, asked_all, missions, is_alone=is_alone)


def calculated(
    measured: Measured,
    per: dict[str, float],
    ranked: dict[str, float],
    missions: int,
    *,
    is_alone: bool,
) -> None:
    """Many missions on many workers: what is slower, all tasks on the workers or the scheduler.

    Ranking is scaled up as if all of it grew with the missions, which is too much: of the bad ones
    some are judged one by one, and no more.
    """
    scale = MANY / missions
    add_s = max(MANY * per["workers_s"] / WORKERS, MANY * per["scheduler_s"])
    show(f"calculated_add_{MANY}_on_{WORKERS}", add_s, "s")
    rank_s = max(ranked["workers_s"] * scale / WORKERS, ranked["scheduler_s"] * scale)
    show(f"calculated_rank_{MANY}_on_{WORKERS}", rank_s, "s")
    show(f"calculated_disk_{MANY}", MANY * measured.stored / 1e9, "GB")
    show(f"calculated_add_{MANY}_read_and_written", MANY * (measured.raw + measured.stored) / 1e9,
         "GB")  # fmt: skip
    if is_alone:
        show(f"calculated_add_{MANY}_messages", MANY * per["bytes"] / 1e9, "GB")
        show(f"calculated_rank_{MANY}_messages", ranked["bytes"] * scale / 1e9, "GB")


def main() -> None:
    """Prints all figures; files stand below ``--folder`` and are removed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--missions", type=int, default=60, metavar="N")
    parser.add_argument("--reports", type=int, default=200_000, metavar="N")
    parser.add_argument("--robots", type=int, default=0, metavar="N")
    parser.add_argument("--raw", type=float, default=3.0, metavar="GB", help="raw files at once")
    parser.add_argument("--folder", type=Path)
    given = parser.parse_args()
    robots = given.robots or max(6, given.missions // 50)
    settings = WorldSettings(robots=robots, missions=given.missions, reports=given.reports)
    batch = max(2, min(-(-given.missions // 2), int(given.raw * 1e9 / RAW_BYTES / given.reports)))
    with tempfile.TemporaryDirectory(dir=given.folder) as name:
        folder = Path(name)
        measured = whole(settings, folder, batch)
        two_workers(folder)
        cluster(folder, measured, given.missions)


if __name__ == "__main__":
    main()
