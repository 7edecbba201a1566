"""The mapped file of reports: disk space that is handed out in chunks."""

from __future__ import annotations

import _thread
import contextlib
import errno
import mmap
import os
import stat
import struct
import sys
import threading
from operator import length_hint
from time import monotonic_ns, time_ns
from typing import TYPE_CHECKING

from pytpc.python_runtime.errors import warn
from pytpc.python_runtime.log_layout import (
    CHUNK,
    CHUNK_BYTES,
    CLOSED,
    HEADER,
    HEADER_BYTES,
    LOST_AT,
    MAGIC,
    NODE_BYTES,
    OPEN,
    RECORD_BYTES,
    SECOND,
    STATE_AT,
    STOPPED,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from pytpc.python_runtime.config import Config

_EXTENT_BYTES = 1 << 20
_HALF_EXTENT = _EXTENT_BYTES // CHUNK_BYTES // 2
# Mappings are never unmapped, because other threads may write to them, and each takes a
# descriptor. They grow in size, so that 4 GiB need about 70 of them.
_LARGEST_EXTENT = 64 << 20


class Extent:
    """A mapped part of the file, as bytes and as words of 32 bits; ``free`` gives its chunks."""

    __slots__ = ("bytes", "free", "words")

    def __init__(self, mapped: mmap.mmap, size: int) -> None:
        """``mapped`` has ``size`` bytes."""
        self.bytes = mapped
        self.words = memoryview(mapped).cast("I")
        # One call into C takes a chunk: a signal handler cannot take the same one.
        self.free = iter(range(0, size, CHUNK_BYTES))


class MappedFile:
    """One file. An error while it is written stops the recording, never the program.

    ``is_stopped``: the disk is full, or a limit is reached.
    """

    def __init__(
        self, config: Config, parent: int, node: str, of: SegmentName | None = None
    ) -> None:
        """Make the file in its folder, with its header alone; ``of``: the next of a ring.

        Raises:
            OSError: it cannot be made.
        """
        self._segment = 0
        self._limit = (config.file_limit if of is None else config.ring_budget) << 20
        # Called when half of the last extent is used, and when there is no more space.
        self.on_half: Callable[[], None] | None = None
        self._reserve = config.file_reserve << 20
        self._lock = threading.RLock()
        self._extents: list[Extent] = []
        self._size = HEADER_BYTES
        self._is_growing = False
        self.is_stopped = False
        self._is_closed = False
        self.path, self._descriptor = _created(config, node, of)
        if of is not None:
            self._segment = of.next - 1
        its = os.fstat(self._descriptor)
        self.identity = (its.st_dev, its.st_ino)
        try:
            self._begin(parent, node)
            os.rename(f"{self.path}.new", self.path)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(f"{self.path}.new")
            os.close(self._descriptor)
            raise

    def new_chunk(self, kind: int, thread: int, first: int) -> tuple[Extent, int] | None:
        """A chunk as its extent and its first byte in it; None where there is no space."""
        with self._lock:
            if self.is_stopped or self._is_closed:
                return None
            while True:
                extent = self._extents[-1]
                begin = next(extent.free, None)
                if begin is not None:
                    break
                if self._is_growing:
                    # A signal handler reports while the file grows.
                    return None
                try:
                    self._grow(extent)
                except OSError as error:
                    self._stop(error.strerror or str(error))
                    return None
            if self.on_half is not None and length_hint(extent.free) == _HALF_EXTENT:
                self.on_half()
            CHUNK.pack_into(extent.bytes, begin + 4, thread, first, _thread.get_native_id())
            extent.words[begin >> 2] = kind
            return extent, begin

    def _grow(self, full: Extent) -> None:
        self._is_growing = True
        try:
            # A signal handler may have done it just before.
            if self._extents[-1] is full:
                self._add_extent()
        finally:
            self._is_growing = False

    def _add_extent(self) -> None:
        if not self._is_mine():
            raise OSError(0, "the program has closed its descriptor")
        largest = _EXTENT_BYTES if self._segment else _LARGEST_EXTENT
        size = min(largest, max(_EXTENT_BYTES, self._size - HEADER_BYTES))
        end = self._size + size
        if self._limit and end > self._limit:
            size = _EXTENT_BYTES
            end = self._size + size
            if end > self._limit:
                what = f"its limit of {self._limit >> 20} MiB (TPC_FILE_LIMIT) is reached"
                raise OSError(0, what)
        disk = os.fstatvfs(self._descriptor)
        if self._reserve and disk.f_bavail * disk.f_frsize < self._reserve + size:
            what = f"the disk has less than {self._reserve >> 20} MiB left (TPC_FILE_RESERVE)"
            raise OSError(0, what)
        os.posix_fallocate(self._descriptor, self._size, size)
        self._extents.append(Extent(mmap.mmap(self._descriptor, size, offset=self._size), size))
        self._size = end

    def _is_mine(self) -> bool:
        """A program that closes all descriptors may have reused the number for another file."""
        try:
            its = os.fstat(self._descriptor)
        except OSError:
            return False
        return (its.st_dev, its.st_ino) == self.identity

    def _stop(self, why: str) -> None:
        if not self.is_stopped:
            self.is_stopped = True
            self._put_state(STOPPED)
            if self._segment:
                # The ring begins another file, or says that it cannot.
                if self.on_half is not None:
                    self.on_half()
                return
            warn(f"{self.path}: {why}; recording stops, and the program continues")

    def close(self) -> None:
        """Give back unused space. Threads can still write to the chunks that they have."""
        with self._lock:
            if self._is_closed:
                return
            self._is_closed = True
            if self._is_mine():
                with contextlib.suppress(OSError):
                    free = length_hint(self._extents[-1].free) * CHUNK_BYTES
                    os.ftruncate(self._descriptor, self._size - free)
                    self._size -= free
                os.close(self._descriptor)
            if not self.is_stopped:
                self._put_state(CLOSED)

    @property
    def size(self) -> int:
        """Bytes that it takes on the disk."""
        return self._size

    @property
    def used(self) -> int:
        """Bytes of its header and of the chunks that were handed out."""
        return self._size - length_hint(self._extents[-1].free) * CHUNK_BYTES

    def _put_state(self, state: int) -> None:
        struct.pack_into("<I", self._header, STATE_AT, state)

    def _count_lost(self) -> None:
        with self._lock:
            (lost,) = struct.unpack_from("<Q", self._header, LOST_AT)
            struct.pack_into("<Q", self._header, LOST_AT, lost + 1)

    def _begin(self, parent: int, node: str) -> None:
        os.posix_fallocate(self._descriptor, 0, HEADER_BYTES)
        self._header = mmap.mmap(self._descriptor, HEADER_BYTES)
        HEADER.pack_into(
            self._header,
            0,
            b"",
            HEADER_BYTES,
            RECORD_BYTES,
            CHUNK_BYTES,
            os.getpid(),
            monotonic_ns(),
            time_ns(),
            OPEN,
            0,
            0,
            parent,
            self._segment,
            bounded(node, NODE_BYTES),
            bounded(os.uname().nodename, 256),
            bounded(_program(), 1024),
        )
        self._header[:8] = MAGIC
        self._add_extent()


def bounded(text: str, size: int) -> bytes:
    """UTF-8, cut between characters, with space for a NUL at the end."""
    return text.encode("utf-8", "replace")[: size - 1].decode("utf-8", "ignore").encode("utf-8")


def _program() -> str:
    """The script that runs, or the interpreter."""
    script = getattr(sys.modules.get("__main__"), "__file__", None)
    return os.path.abspath(script) if isinstance(script, str) else sys.executable or "python"


def _home() -> str:
    """The folder in the user's home; empty without one."""
    home = os.environ.get("HOME")
    ros_home = os.environ.get("ROS_HOME") or (home and os.path.join(home, ".ros"))
    return os.path.join(ros_home, "tpc") if ros_home else ""


def _make_folders(folder: str) -> None:
    """Make a folder and those above it, for this user alone (``makedirs`` does so for the last)."""
    above = os.path.dirname(folder.rstrip("/"))
    if above and not os.path.isdir(above):
        _make_folders(above)
    os.makedirs(folder, mode=0o700, exist_ok=True)


def _private_folder(folder: str) -> str:
    """Make a folder in /tmp, where anybody can make one of the same name first.

    Raises:
        OSError: it is not a folder of this user alone.
    """
    with contextlib.suppress(FileExistsError):
        os.mkdir(folder, 0o700)
    status = os.lstat(folder)
    is_own = stat.S_ISDIR(status.st_mode) and status.st_uid == os.geteuid()
    if not is_own or status.st_mode & 0o077:
        what = "not a folder of this user alone; set TPC_FOLDER or HOME"
        raise PermissionError(errno.EPERM, what, folder)
    return folder


class SegmentName:
    """What the files of one ring have in common, and the number of the next one."""

    def __init__(self, began_s: int) -> None:
        """``began_s``: in seconds since 1970."""
        self.began_s = began_s
        self.next = 1


def _created(config: Config, node: str, of: SegmentName | None = None) -> tuple[str, int]:
    """The path of a new file, and a descriptor of that path with ``.new`` added.

    The file gets its name when it can be read. Until then ``.new`` keeps processes of other
    containers, which may have the same number and so the same names, from using it.
    """
    folder = config.folder or _home()
    if folder:
        _make_folders(folder)
    else:
        folder = _private_folder(f"/tmp/tpc-{os.geteuid()}")
    name = (node or os.path.basename(_program())).lstrip("/")
    name = "".join(c if c.isascii() and (c.isalnum() or c in "_-") else "_" for c in name)[:100]
    began_s = time_ns() // SECOND if of is None else of.began_s
    stem = os.path.join(folder, f"{name or 'process'}-{os.getpid()}-{began_s}")
    for number in range(1, 1000):
        if of is not None:
            path = f"{stem}-{of.next:04}.tpc"
            of.next += 1
        else:
            path = f"{stem}-{number}.tpc" if number > 1 else f"{stem}.tpc"
        flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
        try:
            descriptor = os.open(f"{path}.new", flags, 0o600)
        except FileExistsError:
            continue
        if not os.path.exists(path):
            return path, descriptor
        os.close(descriptor)
        os.unlink(f"{path}.new")
    raise FileExistsError(17, "File exists", stem)
