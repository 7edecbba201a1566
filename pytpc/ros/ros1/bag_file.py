"""Writes a ROS 1 bag of messages that are bytes already."""

from __future__ import annotations

import contextlib
import os
import struct
import time
from typing import BinaryIO

from rosbags.interfaces import Connection
from rosbags.rosbag1 import Writer

from pytpc.ros.kept_file import KeptFile
from pytpc.ros.source import Source

# rosbag pads the first record's parts to 4096 bytes, rosbags both with their two lengths.
_FIRST_PADDING = 4096 - 69
_FIRST_PADDING_AT = 13 + 4 + 69
_MORE_PADDING = 8
_CHUNK = 1 << 20
_LENGTH = struct.Struct("<I")
# The index has a record for each connection, whose definition counts most, and one for each chunk.
_INDEX_OF_CONNECTION = 8 << 10
_INDEX_OF_CHUNK = 256
_LEAST_INDEX = 1 << 20


class BagFile(KeptFile):
    """A bag that gets its name only when it is complete."""

    kind = "bag"
    remedy = "recover it with rosbag reindex"

    def _open(self) -> None:
        self._whole = 0
        self._whole_chunks = 0
        self._connections: dict[tuple[str, str, str], Connection] = {}
        self._writer = Writer(self._active)
        self._writer.open()
        assert self._writer.bio is not None, "it was opened"
        self._writer.bio.write(b" " * _MORE_PADDING)
        self._pad(self._writer.bio)
        self._writer.bio.seek(0, os.SEEK_END)
        self._keep()

    def _write(self, source: Source, time_ns: int, data: bytes) -> None:
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
        self._writer.chunk_threshold = -1 if self._is_due(source.topic) else _CHUNK
        # Before the first /clock it is 0, which rosbag play and info take for a broken entry.
        self.messages[source.topic] += 1
        self._writer.write(connection, max(time_ns, 1), data)
        if len(self._writer.chunks) - 1 > self._whole_chunks:
            self._keep()

    def _keep(self) -> None:
        """Hand to the system what is in whole chunks, and keep room for their index.

        Raises:
            OSError: the disk is full.
        """
        assert self._writer.bio is not None, "it was opened"
        self._writer.bio.flush()
        needed = _INDEX_OF_CONNECTION * len(self._connections)
        needed += _INDEX_OF_CHUNK * len(self._writer.chunks)
        self._keep_room(needed, _LEAST_INDEX)
        self._whole = self._writer.bio.tell()
        self._whole_chunks = len(self._writer.chunks) - 1
        self._kept_at = time.monotonic()

    def _finish(self) -> None:
        self._writer.close()
        with self._active.open("r+b") as stream:
            self._pad(stream)
            stream.flush()
            # The robot may be switched off as soon as the recording has ended.
            os.fsync(stream.fileno())
        self._name()

    def _cut(self) -> int:
        assert self._writer.bio is not None, "it was opened"
        # What the old stream still holds would be written later, over the index.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        with contextlib.suppress(OSError):
            os.dup2(nowhere, self._writer.bio.fileno())
            self._writer.bio.close()
        os.close(nowhere)
        os.truncate(self._active, self._whole)
        self._writer.bio = self._active.open("r+b")
        self._writer.bio.seek(0, os.SEEK_END)
        lost = 0
        for chunk in self._writer.chunks[self._whole_chunks :]:
            for number, entries in chunk.connections.items():
                self.messages[self._writer.connections[number].topic] -= len(entries)
                lost += len(entries)
        del self._writer.chunks[self._whole_chunks :]
        return lost

    def _abandon(self) -> None:
        if self._writer.bio is not None:
            with contextlib.suppress(OSError):
                self._writer.bio.close()

    @staticmethod
    def _pad(stream: BinaryIO) -> None:
        """Make the first record as long as rosbag's own: `rosbag reindex` writes it anew, and what
        is longer would overwrite the first chunk."""
        stream.seek(_FIRST_PADDING_AT)
        stream.write(_LENGTH.pack(_FIRST_PADDING))
