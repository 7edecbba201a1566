"""A recorded mission: its events, its marks, and records that could not be read.

On disk it is a folder with ``events.parquet``, ``marks.json`` and, where there are summaries,
``summaries.parquet`` (docs/reference/formats.md).
"""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.recording.events import Events
from pytpc.recording.marks import MARK_TYPES, Mark, with_short_note
from pytpc.recording.parameter_values import SetValue
from pytpc.recording.summaries import Summaries
from pytpc.static.wiring import Wiring

EVENTS_FILE = "events.parquet"
SUMMARIES_FILE = "summaries.parquet"
MARKS_FILE = "marks.json"
RUN_FILE = "run.json"
REPORTS_FOLDER = "tpc"
"""A folder with this file is a recorded mission, and has its nodes' files in this folder."""
ROS2_FILE = "metadata.yaml"
"""A folder with this file is a bag of rosbag2."""
_SCHEMA = 1
_LARGEST_RUN = 16 << 20
_LATEST = 2**63


@dataclass(frozen=True, slots=True)
class MalformedRecord:
    """A record that was skipped: its place and the reason. ``text`` is cut to 200 characters."""

    topic: str
    time_ns: int
    what: str
    text: str


@dataclass(frozen=True, slots=True)
class Dropped:
    """Reports that the instrumented process dropped, and why.

    ``key`` is empty if the comparison is not known; ``flops`` of the ``count`` were flops; ``why``
    is ``site`` or ``process`` (a cap on reports per second), ``nested`` (made while another report
    was) or ``stopped`` (the sink could not go on).
    """

    key: str
    node: str
    count: int
    flops: int
    why: str

    def order(self) -> tuple[str, str, str]:
        """Sorting by this is deterministic."""
        return (self.node, self.key, self.why)


@dataclass(frozen=True, slots=True, order=True)
class ReadName:
    """The full name of the parameter that a node has read: ``/node/arm/limit``.

    ``key`` is that of the read in the static information. ``object`` is the number of the object in
    which it was read, as the process counts them; 0 if that is not said. Without a name, that
    object evaluates the comparison ``key``.
    """

    key: str
    node: str
    name: str
    object: int = 0


