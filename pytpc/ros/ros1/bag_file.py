"""Writes a ROS 1 bag of messages that are bytes already."""

from __future__ import annotations

import os
import struct
import time
from collections import Counter
from pathlib import Path
from typing import BinaryIO

from rosbags.interfaces import Connection
from rosbags.rosbag1 import Writer

from pytpc.recording.marks import MarkMessages
from pytpc.ros.ros1.subscriber import Source

KEEP_S = 1.0
"""The seconds of a mission that are lost at most when the recorder is killed."""
# rosbag pads the first record's parts to 4096 bytes, rosbags both with their two lengths.
_FIRST_PADDING = 4096 - 69
_FIRST_PADDING_AT = 13 + 4 + 69
_MORE_PADDING = 8
_CHUNK = 1 << 20
_LENGTH = struct.Struct("<I")


class BagFile:
    """A bag that gets its name only when it is complete."""

    def __init__(self, path: Path) -> None:
        """Open ``<path>.active``; what an earlier run left there is deleted."""
        self._path = path
        self._active = path.with_name(path.name + ".active")
        self._active.unlink(missing_ok=True)
        self._writer = Writer(self._active)
        self._writer.open()
        assert self._writer.bio is not None, "it was opened"
        self._writer.bio.write(b" " * _MORE_PADDING)
        self._pad(self._writer.bio)
        self._writer.bio.seek(0, os.SEEK_END)
        self._kept = time.monotonic()
        self._connections: dict[tuple[str, str, str], Connection] = {}
        self.messages: Counter[str] = Counter()

    def write(self, source: Source, time_ns: int, data: bytes) -> None:
        """Add one message."""
        key = (source.topic, source.md5sum, source.node)
        connection = self._connections.get(key)
        if connection is None:
            # rosbags names types in the way of ROS 2 and writes them in that of ROS 1.
            package, _, name = source.type.partition("/")
            connection = self._writer.add_connection(
                source.topic,
                f"{package}/msg/{name}",
                msgdef=source.definition,
                md5sum=source.md5sum,
                # On /threshold_information nothing else says whose reports these are.
                callerid=source.node,
                latching=1 if source.latched else None,
            )
            self._connections[key] = connection
        # A chunk is kept in memory until it is full: with marks alone, for the whole mission.
        due = time.monotonic() - self._kept > KEEP_S or MarkMessages.message_type(source.topic)
        self._writer.chunk_threshold = -1 if due else _CHUNK
        # Before the first /clock it is 0, which rosbag play and info take for a broken entry.
        self._writer.write(connection, max(time_ns, 1), data)
        if due and self._writer.bio is not None:
            self._writer.bio.flush()
            self._kept = time.monotonic()
        self.messages[source.topic] += 1

    def close(self) -> None:
        """Write the index and give the file its name."""
        self._writer.close()
        with self._active.open("r+b") as stream:
            self._pad(stream)
        self._active.replace(self._path)

    @staticmethod
    def _pad(stream: BinaryIO) -> None:
        """Make the first record as long as rosbag's own: `rosbag reindex` writes it anew, and what
        is longer would overwrite the first chunk."""
        stream.seek(_FIRST_PADDING_AT)
        stream.write(_LENGTH.pack(_FIRST_PADDING))
