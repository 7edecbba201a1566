"""Makes a recording of the last minutes, from the rings that nodes write all the time.

The files of the nodes are there already. From the graph come what ``record`` takes from it besides
reports: marks, values of parameters, where these came from, and who speaks to whom.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, NamedTuple

from pytpc.base.errors import InputError, RunError, TpcError
from pytpc.base.folder_lock import alone_in
from pytpc.base.signals import Stop
from pytpc.base.wording import listed, many
from pytpc.ingest.file_counts import FileCounter
from pytpc.ingest.ring_files import FoundRings, keep_segments, remove_ended, rings_in
from pytpc.recording.marks import MarkMessages
from pytpc.recording.mission import REPORTS_FOLDER
from pytpc.ros.mission_run import (
    MissionRun,
    Progress,
    RecorderStatus,
    RecordOptions,
    keep_static,
    save_run,
)
from pytpc.ros.ros1.record_mission import record_graph
from pytpc.ros.ros2.graph_recording import record_ros2_graph
from pytpc.ros.source import Source

# For so long the graph is listened to by who keeps once: observers tell marks that nobody has heard
# yet to each new listener, and nodes of ROS 2 their values.
_HEARD_S = 2.0
_TURN_S = 0.1
_OUTLIVES_S = 5.0
# Marks that go on coming make a recording no later than this.
_LONGEST_S = 60.0
_LISTED = 3
_TEMPORARY = ".keep-"
_LOCK = "keeping"
_NEW_S = 60.0
_RETRY_S = 5.0
NO_RING = (
    "no ring here; start the nodes with one: export TPC_RING=10, or eval"
    ' "$(pytpc env --setup WORKSPACE --ring 10)"; --folder names another folder'
)

__all__ = ["FoundRings", "KeepOptions", "Keeper", "Kept", "keep", "remove_ended", "rings_in"]


@dataclass(frozen=True, slots=True)
class KeepOptions:
    """What is kept.

    Attributes:
        folder: where the nodes write their files.
        minutes: how much is kept; None: all that rings have, see `FoundRings.recent`.
        ros: the graph that is asked, ROS 1 or 2 of ``env``; None: none.
        env: says which graph it is.
        record: what a recording of the graph has besides: the static information of the nodes, and
            the launch file that started them. Its folder is not used.
    """

    folder: Path
    minutes: float | None = None
    ros: Literal[1, 2] | None = None
    env: Mapping[str, str] = field(default_factory=lambda: os.environ)
    record: RecordOptions = field(default_factory=lambda: RecordOptions(Path()))


@dataclass(frozen=True, slots=True)
class Kept:
    """A recording that was kept.

    ``seconds`` is how far back it goes, ``missing`` what it has not, a clause for each.
    """

    folder: Path
    files: int
    processes: int
    seconds: float
    reports: int
    summaries: int
    marks: int
    bytes: int
    missing: tuple[str, ...] = ()


def keep(options: KeepOptions, out: Path, stop: threading.Event | Stop | None = None) -> Kept:
    """Keep the last minutes, now, in a folder that does not exist yet.

    Args:
        options: what is kept.
        out: the folder; it appears when it is complete.
        stop: if it is set, the graph is not waited for.

    Raises:
        InputError: no process has a ring in ``options.folder``, or it cannot be read.
        RunError: ``out`` exists.
        TpcError: the recording cannot be written.
    """
    _refuse(out)
    _require(options)
    with _temporary(out.parent) as new:
        # At once: the oldest file may be removed at any moment.
        found = _keep_files(options, new)
        listening = Listening(options, new)
        _wait_until_it_hears(listening, stop)
        run = listening.finish()
        return _finished(options, _Gathered(new, found, run, listening.fault), out)


class Keeper:
    """Keeps the last minutes after each mark of any observer, until ``stop`` is set.

    Args:
        options: what is kept; with a graph.
        into: the folder of the recordings.
        after_s: how long after a mark; a mark that comes meanwhile is in the same recording.
        most: how many recordings are made at most.
        most_bytes: how many bytes they have together at most.
    """

    def __init__(
        self, options: KeepOptions, into: Path, after_s: float, most: int, most_bytes: int
    ) -> None:
        if options.ros is None:
            raise ValueError("marks come from a graph")
        self._options = options
        self._into = into
        self._after_s = after_s
        self._most, self._most_bytes = most, most_bytes
        self._count = self._bytes = 0
        self._has_heard = False
        self._has_told = False

    def run(
        self,
        stop: threading.Event | Stop,
        on_kept: Callable[[Kept], None],
        on_fault: Callable[[str], None],
    ) -> None:
        """Listen, keep and tell; what fails is told, and tried again with the next mark.

        Raises:
            RunError: there is no graph.
            TpcError: the folder cannot be written.
        """
        part = _Part(self._options, self._into, {})
        following: _Part | None = None
        try:
            while True:
                marks = self._wait_for_marks(part.listening, stop)
                if not marks:
                    self._check(part.listening, stop, on_fault)
                if not stop.is_set():
                    # Most observers say a mark once: the next one listens before this one ends.
                    following = _Part(self._options, self._into, part.listening.latched)
                if marks:
                    if following is not None:
                        _wait_until_it_hears(following.listening, stop)
                    try:
                        self._keep(part, marks, on_kept, on_fault)
                    except TpcError as error:
                        on_fault(str(error))
                part.end()
                if following is None:
                    return
                part, following = following, None
        finally:
            for left in (part, following):
                if left is not None:
                    left.end()

    def _keep(
        self,
        part: _Part,
        marks: int,
        on_kept: Callable[[Kept], None],
        on_fault: Callable[[str], None],
    ) -> None:
        if self._is_full():
            on_fault(
                f"{many(marks, 'mark')} without a recording: there are"
                f" {many(self._count, 'recording')} with {self._bytes >> 20:,} MiB already"
                " (--most, --most-mib)"
            )
            return
        _require(self._options)
        found = _keep_files(self._options, part.folder)
        run = part.listening.finish()
        out = _free(self._into / time.strftime("keep-%Y%m%d-%H%M%S"))
        gathered = _Gathered(part.folder, found, run, part.listening.fault)
        kept = _finished(self._options, gathered, out)
        self._count += 1
        self._bytes += kept.bytes
        on_kept(kept)

    def _is_full(self) -> bool:
        return self._count >= self._most or self._bytes >= self._most_bytes

    def _wait_for_marks(self, listening: Listening, stop: threading.Event | Stop) -> int:
        """How many marks there are when it is time to keep them; 0 if the listening ended."""
        seen, first, last = 0, 0.0, 0.0
        while listening.is_alive():
            now, marks = time.monotonic(), listening.marks
            self._has_heard |= listening.has_begun
            self._has_told &= not listening.has_begun
            if marks > seen:
                first, last = first or now, now
            if not marks:
                # The only one was taken back.
                first = 0.0
            seen = marks
            if first and (now >= last + self._after_s or now >= first + _LONGEST_S + self._after_s):
                return seen
            if stop.is_set():
                # What was marked a moment ago is not lost.
                return seen
            time.sleep(_TURN_S)
        return seen

    def _check(
        self, listening: Listening, stop: threading.Event | Stop, on_fault: Callable[[str], None]
    ) -> None:
        """The listening ended, or is ended, without a mark: the graph may be started again."""
        listening.finish()
        if not listening.fault or stop.is_set():
            return
        if not self._has_heard:
            raise RunError(listening.fault)
        if not self._has_told:
            on_fault(f"{listening.fault} Waiting until it does")
        self._has_told = True
        until = time.monotonic() + _RETRY_S
        while time.monotonic() < until and not stop.is_set():
            time.sleep(_TURN_S)


class Listening(threading.Thread):
    """Records a graph without its reports, while the nodes write these to their rings.

    ``marks`` counts what was heard, and ``latched`` has the last time of each publisher that tells
    it to whoever listens next: that one knows it by then. ``fault`` says why there is no graph, and
    is empty if there is one; ``has_begun`` says that its nodes were found.
    """

    def __init__(
        self,
        options: KeepOptions,
        folder: Path,
        latched: Mapping[tuple[str, str], int] | None = None,
    ) -> None:
        """Begin, if a graph is to be asked; ``latched``: what was heard before."""
        super().__init__(name="listening", daemon=True)
        self._options = options
        self._folder = folder
        self._stop_asked = threading.Event()
        self._run: MissionRun | None = None
        self._marks = MarkMessages()
        self.marks = 0
        self.latched = dict(latched or {})
        self.has_begun = False
        self.fault = ""
        if options.ros is None:
            self.fault = "no graph answers"
        else:
            self.start()

    def run(self) -> None:
        """Record until the end."""
        options = replace(
            self._options.record,
            out_dir=self._folder,
            reports=False,
            on_progress=self._see,
            on_mark=self._hear,
        )
        env = self._options.env
        try:
            if self._options.ros == 2:
                self._run = record_ros2_graph(options, self._stop_asked, env)
            else:
                self._run = record_graph(options, self._stop_asked, env)
        except (TpcError, OSError) as error:
            self.fault = str(error)

    def _see(self, progress: Progress) -> None:
        self.has_begun |= progress.is_found

    def _hear(self, source: Source, time_ns: int) -> None:
        if source.latched:
            whose = source.topic, source.node
            if self.latched.get(whose) == time_ns:
                return
            self.latched[whose] = time_ns
        self._marks.add_time(source.topic, time_ns or time.time_ns())
        self.marks = self._marks.count

    def finish(self) -> MissionRun | None:
        """End it; how it went, None without a graph."""
        self._stop_asked.set()
        if self.ident is not None:
            self.join()
        return self._run


class _Part:
    """The folder of a recording to come, hidden until then, and who listens for it."""

    def __init__(
        self, options: KeepOptions, into: Path, latched: Mapping[tuple[str, str], int]
    ) -> None:
        """See `Listening`.

        Raises:
            TpcError: the folder cannot be made.
        """
        self._end = contextlib.ExitStack()
        self.folder = self._end.enter_context(_temporary(into))
        self.listening = Listening(options, self.folder, latched)

    def end(self) -> None:
        """End the listening; the folder is removed, unless it is a recording by now."""
        self.listening.finish()
        self._end.close()


def _wait_until_it_hears(listening: Listening, stop: threading.Event | Stop | None) -> None:
    """Wait until it is connected to the nodes; finding them may take longer than that."""
    until = float("inf")
    while time.monotonic() < until and listening.is_alive() and not (stop and stop.is_set()):
        if listening.has_begun:
            until = min(until, time.monotonic() + _HEARD_S)
        time.sleep(_TURN_S)


def _require(options: KeepOptions) -> None:
    """Refuse a folder without a ring.

    Raises:
        InputError: see `keep`.
    """
    found = rings_in(options.folder).recent(options.minutes)
    if found.segments:
        return
    if found.others or found.broken:
        names = listed(found.broken, _LISTED)
        broken = f", and {many(len(found.broken), 'broken file')} ({names})" if names else ""
        others = f"{many(found.others, 'file')} of reports of no ring{broken}; "
        raise InputError(f"{others}{NO_RING}", options.folder)
    raise InputError(NO_RING, options.folder)


def _keep_files(options: KeepOptions, new: Path) -> FoundRings:
    return keep_segments(rings_in(options.folder).recent(options.minutes), new / REPORTS_FOLDER)


class _Gathered(NamedTuple):
    """What there is of a recording in its temporary folder; ``fault``: why there is no ``run``."""

    new: Path
    found: FoundRings
    run: MissionRun | None
    fault: str


def _finished(options: KeepOptions, gathered: _Gathered, out: Path) -> Kept:
    """Complete the recording and give it its name."""
    new, found, run, fault = gathered
    asked = replace(options.record, out_dir=new)
    missing = []
    if run is None:
        why = fault.rstrip(".")
        missing.append(f"no marks and no values of parameters: {why}")
        keep_static(asked)
        run = MissionRun.of(RecorderStatus(), new, "kept", 0.0)
    elif not run.params.is_file():
        missing.append(f"no {run.params.name}: the graph did not tell its values")
    if found.others:
        missing.append(
            f"{many(found.others, 'file')} in {options.folder} of no ring, which must be copied by"
            " hand"
        )
    if found.broken:
        names = listed(found.broken, _LISTED)
        missing.append(f"{many(len(found.broken), 'file')} that cannot be read: {names}")
    seconds = max((one.began_ago_ns for one in found.segments), default=0) / 1e9
    counts = FileCounter(new / REPORTS_FOLDER).count()
    run = replace(
        run,
        ended="kept",
        sim_s=seconds,
        wall_s=seconds,
        files=counts.files,
        reports_in_files=counts.reports,
        summaries_in_files=counts.summaries,
    )
    save_run(run, asked)
    size = sum(path.stat().st_blocks * 512 for path in new.rglob("*") if path.is_file())
    _refuse(out)
    try:
        new.rename(out)
        # Before, another process would take the folder for one that was left.
        (out / f".{_LOCK}.lock").unlink()
    except OSError as error:
        raise TpcError(f"cannot be written: {error.strerror or error}", out) from error
    return Kept(
        out,
        counts.files,
        found.processes,
        seconds,
        counts.reports,
        counts.summaries,
        run.marks,
        size,
        tuple(missing),
    )


def _refuse(out: Path) -> None:
    # An empty folder may be replaced, as rename does.
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise RunError("is there already; give another folder with -o", out)


def _free(folder: Path) -> Path:
    """A name that is not taken."""
    number, free = 1, folder
    while free.exists():
        number += 1
        free = folder.with_name(f"{folder.name}-{number}")
    return free


@contextlib.contextmanager
def _temporary(parent: Path) -> Iterator[Path]:
    """A folder beside the recordings, hidden until it is complete.

    Those that killed processes left are removed.

    Raises:
        TpcError: it cannot be made.
    """
    try:
        parent.mkdir(parents=True, exist_ok=True)
        _remove_left(parent)
        new = parent / f"{_TEMPORARY}{secrets.token_hex(4)}"
        new.mkdir()
    except OSError as error:
        raise TpcError(f"cannot be written: {error.strerror or error}", parent) from error
    try:
        with alone_in(new, _LOCK):
            yield new
    finally:
        shutil.rmtree(new, ignore_errors=True)


def _remove_left(parent: Path) -> None:
    for left in parent.glob(f"{_TEMPORARY}*"):
        with contextlib.suppress(RunError, OSError):
            # One that was made this moment is not locked yet.
            if time.time() - left.stat().st_mtime < _NEW_S:
                continue
            with alone_in(left, _LOCK):
                _remove(left)


def _remove(left: Path) -> None:
    """Remove a folder to which processes that outlive a killed one for a moment may still write."""
    until = time.monotonic() + _OUTLIVES_S
    while left.exists() and time.monotonic() < until:
        shutil.rmtree(left, ignore_errors=True)
        time.sleep(_TURN_S)
