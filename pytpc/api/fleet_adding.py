"""Adds missions to a fleet's data set: makes them small, and writes them."""

from __future__ import annotations

import glob
import hashlib
import os
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from importlib.metadata import version
from pathlib import Path
from typing import Literal, NamedTuple, get_args

import pyarrow as pa

from pytpc.api.comparing import RecordedRun
from pytpc.api.dask_engine import DIED, Engine
from pytpc.api.fleet_digests import comparisons_of, files_of, marks_of, mission_id, values_of
from pytpc.api.fleet_given import BAGS, Given
from pytpc.api.fleet_missions import FleetMission, missions_in
from pytpc.api.missions import check_reports, load_static, with_names_of
from pytpc.api.static_of_mission import find_static, recorded_static
from pytpc.base.checked_json import dump_json
from pytpc.base.errors import TpcError
from pytpc.base.legal_names import file_part
from pytpc.base.wording import plain
from pytpc.fleet.data_set import Fleet, Place
from pytpc.fleet.tables import MISSIONS, Table
from pytpc.ingest.reading import read
from pytpc.recording.marks_home import marks_home
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import origins_file
from pytpc.values.recording import params_file

Keep = Literal["edges", "full"]
KEEPS: tuple[Keep, ...] = get_args(Keep)
Verdict = Literal["good", "bad"]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)

PERIOD_NS = 10 * 10**9
"""Of a comparison there is a summary for each period of this length in which it was evaluated."""
_RECORDED = (*BAGS, ".tpc", ".parquet", ".log")
_MOST_FILES = 10_000
_FIRST_REAL_NS = 10**18
"""Before 2001 no robot had reports: such a clock is simulated, or was never set."""
_DAY_NS = 86_400 * 10**9
_DAYS_APART = 2
_ROOT, _ROOTED = b'"source_root"', b'"source_root": "/'
_MOST_KNOWN = 8
_KNOWN: dict[tuple[bytes, Path | None], tuple[StaticInfo, bytes]] = {}
"""Static information that this process has read, by its content."""


@dataclass(frozen=True, slots=True)
class AddOptions:
    """How missions are added.

    Attributes:
        static: their static information; None: that of each mission.
        keep: what is kept of the reports.
        verdict: whether they went right; None: those with marks went wrong.
        day: on which they were; None: by their clocks.
        again: add also what is there.
    """

    static: Path | None = None
    keep: Keep = "edges"
    verdict: Verdict | None = None
    day: str | None = None
    again: bool = False


class Added(NamedTuple):
    """What became of a mission.

    ``place`` is None where it could not be added: then ``why`` says why. ``is_new`` is false where
    it was there. ``reports`` counts its evaluations; ``notes`` are for the user. ``replaced`` are
    places that it had before: on another day, or when less of it was recorded.
    """

    path: Path
    place: Place | None = None
    is_new: bool = False
    reports: int = 0
    size: int = 0
    notes: tuple[str, ...] = ()
    why: str = ""
    replaced: tuple[Place, ...] = ()


def add(
    fleet: Fleet,
    given: Sequence[Given],
    options: AddOptions,
    engine: Engine,
    on_progress: Callable[[int, int], None] | None = None,
) -> list[Added]:
    """Add missions to a data set, which is made if needed; one that is there is passed over.

    Args:
        fleet: the data set.
        given: the missions.
        options: how.
        engine: where the work is done, one task for each mission.
        on_progress: called with (missions done, missions in all).

    Returns:
        What became of each, in their order. A mission that cannot be read is none of the errors.

    Raises:
        TpcError: the data set cannot be written.
    """
    fleet.begin()
    before = fleet.places()
    robots = {one.robot for one in given}
    own = missions_in(fleet, engine, [place for place in before if place.robot in robots])
    known: defaultdict[tuple[str, str], list[FleetMission]] = defaultdict(list)
    for mission in own.found:
        known[mission.place.robot, mission.source].append(mission)
    build = None if options.static is None else _hash(_merged(options.static)[1])
    jobs = []
    found: dict[int, Added] = {}
    for number, one in enumerate(given):
        if one.why:
            found[number] = Added(one.path, why=one.why)
            continue
        try:
            stamp = stamp_of(one.path)
        except OSError as error:
            found[number] = Added(one.path, why=f"cannot be read: {error.strerror or error}")
            continue
        earlier = known[one.robot, _source(one.path)]
        there = [mission for mission in earlier if _is_as_asked(mission, stamp, build, options)]
        if there and not options.again:
            found[number] = Added(one.path, there[0].place)
        else:
            jobs.append((number, _Job(fleet, one, options, stamp, tuple(earlier))))
    made = engine.map(_added, [job for _, job in jobs], on_progress, _lost)
    # A task may be done twice, and finds its own mission there then.
    made = _told(made, before)
    found |= dict(zip((number for number, _ in jobs), made, strict=True))
    return [found[number] for number in range(len(given))]


