"""The messages of a ROS 1 bag in the order of the file, with little memory and little per message.

rosbags' reader keeps an object for each message of a bag in memory and parses each record's header
in full; a mission has millions of them. Here the connections are read from the index, as there, but
the messages from the chunks themselves, one chunk at a time, and the header of a message is parsed
once for all those that have the same form. Format: http://wiki.ros.org/Bags/Format/2.0
"""

from __future__ import annotations

import bz2
import re
import struct
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from itertools import permutations
from typing import BinaryIO

from lz4.frame import LZ4FrameDecompressor  # type: ignore[import-untyped]

MAGIC = b"#ROSBAG V2.0\n"
_LENGTH = struct.Struct("<I")
_TWO = struct.Struct("<II")
_LARGEST_CHUNK = 1 << 30
_LARGEST_HEADER = 1 << 20
_MESSAGE, _HEAD, _CHUNK, _CHUNK_INFO, _CONNECTION = 2, 3, 5, 6, 7


class BrokenBagError(Exception):
    """The bytes are not those of a bag; the caller finds out where."""


@dataclass(frozen=True, slots=True)
class BagConnection:
    """One publisher's topic in the bag; ``type`` in the way of ROS 2 (``std_msgs/msg/String``)."""

    number: int
    topic: str
    type: str
    caller: str


@dataclass(frozen=True)
class BagIndex:
    """What stands at the end of a bag.

    ``span`` is the first and last time of all messages, ``chunks`` the first byte of each chunk in
    the order of the file.
    """

    connections: dict[int, BagConnection]
    chunks: list[int]
    span: tuple[int, int] | None
    index_pos: int


def read_index(stream: BinaryIO) -> BagIndex:
    """Read the connections and the places of the chunks.

    Raises:
        BrokenBagError: this is no bag, or not one that was closed.
    """
    stream.seek(0)
    if stream.read(len(MAGIC)) != MAGIC:
        raise BrokenBagError("no bag")
    head = _fields(_read_header(stream))
    if head.get(b"op") != bytes([_HEAD]):
        raise BrokenBagError("no bag header")
    index_pos = _number(head, b"index_pos", 8)
    count, chunk_count = _number(head, b"conn_count", 4), _number(head, b"chunk_count", 4)
    if head.get(b"encryptor"):
        raise BrokenBagError("encrypted")
    if index_pos == 0:
        raise BrokenBagError("no index")
    if chunk_count == 0:
        return BagIndex({}, [], None, index_pos)
    stream.seek(index_pos)
    connections = {}
    for _ in range(count):
        header = _fields(_read_header(stream))
        connection = _connection(header, _fields(_read_header(stream)))
        connections[connection.number] = connection
    chunks, first, last = [], 2**63, -1
    for _ in range(chunk_count):
        header = _fields(_read_header(stream))
        if header.get(b"op") != bytes([_CHUNK_INFO]) or _number(header, b"ver", 4) != 1:
            raise BrokenBagError("no chunk info")
        data = _read(stream, _LENGTH.unpack(_read(stream, 4))[0])
        chunks.append(_number(header, b"chunk_pos", 8))
        if data:
            first = min(first, _time(header, b"start_time"))
            last = max(last, _time(header, b"end_time"))
    return BagIndex(connections, sorted(chunks), (first, last) if last >= 0 else None, index_pos)


def messages(
    stream: BinaryIO, index: BagIndex, wanted: Collection[int]
) -> Iterator[tuple[int, int, bytes, int]]:
    """The messages of the connections ``wanted``, chunk by chunk.

    Yields:
        Number of the connection, time in ns, the message, and the byte of the file at which the
        next chunk is looked for.

    Raises:
        BrokenBagError: a chunk is not where the index says, or is broken inside.
    """
    chosen = frozenset(number.to_bytes(4, "little") for number in wanted)
    for place in index.chunks:
        stream.seek(place)
        header = _fields(_read_header(stream))
        if header.get(b"op") != bytes([_CHUNK]):
            raise BrokenBagError(f"no chunk at byte {place}")
        length = _LENGTH.unpack(_read(stream, 4))[0]
        data = _unpacked(header, _read(stream, length))
        behind = stream.tell()
        for number, time_ns, begin, end in _in_chunk(data, chosen):
            yield number, time_ns, data[begin:end], behind


