"""The missions of a fleet's data set: which there are, and one of them as a recording again."""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import pyarrow as pa
import pyarrow.parquet as pq

from pytpc.api.comparing import RecordedRun
from pytpc.api.dask_engine import Engine
from pytpc.base.closest import did_you_mean
from pytpc.base.errors import InputError, TpcError
from pytpc.base.paths import MERGED_FILE
from pytpc.base.wording import plain
from pytpc.fleet.data_set import Fleet, Place
from pytpc.fleet.store import shown_url
from pytpc.fleet.tables import COMMIT, MISSIONS
from pytpc.recording.mission import EVENTS_FILE, SUMMARIES_FILE, load_recording
from pytpc.static.static_info import StaticInfo

_ROW = tuple(name for name in MISSIONS.names if name != "files")
_TOLD = tuple(name for name in _ROW if name != "stamp")
_NAME = 200
_TRIES = 5
_TOGETHER = 16
"""So many missions are read by one task: each has a small row."""


@dataclass(frozen=True, slots=True)
class FleetMission:
    """A mission of a fleet; times are on the clock of its reports, the rest is as in `MISSIONS`."""

    place: Place
    name: str
    source: str
    build: str
    verdict: str
    keep: str
    tpc: str
    start_ns: int
    end_ns: int
    reports: int
    rows: int
    marks: int
    seconds: float
    notes: tuple[str, ...]
    stamp: str = ""

    @property
    def is_bad(self) -> bool:
        """Whether it went wrong."""
        return self.verdict == "bad"

    def to_json(self) -> dict[str, Any]:
        """What a person may ask for, as plain data."""
        document = asdict(self)
        del document["place"], document["stamp"]
        return {**self.place._asdict(), **document}


class Unread(NamedTuple):
    """A mission that cannot be read, and why."""

    place: Place
    why: str


class Missions(NamedTuple):
    """The missions that were asked for, by robot, day and name; and what could not be read."""

    found: tuple[FleetMission, ...]
    unread: tuple[Unread, ...] = ()


@dataclass(frozen=True, slots=True)
class Selection:
    """Which missions are meant: those of these robots, days (both included), verdict and build."""

    robots: tuple[str, ...] = ()
    since: str | None = None
    until: str | None = None
    verdict: str | None = None
    build: str | None = None

    def has_place(self, place: Place) -> bool:
        """Whether a mission is meant, as far as its place tells."""
        return (
            (not self.robots or place.robot in self.robots)
            and (self.since is None or place.day >= self.since)
            and (self.until is None or place.day <= self.until)
        )

    def has(self, mission: FleetMission) -> bool:
        """Whether a mission is meant."""
        return (
            self.has_place(mission.place)
            and self.verdict in {None, mission.verdict}
            and (self.build is None or mission.build.startswith(self.build))
        )


EVERY = Selection()
"""All missions."""


def missions(
    fleet: Fleet,
    engine: Engine,
    selection: Selection = EVERY,
    on_progress: Callable[[int, int], None] | None = None,
) -> Missions:
    """The missions of a data set.

    Args:
        fleet: the data set.
        engine: reads them.
        selection: which.
        on_progress: called with (done, in all).

    Raises:
        InputError: there is no such data set, or no such robot.
        TpcError: the store does not answer.
    """
    fleet.check()
    every = fleet.places()
    known = sorted({place.robot for place in every})
    for robot in selection.robots:
        if robot not in known:
            hint = did_you_mean(robot, known)
            raise InputError(f"has no robot {plain(robot)}{hint}", shown_url(fleet.url))
    places = [place for place in every if selection.has_place(place)]
    read = missions_in(fleet, engine, places, on_progress)
    return Missions(tuple(one for one in read.found if selection.has(one)), read.unread)


def missions_in(
    fleet: Fleet,
    engine: Engine,
    places: Sequence[Place],
    on_progress: Callable[[int, int], None] | None = None,
) -> Missions:
    """The missions at places, but for those that somebody removed meanwhile; see ``missions``."""
    parts = [(fleet, tuple(places[at : at + _TOGETHER])) for at in range(0, len(places), _TOGETHER)]
    return engine.joined(_read, parts, _joined, on_progress)


def _read(part: tuple[Fleet, tuple[Place, ...]]) -> Missions:
    """The task of a few missions."""
    fleet, places = part
    found, unread = [], []
    for place in places:
        try:
            (row,) = fleet.read(place, COMMIT, _ROW).to_pylist()
        except InputError as error:
            unread.append(Unread(place, error.message))
            continue
        except ValueError:
            # Somebody removed it meanwhile.
            continue
        found.append(FleetMission(place, **{**row, "notes": tuple(row["notes"])}))
    return Missions(tuple(found), tuple(unread))


def _joined(parts: list[Missions]) -> Missions:
    found = tuple(one for part in parts for one in part.found)
    return Missions(found, tuple(one for part in parts for one in part.unread))


