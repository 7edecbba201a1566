"""ROS 2 recordings: ``.mcap`` and ``.db3`` files, and the folders in which rosbag2 keeps them.

Read through rosbags, which reads the profile of ROS 2 alone.
"""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path

from rosbags.interfaces import Connection
from rosbags.rosbag2 import Reader
from rosbags.rosbag2.storage_mcap import McapReader
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

from pytpc.base.errors import InputError
from pytpc.ingest import ros2
from pytpc.ingest.gathering import Gathering, Progress
from pytpc.ingest.magic import MCAP_MAGIC
from pytpc.ingest.messages import REPORTS, ROSOUT, Decoders, Messages, wanted

_TYPES = {ROSOUT: {"rcl_interfaces/msg/Log"}, REPORTS: {"std_msgs/msg/String"}}
_TIMES = {"builtin_interfaces/msg/Time", "std_msgs/msg/Time"}
_DECODERS = Decoders(ros2.decode_log, ros2.decode_string, ros2.decode_time)
_STEP = 4096
_Reader = Reader | McapReader | Sqlite3Reader
_IN_A_URI = frozenset("?#%")


def read_ros2_into(path: Path, gathering: Gathering, on_progress: Progress | None = None) -> None:
    """Read a .mcap or .db3 file, or a folder of rosbag2.

    Reports come from /rosout and /threshold_information, marks from the topics of
    docs/reference/formats.md#marks.

    Raises:
        InputError: the file is truncated or damaged, or of ROS 1; one line.
    """
    with contextlib.ExitStack() as exits:
        try:
            reader = _open(path, exits)
            kept, notes = wanted(reader.connections, _TYPES, _TIMES)
            gathering.notes += notes
            whole = reader if isinstance(reader, Reader) else reader.metadata
            if whole.message_count:
                gathering.spans.append((whole.start_time, whole.end_time - 1))
        except Exception as error:
            raise _broken(path, error) from error
        taken = Messages(gathering, str(path), _DECODERS, numbered=False)
        total = sum(connection.msgcount for connection in kept)
        for turn, (connection, time_ns, raw) in enumerate(_messages(reader, kept, path)):
            # SQLite keeps any type in any column.
            if isinstance(raw, bytes) and isinstance(time_ns, int):
                taken.take(connection.topic, "", time_ns, raw)
            else:
                gathering.skip(connection.topic, 0, "a message without bytes or without time", "")
            if on_progress is not None and turn % _STEP == 0:
                on_progress(turn, total)
        taken.close()


def _open(path: Path, exits: contextlib.ExitStack) -> _Reader:
    """rosbags' reader of the file, by its content."""
    reader: _Reader
    if path.is_dir():
        reader = Reader(path)
    elif _is_mcap(path):
        reader = McapReader(path)
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
    return reader


def _close(reader: _Reader) -> None:
    with contextlib.suppress(Exception):
        reader.close()


def _messages(
    reader: _Reader, wanted: list[Connection], path: Path
) -> Iterator[tuple[Connection, int, bytes]]:
    """The messages of ``wanted``; any error of the reader becomes an InputError."""
    if not wanted:
        return
    messages = reader.messages(wanted)
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
    hint = f'; "mcap recover {path.name}" recovers the rest'
    if path.is_dir():
        hint = ""
    elif not _is_mcap(path):
        hint = f'; "sqlite3 {path.name} .recover" recovers the rest'
    size = "" if path.is_dir() else f" ({path.stat().st_size:,} bytes)"
    return InputError(f"truncated or damaged{size}: {said}{hint}", path)


def _is_mcap(path: Path) -> bool:
    try:
        with path.open("rb") as stream:
            return stream.read(len(MCAP_MAGIC)) == MCAP_MAGIC
    except OSError:
        return False
