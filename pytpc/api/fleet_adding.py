"""Adds missions to a fleet's data set: finds them, makes them small, and writes them."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from importlib.metadata import version
from pathlib import Path
from typing import Literal, NamedTuple, get_args

import pyarrow as pa

from pytpc.api.comparing import RecordedRun
from pytpc.api.dask_engine import Engine
from pytpc.api.fleet_digests import comparisons_of, files_of, marks_of, mission_id, values_of
from pytpc.api.missions import check_reports, load_static, with_names_of
from pytpc.api.static_of_mission import find_static, recorded_static
from pytpc.base.checked_json import dump_json
from pytpc.base.closest import path_hint
from pytpc.base.errors import InputError, TpcError
from pytpc.fleet.store import Fleet, Place
from pytpc.fleet.tables import MISSIONS, Table
from pytpc.ingest.reading import holds_mission, read
from pytpc.recording.mission import RUN_FILE, Recording, is_converted, is_ros2_folder
from pytpc.static.static_info import StaticInfo

Keep = Literal["edges", "full"]
KEEPS: tuple[Keep, ...] = get_args(Keep)
Verdict = Literal["good", "bad"]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)

PERIOD_NS = 10 * 10**9
"""Of a comparison there is a summary for each period of this length in which it was evaluated."""
_BAGS = (".bag", ".mcap", ".db3")
_NAME = 60
_MOST_FILES = 10_000
_FIRST_REAL_NS = 10**18
"""Before 2001 no robot had reports: such a clock is simulated, or was never set."""
_DAY_NS = 86_400 * 10**9
_DAYS_APART = 2
_ROOT, _ROOTED = b'"source_root"', b'"source_root": "/'
_MOST_KNOWN = 8
_KNOWN: dict[tuple[bytes, Path | None], tuple[StaticInfo, bytes]] = {}
"""Static information that this process has read, by its content."""


class Given(NamedTuple):
    """A mission to add: its path, and the name of its robot."""

    path: Path
    robot: str


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
    it was there. ``reports`` counts its evaluations; ``notes`` are for the user.
    """

    path: Path
    place: Place | None = None
    is_new: bool = False
    reports: int = 0
    size: int = 0
    notes: tuple[str, ...] = ()
    why: str = ""


def missions_at(paths: Iterable[Path], robot: str | None = None) -> list[Given]:
    """The missions at paths, each once: recordings, and all that lie in folders, at any depth.

    A folder that is one mission by its form is one, also with several files; in other folders each
    bag is a mission.

    Args:
        paths: files and folders.
        robot: the name of their robot. None: the first folder below the given one, if the missions
            lie deeper; else the name of the given folder, or of that with the file.

    Raises:
        InputError: a path is not there, or has no mission.
    """
    found: dict[Path, Given] = {}
    for path in paths:
        if not path.exists():
            raise InputError(f"no such bag, file or folder{path_hint(path)}", path)
        before = len(found)
        for one in _below(path) if path.is_dir() else [path]:
            found.setdefault(one.absolute(), Given(one, robot or _robot_of(one, path)))
        if len(found) == before and not any(path.absolute() in one.parents for one in found):
            raise InputError("no recordings in this folder, or in those in it", path)
    return [found[path] for path in sorted(found)]


def _below(folder: Path) -> Iterator[Path]:
    if (folder / RUN_FILE).is_file() or is_converted(folder) or is_ros2_folder(folder):
        yield folder
        return
    try:
        entries = sorted(one for one in folder.iterdir() if not one.name.startswith("."))
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", folder) from error
    bags = [one for one in entries if one.suffix in _BAGS and one.is_file()]
    yield from bags
    if not bags and holds_mission(folder):
        yield folder
        return
    for one in entries:
        if one.is_dir() and not one.is_symlink():
            yield from _below(one)