def _told(made: Iterable[Added], before: Iterable[Place]) -> list[Added]:
    """Missions with what is known of them: whether each is new, or is there a second time."""
    places: defaultdict[str, set[Place]] = defaultdict(set)
    for known in before:
        places[known.mission].add(known)
    told = []
    for one in made:
        place, notes = one.place, one.notes
        if place is not None:
            there = places[place.mission]
            if twice := sorted(there - {place, *one.replaced}):
                named = plain("/".join(twice[0]))
                notes = (*notes, f"is there as {named}, too: it counts twice until you drop one")
            told.append(one._replace(is_new=place not in there, notes=notes))
        else:
            told.append(one)
    return told


def _is_as_asked(earlier: FleetMission, stamp: str, build: str | None, options: AddOptions) -> bool:
    """Whether what is there is of the same files; other options may be as somebody asked then."""
    return (
        earlier.stamp == stamp
        and earlier.keep in {options.keep, "full"}
        and options.verdict in {None, earlier.verdict}
        and options.day in {None, earlier.place.day}
        and build in {None, earlier.build}
    )


def _is_replaced_by(earlier: FleetMission, place: Place, start_ns: int) -> bool:
    """Whether a mission of the same path is the same one, longer or on another day."""
    is_same = earlier.place.mission == place.mission
    grew = earlier.start_ns == start_ns >= _FIRST_REAL_NS
    return earlier.place != place and (is_same or grew)


def _source(path: Path) -> str:
    return str(path.absolute()).encode("utf-8", "backslashreplace").decode()


def stamp_of(path: Path) -> str:
    """A digest of the names, sizes and times of a mission's files, and of those beside it.

    Raises:
        OSError: one of them cannot be read, or has just gone.
    """
    digest = hashlib.sha256()
    files = {path} if path.is_file() else set(_files_in(path))
    home = marks_home(path)
    files |= {*home.files(), *home.files_nearby()}
    if path.is_file():
        files |= set(path.parent.glob(f"{glob.escape(path.name)}.*"))
        beside = params_file(path), origins_file(path)
        files |= {one for one in beside if one is not None and one.is_file()}
    for file in sorted(files)[:_MOST_FILES]:
        found = file.stat()
        told = f"\0{file.name}\0{found.st_size}\0{found.st_mtime_ns}"
        digest.update(told.encode("utf-8", "surrogateescape"))
    return digest.hexdigest()


def _files_in(folder: Path) -> list[Path]:
    return [
        Path(where, name)
        for where, _, names in os.walk(folder)
        for name in names
        if Path(where, name).is_file()
    ]


class _Job(NamedTuple):
    fleet: Fleet
    given: Given
    options: AddOptions
    stamp: str
    earlier: tuple[FleetMission, ...]


def _added(job: _Job) -> Added:
    """The task of one mission."""
    path = job.given.path
    try:
        return _added_anew(job)
    except TpcError as error:
        why = str(error)
    except OSError as error:
        why = f"cannot be read: {error.strerror or error}"
    except MemoryError:
        why = "does not fit into memory"
    except ValueError as error:  # one broken mission among thousands ends nothing
        why = f"cannot be read: {error}"
    return Added(path, why=why.removeprefix(f"{path}: "))