def _unpacked(header: dict[bytes, bytes], data: bytes) -> bytes:
    size = _number(header, b"size", 4)
    if size > _LARGEST_CHUNK:
        raise BrokenBagError(f"a chunk of {size} bytes")
    name = header.get(b"compression", b"").decode("ascii", "replace")
    try:
        if name == "none":
            return data
        if name == "bz2":
            # What it becomes must not be without end.
            unpacked = bz2.BZ2Decompressor().decompress(data, size + 1)
        elif name == "lz4":
            unpacked = LZ4FrameDecompressor().decompress(data, size + 1)
        else:
            raise BrokenBagError(f"compression {name!r}")
    except (OSError, ValueError, RuntimeError, EOFError, AssertionError) as error:
        raise BrokenBagError(str(error)) from error
    if len(unpacked) != size:
        raise BrokenBagError(f"a chunk of {len(unpacked)} bytes, not {size}")
    return unpacked


def _in_chunk(data: bytes, chosen: frozenset[bytes]) -> Iterator[tuple[int, int, int, int]]:
    """Connection, time, begin and end of each message in a chunk's bytes."""
    form = _FORMS[0]
    at, size = 0, len(data)
    try:
        while at < size:
            body = at + 4 + _LENGTH.unpack_from(data, at)[0]
            begin = body + 4
            end = begin + _LENGTH.unpack_from(data, body)[0]
            if end > size:
                raise BrokenBagError("a record goes past the end of its chunk")
            found = form.fullmatch(data, at + 4, body)
            if found is None:
                # Another writer's order of the fields, another kind of record, or more fields.
                form = next((f for f in _FORMS if f.fullmatch(data, at + 4, body)), form)
                found = form.fullmatch(data, at + 4, body)
            if found is not None:
                raw, time = found["conn"], found["time"]
            else:
                fields = _fields(data[at + 4 : body])
                if fields.get(b"op") != bytes([_MESSAGE]):
                    at = end
                    continue
                raw, time = fields.get(b"conn", b""), fields.get(b"time", b"")
                if len(raw) != 4 or len(time) != 8:
                    raise BrokenBagError("a message without connection or time")
            at = end
            if raw in chosen:
                seconds, nanoseconds = _TWO.unpack(time)
                yield int.from_bytes(raw, "little"), seconds * 10**9 + nanoseconds, begin, end
    except struct.error as error:
        raise BrokenBagError("a record is cut off") from error


def _form(order: tuple[bytes, ...]) -> re.Pattern[bytes]:
    parts = {
        b"conn": rb"\x09\0\0\0conn=(?P<conn>.{4})",
        b"op": rb"\x04\0\0\0op=\x02",
        b"time": rb"\x0d\0\0\0time=(?P<time>.{8})",
    }
    return re.compile(b"".join(parts[name] for name in order), re.DOTALL)


_FORMS = [_form(order) for order in permutations((b"conn", b"op", b"time"))]


def _read(stream: BinaryIO, count: int) -> bytes:
    if count > _LARGEST_CHUNK:
        raise BrokenBagError(f"a field of {count} bytes")
    data = stream.read(count)
    if len(data) != count:
        raise BrokenBagError("the file ends within a field")
    return data


def _read_header(stream: BinaryIO) -> bytes:
    (length,) = _LENGTH.unpack(_read(stream, 4))
    if length > _LARGEST_HEADER:
        raise BrokenBagError(f"a header of {length} bytes")
    return _read(stream, length)


def _fields(header: bytes) -> dict[bytes, bytes]:
    fields = {}
    at = 0
    while at < len(header):
        end = at + 4 + int.from_bytes(header[at : at + 4], "little")
        name, separator, value = header[at + 4 : end].partition(b"=")
        if end > len(header) or not separator:
            raise BrokenBagError("a header's field goes past its end, or has no name")
        fields[name] = value
        at = end
    return fields


def _number(fields: dict[bytes, bytes], name: bytes, length: int) -> int:
    value = fields.get(name, b"")
    if len(value) != length:
        raise BrokenBagError(f"no {name.decode()} in a header")
    return int.from_bytes(value, "little")


def _time(fields: dict[bytes, bytes], name: bytes) -> int:
    both = _number(fields, name, 8)
    return (both & 0xFFFFFFFF) * 10**9 + (both >> 32)


def _connection(header: dict[bytes, bytes], data: dict[bytes, bytes]) -> BagConnection:
    if header.get(b"op") != bytes([_CONNECTION]) or b"topic" not in header or b"type" not in data:
        raise BrokenBagError("no connection")
    topic, kind, caller = (
        raw.decode("utf-8", "replace")
        for raw in (header[b"topic"], data[b"type"], data.get(b"callerid", b""))
    )
    package, _, name = kind.rpartition("/")
    package = package.removesuffix("/msg")
    words = "/".join(word for word in topic.split("/") if word)
    topic = f"/{words}" if topic.startswith("/") else words
    return BagConnection(_number(header, b"conn", 4), topic, f"{package}/msg/{name}", caller)
