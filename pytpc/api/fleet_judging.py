"""What each bad mission of a fleet says by itself, beside good ones: a task for each of them."""

from __future__ import annotations

import tempfile
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import log
from pathlib import Path

import pyarrow as pa

from pytpc.api.comparing import RecordedRun
from pytpc.api.dask_engine import DIED, Engine
from pytpc.api.diagnosing import AskedMission
from pytpc.api.fleet_missions import (
    FleetMission,
    Unread,
    build_of,
    folder_name,
    opened,
    write_folder,
)
from pytpc.base.errors import InputError
from pytpc.base.wording import many
from pytpc.diagnosis.fleet.rows import Rows
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.thinned import thinned
from pytpc.fleet.data_set import Fleet, Place
from pytpc.recording.mission import load_recording

MOST_BAD = 24
"""So many bad missions are judged one by one, spread over robots and days: more say hardly more."""
GOOD_OWN, GOOD_OTHERS = 3, 4
"""So many good missions of its robot, and of its sisters, stand beside each of them."""

JUDGED = pa.schema(
    [
        pa.field("mission", pa.string()),
        pa.field("robot", pa.string()),
        pa.field("parameter", pa.string()),
        pa.field("log_probability", pa.float64()),
        pa.field("log_none", pa.float64()),
        pa.field("position", pa.int64()),
    ]
)
"""A row for each parameter that a mission suspects; missions without a suspect have none."""

_LEAST = 1e-300


@dataclass(frozen=True, slots=True)
class Judged:
    """The suspects of the missions (`JUDGED`), and the missions that cannot be read."""

    rows: pa.Table
    unread: tuple[Unread, ...] = ()


@dataclass(frozen=True, slots=True)
class _Job:
    fleet: Fleet
    bad: FleetMission
    good: tuple[Place, ...]
    build: str


def judged(
    fleet: Fleet,
    engine: Engine,
    found: Sequence[FleetMission],
    build: str,
    on_progress: Callable[[int, int], None] | None = None,
) -> Judged:
    """Judge bad missions by their marks, each beside good ones.

    Args:
        fleet: the data set.
        engine: where the tasks run.
        found: the missions, good and bad.
        build: the build whose keys and names count.
        on_progress: called with (done, in all).
    """
    good = [one for one in found if not one.is_bad]
    shared = spread(good, 2 * GOOD_OTHERS)
    jobs = [
        _Job(fleet, bad, tuple(one.place for one in _beside(bad, good, shared)), build)
        for bad in spread([one for one in found if one.is_bad and one.marks], MOST_BAD)
    ]
    return _joined(engine.map(_judged, jobs, on_progress, _lost))


def notes_on(
    found: Sequence[FleetMission], rows: Rows, unread: Sequence[Unread]
) -> tuple[str, ...]:
    """What keeps missions from counting, or bad ones from having a diagnosis.

    Args:
        found: the missions.
        rows: the digests; a mission that compared nothing has none.
        unread: the missions that could not be read, of which others are told.

    Raises:
        InputError: there are bad missions, but none of them counts.
    """
    told = {*rows.places, *((one.place.robot, one.place.mission) for one in unread)}
    bad = [one for one in found if one.is_bad]
    silent = [one for one in found if (one.place.robot, one.place.mission) not in told]
    notes = []
    if silent:
        so_bad = sum(one.is_bad for one in silent)
        what = many(len(silent), "mission")
        notes.append(f"{what} without a comparison, not counted ({so_bad:,} bad)")
        if bad and not rows.bad.any():
            raise InputError(f"no bad mission can be judged: {notes[0]}")
    if bad and not any(one.marks for one in bad):
        notes.append(
            "no bad mission has marks, so that none has a diagnosis: say when it went wrong"
        )
    return tuple(notes)


def spread(found: Sequence[FleetMission], most: int) -> list[FleetMission]:
    """At most so many missions: of each robot about as many, evenly over its time."""
    robots: defaultdict[str, list[FleetMission]] = defaultdict(list)
    for one in sorted(found, key=lambda one: (one.place.robot, one.start_ns, one.place)):
        robots[one.place.robot].append(one)
    left, chosen = most, list[FleetMission]()
    for number, own in enumerate(sorted(robots.values(), key=lambda own: (len(own), own[0].place))):
        share = min(len(own), left // (len(robots) - number))
        chosen += [own[(2 * place + 1) * len(own) // (2 * share)] for place in range(share)]
        left -= share
    return sorted(chosen, key=lambda one: one.place)


def _beside(
    bad: FleetMission, good: Sequence[FleetMission], shared: Sequence[FleetMission]
) -> list[FleetMission]:
    """The good missions that stand beside a bad one.

    Args:
        bad: it.
        good: all good ones; the nearest in time of its robot count.
        shared: some of all robots, the same for all bad ones: a worker reads each only once.
    """

    def nearest(one: FleetMission) -> tuple[int, Place]:
        return abs(one.start_ns - bad.start_ns), one.place

    own = sorted((one for one in good if one.place.robot == bad.place.robot), key=nearest)
    others = [one for one in shared if one.place.robot != bad.place.robot]
    return [*own[:GOOD_OWN], *others[:GOOD_OTHERS]]


def _judged(job: _Job) -> Judged:
    """The task of one bad mission."""
    try:
        static = build_of(job.fleet, job.build)
        good = [_good(job.fleet, place) for place in job.good]
        with opened(job.fleet, job.bad.place) as mission:
            run = mission.in_build(static)
            # Which values are wrong, the whole fleet says: nobody may have watched these missions.
            others = [one.run.in_build(static).recording for one in good if one is not None]
            asked = AskedMission.of(run, static, Question(declared=(), others=others))
            found = blame(asked.run.recording, asked.static_info, asked.question)
    except InputError as error:
        return _without(job, error.message)
    none = log(max(found.none, _LEAST))
    rows = [
        {
            "mission": job.bad.place.mission,
            "robot": job.bad.place.robot,
            "parameter": one.parameter,
            "log_probability": log(max(one.probability, _LEAST)),
            "log_none": none,
            "position": one.position,
        }
        for one in found.suspects
    ]
    return Judged(pa.Table.from_pylist(rows, schema=JUDGED))


def _lost(job: _Job) -> Judged:
    return _without(job, DIED)


def _without(job: _Job, why: str) -> Judged:
    return Judged(JUDGED.empty_table(), (Unread(job.bad.place, why),))


@dataclass(frozen=True)
class _Good:
    """A good run made small; its folder is there as long as it is."""

    folder: tempfile.TemporaryDirectory[str]
    run: RecordedRun


@lru_cache(maxsize=64)
def _of_store(url: str, patience_s: float, place: Place) -> _Good | None:
    folder = tempfile.TemporaryDirectory(prefix="pytpc-fleet-")
    path = Path(folder.name) / folder_name(place)
    try:
        write_folder(Fleet(url, patience_s), place, path)
        recording = replace(thinned(load_recording(path)), marks=())
    except InputError:
        # A good run more or less: who asks for the missions is told of it.
        folder.cleanup()
        return None
    return _Good(folder, RecordedRun(recording, path))


def _good(fleet: Fleet, place: Place) -> _Good | None:
    return _of_store(fleet.url, fleet.patience_s, place)


def _joined(parts: list[Judged]) -> Judged:
    rows = pa.concat_tables([JUDGED.empty_table(), *(part.rows for part in parts)])
    return Judged(rows, tuple(one for part in parts for one in part.unread))
