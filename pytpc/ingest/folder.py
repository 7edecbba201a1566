"""Reads folders and Parquet files that ``pytpc convert`` wrote."""

from __future__ import annotations

from pathlib import Path

from pytpc.base.columns import read_parts
from pytpc.ingest.gathering import Channel, Gathering, Progress, ReportColumns
from pytpc.recording.events import Events
from pytpc.recording.mission import EVENTS_FILE, SUMMARIES_FILE, check_rows, read_marks_json
from pytpc.recording.summaries import Summaries

_ROWS = 1 << 18


def read_parquet_into(
    path: Path, gathering: Gathering, on_progress: Progress | None = None
) -> None:
    """Read a file of events alone, some rows at a time.

    Raises:
        InputError: it is broken, or not one of events.
    """
    channel = gathering.channel(str(path), "events")
    _read_events(path, channel, gathering, on_progress)


def read_folder_into(
    folder: Path, gathering: Gathering, on_progress: Progress | None = None
) -> None:
    """Read a converted folder, some rows at a time.

    Raises:
        InputError: a file is missing or broken, or the files are not of one recording.
    """
    recording, events, summaries = read_marks_json(folder)
    channel = gathering.channel(str(folder), "events")
    done = _read_events(folder / EVENTS_FILE, channel, gathering, on_progress, events)
    check_rows(folder, EVENTS_FILE, events, done)
    done = 0
    if summaries:
        path = folder / SUMMARIES_FILE
        for table in read_parts(path, "summaries", Summaries.schema, _ROWS):
            gathering.add_summaries(channel.code, Summaries.from_arrow(table))
            done += table.num_rows
        check_rows(folder, SUMMARIES_FILE, summaries, done)
    gathering.marks += recording.marks
    gathering.notes += recording.notes
    gathering.spans.append((recording.start_ns, recording.end_ns))
    gathering.lost.update(recording.lost)
    for dropped in recording.dropped:
        gathering.add_dropped(dropped)
    for name in recording.names:
        gathering.add_name(name)
    for record in recording.malformed_first:
        gathering.skip(record.topic, record.time_ns, record.what, record.text)
    gathering.malformed += recording.malformed - len(recording.malformed_first)


def _read_events(
    path: Path,
    channel: Channel,
    gathering: Gathering,
    on_progress: Progress | None,
    expected: int = 0,
) -> int:
    """Read a file of events; their number."""
    done = 0
    for table in read_parts(path, "events", Events.schema, _ROWS):
        part = Events.from_arrow(table)
        key = gathering.keys.all(part.keys)[part.key]
        node = gathering.nodes.all(part.nodes)[part.node]
        reports = ReportColumns(part.time_ns, key, part.result, part.cmp, part.thresh, part.res)
        gathering.add_events(channel, node, reports)
        done += len(part)
        if on_progress is not None:
            on_progress(done, max(done, expected))
    return done
