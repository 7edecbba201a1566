"""Reads the messages of a ROS 1 bag in the order of the file, quickly and with little memory.

rosbags' reader keeps an object for each message of a bag in memory and parses each record's header
in full; a mission has millions of them (docs/explanation/decisions.md). This reader also takes the
connections from the index, but reads all messages of a chunk at once. The format is described at
http://wiki.ros.org/Bags/Format/2.0
"""

from __future__ import annotations

import re
import struct
from array import array
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from itertools import permutations
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

from pytpc.base.columns import Int64s
from pytpc.ingest.magic import BAG_MAGIC
from pytpc.ingest.spool import Rows
from pytpc.ingest.unpacking import LARGEST_CHUNK, MOST_MESSAGES, Unpacker, UnpackingError

_LENGTH = struct.Struct("<I")
_LARGEST_HEADER = 1 << 20
_LARGEST_FILE = 1 << 60
_MESSAGE, _HEAD, _INDEX, _CHUNK, _CHUNK_INFO, _CONNECTION = 2, 3, 4, 5, 6, 7
_ENTRY = np.dtype([("seconds", "<u4"), ("nanoseconds", "<u4"), ("offset", "<u4")])
_FORM_BYTES = 38
_Found = tuple[Int64s, Int64s, Int64s, Int64s]


class BrokenBagError(Exception):
    """Not a bag, or a damaged one; the caller finds the place."""


@dataclass(frozen=True, slots=True)
class BagConnection:
    """One publisher's topic in the bag.

    ``msgtype`` is as in ROS 2 (``std_msgs/msg/String``), ``definition`` the text of the message.
    ``latched``: it sent its last message to each new subscriber.
    """

    number: int
    topic: str
    msgtype: str
    caller: str
    latched: bool
    definition: str