def once_each(
    found: Sequence[FleetMission],
) -> tuple[tuple[FleetMission, ...], tuple[Unread, ...]]:
    """The missions, each on its first day only; and those that are there again on another day.

    A mission whose clock says nothing has the day of its files, which a copy may have changed.
    """
    first: dict[tuple[str, str], FleetMission] = {}
    again = []
    for one in sorted(found, key=lambda one: one.place.day):
        other = first.setdefault((one.place.robot, one.place.mission), one)
        if other is not one:
            why = f"is there on {other.place.day}, too, and counts only then: drop one of both"
            again.append(Unread(one.place, why))
    kept = {one.place for one in first.values()}
    return tuple(one for one in found if one.place in kept), tuple(again)


def meant(fleet: Fleet, name: str) -> Place:
    """The mission that a person means by its name in the data set, or by that of its recording.

    Raises:
        InputError: there is none, or several.
    """
    places = fleet.places()
    found = [place for place in places if name in (place.mission, "/".join(place))]
    found = found or [place for place in places if place.mission.rpartition("-")[0] == name]
    if len(found) == 1:
        return found[0]
    if not found:
        hint = did_you_mean(name, [place.mission for place in places])
        raise InputError(f"has no mission {plain(name)}{hint}", shown_url(fleet.url))
    which = ", ".join("/".join(place) for place in found[:3])
    what = f"has {len(found)} missions {plain(name)}; give one of: {plain(which)}"
    raise InputError(what, shown_url(fleet.url))


def write_folder(fleet: Fleet, place: Place, folder: Path) -> None:
    """Write a mission as a folder that all other commands take.

    Args:
        fleet: the data set.
        place: of the mission.
        folder: a new or empty one.

    Raises:
        InputError: the mission is broken or not there, or the folder has something in it.
        TpcError: the folder cannot be written, or the store does not answer.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError("is there already; give a new -o FOLDER", folder)
    row, events, summaries = _whole(fleet, place)
    files = dict(row["files"]) | {MERGED_FILE: fleet.build(str(row["build"]))}
    tables = {EVENTS_FILE: events}
    if len(summaries):
        tables[SUMMARIES_FILE] = summaries
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        staged = Path(tempfile.mkdtemp(prefix=f".{folder.name[:60]}.", dir=folder.parent))
        try:
            for name, content in files.items():
                # A name from somebody else's data set.
                if name == os.path.basename(name) and name not in {"", ".", ".."}:  # noqa: PTH119
                    (staged / name).write_bytes(content)
            for name, table in tables.items():
                pq.write_table(table, staged / name, compression="zstd")
            staged.chmod(0o755)
            staged.replace(folder)
        finally:
            shutil.rmtree(staged, ignore_errors=True)
    except OSError as error:
        raise TpcError(f"cannot be written: {error.strerror or error}", folder) from error


def _whole(fleet: Fleet, place: Place) -> tuple[dict[str, Any], pa.Table, pa.Table]:
    """The row of a mission, its reports and its summaries, all of one version of it."""
    named = plain("/".join(place))
    columns = ["build", "files", "stamp", "keep", "rows"]
    for _ in range(_TRIES):
        rows = fleet.read(place, COMMIT, columns).to_pylist()
        if len(rows) != 1:
            raise InputError(f"has no mission {named}", shown_url(fleet.url))
        tables = fleet.read(place, "reports"), fleet.read(place, "summaries")
        if fleet.read(place, COMMIT, columns).to_pylist() != rows:
            continue
        if len(tables[0]) != rows[0]["rows"]:
            what = f"has not all reports of {named}: add it again"
            raise InputError(what, shown_url(fleet.url))
        return rows[0], *tables
    raise InputError(f"{named} is replaced again and again; try later", shown_url(fleet.url))


def folder_name(place: Place) -> str:
    """The name of a mission as that of a folder: in somebody else's data set it may be a path.

    >>> folder_name(Place("a", "2026-11-30", "/etc/x"))
    '-etc-x'
    """
    return re.sub(r"[^A-Za-z0-9_.-]", "-", place.mission).lstrip(".")[:_NAME] or "mission"


@contextmanager
def opened(fleet: Fleet, place: Place) -> Iterator[RecordedRun]:
    """A mission as all other functions take one; its folder is there until the end of the block.

    Raises:
        InputError: it is broken, or not there.
        TpcError: the store does not answer.
    """
    with tempfile.TemporaryDirectory(prefix="pytpc-fleet-") as scratch:
        folder = Path(scratch) / folder_name(place)
        write_folder(fleet, place, folder)
        yield RecordedRun(load_recording(folder), folder)


@lru_cache(maxsize=4)
def _build(url: str, patience_s: float, name: str) -> StaticInfo:
    content = Fleet(url, patience_s).build(name)
    with tempfile.TemporaryDirectory(prefix="pytpc-fleet-") as scratch:
        path = Path(scratch) / MERGED_FILE
        path.write_bytes(content)
        return StaticInfo.load(path)


def build_of(fleet: Fleet, name: str) -> StaticInfo:
    """The static information of a build; that of the last few is kept in memory.

    Raises:
        InputError: it is missing or broken.
    """
    return _build(fleet.url, fleet.patience_s, name)


def table_of(found: Sequence[FleetMission]) -> pa.Table:
    """The missions as a table."""
    own = [field for field in MISSIONS if field.name in _TOLD]
    places = [pa.field(name, pa.string()) for name in Place._fields]
    return pa.Table.from_pylist([one.to_json() for one in found], schema=pa.schema([*places, *own]))
