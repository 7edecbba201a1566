"""Writes a mission to an MCAP file that Foxglove, Lichtblick, PlotJuggler and Rerun open.

The messages are ROS 2's CDR, the one encoding that all of them read without a plugin. Nothing is
kept in memory: what is written is merged by time from its streams.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from mcap.writer import Writer

from pytpc.base.atomic import replacing
from pytpc.base.wording import utf8_text
from pytpc.diagnosis.results.exported import (
    LOG_TOPIC,
    MARKS_TOPIC,
    SUSPECTS_TOPIC,
    ExportedLine,
    ExportedSuspects,
    MissionExport,
    Progress,
)
from pytpc.present.viewers import messages
from pytpc.recording.marks import Mark

_PART = 1 << 14
_SUSPECTS = 20
_INFO, _WARN = 20, 30
_TYPES = {"I": 1, "II": 2}


class _Message(NamedTuple):
    time_ns: int
    order: int
    topic: str
    data: bytes


def write_mcap(found: MissionExport, path: Path, on_progress: Progress | None = None) -> None:
    """Write the file; times are those of the robot's clock.

    Args:
        found: the mission.
        path: the file, which is replaced.
        on_progress: called with (evaluations and ranks written, all of them).

    Raises:
        TpcError: it cannot be written.
    """
    with replacing(path) as staged, staged.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2", library="pytpc")
        channels = _channels(writer, found)
        tell = found.counting(on_progress)
        streams = (
            _evaluations(found, tell),
            _ranks(found, tell),
            _probabilities(found),
            sorted(_few(found)),
        )
        for number, one in enumerate(heapq.merge(*streams)):
            time_ns = max(0, one.time_ns)
            writer.add_message(channels[one.topic], time_ns, one.data, time_ns, number)
        writer.finish()  # type: ignore[no-untyped-call]


def _channels(writer: Writer, found: MissionExport) -> dict[str, int]:
    """The number of each topic's channel."""
    schemas: dict[str, int] = {}
    channels: dict[str, int] = {}

    def add(topic: str, kind: str, **about: str) -> None:
        if kind not in schemas:
            text = messages.definition(kind).encode()
            schemas[kind] = writer.register_schema(kind, "ros2msg", text)
        channels[topic] = writer.register_channel(topic, "cdr", schemas[kind], about)

    for topic, kind in (
        (MARKS_TOPIC, messages.MARK),
        (SUSPECTS_TOPIC, messages.SUSPECTS),
        (LOG_TOPIC, messages.LOG),
    ):
        add(topic, kind)
    for one in found.series:
        add(
            one.topic,
            messages.EVALUATION,
            node=utf8_text(one.node),
            parameter=utf8_text(one.parameter),
            place=utf8_text(one.place),
            relation=one.relation,
            margin_unit=one.unit,
            source_code=utf8_text(one.source_code),
            key=utf8_text(one.key),
        )
    for value in found.values:
        if value.topic not in channels:
            about = {"node": utf8_text(value.node), "parameter": utf8_text(value.parameter)}
            add(value.topic, messages.PARAMETER, **about)
    for name, topic in zip(found.ranks.parameters, found.rank_topics, strict=True):
        add(topic, messages.RANK, parameter=utf8_text(name))
    for name, topic in found.probability_topics.items():
        add(topic, messages.PROBABILITY, parameter=utf8_text(name))
    return channels


def _evaluations(found: MissionExport, tell: Callable[[int], None]) -> Iterator[_Message]:
    topics = [one.topic for one in found.series]
    for rows in found.rows(_PART):
        columns = rows.time_ns.tolist(), rows.series.tolist(), messages.encode_rows(rows)
        for time_ns, series, data in zip(*columns, strict=True):
            yield _Message(time_ns, 0, topics[series], data)
        tell(rows.time_ns.size)


def _ranks(found: MissionExport, tell: Callable[[int], None]) -> Iterator[_Message]:
    ranks, topics = found.ranks, found.rank_topics
    if not topics:
        return
    size = max(1, _PART // len(topics))
    for begin in range(0, ranks.times_ns.size, size):
        part = slice(begin, begin + size)
        columns = ranks.rank1[part], ranks.rank2[part], ranks.combined[part]
        data = iter(messages.encode_ranks(*(one.ravel() for one in columns)))
        times = ranks.times_ns[part].tolist()
        for time_ns in times:
            for topic in topics:
                yield _Message(time_ns, 1, topic, next(data))
        tell(len(times) * len(topics))


def _probabilities(found: MissionExport) -> Iterator[_Message]:
    for at in found.suspects:
        for one in at.suspects:
            topic = found.probability_topics[one.parameter]
            fields = {"probability": one.probability}
            data = messages.encode(messages.PROBABILITY, fields)
            yield _Message(at.time_ns, 2, topic, data)


def _few(found: MissionExport) -> Iterator[_Message]:
    """The messages of which there are only some hundreds."""
    for mark in found.marks:
        yield _Message(mark.time_ns, 3, MARKS_TOPIC, messages.encode(messages.MARK, _mark(mark)))
    for at in found.suspects:
        data = messages.encode(messages.SUSPECTS, _suspects(at))
        yield _Message(at.time_ns, 4, SUSPECTS_TOPIC, data)
    for line in found.log:
        data = messages.encode(messages.LOG, _line(line))
        yield _Message(line.time_ns, 5, LOG_TOPIC, data)
    for value in found.values:
        fields = {"value": value.number, "text": utf8_text(value.text)}
        data = messages.encode(messages.PARAMETER, fields)
        yield _Message(value.time_ns, 6, value.topic, data)


def _mark(mark: Mark) -> dict[str, Any]:
    kind = _TYPES.get(mark.type or "", 0)
    return {"type": kind, "observer": utf8_text(mark.observer), "note": utf8_text(mark.note)}


def _suspects(at: ExportedSuspects) -> dict[str, Any]:
    return {
        "mark": at.mark,
        "verdict": utf8_text(at.text),
        "action": utf8_text(at.action),
        "none": at.none,
        "suspects": [
            {
                "position": one.position,
                "parameter": utf8_text(one.parameter),
                "probability": one.probability,
                "type": one.type,
                "place": utf8_text(one.place),
                "value_to_try": one.to_try,
            }
            for one in at.suspects[:_SUSPECTS]
        ],
    }


def _line(line: ExportedLine) -> dict[str, Any]:
    seconds, nanoseconds = divmod(max(0, line.time_ns), 10**9)
    time = messages.store().types["builtin_interfaces/msg/Time"]
    return {
        "stamp": time(sec=min(seconds, 2**31 - 1), nanosec=nanoseconds),
        "level": _INFO if line.kind == "turn" else _WARN,
        "name": utf8_text(line.name),
        "msg": utf8_text(line.text),
        "file": "",
        "function": "",
        "line": 0,
    }
