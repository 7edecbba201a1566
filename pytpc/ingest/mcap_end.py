"""MCAP files without an end, as a recorder leaves them that was killed or lost its power.

Records follow one another, each with its length, so that all but the last one are whole. A reader
gets them with an end without an index. The format: https://mcap.dev/spec.
"""

from __future__ import annotations

import io
import os
import struct
import zlib
from pathlib import Path
from typing import BinaryIO

from pytpc.ingest.magic import MCAP_MAGIC

_HEAD = struct.Struct("<BQ")
_CHUNK_HEAD = struct.Struct("<QQQII")
_CHUNK, _DATA_END, _LAST_KIND = 0x06, 0x0F, 0x0F
# A footer without an index, and the magic at a file's end.
_END = _HEAD.pack(0x02, 20) + bytes(20) + MCAP_MAGIC
_LARGEST = 1 << 29


class CutOff:
    """The whole records of an MCAP file that ends too early; it opens as a path does.

    Attributes:
        size: bytes of the records.
        left: bytes after them, which are not read.
    """

    def __init__(self, path: Path, size: int, left: int) -> None:
        self._path = path
        self.size = size
        self.left = left

    def open(self, _mode: str = "rb") -> BinaryIO:
        """The records, and an end.

        Raises:
            OSError: it cannot be read.
        """
        return io.BufferedReader(_WithEnd(self._path, self.size))

    def __str__(self) -> str:
        return str(self._path)


def cut_off(path: Path) -> CutOff | None:
    """What is whole of a file that begins as MCAP and does not end so; None where it does.

    Raises:
        OSError: it cannot be read.
    """
    with path.open("rb") as stream:
        size = stream.seek(0, os.SEEK_END)
        stream.seek(-min(size, len(MCAP_MAGIC)), os.SEEK_END)
        if size > len(MCAP_MAGIC) and stream.read() == MCAP_MAGIC:
            return None
        at = stream.seek(len(MCAP_MAGIC))
        while (following := _after(stream, at, size)) is not None:
            at = stream.seek(following)
    return CutOff(path, at, size - at)


def _after(stream: BinaryIO, at: int, size: int) -> int | None:
    """Where the record ends that begins at ``at``; None if it is not whole, or ends the data."""
    head = stream.read(_HEAD.size)
    if len(head) < _HEAD.size:
        return None
    kind, length = _HEAD.unpack(head)
    end = at + _HEAD.size + length
    if not 0 < kind < _LAST_KIND or end > size:
        return None
    return end if kind != _CHUNK or _is_intact(stream, length) else None


def _is_intact(stream: BinaryIO, length: int) -> bool:
    """Whether a chunk's bytes are those that its checksum is of, where that can be seen."""
    raw = stream.read(length) if length <= _LARGEST else b""
    if len(raw) < _CHUNK_HEAD.size:
        return False
    *_, checksum, name_size = _CHUNK_HEAD.unpack_from(raw)
    is_known = bool(checksum) and not name_size
    return not is_known or zlib.crc32(memoryview(raw)[_CHUNK_HEAD.size + 8 :]) == int(checksum)


class _WithEnd(io.RawIOBase):
    """The first bytes of a file, and ``_END``."""

    def __init__(self, path: Path, size: int) -> None:
        self._file = path.open("rb", buffering=0)
        self._size = size
        self._at = 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        begin = {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._size + len(_END)}
        self._at = max(0, begin[whence] + offset)
        return self._at

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        if self._at < self._size:
            self._file.seek(self._at)
            data = self._file.read(min(len(buffer), self._size - self._at))
        else:
            begin = self._at - self._size
            data = _END[begin : begin + len(buffer)]
        buffer[: len(data)] = data
        self._at += len(data)
        return len(data)

    def close(self) -> None:
        self._file.close()
        super().close()
