"""Reads recordings of every format; the content of a file tells its format, not its name."""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from importlib import import_module
from itertools import islice
from pathlib import Path

from pytpc.base.closest import path_hint
from pytpc.base.errors import InputError, TpcError
from pytpc.base.regular_files import open_file, real_path
from pytpc.base.wording import listed, many, plain
from pytpc.ingest.condense import condensed
from pytpc.ingest.duplicates import TOLERANCE_NS
from pytpc.ingest.folder import read_folder_into
from pytpc.ingest.gathering import Gathering, Progress
from pytpc.ingest.magic import BAG_MAGIC, MCAP_MAGIC, PARQUET_MAGIC, SQLITE_MAGIC, TPC_MAGIC
from pytpc.ingest.merged import Merged
from pytpc.recording.marks import begins_marks, joined, marks_between, read_marks
from pytpc.recording.marks_home import marks_home
from pytpc.recording.mission import (
    EVENTS_FILE,
    REPORTS_FOLDER,
    RUN_FILE,
    Recording,
    is_converted,
    is_ros2_folder,
    load_recording,
)

Reader = Callable[[Path, Gathering, Progress | None], None]
_BY_MAGIC = {
    TPC_MAGIC: ("binary", "read_binary"),
    BAG_MAGIC[:8]: ("bag", "read_bag_into"),
    MCAP_MAGIC: ("ros2_bag", "read_ros2_into"),
    SQLITE_MAGIC: ("ros2_bag", "read_ros2_into"),
    PARQUET_MAGIC: ("folder", "read_parquet_into"),
}
"""Module and function of the reader of each format."""
MOST_ROWS = 1 << 22
"""A binary file with more reports is condensed, if the recording is read into memory."""
_FIRST = 4096
# What a recorder of ROS 2 writes, until it ends.
_GROWING = ".mcap.active"
_MOST_BELOW, _LISTED = 500, 6
# The rosout node and roscpp begin a new file after 100 MB.
_ROTATED = re.compile(r"\.log\.[0-9]+")


def read(
    paths: Path | Sequence[Path],
    on_progress: Progress | None = None,
    *,
    tolerance_ns: int = TOLERANCE_NS,
    period_ns: int | None = None,
) -> Recording:
    """Read recordings of one mission into memory, in order of time and every report once.

    Args:
        paths: bags (ROS 1, .mcap, .db3), binary files, logs, console text, CSV (reports or marks),
            folders of such files, and folders and files that ``pytpc convert`` wrote. The marks of
            each are read with it (`pytpc.recording.marks_home`).
        on_progress: called with (done, total) now and then, for one file after another.
        tolerance_ns: how far apart in time the same report may be in two files.
        period_ns: keep of each comparison only its first evaluation, its flops, and a summary of
            each period of this length; as recorded if it has summaries. None: all that was read.

    Raises:
        InputError: a file is missing, of no known format, or broken; one line.
    """
    given = [paths] if isinstance(paths, Path) else list(paths)
    converted = _converted(given[0]) if len(given) == 1 else None
    if converted is not None:
        recording, home = load_recording(converted), marks_home(given[0])
        nearby = marks_between(home.marks_nearby(), recording.start_ns, recording.end_ns)
        marked = replace(recording, marks=joined([*recording.marks, *home.marks(), *nearby]))
        return marked if period_ns is None else condensed(marked, period_ns)
    gathering = Gathering(most_rows=MOST_ROWS, period_ns=period_ns)
    gather(given, gathering, on_progress)
    found = Merged(gathering, name_of(given), tolerance_ns).recording()
    return found if period_ns is None else condensed(found, period_ns)


