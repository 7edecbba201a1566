"""Makes a recording of everything that was read, in memory or, block by block, on disk."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TypeVar

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from pytpc.base.atomic import replacing
from pytpc.base.columns import recode, sorted_words, table_writer, to_arrow
from pytpc.ingest.duplicates import (
    APART_NS,
    TOLERANCE_NS,
    Once,
    clock_notes,
    summaries_twice,
)
from pytpc.ingest.gathering import EVENT_ROW, SUMMARY_ROW, Gathering, Progress
from pytpc.ingest.spool import Rows
from pytpc.recording.events import Events
from pytpc.recording.marks import Mark, joined, marks_between, read_marks, write_marks
from pytpc.recording.marks_home import marks_home
from pytpc.recording.mission import EVENTS_FILE, SUMMARIES_FILE, Recording, write_marks_json
from pytpc.recording.parameter_values import ParameterValues
from pytpc.recording.summaries import Summaries

_MOST_CHANGES = 5
_MOST_HELD = 1 << 20
_Table = TypeVar("_Table", Events, Summaries)


@dataclass
class Merged:
    """Everything that was read, with sorted words and no report twice; events are in blocks."""

    gathering: Gathering
    name: str
    tolerance_ns: int = TOLERANCE_NS
    first_ns: int = 2**63 - 1
    last_ns: int = -(2**63)
    events: int = 0
    summaries: int = 0
    _twice: int = 0
    _once: Once = field(init=False)

    def __post_init__(self) -> None:
        self.gathering.flush()
        self._nodes_of_keys = self.gathering.moved_nodes()
        for channel in self.gathering.channels:
            channel.pairs = {self._nodes_of_keys.of_pair(pair) for pair in channel.pairs}
        self.keys, self._key_places = sorted_words(self.gathering.keys.codes)
        self.nodes, self._node_places = sorted_words(self.gathering.nodes.codes)
        self._seen = np.zeros(len(self.keys), np.bool_)

    @property
    def comparisons(self) -> int:
        """How many different keys the returned events have."""
        return int(np.count_nonzero(self._seen))

    def event_blocks(self) -> Iterator[Rows]:
        """The events in order of time; codes are those of the sorted words."""
        self._once = Once(self.gathering, self.tolerance_ns)
        self.events, self.first_ns, self.last_ns = 0, 2**63 - 1, -(2**63)
        for rows in self._once.blocks(map(self._moved, self.gathering.events.blocks())):
            if rows.size:
                self.events += rows.size
                self.first_ns = min(self.first_ns, int(rows["time_ns"][0]))
                self.last_ns = max(self.last_ns, int(rows["time_ns"][-1]))
                recoded = self._recoded(rows)
                self._seen[recoded["key"]] = True
                yield recoded

    def summary_blocks(self) -> Iterator[Rows]:
        """The summaries in the order of their beginning, without duplicates."""
        self.summaries = self._twice = 0
        held: Rows | None = None
        apart_ns = self.tolerance_ns if self._may_repeat else 0
        for block in map(self._moved, self.gathering.summaries.blocks()):
            rows = block if held is None else np.concatenate([held, block])
            # Between two that cannot be the same one.
            gaps = np.flatnonzero(np.diff(rows["begin_ns"]) > apart_ns)
            cut = int(gaps[-1]) + 1 if gaps.size else 0
            cut = cut if rows.size - cut <= _MOST_HELD else rows.size
            yield from self._each_once(rows[:cut])
            held = rows[cut:]
        if held is not None:
            yield from self._each_once(held)

    @cached_property
    def _may_repeat(self) -> bool:
        """Whether a summary may have come twice; not if each channel is a process's own file."""
        own = [(one.way, one.process) for one in self.gathering.channels]
        return len(own) > 1 and (
            len(set(own)) < len(own) or any(way != "file" or not who for way, who in own)
        )

    def _each_once(self, rows: Rows) -> Iterator[Rows]:
        """Drop summaries that came by two channels: they are equal in all fields, or nearly."""
        if self._may_repeat and rows.size:
            rest = [name for name in SUMMARY_ROW.names or () if name != "channel"]
            _, first = np.unique(_packed(rows[rest]), return_index=True)
            rows = rows[np.sort(first)]
            twice = summaries_twice(rows, self.gathering.channels, self.tolerance_ns)
            self._twice += int(np.count_nonzero(twice))
            rows = rows[~twice]
        if rows.size:
            self.summaries += rows.size
            yield self._recoded(rows)

    def recording(self) -> Recording:
        """All of it in memory."""
        events = self._table(Events, [np.empty(0, EVENT_ROW), *self.event_blocks()])
        summaries = self._table(Summaries, [np.empty(0, SUMMARY_ROW), *self.summary_blocks()])
        return self.rest(_used(events), summaries)

    def rest(self, events: Events, summaries: Summaries) -> Recording:
        """The recording with these tables; the blocks must have been read."""
        gathering = self.gathering
        marks = gathering.known_marks()
        start_ns, end_ns = self._span(marks)
        values = ParameterValues(gathering.values)
        marks = joined([*marks, *marks_between(gathering.marks_nearby, start_ns, end_ns)])
        notes = [
            *gathering.notes,
            *self._once.notes(),
            *self._summary_notes(),
            *gathering.late_notes,
            *gathering.light_notes(),
            *clock_notes(gathering.channels),
            *self._clock_notes(marks),
            *_changed(values, start_ns),
        ]
        return Recording(
            name=self.name,
            events=events,
            marks=marks,
            start_ns=start_ns,
            end_ns=end_ns,
            malformed=gathering.malformed,
            malformed_first=gathering.malformed_first,
            lost={node: count for node, count in sorted(gathering.lost.items()) if count},
            notes=tuple(notes),
            summaries=summaries,
            dropped=gathering.dropped_list,
            names=tuple(sorted(gathering.names)),
            values=values.kept(),
        )

    def save(self, folder: Path, told: Progress | None = None) -> Recording:
        """Write a converted folder block by block; the tables of the result are empty.

        Marks that are read with the folder from their own files are not copied into it: they could
        not be removed any more.

        Raises:
            TpcError: a file cannot be written; ``marks.json`` is written last.
        """
        self._parquet(folder / EVENTS_FILE, Events.schema, self.event_blocks(), told)
        if len(self.gathering.summaries):
            self._parquet(folder / SUMMARIES_FILE, Summaries.schema, self.summary_blocks())
        rest = self.rest(Events.empty(), Summaries.empty())
        beside = set(marks_home(folder).marks())
        copied = replace(rest, marks=tuple(mark for mark in rest.marks if mark not in beside))
        write_marks_json(copied, folder, self.events, self.summaries)
        return rest

    def save_parquet(self, path: Path, told: Progress | None = None) -> Recording:
        """Write only the events, and the marks where they are read with them; see ``save``."""
        self._parquet(path, Events.schema, self.event_blocks(), told)
        return self._rest_beside(path)

    def save_csv(self, path: Path, told: Progress | None = None) -> Recording:
        """Write the events as CSV in the thesis's form, without nodes; see ``save_parquet``."""
        total = max(1, len(self.gathering.events))
        with replacing(path) as staged, staged.open("w", encoding="ascii") as stream:
            for rows in self.event_blocks():
                stream.writelines(self._lines(rows))
                if told is not None:
                    told(self.events, total)
        return self._rest_beside(path)

    def _rest_beside(self, path: Path) -> Recording:
        """What is not in the file ``path``; its marks are written to where they are read with it.

        Those that are there already, stay.
        """
        rest = self.rest(Events.empty(), Summaries.empty())
        home = marks_home(path)
        if {*rest.marks} - {*home.marks(), *home.marks_nearby()}:
            before = read_marks(home.file) if home.file.exists() else ()
            write_marks(joined([*before, *rest.marks]), home.file)
        return rest

    def _lines(self, rows: Rows) -> Iterator[str]:
        names = ["time_ns", "key", "result", "cmp", "thresh", "res"]
        for time_ns, key, result, cmp, thresh, res in rows[names].tolist():
            seconds, rest = divmod(time_ns, 10**9)
            decimals = f"{rest:09d}".removesuffix("0").removesuffix("0")
            yield (
                f"{seconds}.{decimals},{self.keys[key]},{result:d},cmp:{_shortest(cmp)},"
                f"thresh:{_shortest(thresh)},res:{res:d}\n"
            )

    def _parquet(
        self, path: Path, schema: pa.Schema, blocks: Iterator[Rows], told: Progress | None = None
    ) -> None:
        total = max(1, len(self.gathering.events))
        with table_writer(path, schema) as write:
            for rows in blocks:
                columns = {name: np.ascontiguousarray(rows[name]) for name in schema.names}
                write(to_arrow(columns, self._words(), schema))
                if told is not None:
                    told(self.events, total)

    def _table(self, kind: type[_Table], blocks: list[Rows]) -> _Table:
        columns = {name: np.concatenate([rows[name] for rows in blocks]) for name in kind.kinds}
        return kind.of(**columns, keys=self.keys, nodes=self.nodes)

    def _words(self) -> dict[str, list[str]]:
        return {"key": self.keys, "node": self.nodes}

    def _moved(self, rows: Rows) -> Rows:
        """With the node of each row where its process has several."""
        nodes = self._nodes_of_keys.of(rows["key"], rows["node"])
        if nodes is not rows["node"]:
            rows = rows.copy()
            rows["node"] = nodes
        return rows

    def _recoded(self, rows: Rows) -> Rows:
        rows = rows.copy()
        rows["key"] = self._key_places[rows["key"]]
        rows["node"] = self._node_places[rows["node"]]
        return rows

    def _times(self, marks: tuple[Mark, ...]) -> list[int]:
        times = [mark.time_ns for mark in marks]
        return times + ([self.first_ns, self.last_ns] if self.events else [])

    def _span(self, marks: tuple[Mark, ...]) -> tuple[int, int]:
        """First and last time, on the clock of the reports.

        A bag that was recorded on another clock (wall time, while the robot ran on simulated time)
        does not count.
        """
        times = self._times(marks)
        spans = self.gathering.spans
        if times:
            spans = [span for span in spans if not _apart(times, span)]
        every = times + [time for span in spans for time in span]
        return (min(every), max(every)) if every else (0, 0)

    def _summary_notes(self) -> Iterator[str]:
        if self._twice:
            summaries = "1 summary" if self._twice == 1 else f"{self._twice:,} summaries"
            yield f"{summaries} that also came another way: counted once"

    def _clock_notes(self, marks: tuple[Mark, ...]) -> Iterator[str]:
        times = self._times(marks)
        if times and any(_apart(times, span) for span in self.gathering.spans):
            yield "the bag was recorded on another clock than the reports"


