"""Writes an MCAP file of ROS 2 messages that are bytes already.

What came is on the disk a second later, so that a recorder that is killed loses no more. The
format: https://mcap.dev/spec; its profile is that of rosbag2.
"""

from __future__ import annotations

import contextlib
import os
import struct
import time
import zlib
from collections import Counter
from dataclasses import dataclass, field
from io import BytesIO, FileIO

from pytpc.ros.kept_file import KeptFile
from pytpc.ros.source import Source

_MAGIC = b"\x89MCAP0\r\n"
_CHUNK = 1 << 20
# The index is of the definitions and of each chunk; the rest are counts and the ends.
_LEAST_INDEX = 1 << 18
_REST = 1 << 16
_HEADER, _FOOTER, _SCHEMA, _CHANNEL, _MESSAGE = 0x01, 0x02, 0x03, 0x04, 0x05
_CHUNK_RECORD, _MESSAGE_INDEX, _CHUNK_INDEX = 0x06, 0x07, 0x08
_STATISTICS, _DATA_END = 0x0B, 0x0F
_QOS = "offered_qos_profiles"


def _text(value: str) -> bytes:
    data = value.encode()
    return struct.pack("<I", len(data)) + data


def _record(kind: int, body: bytes) -> bytes:
    return struct.pack("<BQ", kind, len(body)) + body


@dataclass
class _Pending:
    """A chunk that grows: its records, and for each channel the times and places of messages."""

    records: BytesIO = field(default_factory=BytesIO)
    messages: dict[int, list[tuple[int, int]]] = field(default_factory=dict)
    first_ns: int = 2**63 - 1
    last_ns: int = 0


