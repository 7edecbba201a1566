"""Fleets: what it takes to add missions and to ask all of them, here and on a cluster.

A fleet is made (``pytpc study fleet-world``), added and asked by the command line. Raw files are
made, added and removed in batches, so that a thousand missions of a million reports (32 GB) need
a tenth of that: ``--missions 1000 --reports 1000000``.

Rates are of processor time, and of the missions behind the first: what a start takes is shown by
itself. ``two_workers`` compares the processor time of one worker process with that of the busier
one of two, which is what a quiet machine of two cores would show on the wall; what the wall did
show stands beside it. The scheduler of Dask runs in a network of its own (``unshare``), whose bytes
are counted; where that is not possible, these figures are left out. ``calculated`` is 10,000
missions on 100 workers, from what a task, its messages and its scheduling took.
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
from functools import cache
from pathlib import Path
from typing import Any

from figures import figure

from pytpc_evaluation.fleet.generating import generate, mission_folder
from pytpc_evaluation.fleet.world import World, WorldSettings, parameter_of

ROOT = Path(__file__).parents[1]
TOPIC = "fleet"
KEPT = 24
"""So many missions are added again for the comparisons."""
LONG = 6
"""So many missions of a million reports are added."""
RAW_BYTES = 32
MANY, WORKERS = 10_000, 100
"""What is calculated."""
_ALONE = ("unshare", "--user", "--map-root-user", "--net")
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


def long_missions(folder: Path) -> None:
    """Add missions of a million reports, of which each costs little beside its reports."""
    raw = folder / "long"
    made = generate(WorldSettings(missions=LONG, reports=10**6), raw, jobs=os.cpu_count() or 1)
    one = add(folder / "long_one", raw / made["missions"][0]["folder"])
    ran = add(folder / "long_fleet", raw)
    rate = (reports_in(ran) - reports_in(one)) / (ran.processor - one.processor)
    figure(TOPIC, "add_per_core", rate, unit="reports/s", target=">=3e6", hit=rate >= 3e6)
    for name in ("long", "long_one", "long_fleet"):
        shutil.rmtree(folder / name)


def right(world: World, answer: dict[str, Any]) -> None:
    """How many of the parameters that are wrong come first, and which causes are named."""
    wrong = {parameter_of(one.decision).rpartition("/")[2] for one in world.culprits}
    first, causes = (
        [one["parameter"].strip("~/").rpartition("/")[2] for one in answer[what]]
        for what in ("suspects", "causes")
    )
    found = sum(name in wrong for name in first[: len(wrong)])
    is_first = bool(first) and first[0] in wrong
    target = f"first_of_{len(wrong)}"
    figure(TOPIC, "rank_wrong_ones_first", found, unit="parameters", target=target, hit=is_first)
    show("rank_causes_right", len({*causes} & wrong), "parameters")
    false = len({*causes} - wrong)
    figure(TOPIC, "rank_causes_false", false, unit="parameters", target="0", hit=not false)


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
    show(f"add_{settings.reports}_per_core", reports / processor, "reports/s")
    size = size_of(fleet)
    each = size / reports
    figure(TOPIC, "bytes_per_report", each, unit="B", target="<=3", hit=each <= 3)
    show("raw_bytes_per_report", raw_bytes / reports, "B")
    right(world, asked(fleet, settings.missions))
    count = settings.missions
    return Measured(reports / count, size / count, raw_bytes / count)


def asked(fleet: Path, missions: int) -> Any:  # noqa: ANN401 - JSON
    """Ask which parameter it is, by threads; the answer."""
    ran = pytpc("fleet", "rank", str(fleet), "--json")
    name, is_large = f"rank_{missions}", missions >= 1000
    target = "<30" if is_large else "none"
    figure(TOPIC, name, ran.wall, unit="s", target=target, hit=not is_large or ran.wall < 30)
    show(f"{name}_processor", ran.processor, "s")
    return json.loads(ran.output)


def same_results(folder: Path, scheduled: dict[str, Any]) -> None:
    """Whether threads, processes and a scheduler give the same data set and the same answer."""
    local = ("--cluster", "local", "--workers", "2")
    answers = {scheduled["rank_kept"]["output"]}
    for name, words in (("threads", ()), ("processes", local)):
        add(folder / name, folder / "kept", *words)
        answers.add(pytpc("fleet", "rank", str(folder / "kept_fleet"), "--json", *words).output)
    digests = {digest_of(folder / name) for name in ("threads", "processes", "kept_fleet")}
    same = len(digests) == len(answers) == 1
    figure(TOPIC, "same_results", float(same), unit="bool", target="1", hit=same)


def on_cluster(folder: Path, workers: int) -> dict[str, Any]:
    """What it takes on a scheduler with so many workers: see `fleet_cluster`."""
    there = ("--cluster", "ADDRESS", "--json")
    for name in ("one_fleet", "warm_fleet", "kept_fleet"):
        shutil.rmtree(folder / name, ignore_errors=True)
    command = {
        # Before they are measured, all workers have imported what they need.
        "warm_add": ("add", folder / "warm_fleet", folder / "kept"),
        "warm_rank": ("rank", folder / "warm_fleet"),
        "add_one": ("add", folder / "one_fleet", folder / "one"),
        "add_kept": ("add", folder / "kept_fleet", folder / "kept"),
        "rank_kept": ("rank", folder / "kept_fleet"),
        "rank_all": ("rank", folder / "fleet"),
    }
    commands = {
        name: [*_PYTPC, "fleet", *map(str, words), *there] for name, words in command.items()
    }
    script = Path(__file__).with_name("fleet_cluster.py")
    done = subprocess.run(
        [*(_ALONE if can_be_alone() else ()), sys.executable, str(script)],
        input=json.dumps({"workers": workers, "commands": commands}),
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        env=_ENV,
    )
    found: dict[str, Any] = json.loads(done.stdout)
    return found


@cache
def can_be_alone() -> bool:
    """Whether a command can have a network of its own here."""
    return subprocess.run([*_ALONE, "true"], capture_output=True, check=False).returncode == 0


def cluster(folder: Path, measured: Measured, missions: int) -> None:
    """One worker process against two, memory, messages, the same results, and what follows."""
    one, two = on_cluster(folder, 1)["commands"], on_cluster(folder, 2)
    peak, two = two["peak_mb"], two["commands"]
    for name, asked_for in (("add", "add_kept"), ("rank", "rank_all")):
        ratio = one[asked_for]["busiest_s"] / two[asked_for]["busiest_s"]
        figure(TOPIC, f"two_workers_{name}", ratio, unit="ratio", target=">=1.8", hit=ratio >= 1.8)
        show(f"one_worker_{name}_wall", one[asked_for]["seconds"], "s")
        show(f"two_workers_{name}_wall", two[asked_for]["seconds"], "s")
    figure(TOPIC, "worker_peak", peak, unit="MB", target="<=2000", hit=peak <= 2000)
    same_results(folder, two)
    if not can_be_alone():
        print("no network of its own (unshare): bytes are not counted", file=sys.stderr)
    calculated(measured, two, missions)


def calculated(measured: Measured, taken: dict[str, Any], missions: int) -> None:
    """Many missions on many workers: what is slower, the tasks on the workers or the scheduler.

    A mission costs what those behind the first ones cost. That is too much: of the bad missions a
    ranking judges some one by one, and no more; and the scheduler's time has what it does anyway
    while it waits.
    """
    kept = min(KEPT, missions)

    def added(what: str) -> float:
        few, more = taken["add_one"][what], taken["add_kept"][what]
        return max(0.0, (more - few) / (kept - 1))

    def ranked(what: str) -> float:
        few, more = taken["rank_kept"][what], taken["rank_all"][what]
        return float(few + max(0.0, more - few) / max(1, missions - kept) * (MANY - kept))

    show("add_task", added("workers_s"), "s")
    show("add_scheduler_per_task", added("scheduler_s"), "s")
    add_s = MANY * max(added("workers_s") / WORKERS, added("scheduler_s"))
    show(f"calculated_add_{MANY}_on_{WORKERS}", add_s, "s")
    # What a mission adds to a ranking does not show in the noise of a few of them.
    is_known = missions >= 2 * KEPT
    if is_known:
        rank_s = max(ranked("workers_s") / WORKERS, ranked("scheduler_s"))
        show(f"calculated_rank_{MANY}_on_{WORKERS}", rank_s, "s")
    show(f"calculated_{MANY}_raw", MANY * measured.raw / 1e9, "GB")
    show(f"calculated_{MANY}_stored", MANY * measured.stored / 1e9, "GB")
    if can_be_alone():
        show("add_messages_per_mission", added("bytes"), "B")
        show("rank_messages", taken["rank_all"]["bytes"], "B")
        show(f"calculated_add_{MANY}_messages", MANY * added("bytes") / 1e6, "MB")
        if is_known:
            show(f"calculated_rank_{MANY}_messages", ranked("bytes") / 1e6, "MB")


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
    if given.folder is not None:
        given.folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=given.folder) as name:
        folder = Path(name)
        long_missions(folder)
        measured = whole(settings, folder, batch)
        cluster(folder, measured, given.missions)


if __name__ == "__main__":
    main()