def _changed(values: ParameterValues, start_ns: int) -> Iterator[str]:
    """A sentence for each of the first parameters that were set while the mission ran."""
    changes = list(values.changes())
    for change in changes[:_MOST_CHANGES]:
        seconds = (change.time_ns - start_ns) / 1e9
        yield f"{change.name} was set from {change.old} to {change.new} at {seconds:.1f} s"
    if len(changes) > _MOST_CHANGES:
        yield f"{len(changes) - _MOST_CHANGES:,} more parameters were set while the mission ran"


def _apart(times: list[int], span: tuple[int, int]) -> bool:
    return min(times) > span[1] + APART_NS or max(times) < span[0] - APART_NS


def _used(events: Events) -> Events:
    """The table without words that it does not use."""
    keys = [events.keys[code] for code in np.unique(events.key).tolist()]
    nodes = [events.nodes[code] for code in np.unique(events.node).tolist()]
    columns = events.columns()
    columns["key"] = recode(events.key, events.keys, keys)
    columns["node"] = recode(events.node, events.nodes, nodes)
    return Events.of(**columns, keys=keys, nodes=nodes)


def _packed(rows: Rows) -> npt.NDArray[np.bytes_]:
    """bytes[n]: the bytes of all fields of each row."""
    packed = np.empty(rows.size, [(name, rows.dtype[name]) for name in rows.dtype.names or ()])
    for name in rows.dtype.names or ():
        packed[name] = rows[name]
    whole: npt.NDArray[np.bytes_] = packed.view(f"S{packed.dtype.itemsize}")
    return whole


def _shortest(value: float) -> str:
    return repr(value).removesuffix(".0")
