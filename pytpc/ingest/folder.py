"""A folder that ``pytpc convert`` wrote, as one source among others."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from pytpc.base import columns as tables
from pytpc.base.errors import InputError
from pytpc.ingest.gathering import SUMMARY_ROW, Gathering, Progress, Reports
from pytpc.recording import events as event_table
from pytpc.recording import summaries as summary_table
from pytpc.recording.events import Events
from pytpc.recording.mission import EVENTS_FILE, SUMMARIES_FILE, read_marks
from pytpc.recording.summaries import Summaries

_ROWS = 1 << 18


def read_folder_into(
    folder: Path, gathering: Gathering, on_progress: Progress | None = None
) -> None:
    """Read an ingested folder, some rows at a time.

    Raises:
        InputError: a file is missing or broken, or the files are not of one recording.
    """
    recording, events, summaries = read_marks(folder)
    channel = gathering.channel(str(folder), "events")
    done = 0
    for table in _tables(folder / EVENTS_FILE, event_table.SCHEMA, "events"):
        part = Events.from_arrow(table)
        key = gathering.keys.all(part.keys)[part.key]
        node = gathering.nodes.all(part.nodes)[part.node]
        reports = Reports(part.time_ns, key, part.result, part.cmp, part.thresh, part.res)
        gathering.add_events(channel, node, reports)
        done += len(part)
        if on_progress is not None:
            on_progress(done, max(done, events))
    _check(folder / EVENTS_FILE, events, done)
    done = 0
    if summaries:
        for table in _tables(folder / SUMMARIES_FILE, summary_table.SCHEMA, "summaries"):
            rows = Summaries.from_arrow(table)
            made = np.zeros(len(rows), SUMMARY_ROW)
            for name, column in rows.columns().items():
                made[name] = column
            made["key"] = gathering.keys.all(rows.keys)[rows.key]
            made["node"] = gathering.nodes.all(rows.nodes)[rows.node]
            made["channel"] = channel.code
            gathering.add_summary_rows(made)
            done += len(rows)
        _check(folder / SUMMARIES_FILE, summaries, done)
    gathering.marks += recording.marks
    gathering.notes += recording.notes
    gathering.spans.append((recording.start_ns, recording.end_ns))
    gathering.lost.update(recording.lost)
    for dropped in recording.dropped:
        gathering.add_dropped(dropped)
    for record in recording.malformed_first:
        gathering.skip(record.topic, record.time_ns, record.what, record.text)
    gathering.malformed += recording.malformed - len(recording.malformed_first)


def _tables(path: Path, schema: pa.Schema, what: str) -> Iterator[pa.Table]:
    try:
        with pq.ParquetFile(path) as file:
            tables.check_schema(file.schema_arrow, schema)
            for batch in file.iter_batches(_ROWS):
                yield pa.Table.from_batches([batch])
    except OSError as error:
        raise InputError(f"not a file of {what}: {error.strerror or error}", path) from error
    except (pa.ArrowException, ValueError) as error:
        raise InputError(f"not a file of {what}: {error}", path) from error
    except InputError as error:
        raise InputError(error.message, path) from error


def _check(path: Path, said: int, found: int) -> None:
    if said != found:
        raise InputError(f"has {found} rows, but marks.json tells of {said}", path)
