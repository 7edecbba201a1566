"""Writes a ROS 1 bag of messages that are bytes already.

Where the disk gets full, what was written until then becomes a bag with an index. Room for the
index is kept free beside it from the beginning.
"""

from __future__ import annotations

import contextlib
import os
import struct
import time
from collections import Counter
from pathlib import Path
from typing import BinaryIO

from rosbags.interfaces import Connection
from rosbags.rosbag1 import Writer

from pytpc.base.errors import RunError
from pytpc.recording.marks import MarkMessages
from pytpc.ros.source import Source

KEEP_S = 1.0
"""The seconds of a mission that are lost at most when the recorder is killed."""
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


class BagFile:
    """A bag that gets its name only when it is complete.

    If it can no longer be written, ``write`` and ``close`` give it an index and its name before
    they raise.
    """

    def __init__(self, path: Path) -> None:
        """Open ``<path>.active``; what an earlier run left there is deleted.

        Raises:
            OSError: it cannot be written.
        """
        self._path = path
        self._active = path.with_name(path.name + ".active")
        self._active.unlink(missing_ok=True)
        self._reserve = path.with_name(f".{path.name}.reserve")
        self._reserved = 0
        self._whole = 0
        self._whole_chunks = 0
        self._ended: RunError | None = None
        self._writer = Writer(self._active)
        self._writer.open()
        assert self._writer.bio is not None, "it was opened"
        self._writer.bio.write(b" " * _MORE_PADDING)
        self._pad(self._writer.bio)
        self._writer.bio.seek(0, os.SEEK_END)
        self._kept = time.monotonic()
        self._connections: dict[tuple[str, str, str], Connection] = {}
        self.messages: Counter[str] = Counter()
        try:
            self._keep()
        except OSError:
            with contextlib.suppress(OSError):
                self._writer.bio.close()
            self._reserve.unlink(missing_ok=True)
            self._active.unlink(missing_ok=True)
            raise

    def write(self, source: Source, time_ns: int, data: bytes) -> None:
        """Add one message.

        Raises:
            RunError: it cannot be written; the bag is closed, and has what was written before.
        """
        if self._ended is not None:
            raise self._ended
        try:
            self._write(source, time_ns, data)
        except OSError as error:
            self._ended = self._rescue(error)
            raise self._ended from error

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
        due = time.monotonic() - self._kept > KEEP_S or MarkMessages.message_type(source.topic)
        self._writer.chunk_threshold = -1 if due else _CHUNK
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
        if needed >= self._reserved:
            self._reserved = max(2 * needed, _LEAST_INDEX)
            with self._reserve.open("ab") as stream:
                os.posix_fallocate(stream.fileno(), 0, self._reserved)
        self._whole = self._writer.bio.tell()
        self._whole_chunks = len(self._writer.chunks) - 1
        self._kept = time.monotonic()

    def close(self) -> None:
        """Write the index and give the file its name.

        Raises:
            RunError: not all of it could be written.
        """
        if self._ended is not None:
            raise self._ended
        try:
            self._finish()
        except OSError as error:
            self._ended = self._rescue(error)
            raise self._ended from error

    def _finish(self) -> None:
        self._writer.close()
        with self._active.open("r+b") as stream:
            self._pad(stream)
            stream.flush()
            # The robot may be switched off as soon as the recording has ended.
            os.fsync(stream.fileno())
        self._active.replace(self._path)
        self._reserve.unlink(missing_ok=True)

    def _rescue(self, error: OSError) -> RunError:
        """Close the bag after its last whole chunk; the error says what became of it."""
        why = error.strerror or str(error)
        try:
            lost = self._cut()
            self._finish()
        except OSError:
            return RunError(
                f"cannot be written: {why}; make room, and recover it with rosbag reindex",
                self._active,
            )
        return RunError(
            f"the recording ended: {why}; the bag is closed and has all but the last"
            f" {lost} messages; make room before you record again",
            self._path,
        )

    def _cut(self) -> int:
        """Take the parts of the last chunk away; return how many messages were in it."""
        assert self._writer.bio is not None, "it was opened"
        # What the old stream still holds would be written later, over the index.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        with contextlib.suppress(OSError):
            os.dup2(nowhere, self._writer.bio.fileno())
            self._writer.bio.close()
        os.close(nowhere)
        self._reserve.unlink(missing_ok=True)
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

    @staticmethod
    def _pad(stream: BinaryIO) -> None:
        """Make the first record as long as rosbag's own: `rosbag reindex` writes it anew, and what
        is longer would overwrite the first chunk."""
        stream.seek(_FIRST_PADDING_AT)
        stream.write(_LENGTH.pack(_FIRST_PADDING))
