"""ROS 2 recordings: ``.mcap`` and ``.db3`` files, and the folders in which rosbag2 keeps them.

Read through rosbags, which reads the profile of ROS 2 alone.
"""

from __future__ import annotations

import contextlib
import re
import tempfile
from collections.abc import Iterator
from contextvars import ContextVar
from pathlib import Path
from typing import BinaryIO, cast

from rosbags.interfaces import Connection
from rosbags.rosbag2 import Reader, storage_mcap
from rosbags.rosbag2 import reader as folder_reader
from rosbags.rosbag2.storage_mcap import McapReader
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

from pytpc.base.errors import InputError
from pytpc.base.regular_files import read_file
from pytpc.ingest.decoders import ROS2
from pytpc.ingest.gathering import Gathering, Progress
from pytpc.ingest.magic import MCAP_MAGIC
from pytpc.ingest.mcap_end import cut_off
from pytpc.ingest.messages import REPORTS, ROSOUT, Messages, wanted
from pytpc.ingest.parameter_events import TOPIC, TYPE, decode_parameter_event
from pytpc.ingest.unpacking import LARGEST_MESSAGE, UnpackedStream, Unpacker

_TYPES = {ROSOUT: {"rcl_interfaces/msg/Log"}, REPORTS: {"std_msgs/msg/String"}, TOPIC: {TYPE}}
_TIMES = {"builtin_interfaces/msg/Time", "std_msgs/msg/Time"}
_STEP = 4096
_Reader = Reader | McapReader | Sqlite3Reader
_IN_A_URI = frozenset("?#%")
_SQLITE_LIMIT_LENGTH = 0
_METADATA = "metadata.yaml"
_ALIAS = re.compile(rb"(?m)(?:^|[\s\[{,])\*[A-Za-z0-9_]")
_unpacker: ContextVar[Unpacker] = ContextVar("unpacker")


def _bounded(name: str) -> None:
    """Let rosbags unpack chunks no further than the limits; it trusts what they say."""

    def unpack(data: bytes, size: int) -> bytes:
        return _unpacker.get().unpack(data, name, size)

    storage_mcap.DECOMPRESSORS[name] = unpack


for _name in ("lz4", "zstd"):
    _bounded(_name)


class _Zstd:
    """Takes the place of the module zstd in rosbags' reader of folders, with limits."""

    @staticmethod
    def decompress(data: bytes) -> bytes:
        """Unpack one message.

        Raises:
            UnpackingError: it is too large.
        """
        return _unpacker.get().unpack_message(data)

    @staticmethod
    def open(stream: BinaryIO, _mode: str) -> UnpackedStream:
        """Unpack a whole file."""
        return UnpackedStream(stream)


setattr(folder_reader, "zstd", _Zstd)  # noqa: B010 - it is not exported


def read_ros2_into(path: Path, gathering: Gathering, on_progress: Progress | None = None) -> None:
    """Read a .mcap or .db3 file, or a folder of rosbag2.

    Reports come from /rosout and /threshold_information, marks from the topics of
    docs/reference/formats.md#marks, and the values of parameters from /parameter_events.

    Raises:
        InputError: the file is damaged, or of ROS 1; one line. An MCAP file that ends too early is
            read up to there, and a note says so.
    """
    with contextlib.ExitStack() as exits:
        _unpacker.set(Unpacker())
        try:
            reader = _open(path, exits, gathering)
            kept, notes = wanted(reader.connections, _TYPES, _TIMES)
            gathering.notes += notes
            whole = reader if isinstance(reader, Reader) else reader.metadata
            if whole.message_count:
                gathering.spans.append((whole.start_time, whole.end_time - 1))
        except InputError:
            raise
        except Exception as error:
            raise _broken(path, error) from error
        taken = Messages(gathering, str(path), ROS2, numbered=False)
        total = sum(connection.msgcount for connection in kept)

        def take_values(topic: str, _caller: str, time_ns: int, raw: bytes) -> None:
            try:
                gathering.add_values(decode_parameter_event(raw), time_ns)
            except ValueError as error:
                gathering.skip(topic, time_ns, str(error), "")

        for turn, (connection, time_ns, raw) in enumerate(_messages(reader, kept, path)):
            # SQLite keeps any type in any column.
            if isinstance(raw, bytes) and isinstance(time_ns, int):
                take = take_values if connection.topic == TOPIC else taken.take
                take(connection.topic, "", time_ns, raw)
            else:
                gathering.skip(connection.topic, 0, "a message without bytes or without time", "")
            if on_progress is not None and turn % _STEP == 0:
                on_progress(turn, total)
        taken.close()