@contextmanager
def opened(
    paths: Sequence[Path],
    scratch: Path,
    on_progress: Progress | None = None,
    *,
    tolerance_ns: int = TOLERANCE_NS,
) -> Iterator[Merged]:
    """Read recordings with little memory: data that does not fit goes to files in ``scratch``.

    Args:
        paths: as in ``read``.
        scratch: a folder on a disk with room for the reports, 36 bytes each.
        on_progress: as in ``read``.
        tolerance_ns: as in ``read``.

    Raises:
        InputError: as in ``read``.
        TpcError: ``scratch`` cannot be written.
    """
    try:
        scratch.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix=".tpc-", dir=scratch))
    except OSError as error:
        raise TpcError(f"cannot be written: {error.strerror or error}", scratch) from error
    try:
        gathering = Gathering(folder)
        gather(paths, gathering, on_progress)
        yield Merged(gathering, name_of(paths), tolerance_ns)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def gather(
    paths: Sequence[Path], gathering: Gathering, on_progress: Progress | None = None
) -> None:
    """Read all of ``paths`` into ``gathering``, and their marks.

    A folder stands for the recordings in it.

    Raises:
        InputError: see ``read``.
    """
    seen: set[Path] = set()
    last: list[tuple[Reader, Path]] = []
    for path in paths:
        found = sources(path)
        home = marks_home(path)
        gathering.marks += home.marks()
        gathering.marks_nearby += home.marks_nearby()
        for source in found:
            # A file with two names is read once.
            real = real_path(source)
            if real in seen:
                continue
            seen.add(real)
            reader = reader_of(source)
            if source.is_dir() or source.is_symlink():
                # Those of the files in a folder are the folder's.
                gathering.marks += marks_home(source).marks()
            is_binary = reader.__name__ == _BY_MAGIC[TPC_MAGIC][1]
            if is_binary and not gathering.has_room(source.stat().st_size // 32):
                # It is condensed, which needs the marks of all others.
                last.append((reader, source))
            else:
                reader(source, gathering, on_progress)
    for reader, source in last:
        reader(source, gathering, on_progress)
    empty = gathering.without_reports
    if empty:
        what = many(len(empty), "text file")
        gathering.late_notes.append(f"{what} without a report, for example {empty[0]}")
    for path in paths:
        for left in sorted(path.glob("*.bag.active")):
            gathering.late_notes.append(f"{left}: not read; recover it with: rosbag reindex")


def sources(path: Path) -> list[Path]:
    """The recordings at ``path``: the file itself, or those in a folder, by name.

    Raises:
        InputError: it is not there, or the folder has no recordings.
    """
    if not path.exists() and not path.is_symlink():
        raise InputError(f"no such bag, file or folder{path_hint(path)}", path)
    converted = _converted(path)
    if converted is not None:
        return [converted]
    if not path.is_dir() or is_ros2_folder(path):
        return [path]
    try:
        entries = sorted(entry for entry in path.iterdir() if not entry.name.startswith("."))
        if (path / RUN_FILE).is_file() and (path / REPORTS_FOLDER).is_dir():
            # A mission of ``pytpc record`` whose nodes wrote files.
            entries += sorted((path / REPORTS_FOLDER).iterdir())
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", path) from error
    found = [entry for entry in entries if _is_recording(entry)]
    if not found and any(path.glob("*.bag.active")):
        what = "only an unfinished bag: run rosbag reindex on it, then remove .active from its name"
        raise InputError(what, path)
    if not found:
        raise InputError(f"no recordings in this folder; {_to_give(path, entries)}", path)
    return found


def _to_give(folder: Path, entries: Sequence[Path]) -> str:
    """What to give instead of a folder without recordings: those in its folders, if it has any."""
    below = [plain(str(folder / one.name)) for one in entries[:_MOST_BELOW] if holds_mission(one)]
    if not below:
        return "give a bag, or a folder that `pytpc record` wrote"
    which = "give the one below it" if len(below) == 1 else f"give one of the {len(below)} below it"
    return f"{which}: {listed(below, _LISTED)}"


def holds_mission(folder: Path) -> bool:
    """Whether a folder is a recorded mission; logs and tables alone may be of anything."""
    try:
        if is_converted(folder) or is_ros2_folder(folder) or (folder / RUN_FILE).is_file():
            return True
        return folder.is_dir() and any(
            one.suffix in {".bag", ".mcap", ".db3", ".tpc"}
            for one in islice(folder.iterdir(), _MOST_BELOW)
        )
    except OSError:
        return False


def _converted(path: Path) -> Path | None:
    """The folder of ``pytpc convert`` that this is, or whose events this is, if there is one."""
    folder = path.parent if path.name == EVENTS_FILE else path
    return folder if is_converted(folder) else None


def name_of(paths: Sequence[Path]) -> str:
    """The name of a mission in these files, taken from the first."""
    path = paths[0]
    return path.name if path.is_dir() else path.stem


def reader_of(path: Path) -> Reader:
    """The reader for this, by its first bytes.

    Raises:
        InputError: it cannot be read, or its format is unknown.
    """
    if path.is_dir():
        return read_folder_into if is_converted(path) else _reader("ros2_bag", "read_ros2_into")
    try:
        with open_file(path) as stream:
            first = stream.read(_FIRST)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", path) from error
    for magic, (module, name) in _BY_MAGIC.items():
        if first.startswith(magic):
            return _reader(module, name)
    if not first:
        raise InputError("the file is empty: nothing was recorded, or nothing copied", path)
    if BAG_MAGIC.startswith(first) or path.suffix == ".bag":
        return _reader("bag", "read_bag_into")
    if begins_marks(first):
        return _read_marks_into
    if b"\0" in first:
        raise InputError("neither a bag, nor a .tpc file, nor Parquet, nor text", path)
    return _reader("text", "read_text_into")


def _reader(module: str, name: str) -> Reader:
    """A reader, imported when a file needs it: those of bags take longer than a short mission."""
    found: Reader = getattr(import_module(f"pytpc.ingest.{module}"), name)
    return found


def _read_marks_into(path: Path, gathering: Gathering, on_progress: Progress | None) -> None:
    gathering.marks += read_marks(path)


def _is_recording(path: Path) -> bool:
    if path.is_dir():
        return is_converted(path) or is_ros2_folder(path)
    if (
        path.name.endswith(".marks.csv")
        and path.with_name(path.name[: -len(".marks.csv")]).exists()
    ):
        # It is read with the recording beside it.
        return False
    if path.name.endswith(_GROWING):
        return True
    return bool(_ROTATED.search(path.name)) or path.suffix in {
        ".bag",
        ".mcap",
        ".db3",
        ".tpc",
        ".log",
        ".csv",
        ".txt",
    }