@dataclass(frozen=True)
class Recording:
    """One mission.

    ``summaries`` is what the policy ``edges`` keeps of the evaluations that are not in ``events``.

    ``malformed`` counts the records that were skipped, ``malformed_first`` has the first 20.
    ``lost`` has for each node how many of its log messages never reached the recorder.
    ``start_ns`` and ``end_ns`` are on the clock of the events. ``notes`` are sentences for the user
    about what was read and what was left out. ``dropped`` is what the processes themselves counted,
    and ``names`` the full names of parameters that they reported, sorted. ``values`` are those of
    parameters over time, where they were recorded (ROS 2); ``ParameterValues`` looks them up.
    ``wiring`` are the nodes and their topics; None if nobody has looked for them.
    """

    name: str
    events: Events
    marks: tuple[Mark, ...]
    start_ns: int
    end_ns: int
    malformed: int = 0
    malformed_first: tuple[MalformedRecord, ...] = ()
    lost: dict[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    summaries: Summaries = field(default_factory=Summaries.empty)
    dropped: tuple[Dropped, ...] = ()
    names: tuple[ReadName, ...] = ()
    values: tuple[SetValue, ...] = ()
    wiring: Wiring | None = None

    @cached_property
    def nodes_of(self) -> Mapping[str, frozenset[str]]:
        """The nodes that evaluated each comparison, by key."""
        found = defaultdict(set)
        for table in (self.events, self.summaries):
            seen = np.zeros((len(table.keys), len(table.nodes)), np.bool_)
            seen[table.key, table.node] = True
            for key, node in np.argwhere(seen).tolist():
                found[table.keys[key]].add(table.nodes[node])
        return {key: frozenset(nodes) for key, nodes in found.items()}

    def with_keys(self, new: Callable[[str], str]) -> Recording:
        """The recording with other keys: ``new`` gives a different one for each."""
        events, summaries = self.events, self.summaries
        return replace(
            self,
            events=replace(events, keys=tuple(map(new, events.keys))),
            summaries=replace(summaries, keys=tuple(map(new, summaries.keys))),
            names=tuple(sorted(replace(one, key=new(one.key)) for one in self.names)),
        )

    @property
    def seconds(self) -> float:
        """How long the mission took."""
        return (self.end_ns - self.start_ns) / 1e9


def is_converted(path: Path) -> bool:
    """Whether ``pytpc convert`` wrote this folder."""
    return (path / MARKS_FILE).is_file() and (path / EVENTS_FILE).is_file()


def is_ros2_folder(path: Path) -> bool:
    """Whether rosbag2 wrote this folder."""
    return (path / ROS2_FILE).is_file()


def read_run(folder: Path) -> dict[str, Any]:
    """run.json of a mission's folder; empty if there is none that can be read."""
    path = folder / RUN_FILE
    try:
        if not path.is_file() or path.stat().st_size > _LARGEST_RUN:
            return {}
        document = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return {}
    return document if isinstance(document, dict) else {}


def save_recording(recording: Recording, folder: Path) -> None:
    """Write the files of a recording, each atomically; ``marks.json`` last.

    Raises:
        TpcError: a file cannot be written.
    """
    recording.events.write(folder / EVENTS_FILE)
    if len(recording.summaries):
        recording.summaries.write(folder / SUMMARIES_FILE)
    write_marks_json(recording, folder, len(recording.events), len(recording.summaries))


def write_marks_json(recording: Recording, folder: Path, events: int, summaries: int) -> None:
    """Write ``marks.json`` for tables of this many rows, and delete a leftover file of summaries.

    Raises:
        TpcError: the file cannot be written.
    """
    write_atomic(folder / MARKS_FILE, marks_json(recording, events, summaries))
    if not summaries:
        (folder / SUMMARIES_FILE).unlink(missing_ok=True)


def marks_json(recording: Recording, events: int, summaries: int) -> bytes:
    """The content of ``marks.json`` for tables of this many rows."""
    document = {
        "schema": _SCHEMA,
        "name": recording.name,
        "start_ns": recording.start_ns,
        "end_ns": recording.end_ns,
        "events": events,
        "summaries": summaries,
        "marks": [asdict(mark) for mark in recording.marks],
        "malformed": recording.malformed,
        "malformed_first": [asdict(record) for record in recording.malformed_first],
        "lost": recording.lost,
        "dropped": [asdict(dropped) for dropped in recording.dropped],
        "names": [
            {"key": one.key, "node": one.node, "name": one.name}
            for one in recording.names
            if not one.object
        ],
        "objects": [asdict(one) for one in recording.names if one.object],
        "notes": list(recording.notes),
        "values": [one._asdict() for one in recording.values],
    }
    text = json.dumps(document, indent=1, sort_keys=True, ensure_ascii=False)
    return text.encode("utf-8", "backslashreplace") + b"\n"


def load_recording(folder: Path) -> Recording:
    """Read a folder of ``save_recording``.

    Raises:
        InputError: a file is missing or broken, or the files are not of one recording.
    """
    recording, event_count, summary_count = read_marks_json(folder)
    events = Events.read(folder / EVENTS_FILE)
    check_rows(folder, EVENTS_FILE, event_count, len(events))
    # Without a count in marks.json, a file of summaries is a leftover.
    summaries = Summaries.read(folder / SUMMARIES_FILE) if summary_count else Summaries.empty()
    check_rows(folder, SUMMARIES_FILE, summary_count, len(summaries))
    return replace(recording, events=events, summaries=summaries)


def read_marks_json(folder: Path) -> tuple[Recording, int, int]:
    """Read only ``marks.json``: a recording with empty tables, and their number of rows on disk.

    Raises:
        InputError: the file is missing or broken.
    """
    path = folder / MARKS_FILE
    document = parse_json(path, half_characters=True)
    try:
        return _recording(document)
    except (AttributeError, KeyError, TypeError, ValueError, OverflowError) as error:
        raise InputError(f"not the marks of a recording: {_why(error)}", path) from error


def check_rows(folder: Path, name: str, said: int, found: int) -> None:
    """Check that the table ``name`` has as many rows as ``marks.json`` says.

    Raises:
        InputError: it has not.
    """
    if said != found:
        what = f"{said} {name.removesuffix('.parquet')}, but {name} has {found}"
        raise InputError(f"is of a recording with {what}", folder / MARKS_FILE)


def _recording(document: object) -> tuple[Recording, int, int]:
    if not isinstance(document, dict) or document.get("schema") != _SCHEMA:
        raise ValueError(f"not of format {_SCHEMA}, the only one that this TPC reads")
    marks = [Mark(**mark) for mark in document["marks"]]
    for mark in marks:
        if type(mark.time_ns) is not int or not isinstance(mark.observer, str):
            raise ValueError("a mark without a time in ns or an observer")
        if not -_LATEST <= mark.time_ns < _LATEST:
            raise ValueError(f"a mark at {mark.time_ns:.3g} ns")
        if not isinstance(mark.note, str):
            raise ValueError("a mark whose note is not text")
        if mark.type is not None and mark.type not in MARK_TYPES:
            raise ValueError(f"a mark of type {mark.type!r}")
    recording = Recording(
        name=str(document["name"]),
        events=Events.empty(),
        marks=tuple(sorted(map(with_short_note, marks), key=Mark.order)),
        start_ns=int(document["start_ns"]),
        end_ns=int(document["end_ns"]),
        malformed=int(document["malformed"]),
        malformed_first=tuple(MalformedRecord(**item) for item in document["malformed_first"]),
        lost={str(node): int(count) for node, count in document["lost"].items()},
        notes=tuple(str(note) for note in document["notes"]),
        dropped=tuple(Dropped(**item) for item in document.get("dropped", [])),
        names=tuple(
            sorted(
                ReadName(**item) for name in ("names", "objects") for item in document.get(name, [])
            )
        ),
        values=tuple(SetValue(**item) for item in document.get("values", [])),
    )
    for record in recording.malformed_first:
        texts = (record.topic, record.what, record.text)
        if type(record.time_ns) is not int or not all(isinstance(one, str) for one in texts):
            raise ValueError("a broken report whose fields are of other types")
    times = [recording.start_ns, recording.end_ns]
    times += [record.time_ns for record in recording.malformed_first]
    if not all(-_LATEST <= time < _LATEST for time in times):
        raise ValueError("a time beyond 64 bits")
    # Files of older versions say nothing of summaries.
    return recording, int(document["events"]), int(document.get("summaries", 0))


def _why(error: Exception) -> str:
    return f"{error} is missing" if isinstance(error, KeyError) else str(error)
