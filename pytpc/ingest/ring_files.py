"""The files of rings: which of them have the last minutes, and a consistent copy of each.

A process that has a ring writes several files, one after the other; each is a whole ``.tpc`` file
(docs/reference/runtime.md#the-ring). The process may be running, may have ended, or may have been
killed in the middle of a report, and it may remove its oldest file at any moment.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import socket
import stat
import time
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

from pytpc.base.errors import InputError, TpcError
from pytpc.ingest.binary_chunks import ChunkFile, FileHeader
from pytpc.ingest.binary_system import SystemRecords, read_system
from pytpc.python_runtime import log_layout as layout

_SECOND = 10**9
# A clock that is read twice, and set by so little, is the same clock.
_SAME_BOOT_NS = 2 * _SECOND
# A process that writes notes both clocks every second.
_FRESH_NS = 5 * _SECOND
_CERTAINLY_ENDED_NS = 60 * _SECOND
_LEAST_SPAN_NS = 600 * _SECOND
_UNFINISHED = re.compile(r"-\d+-\d+(-\d+)?\.tpc\.new$")
_NAME = re.compile(r"-(\d+)-(\d{4,})\.tpc")


@dataclass(frozen=True, slots=True)
class Now:
    """This moment, in ns on the real and on the steady clock, and the name of this machine."""

    real_ns: int
    steady_ns: int
    host: str

    @classmethod
    def here(cls) -> Now:
        """It."""
        return cls(time.time_ns(), time.monotonic_ns(), socket.gethostname())


@dataclass(frozen=True, slots=True)
class Segment:
    """A file of a ring.

    Attributes:
        path: where it is.
        header: as it was read.
        size: bytes on the disk.
        is_written: its process runs and has it mapped.
        began_ago_ns, ended_ago_ns: how long ago it was begun, and its last report may have come.
    """

    path: Path
    header: FileHeader
    size: int
    is_written: bool
    began_ago_ns: int
    ended_ago_ns: int


@dataclass(frozen=True, slots=True)
class FoundRings:
    """The files of all rings in a folder, those of one process in order; ``others`` are no ring's.

    ``broken`` has the names of files that cannot be read.
    """

    segments: tuple[Segment, ...]
    others: int
    broken: tuple[str, ...] = ()

    @property
    def processes(self) -> int:
        """Of how many processes they are."""
        return len({_process_of(one.path, one.header) for one in self.segments})

    @property
    def writing(self) -> FoundRings:
        """Those of processes that go on writing."""
        written = {_process_of(one.path, one.header) for one in self.segments if one.is_written}
        kept = [one for one in self.segments if _process_of(one.path, one.header) in written]
        return replace(self, segments=tuple(kept))

    @property
    def size(self) -> int:
        """Bytes on the disk."""
        return sum(one.size for one in self.segments)

    def recent(self, minutes: float | None) -> FoundRings:
        """Those that have something of the last minutes.

        None: of as many minutes before the last report as the longest ring has, and at least ten.
        The last files of a process stay when it ends: those of yesterday are none of the last run.
        """
        if not self.segments:
            return self
        if minutes is not None:
            most_ns = minutes * 60 * _SECOND
        else:
            spans: dict[tuple[object, ...], list[int]] = defaultdict(list)
            for one in self.segments:
                of_one = spans[_process_of(one.path, one.header)]
                of_one += [one.began_ago_ns, one.ended_ago_ns]
            longest = max(max(ago) - min(ago) for ago in spans.values())
            last = min(one.ended_ago_ns for one in self.segments)
            most_ns = last + max(longest, _LEAST_SPAN_NS)
        kept = [one for one in self.segments if one.ended_ago_ns <= most_ns]
        return replace(self, segments=tuple(kept))


def rings_in(folder: Path, now: Now | None = None) -> FoundRings:
    """The rings whose files are in a folder, which need not exist.

    Raises:
        InputError: the folder cannot be read.
    """
    now = Now.here() if now is None else now
    of_process: dict[tuple[object, ...], list[tuple[Path, FileHeader, int]]] = defaultdict(list)
    others, broken = 0, []
    for path in _files(folder):
        try:
            with path.open("rb", buffering=0) as stream:
                header = FileHeader.of(stream.read(layout.HEADER_BYTES) or b"")
                size = os.fstat(stream.fileno()).st_blocks * 512
        except FileNotFoundError:
            # It was removed this moment.
            continue
        except (OSError, ValueError):
            broken.append(path.name)
            continue
        if header.segment:
            of_process[_process_of(path, header)].append((path, header, size))
        else:
            others += 1
    found: list[Segment] = []
    for files in of_process.values():
        files.sort(key=lambda one: one[1].segment)
        found += _with_times(files, now)
    found.sort(key=lambda one: (one.header.node, one.header.pid, one.header.segment))
    return FoundRings(tuple(found), others, tuple(broken))


def _files(folder: Path) -> list[Path]:
    try:
        return sorted(path for path in folder.iterdir() if path.suffix == ".tpc" and path.is_file())
    except FileNotFoundError:
        return []
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", folder) from error


def _process_of(path: Path, header: FileHeader) -> tuple[object, ...]:
    """What the files of one process have in common: a number of a process may come again."""
    named = _NAME.search(path.name)
    # In containers that share the name of the host, several may have one number.
    return header.host, header.pid, header.program, named[1] if named else path.name


def _with_times(files: Sequence[tuple[Path, FileHeader, int]], now: Now) -> Iterator[Segment]:
    """The files of one process, with how old they are.

    The wall clock may have been set meanwhile, as on a robot that learns the time late. So the
    steady clock counts, if the process is one of this machine since it was started.
    """
    written: set[Path] = set()
    if files[0][1].host == now.host:
        mapped = _mapped_by(files[0][1].pid)
        for path, header, _ in files:
            is_open = header.state == layout.OPEN
            if is_open if mapped is None else _identity(path) in mapped:
                written.add(path)
    last_path, last_header, _ = files[-1]
    last_steady, last_real = _last_moment(last_path, last_header)
    if last_header.state == layout.OPEN and abs(now.real_ns - last_real) <= _FRESH_NS:
        # A process of a container may have the name of this host, and a number of its own.
        written.add(last_path)
    shift = now.real_ns - now.steady_ns
    is_of_boot = bool(written) or (
        files[0][1].host == now.host
        and last_steady <= now.steady_ns
        and abs(last_real - last_steady - shift) <= _SAME_BOOT_NS
    )
    if written:
        last_steady, last_real = now.steady_ns, now.real_ns
    ends = [(head.steady_ns, head.real_ns) for _, head, _ in files[1:]] + [(last_steady, last_real)]
    for (path, header, size), (steady, real) in zip(files, ends, strict=True):
        began = now.steady_ns - header.steady_ns if is_of_boot else now.real_ns - header.real_ns
        ended = now.steady_ns - steady if is_of_boot else now.real_ns - real
        yield Segment(path, header, size, path in written, began, ended)


def _mapped_by(pid: int) -> set[tuple[int, str]] | None:
    """Inode and name of the files that a process has mapped; None if it may not be asked."""
    found = set()
    try:
        text = Path(f"/proc/{pid}/maps").read_text(encoding="utf-8", errors="replace")
    except PermissionError:
        return None
    except OSError:
        return set()
    for line in text.splitlines():
        words = line.split(None, 5)
        if len(words) == 6 and words[5].endswith(".tpc"):
            found.add((int(words[4]), os.path.basename(words[5])))  # noqa: PTH119
    return found


def _identity(path: Path) -> tuple[int, str]:
    """Without the device: some file systems name another one there."""
    try:
        return path.stat().st_ino, path.name
    except OSError:
        return -1, path.name


def _last_moment(path: Path, header: FileHeader) -> tuple[int, int]:
    """Steady and real time when the process last noted both in a file, about once a second."""
    system = SystemRecords()
    try:
        with path.open("rb", buffering=0) as stream:
            file = ChunkFile(path, stream.fileno())
            file.find(lambda _: None)
            for place in file.system:
                read_system(file.load_one(place), place, system, lambda _: None)
    except (OSError, ValueError, TpcError):
        pass
    return max([(header.steady_ns, header.real_ns), *system.syncs])


def remove_ended(folder: Path, hours: float) -> tuple[int, int]:
    """Remove the files of rings whose process ended so many hours, and a minute, ago.

    A process removes its own files only, so those of the last one of each node stay. Files that a
    process was making when it was killed are removed, too: they have no report.

    Returns:
        How many, and their bytes.

    Raises:
        InputError: the folder cannot be read.
        TpcError: a file cannot be removed.
    """
    of_process: dict[tuple[object, ...], list[Segment]] = defaultdict(list)
    for one in rings_in(folder).segments:
        of_process[_process_of(one.path, one.header)].append(one)
    count = size = 0
    least_ns = max(hours * 3600 * _SECOND, _CERTAINLY_ENDED_NS)
    for files in of_process.values():
        # What its process does that runs elsewhere, as in a container, only the files say.
        if any(one.is_written or one.ended_ago_ns < least_ns for one in files):
            continue
        for one in files:
            try:
                one.path.unlink()
            except FileNotFoundError:
                continue
            except OSError as error:
                what = f"cannot be removed: {error.strerror or error}"
                raise TpcError(what, one.path) from error
            count += 1
            size += one.size
    for path, bytes_of_it in _left_unfinished(folder, least_ns):
        with contextlib.suppress(OSError):
            path.unlink()
            count += 1
            size += bytes_of_it
    return count, size


def _left_unfinished(folder: Path, least_ns: float) -> Iterator[tuple[Path, int]]:
    """Files that are being made for so long, which takes a moment, and their bytes."""
    with contextlib.suppress(OSError):
        for path in sorted(folder.iterdir()):
            if _UNFINISHED.search(path.name) is None:
                continue
            with contextlib.suppress(OSError):
                its = path.lstat()
                if stat.S_ISREG(its.st_mode) and time.time_ns() - its.st_mtime_ns >= least_ns:
                    yield path, its.st_blocks * 512


# --- keeping them


def keep_segments(found: FoundRings, folder: Path) -> FoundRings:
    """Keep files in a folder, which is made; what a process still writes is copied as it is now.

    Returns:
        Those that were kept: the oldest may have been removed meanwhile.

    Raises:
        TpcError: the folder cannot be written.
    """
    kept = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        # The oldest ones first: they are removed first.
        for one in sorted(found.segments, key=lambda one: -one.ended_ago_ns):
            try:
                _keep(one, folder / one.path.name)
            except FileNotFoundError:
                continue
            kept.append(one)
    except OSError as error:
        raise TpcError(f"cannot be written: {error.strerror or error}", folder) from error
    return replace(found, segments=tuple(one for one in found.segments if one in kept))


def _keep(segment: Segment, to: Path) -> None:
    if segment.is_written or not _is_still(segment):
        with segment.path.open("rb", buffering=0) as source, to.open("xb") as target:
            copy_written(source, target)
        return
    try:
        os.link(segment.path, to, follow_symlinks=False)
    except FileNotFoundError:
        raise
    except OSError:
        # Another disk, or a file of somebody else.
        with segment.path.open("rb") as source, to.open("xb") as target:
            shutil.copyfileobj(source, target)


def _is_still(segment: Segment) -> bool:
    """Whether nobody writes it any more: it was closed, or its process of this machine is gone."""
    is_closed = segment.header.state == layout.CLOSED
    return is_closed or segment.header.host == socket.gethostname()


def copy_written(source: BinaryIO, target: BinaryIO) -> None:
    """Copy a ``.tpc`` file that is being written, so that all that it holds is known in it.

    Which chunks there are is read first, then the reports in these, and the keys last: a key is
    written before its first report. A summary that moves from its slot to the system's records
    meanwhile is in both, and readers count it once.
    """
    descriptor = source.fileno()
    target.write(os.pread(descriptor, layout.HEADER_BYTES, 0))
    at_first = [place for place, kind in _chunks(descriptor) if kind != layout.SYSTEM_CHUNK]
    for place in at_first:
        _copy_chunk(descriptor, place, target)
    for place, kind in _chunks(descriptor):
        if kind == layout.SYSTEM_CHUNK:
            _copy_chunk(descriptor, place, target)


def _chunks(descriptor: int) -> list[tuple[int, int]]:
    """Place and kind of the chunks in use."""
    places = range(layout.HEADER_BYTES, os.fstat(descriptor).st_size, layout.CHUNK_BYTES)
    heads = ((place, os.pread(descriptor, 4, place)) for place in places)
    return [(place, kind) for place, head in heads if (kind := int.from_bytes(head, "little"))]


def _copy_chunk(descriptor: int, place: int, target: BinaryIO) -> None:
    target.seek(place)
    target.write(os.pread(descriptor, layout.CHUNK_BYTES, place))