def _open(path: Path, exits: contextlib.ExitStack, gathering: Gathering) -> _Reader:
    """rosbags' reader of the file, by its content."""
    reader: _Reader
    if path.is_dir():
        _check_metadata(path / _METADATA)
        reader = Reader(path)
    elif _is_mcap(path):
        reader = McapReader(_whole(path, gathering))
    else:
        if _IN_A_URI & set(str(path)):
            # The path becomes a part of a URI there.
            folder = exits.enter_context(tempfile.TemporaryDirectory())
            link = Path(folder) / "bag.db3"
            link.symlink_to(path.absolute())
            path = link
        reader = Sqlite3Reader(path)
    reader.open()
    exits.callback(_close, reader)
    for storage in _storages(reader):
        if isinstance(storage, Sqlite3Reader) and storage.dbconn is not None:
            storage.dbconn.limit(_SQLITE_LIMIT_LENGTH, LARGEST_MESSAGE)
    return reader


def _whole(path: Path, gathering: Gathering) -> Path:
    """The file, or what is whole of it where its end is missing.

    Raises:
        InputError: it ends before its first message can.
    """
    cut = cut_off(path)
    if cut is None:
        return path
    if cut.size <= len(MCAP_MAGIC):
        size = path.stat().st_size
        raise InputError(f"truncated or damaged: it ends at its beginning ({size:,} bytes)", path)
    gathering.notes.append(
        f"{path}: has no end; its recorder was killed, or still runs: all but the last"
        f" {cut.left:,} bytes are read"
    )
    # It has all that the reader uses of a path.
    return cast("Path", cut)


def _storages(reader: _Reader) -> list[object]:
    """The readers of single files."""
    storage = reader.storage if isinstance(reader, Reader) else reader
    return list(getattr(storage, "storages", [storage]))


def _check_metadata(path: Path) -> None:
    """Check metadata.yaml, which rosbags reads as a whole; rosbag2 writes no aliases.

    Raises:
        InputError: it is no file, too large, or has aliases, which may stand for many values.
    """
    if _ALIAS.search(read_file(path)) is not None:
        raise InputError("has aliases of YAML, which rosbag2 does not write", path)


def _close(reader: _Reader) -> None:
    with contextlib.suppress(Exception):
        reader.close()


def _messages(
    reader: _Reader, wanted: list[Connection], path: Path
) -> Iterator[tuple[Connection, int, bytes]]:
    """The messages of ``wanted``; any error of the reader becomes an InputError."""
    if not wanted:
        return
    if isinstance(reader, McapReader) and not reader.chunks:
        # Without an index, rosbags gives them as they are in the file, or not at all.
        messages = reader.messages_scan(wanted)
    else:
        messages = iter(reader.messages(wanted))
    while True:
        try:
            message = next(messages)
        except StopIteration:
            return
        except Exception as error:
            raise _broken(path, error) from error
        yield message


def _broken(path: Path, error: Exception) -> InputError:
    if isinstance(error, OSError) and error.strerror:
        return InputError(f"cannot be read: {error.strerror}", path)
    said = " ".join(str(error).split()) or type(error).__name__
    if "Profile is not ros2" in said:
        return InputError("not an .mcap file of ROS 2, the only kind that rosbags reads", path)
    tool = "mcap recover {0}" if _is_mcap(path) else "sqlite3 {0} .recover"
    hint = "" if path.is_dir() else f'; "{tool.format(path.name)}" recovers the rest'
    size = "" if path.is_dir() else f" ({path.stat().st_size:,} bytes)"
    return InputError(f"truncated or damaged{size}: {said}{hint}", path)


def _is_mcap(path: Path) -> bool:
    try:
        with path.open("rb") as stream:
            return stream.read(len(MCAP_MAGIC)) == MCAP_MAGIC
    except OSError:
        return False