def _robot_of(mission: Path, given: Path) -> str:
    given, mission = given.absolute(), mission.absolute()
    if mission == given:
        return given.parent.name or "robot"
    between = mission.relative_to(given).parts[:-1]
    return between[0] if between else given.name or "robot"


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
    known = {} if options.again else _known(fleet, before, engine)
    jobs = []
    found: dict[int, Added] = {}
    for number, one in enumerate(given):
        stamp = stamp_of(one.path, options)
        place = known.get((one.robot, stamp))
        if place is not None:
            found[number] = Added(one.path, place)
        else:
            jobs.append((number, _Job(fleet, one, options, stamp)))
    made = engine.map(_added, [job for _, job in jobs], on_progress)
    # A task may be done twice, and finds its own mission there then.
    there = set(before)
    made = [one._replace(is_new=one.place is not None and one.place not in there) for one in made]
    found |= dict(zip((number for number, _ in jobs), made, strict=True))
    return [found[number] for number in range(len(given))]


def _known(fleet: Fleet, places: Sequence[Place], engine: Engine) -> dict[tuple[str, str], Place]:
    """The missions that are there, by robot and stamp."""
    stamps = engine.map(_stamp, [(fleet, place) for place in places])
    return {
        (place.robot, stamp): place
        for place, stamp in zip(places, stamps, strict=True)
        if stamp is not None
    }


def _stamp(job: tuple[Fleet, Place]) -> str | None:
    fleet, place = job
    try:
        (stamp,) = fleet.read(place, "missions", ["stamp"])["stamp"].to_pylist()
    except (InputError, ValueError):
        return None
    return str(stamp)


def stamp_of(path: Path, options: AddOptions = AddOptions()) -> str:
    """A digest of the names, sizes and times of a mission's files, and of how it is added."""
    digest = hashlib.sha256(f"{options.keep} {options.verdict} {options.day}".encode())
    digest.update(str(path.absolute()).encode("utf-8", "surrogateescape"))
    files = [path, *path.parent.glob(f"{path.name}.*")] if path.is_file() else _files_in(path)
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
    return Added(path, why=why.removeprefix(f"{path}: "))


def _added_anew(job: _Job) -> Added:
    fleet, (path, robot), options, stamp = job
    recording = read(path, period_ns=PERIOD_NS if options.keep == "edges" else None)
    static, content = _static_for(path, recording, options.static)
    check_reports(recording, static, path)
    run = RecordedRun(recording, path)
    comparisons = comparisons_of(recording, with_names_of(recording, static, path))
    day, notes = _day_of(recording, path, options.day)
    notes = (*recording.notes, *notes)
    build = hashlib.sha256(content).hexdigest()[:16]
    evaluations = sum(comparisons["evaluations"].to_pylist())
    row = {
        "name": _name_of(path),
        "source": str(path.absolute()).encode("utf-8", "backslashreplace").decode(),
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
    return Added(path, place, True, evaluations, size, notes)


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


def _name_of(path: Path) -> str:
    name = path.name if path.is_dir() else path.stem
    return re.sub(r"[^A-Za-z0-9_.-]+", "-", name).strip(".-")[:_NAME] or "mission"


def _day_of(recording: Recording, path: Path, given: str | None) -> tuple[str, tuple[str, ...]]:
    """The day of a mission, and notes about its clock: by the reports, or else by the files."""
    if given is not None:
        return given, ()
    written_ns = min(
        (file.stat().st_mtime_ns for file in (_files_in(path) if path.is_dir() else [path])),
        default=0,
    )
    start_ns = recording.start_ns
    if start_ns < _FIRST_REAL_NS:
        return _day(written_ns), ()
    if start_ns > written_ns + _DAYS_APART * _DAY_NS:
        what = f"its clock says {_day(start_ns)}, but its files are of {_day(written_ns)}"
        return _day(written_ns), (f"{what}: that is taken as its day",)
    return _day(start_ns), ()


def _day(time_ns: int) -> str:
    return datetime.fromtimestamp(time_ns // 10**9, tz=timezone.utc).date().isoformat()