def _lost(job: _Job) -> Added:
    return Added(job.given.path, why=DIED)


def _added_anew(job: _Job) -> Added:
    fleet, (path, robot, _), options, stamp, earlier = job
    recording = read(path, period_ns=PERIOD_NS if options.keep == "edges" else None)
    static, content = _static_for(path, recording, options.static)
    check_reports(recording, static, path)
    run = RecordedRun(recording, path)
    comparisons = comparisons_of(recording, with_names_of(recording, static, path))
    day, notes = _day_of(recording, path, options.day)
    notes = (*recording.notes, *notes)
    build = _hash(content)
    evaluations = sum(comparisons["evaluations"].to_pylist())
    row = {
        "name": _name_of(path),
        "source": _source(path),
        "stamp": stamp,
        "build": build,
        "verdict": options.verdict or ("bad" if recording.marks else "good"),
        "keep": options.keep,
        "tpc": version("pytpc"),
        "start_ns": recording.start_ns,
        "end_ns": recording.end_ns,
        "reports": evaluations,
        "rows": len(recording.events),
        "marks": len(recording.marks),
        "seconds": recording.seconds,
        "notes": list(notes),
        "files": list(files_of(recording, path).items()),
    }
    tables: dict[Table, pa.Table] = {
        "missions": pa.Table.from_pylist([row], schema=MISSIONS),
        "reports": recording.events.to_arrow(),
        "summaries": recording.summaries.to_arrow(),
        "comparisons": comparisons,
        "values": values_of(run),
        "marks": marks_of(recording.marks),
    }
    fleet.put_build(build, content)
    place = Place(robot, day, mission_id(_name_of(path), comparisons))
    size = fleet.write(place, tables)
    start_ns = recording.start_ns
    replaced = tuple(one.place for one in earlier if _is_replaced_by(one, place, start_ns))
    for one in replaced:
        fleet.drop(one)
    return Added(path, place, True, evaluations, size, notes, replaced=replaced)


def _static_for(path: Path, recording: Recording, given: Path | None) -> tuple[StaticInfo, bytes]:
    """The static information of a mission, and its merged file."""
    source = given
    if source is None:
        source = recorded_static(path, recording) or find_static(path, recording).path
    if not source.is_file():
        return _merged(source)
    content = source.read_bytes()
    # Missions of one build have copies of one file, which mostly has absolute paths alone.
    is_rooted = content.count(_ROOTED) == content.count(_ROOT)
    known = _KNOWN.get((content, None if is_rooted else source.parent))
    if known is None:
        if len(_KNOWN) >= _MOST_KNOWN:
            _KNOWN.clear()
        known = _KNOWN[content, None if is_rooted else source.parent] = _merged(source)
    return known


def _merged(source: Path) -> tuple[StaticInfo, bytes]:
    static = load_static(source)
    return static, dump_json(static.to_json())


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:16]


def _name_of(path: Path) -> str:
    return file_part(path.name if path.is_dir() else path.stem, "mission")


def _day_of(recording: Recording, path: Path, given: str | None) -> tuple[str, tuple[str, ...]]:
    """The day of a mission, and notes about its clock: by the reports, or else by the files."""
    if given is not None:
        return given, ()
    files = _files_in(path) if path.is_dir() else [path]
    # Other files in a folder may be older, or newer.
    files = [one for one in files if one.suffix in _RECORDED] or files
    written = [one.stat().st_mtime_ns for one in files] or [0]
    start_ns = recording.start_ns
    if start_ns < _FIRST_REAL_NS:
        return _day(min(written)), ()
    if start_ns > max(written) + _DAYS_APART * _DAY_NS:
        day = _day(min(written))
        what = f"its clock says {_day(start_ns)}, but its files are of {day}"
        return day, (f"{what}: that is taken as its day",)
    return _day(start_ns), ()


def _day(time_ns: int) -> str:
    return datetime.fromtimestamp(time_ns // 10**9, tz=timezone.utc).date().isoformat()