class McapFile(KeptFile):
    """An MCAP file that gets its name only when it is complete."""

    kind = "file"
    remedy = "rank and report read it as it is"
    _stream: FileIO | None = None

    def _open(self) -> None:
        self._schemas: dict[tuple[str, str], int] = {}
        self._channels: dict[tuple[str, str, str], int] = {}
        self._topics: dict[int, str] = {}
        self._definitions = b""
        self._indexes: list[bytes] = []
        self._index_bytes = 0
        self._counts: Counter[int] = Counter()
        self._first_ns, self._last_ns = 2**63 - 1, 0
        self._pending = _Pending()
        self._whole = 0
        self._stream = self._active.open("xb", buffering=0)
        self._keep_room(1, _LEAST_INDEX)
        self._put(_MAGIC + _record(_HEADER, _text("ros2") + _text("pytpc")))

    def _write(self, source: Source, time_ns: int, data: bytes) -> None:
        channel = self._channel(source)
        pending, time_ns = self._pending, max(time_ns, 0)
        pending.messages.setdefault(channel, []).append((time_ns, pending.records.tell()))
        pending.first_ns = min(pending.first_ns, time_ns)
        pending.last_ns = max(pending.last_ns, time_ns)
        head = struct.pack("<BQHIQQ", _MESSAGE, len(data) + 22, channel, 0, time_ns, time_ns)
        pending.records.write(head + data)
        self.messages[source.topic] += 1
        if pending.records.tell() > _CHUNK or self._is_due(source.topic):
            self._close_chunk()

    def keep(self) -> None:
        """Write what waits, if it has waited for long.

        Raises:
            RunError: as ``write``.
        """
        if self._ended is None and self._is_due():
            self._try(self._close_chunk)

    def _channel(self, source: Source) -> int:
        """The number of a topic; a new one is described in the chunk."""
        key = (source.topic, source.type, source.definition)
        channel = self._channels.get(key)
        if channel is not None:
            return channel
        schema = self._schemas.get(key[1:])
        added = b""
        if schema is None:
            schema = self._schemas[key[1:]] = len(self._schemas) + 1
            body = struct.pack("<H", schema) + _text(source.type) + _text("ros2msg")
            added = _record(_SCHEMA, body + _text(source.definition))
        channel = self._channels[key] = len(self._channels) + 1
        metadata = _text(_QOS) + _text("[]")
        body = struct.pack("<HH", channel, schema) + _text(source.topic) + _text("cdr")
        added += _record(_CHANNEL, body + struct.pack("<I", len(metadata)) + metadata)
        self._topics[channel] = source.topic
        self._definitions += added
        self._pending.records.write(added)
        return channel

    def _close_chunk(self) -> None:
        """Write the chunk that grows, with the index of its messages.

        Raises:
            OSError: the disk is full.
        """
        self._kept_at = time.monotonic()
        pending = self._pending
        data = pending.records.getvalue()
        if not pending.messages:
            return
        times = struct.pack("<QQ", pending.first_ns, pending.last_ns)
        sizes = struct.pack("<QI", len(data), zlib.crc32(data)) + _text("")
        chunk = _record(_CHUNK_RECORD, times + sizes + struct.pack("<Q", len(data)) + data)
        begin = self._whole
        offsets, index = b"", b""
        for channel, entries in pending.messages.items():
            offsets += struct.pack("<HQ", channel, begin + len(chunk) + len(index))
            packed = b"".join(struct.pack("<QQ", *entry) for entry in entries)
            index += _record(_MESSAGE_INDEX, struct.pack("<HI", channel, len(packed)) + packed)
        self._put(chunk + index)
        body = times + struct.pack("<QQI", begin, len(chunk), len(offsets)) + offsets
        body += struct.pack("<Q", len(index)) + _text("")
        self._indexes.append(_record(_CHUNK_INDEX, body + struct.pack("<QQ", len(data), len(data))))
        self._index_bytes += len(self._indexes[-1])
        for channel, entries in pending.messages.items():
            self._counts[channel] += len(entries)
        self._first_ns = min(self._first_ns, pending.first_ns)
        self._last_ns = max(self._last_ns, pending.last_ns)
        self._pending = _Pending()
        self._keep_room(len(self._definitions) + self._index_bytes + _REST, _LEAST_INDEX)

    def _put(self, data: bytes) -> None:
        assert self._stream is not None, "it is open"
        view = memoryview(data)
        while view:
            view = view[self._stream.write(view) :]
        self._whole += len(data)

    def _finish(self) -> None:
        self._close_chunk()
        end = _record(_DATA_END, struct.pack("<I", 0))
        begin = self._whole + len(end)
        summary = self._definitions + b"".join(self._indexes)
        counts = b"".join(struct.pack("<HQ", *one) for one in sorted(self._counts.items()))
        first = self._first_ns if self._counts else 0
        body = struct.pack("<QH", self._counts.total(), len(self._schemas))
        body += struct.pack("<III", len(self._channels), 0, 0)
        body += struct.pack("<IQQ", len(self._indexes), first, self._last_ns)
        summary += _record(_STATISTICS, body + struct.pack("<I", len(counts)) + counts)
        footer = _record(_FOOTER, struct.pack("<QQI", begin, 0, 0))
        self._reserve.unlink(missing_ok=True)
        assert self._stream is not None, "it is open"
        whole = self._whole
        try:
            self._put(end + summary + footer + _MAGIC)
        finally:
            self._whole = whole
        # The robot may be switched off as soon as the recording has ended.
        os.fsync(self._stream.fileno())
        self._stream.close()
        self._name()

    def _cut(self) -> int:
        assert self._stream is not None, "it is open"
        lost = sum(map(len, self._pending.messages.values()))
        for channel, entries in self._pending.messages.items():
            self.messages[self._topics[channel]] -= len(entries)
        self._pending = _Pending()
        self._stream.truncate(self._whole)
        self._stream.seek(self._whole)
        return lost

    def _abandon(self) -> None:
        if self._stream is not None:
            with contextlib.suppress(OSError):
                self._stream.close()