@dataclass(frozen=True)
class BagIndex:
    """The index at the end of a bag.

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
    if stream.read(len(BAG_MAGIC)) != BAG_MAGIC:
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
    _seek(stream, index_pos)
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
    return BagIndex(
        connections, sorted(set(chunks)), (first, last) if last >= 0 else None, index_pos
    )


def find_damage(stream: BinaryIO, size: int) -> str | None:
    """What is wrong with a bag of ``size`` bytes, and at which byte; None if nothing is found.

    A walk over the records, which needs no index: the first is the bag header, whose ``index_pos``
    is 0 until the recorder closes the file.
    """
    begin = stream.read(len(BAG_MAGIC))
    if begin != BAG_MAGIC:
        if BAG_MAGIC.startswith(begin):
            return f"truncated: the file ends at byte {size}, within its first line"
        return f'not a ROS 1 bag: "{BAG_MAGIC.decode().strip()}" is not at byte 0'
    index: int | None = None
    while (place := stream.tell()) < size:
        try:
            header = _read_header(stream)
            behind = _LENGTH.unpack(_read(stream, 4))[0] + stream.tell()
        except BrokenBagError:
            behind = size + 1
        if behind > size:
            return f"truncated or damaged: no whole record at byte {place} of {size}"
        if index is None:
            index = int.from_bytes(header.partition(b"index_pos=")[2][:8], "little")
        stream.seek(behind)
    if index == 0:
        return f"not closed by its recorder: no index after byte {size}"
    if index is None or index >= size:
        at = "before the bag header" if index is None else f"the index should be at byte {index}"
        return f"truncated: the file ends at byte {size}, {at}"
    return None


@dataclass(frozen=True)
class ChunkMessages:
    """The messages of a chunk, in the order of the file; n of them.

    ``data`` is the chunk's bytes; ``connection``, ``time_ns`` (the recorder's), ``begin`` and
    ``end`` (of the message in ``data``) are int64[n]. ``behind`` is the byte of the file behind the
    chunk.
    """

    data: bytes
    connection: Int64s
    time_ns: Int64s
    begin: Int64s
    end: Int64s
    behind: int


def messages(stream: BinaryIO, index: BagIndex, wanted: Collection[int]) -> Iterator[ChunkMessages]:
    """The messages of the connections ``wanted``, chunk by chunk.

    The index behind each chunk says where they are; where it does not fit the chunk, or is not
    there, the chunk is searched.

    Raises:
        BrokenBagError: a chunk is not where the index says, or is broken inside.
    """
    chosen = frozenset(wanted)
    unpacker = Unpacker()
    behind = 0
    for place in index.chunks:
        if place < behind:
            raise BrokenBagError(f"the chunk at byte {place} begins within the one before it")
        _seek(stream, place)
        header = _fields(_read_header(stream))
        if header.get(b"op") != bytes([_CHUNK]):
            raise BrokenBagError(f"no chunk at byte {place}")
        length = _LENGTH.unpack(_read(stream, 4))[0]
        if length > LARGEST_CHUNK:
            raise BrokenBagError(f"a chunk of {length:,} bytes at byte {place}")
        data = _unpacked(header, _read(stream, length), unpacker)
        behind = stream.tell()
        try:
            found = _by_index(data, _entries(stream, chosen))
        except BrokenBagError:
            found = None
        yield ChunkMessages(data, *(_by_search(data, chosen) if found is None else found), behind)


def _entries(stream: BinaryIO, chosen: frozenset[int]) -> list[tuple[int, Rows]]:
    """The index records behind a chunk: number of the connection, time and place of messages."""
    found: list[tuple[int, Rows]] = []
    most = MOST_MESSAGES
    while True:
        head = stream.read(4)
        if len(head) < 4 or _LENGTH.unpack(head)[0] > _LARGEST_HEADER:
            return found
        header = _fields(_read(stream, _LENGTH.unpack(head)[0]))
        if header.get(b"op") != bytes([_INDEX]) or _number(header, b"ver", 4) != 1:
            return found
        number, count = _number(header, b"conn", 4), _number(header, b"count", 4)
        raw = _read(stream, _LENGTH.unpack(_read(stream, 4))[0])
        if len(raw) != count * _ENTRY.itemsize:
            raise BrokenBagError("an index record of another size than it says")
        if number in chosen:
            most -= count
            if most < 0:
                raise BrokenBagError(f"a chunk with more than {MOST_MESSAGES:,} messages")
            found.append((number, np.frombuffer(raw, _ENTRY)))


def _by_index(data: bytes, entries: list[tuple[int, Rows]]) -> _Found | None:
    """Where messages are, from the index; None where one is not, or not in the usual form."""
    if not entries:
        return None
    connection = np.concatenate([np.full(rows.size, number) for number, rows in entries])
    rows = np.concatenate([rows for _, rows in entries])
    order = np.argsort(rows["offset"], kind="stable")
    connection, rows = connection[order].astype(np.int64), rows[order]
    offset = rows["offset"].astype(np.int64)
    if not offset.size or int(offset[-1]) + _FORM_BYTES + 8 > len(data):
        return None
    whole = np.frombuffer(data, np.uint8)
    heads = whole[offset[:, None] + np.arange(_FORM_BYTES + 8)]
    head = heads[0, 4:-4].tobytes()
    first = next((found for form in _FORMS if (found := form.fullmatch(head))), None)
    if first is None:
        return None
    # All have the form of the first: the same bytes but for connection and time.
    fixed = np.ones(_FORM_BYTES + 8, np.bool_)
    fixed[-4:] = False
    for name in ("conn", "time"):
        fixed[4 + first.start(name) : 4 + first.end(name)] = False
    at, time_at = 4 + first.start("conn"), 4 + first.start("time")
    said = _u32(heads[:, at : at + 4])
    seconds, nanoseconds = (
        _u32(heads[:, time_at : time_at + 4]),
        _u32(heads[:, time_at + 4 : time_at + 8]),
    )
    begin = offset + _FORM_BYTES + 8
    end = begin + _u32(heads[:, -4:])
    fits = (
        bool((heads[:, fixed] == heads[0, fixed]).all())
        and bool((said == connection).all())
        and bool((end[:-1] <= offset[1:]).all())
        and int(end[-1]) <= len(data)
    )
    return (connection, seconds * 10**9 + nanoseconds, begin, end) if fits else None


def _u32(raw: npt.NDArray[np.uint8]) -> Int64s:
    """int64[n] of uint8[n, 4]."""
    return np.ascontiguousarray(raw).view("<u4").reshape(-1).astype(np.int64)


def _by_search(data: bytes, chosen: frozenset[int]) -> _Found:
    found = array("q")
    for one in _in_chunk(data, chosen):
        found.extend(one)
    columns = np.frombuffer(found, np.int64).reshape(-1, 4).T
    return columns[0].copy(), columns[1].copy(), columns[2].copy(), columns[3].copy()


def _unpacked(header: dict[bytes, bytes], data: bytes, unpacker: Unpacker) -> bytes:
    name = header.get(b"compression", b"").decode("ascii", "replace")
    try:
        return unpacker.unpack(data, name, _number(header, b"size", 4))
    except UnpackingError as error:
        raise BrokenBagError(str(error)) from error


def _in_chunk(data: bytes, chosen: frozenset[int]) -> Iterator[tuple[int, int, int, int]]:
    """Connection, time, begin and end of each message in a chunk's bytes."""
    at, size, records = 0, len(data), 0
    while at < size:
        try:
            body = at + 4 + _LENGTH.unpack_from(data, at)[0]
            begin = body + 4
            end = begin + _LENGTH.unpack_from(data, body)[0]
        except struct.error as error:
            raise BrokenBagError("a record is cut off") from error
        if end > size:
            raise BrokenBagError("a record goes past the end of its chunk")
        fields = _fields(data[at + 4 : body])
        at = end
        records += 1
        if records > MOST_MESSAGES or b"op" not in fields:
            raise BrokenBagError("a chunk of too many records, or one without a kind")
        if fields.get(b"op") == bytes([_MESSAGE]):
            number = _number(fields, b"conn", 4)
            if number in chosen:
                yield number, _time(fields, b"time"), begin, end


def _form(order: tuple[bytes, ...]) -> re.Pattern[bytes]:
    parts = {
        b"conn": rb"\x09\0\0\0conn=(?P<conn>.{4})",
        b"op": rb"\x04\0\0\0op=\x02",
        b"time": rb"\x0d\0\0\0time=(?P<time>.{8})",
    }
    return re.compile(b"".join(parts[name] for name in order), re.DOTALL)


_FORMS = [_form(order) for order in permutations((b"conn", b"op", b"time"))]


def _seek(stream: BinaryIO, place: int) -> None:
    if place > _LARGEST_FILE:
        raise BrokenBagError(f"nothing can be at byte {place}")
    stream.seek(place)


def _read(stream: BinaryIO, count: int) -> bytes:
    if count > LARGEST_CHUNK:
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
    rest = (data.get(name, b"") for name in (b"callerid", b"message_definition"))
    topic, kind, caller, definition = (
        raw.decode("utf-8", "replace") for raw in (header[b"topic"], data[b"type"], *rest)
    )
    package, _, name = kind.rpartition("/")
    package = package.removesuffix("/msg")
    words = "/".join(word for word in topic.split("/") if word)
    topic = f"/{words}" if topic.startswith("/") else words
    latched = data.get(b"latching") == b"1"
    kind = f"{package}/msg/{name}"
    return BagConnection(_number(header, b"conn", 4), topic, kind, caller, latched, definition)
