"""Finds where a ROS 1 bag is broken by a walk over its records.

The walk needs no index, so it also works on what a killed recorder left behind. Format: version
line, then records of (uint32 length, header, uint32 length, data); the first record is the bag
header, whose ``index_pos`` is 0 until the recorder closes the file
(http://wiki.ros.org/Bags/Format/2.0).
"""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

from pytpc.ingest.bag_chunks import MAGIC

_LONGEST_HEADER = 1 << 20


def describe_damage(path: Path) -> str | None:
    """One clause with what is wrong and at which byte; None if nothing is found.

    Raises:
        OSError: the file cannot be read.
    """
    size = path.stat().st_size
    with path.open("rb") as stream:
        return _first_line(stream, size) or _records(stream, size)


def _first_line(stream: BinaryIO, size: int) -> str | None:
    begin = stream.read(len(MAGIC))
    if begin == MAGIC:
        return None
    if size == 0:
        return "not a ROS 1 bag: the file is empty"
    if MAGIC.startswith(begin):
        return f"truncated: the file ends at byte {size}, within its first line"
    return f'not a ROS 1 bag: "{MAGIC.decode().strip()}" is not at byte 0'


def _records(stream: BinaryIO, size: int) -> str | None:
    index: int | None = None
    while (place := stream.tell()) < size:
        header = _field(stream, size, _LONGEST_HEADER)
        if header is None or (data_end := _skip(stream, size)) is None:
            return f"truncated or damaged: no whole record at byte {place} of {size}"
        if index is None:
            index = _number(header, b"index_pos=")
        stream.seek(data_end)
    if index is None:
        return f"truncated: the file ends at byte {size}, before the bag header"
    if index == 0:
        return f"not closed by its recorder: no index after byte {size}"
    if index >= size:
        return f"truncated: the file ends at byte {size}, the index should be at byte {index}"
    return None


def _field(stream: BinaryIO, size: int, longest: int) -> bytes | None:
    end = _skip(stream, size)
    if end is None or end - stream.tell() > longest:
        return None
    return stream.read(end - stream.tell())


def _skip(stream: BinaryIO, size: int) -> int | None:
    """Read a length; return the byte after that field, None if the file is shorter."""
    raw = stream.read(4)
    if len(raw) < 4:
        return None
    end = stream.tell() + int.from_bytes(raw, "little")
    return end if end <= size else None


def _number(header: bytes, name: bytes) -> int:
    """The uint64 after ``name``; 0 where the header has no such field."""
    _, _, rest = header.partition(name)
    return int.from_bytes(rest[:8], "little")
