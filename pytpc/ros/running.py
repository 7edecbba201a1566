"""The recordings that run on this machine, so that other terminals find them by themselves.

Each has a file in a folder of its user alone: ``$XDG_RUNTIME_DIR/pytpc`` (by default
``/run/user/UID/pytpc``), or ``/tmp/pytpc-UID`` where that cannot be used. A file whose process is
gone is removed by whoever finds it.
"""

from __future__ import annotations

import contextlib
import json
import os
import stat
import tempfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.errors import TpcError
from pytpc.ros.ros2.address import is_ros2, words_of

_SUFFIX = ".recording.json"
_MOST_BYTES = 1 << 16
_USERS = Path("/run/user")
# Fields of /proc/PID/stat behind the program's name; `starttime` is the 22nd of all.
_START_FIELD = 22 - 3


@dataclass(frozen=True, slots=True)
class RunningRecording:
    """A recording that runs.

    Attributes:
        pid: of the process that records.
        process_start: when that began, in ticks since the machine's start: a number of a process
            is used again.
        master: URI of its ROS master, or the address of its ROS 2 graph.
        host: the address at which this graph reaches this machine.
        folder: of the results.
        workspace: whose launch file runs, empty for a graph that ran already.
        static: its file of static information, empty where that is not known.
        launch: the launch file, empty where that is not known.
        since: when it began, in seconds since 1970.
    """

    pid: int
    process_start: int
    master: str
    host: str
    folder: str
    workspace: str = ""
    static: str = ""
    launch: str = ""
    since: float = 0.0

    @property
    def words(self) -> str:
        """Which one it is, in a few words."""
        what = Path(self.launch).name if self.launch else "a running graph"
        graph = words_of(self.master) if is_ros2(self.master) else f"master {self.master}"
        return f"{self.folder} ({what}, {graph})"


def process_start(pid: int) -> int | None:
    """When a process began, in ticks since the machine's start; None if there is no such one."""
    try:
        text = Path(f"/proc/{pid}/stat").read_bytes()
        # The name may have blanks and parentheses.
        return int(text.rpartition(b")")[2].split()[_START_FIELD])
    except (OSError, ValueError, IndexError):
        return None


def entries_folder() -> Path:
    """Where the entries are; the folder need not exist.

    After ``su`` the variable names the folder of another user. If root makes a folder there, that
    user cannot use it any more.
    """
    # Not every shell of a user has the variable.
    runtime = Path(os.environ.get("XDG_RUNTIME_DIR") or _USERS / str(os.getuid())) / "pytpc"
    return runtime if _is_usable(runtime) else Path(tempfile.gettempdir()) / f"pytpc-{os.getuid()}"


@contextlib.contextmanager
def announced(recording: RunningRecording) -> Iterator[None]:
    """Have other terminals find a recording within the block.

    Where no entry can be written, they need to be told the address of the master.
    """
    folder = entries_folder()
    path = folder / f"{recording.pid}{_SUFFIX}"
    try:
        with contextlib.suppress(OSError, TpcError):
            with contextlib.suppress(FileExistsError):
                folder.mkdir(mode=0o700)
            if _is_private(folder):
                write_atomic(path, json.dumps(asdict(recording)).encode() + b"\n")
                path.chmod(0o600)
        yield
    finally:
        with contextlib.suppress(OSError):
            path.unlink()


def running_recordings() -> list[RunningRecording]:
    """The recordings of this user that run on this machine, the oldest first."""
    folder = entries_folder()
    if not _is_private(folder):
        return []
    found = []
    for path in sorted(folder.glob(f"*{_SUFFIX}")):
        entry = _entry(path)
        if entry is not None and process_start(entry.pid) == entry.process_start:
            found.append(entry)
            continue
        with contextlib.suppress(OSError):
            path.unlink()
    return sorted(found, key=lambda one: (one.since, one.pid))


def _is_usable(folder: Path) -> bool:
    """Whether a folder is this user's alone, or can be made."""
    try:
        folder.lstat()
    except FileNotFoundError:
        above = folder.parent
        return above.is_dir() and above.stat().st_uid == os.getuid() and os.access(above, os.W_OK)
    except OSError:
        return False
    return _is_private(folder)


def _is_private(folder: Path) -> bool:
    """Whether a folder is this user's, and nobody else can write there or read it."""
    try:
        found = folder.lstat()
    except OSError:
        return False
    ours = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
    return ours and not found.st_mode & 0o077


def _entry(path: Path) -> RunningRecording | None:
    """An entry, None where it is none."""
    try:
        with path.open("rb") as stream:
            fields = json.loads(stream.read(_MOST_BYTES))
        entry = RunningRecording(**fields)
    except (OSError, ValueError, TypeError):
        return None
    texts = (entry.master, entry.host, entry.folder, entry.workspace, entry.static, entry.launch)
    numbers = (entry.pid, entry.process_start, entry.since)
    good = all(isinstance(text, str) for text in texts)
    return entry if good and all(isinstance(one, int | float) for one in numbers) else None
