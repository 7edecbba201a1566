"""A mission as it was recorded: its events, its marks, and what could not be read of it.

On disk it is a folder with ``events.parquet`` and ``marks.json`` (docs/formats.md).
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

from pytpc.atomic import write_atomic
from pytpc.errors import InputError
from pytpc.events import Events, read_parquet, write_parquet
from pytpc.marks import MARK_TYPES, Mark

EVENTS_FILE = "events.parquet"
MARKS_FILE = "marks.json"
_SCHEMA = 1


@dataclass(frozen=True, slots=True)
class MalformedRecord:
    """A record that was skipped: where it stood, and why. ``text`` is cut to 200 characters."""

    topic: str
    time_ns: int
    what: str
    text: str


@dataclass(frozen=True)
class Recording:
    """One mission.

    ``malformed`` counts the records that were skipped, ``malformed_first`` has the first 20.
    ``lost`` has for each node how many of its log messages never reached the recorder.
    ``start_ns`` and ``end_ns`` are on the clock of the events. ``notes`` are sentences for the user
    about what was read and what was left out.
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

    @property
    def seconds(self) -> float:
        """How long the mission took."""
        return (self.end_ns - self.start_ns) / 1e9


def save_recording(recording: Recording, folder: Path) -> None:
    """Write the two files of a recording, each atomically; ``marks.json`` last.

    Raises:
        TpcError: a file cannot be written.
    """
    write_parquet(recording.events, folder / EVENTS_FILE)
    document = {
        "schema": _SCHEMA,
        "name": recording.name,
        "start_ns": recording.start_ns,
        "end_ns": recording.end_ns,
        "events": len(recording.events),
        "marks": [asdict(mark) for mark in recording.marks],
        "malformed": recording.malformed,
        "malformed_first": [asdict(record) for record in recording.malformed_first],
        "lost": recording.lost,
        "notes": list(recording.notes),
    }
    text = json.dumps(document, indent=1, sort_keys=True, ensure_ascii=False)
    write_atomic(folder / MARKS_FILE, text.encode("utf-8", "backslashreplace") + b"\n")


def load_recording(folder: Path) -> Recording:
    """Read the folder that ``save_recording`` wrote.

    Raises:
        InputError: a file is missing or broken, or the two files are not of one recording.
    """
    path = folder / MARKS_FILE
    try:
        text = path.read_bytes().decode("utf-8")
        document = json.loads(text)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", path) from error
    except json.JSONDecodeError as error:
        raise InputError(f"not JSON: {error.msg}", path, error.lineno) from error
    except UnicodeDecodeError as error:
        raise InputError(f"not JSON: byte {error.start} is not UTF-8", path) from error
    events = read_parquet(folder / EVENTS_FILE)
    try:
        recording = _recording(document, events)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"not the marks of a recording: {_why(error)}", path) from error
    if document["events"] != len(events):
        raise InputError(
            f"is of a recording with {document['events']} events, but {EVENTS_FILE} has"
            f" {len(events)}",
            path,
        )
    return recording


def _recording(document: object, events: Events) -> Recording:
    if not isinstance(document, dict) or document.get("schema") != _SCHEMA:
        raise ValueError(f"schema {_SCHEMA} is read")
    marks = [Mark(**mark) for mark in document["marks"]]
    for mark in marks:
        if type(mark.time_ns) is not int or not isinstance(mark.observer, str):
            raise ValueError("a mark without a time in ns or an observer")
        if mark.type is not None and mark.type not in MARK_TYPES:
            raise ValueError(f"a mark of type {mark.type!r}")
    return Recording(
        name=str(document["name"]),
        events=events,
        marks=tuple(sorted(marks, key=Mark.order)),
        start_ns=int(document["start_ns"]),
        end_ns=int(document["end_ns"]),
        malformed=int(document["malformed"]),
        malformed_first=tuple(MalformedRecord(**item) for item in document["malformed_first"]),
        lost={str(node): int(count) for node, count in document["lost"].items()},
        notes=tuple(str(note) for note in document["notes"]),
    )


def _why(error: Exception) -> str:
    return f"{error} is missing" if isinstance(error, KeyError) else str(error)
