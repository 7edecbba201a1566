"""The files of a recorded mission, its options, and how it went.

A recorded mission's folder has ``mission.bag``, ``params.yaml`` (the parameters at the end;
``params_start.yaml`` right after the launch), ``origins.json`` (where these values came from),
``graph.json`` (who spoke to whom), ``run.json`` (how it went), ``static.json`` (the static
information of the build that ran) and ``tpc/`` (the files of nodes with the sink ``file``).
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.errors import RunError
from pytpc.base.paths import MERGED_FILE
from pytpc.base.source_bytes import read_bytes, sha256_of
from pytpc.ingest.file_counts import NO_FILES, FileCounts
from pytpc.recording.graph_file import GRAPH_FILE
from pytpc.recording.marks import topic_of_marks
from pytpc.recording.marks_home import set_marks_aside
from pytpc.recording.mission import (
    EVENTS_FILE,
    MARKS_FILE,
    REPORTS_FOLDER,
    RUN_FILE,
    SUMMARIES_FILE,
    Dropped,
    is_converted,
)
from pytpc.ros.source import Source
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import ORIGINS_FILE, PARAMS_FILE, START_FILE

BAG_FILE = "mission.bag"
MCAP_FILE = "mission.mcap"
"""What ``BAG_FILE`` is under ROS 1, this is under ROS 2."""
MISSION_DONE = "/mission/done"
"""On this topic the simulated missions say that they are done."""
MARK_TOPICS = ("/mark_action", "/mark_no_action")
_RECORDINGS = {".bag", ".mcap", ".db3", ".tpc", ".log", ".txt"}
DEFAULT_TOPICS = ("/rosout", "/threshold_information", *MARK_TOPICS)


@dataclass(frozen=True)
class RecorderStatus:
    """The state of the recorder; times in ns on the graph's clock, at the start and now.

    ``done_ns`` is when a topic said that the mission is done, None before.
    ``missed_before`` has the messages on /rosout that a node sent before the recorder was
    connected, ``lost`` those that went missing afterwards. ``dropped`` has for each comparison the
    reports that its process says never left it. ``broken`` has for each node the connections that
    ended within a message, or sent a length that no message has. ``is_reporting`` says whether a
    report or summary came. ``heard`` has, until one comes, the nodes to whose log messages the
    recorder is connected. ``marks`` are those that were not taken back.
    """

    ready: bool = False
    done_ns: int | None = None
    closed: bool = False
    began_ns: int = 0
    now_ns: int = 0
    reports: int = 0
    messages: dict[str, int] = field(default_factory=dict)
    lost: dict[str, int] = field(default_factory=dict)
    missed_before: dict[str, int] = field(default_factory=dict)
    dropped: tuple[Dropped, ...] = ()
    broken: dict[str, int] = field(default_factory=dict)
    heard: tuple[str, ...] = ()
    is_reporting: bool = False
    marks: int = 0

    @property
    def done(self) -> bool:
        """Whether the mission is done."""
        return self.done_ns is not None


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a mission is: seconds of the graph's clock and of the wall, reports and marks.

    ``in_files`` is what the nodes wrote to files, ``has_time`` whether the graph has a clock yet,
    and ``is_found`` whether its nodes are known; of ROS 2 they are discovered, which takes seconds.
    """

    sim_s: float
    wall_s: float
    reports: int
    marks: int
    in_files: FileCounts = NO_FILES
    has_time: bool = True
    is_found: bool = True

    @classmethod
    def of(cls, status: RecorderStatus, wall_s: float, in_files: FileCounts = NO_FILES) -> Progress:
        """The progress of the mission whose recorder has this status."""
        sim_s = (status.now_ns - status.began_ns) / 1e9 if status.began_ns else 0.0
        has_time = status.now_ns != 0
        return cls(sim_s, wall_s, status.reports, status.marks, in_files, has_time)


@dataclass(frozen=True, slots=True)
class DiedNode:
    """A node of a launch file that died.

    Attributes:
        name: as roslaunch numbers it: ``camera-2``.
        status: of its process; a signal is negative.
        said: the last lines that nodes wrote to standard error before.
        log: the file that has these.
    """

    name: str
    status: int
    said: tuple[str, ...]
    log: Path

    @property
    def words(self) -> str:
        """Which one it is, and how it ended."""
        how = f"exit status {self.status}" if self.status >= 0 else f"signal {-self.status}"
        return f"the node {self.name} died ({how})"


class Deaths:
    """How each node that died did so last; ``tell`` is called with each death."""

    def __init__(self, tell: Callable[[DiedNode], None] | None) -> None:
        """Nobody has died yet."""
        self._tell = tell
        self._last: dict[str, DiedNode] = {}

    def see(self, died: Iterable[DiedNode]) -> None:
        """These nodes died."""
        for node in died:
            self._last[node.name] = node
            if self._tell is not None:
                self._tell(node)

    @property
    def last(self) -> tuple[DiedNode, ...]:
        """One for each node."""
        return tuple(self._last.values())


@dataclass(frozen=True, slots=True)
class RecordOptions:
    """What a recording has, where it is written, and when it ends.

    Attributes:
        out_dir: the folder of the results.
        launch: the launch file; for a running graph, the one that it was started with: without
            it the origins of its values are not known.
        args: the arguments of the launch file.
        timeout_s: wall time after which the mission is ended; None: it is not.
        until: a topic of type std_msgs/Bool; when it says true the mission is done.
        topics: recorded besides ``DEFAULT_TOPICS`` and ``until``.
        package: the package in which roslaunch looks for ``launch``; empty where that is a path.
        programs: more executables of ROS 2 that are run beside ``launch``, which then names one;
            PACKAGE/EXECUTABLE is one of another package.
        arguments: what each executable is given.
        on_progress: called several times a second.
        on_kept: called with the new names of an earlier recording's files of marks, if any.
        static: the file or build with the static information of the nodes; the folder gets a copy,
            because a later build moves the places that it names.
        static_info: what is in ``static``, where that is no file.
        is_static_guessed: that ``static`` was not given, and may be that of other nodes.
        on_graph: called when the recording begins, with the URI of the master and the address at
            which its graph reaches this machine.
        on_doubt: called before a launch file runs, with each sentence of `pytpc.values.doubts`.
        on_quiet: called by another thread if nodes report nothing, with the reason as a line, and
            whether that is a fault.
        on_died: called with each node of the launch file that dies.
        on_mark: called by the thread that records with each message of a mark, or of one that is
            taken back, and its time in ns, 0 where it has none.
        reports: reports that come over a running graph are recorded; else only marks and values.
    """

    out_dir: Path
    launch: Path | None = None
    args: Mapping[str, str] = field(default_factory=dict)
    timeout_s: float | None = None
    until: str | None = None
    topics: Sequence[str] = ()
    package: str = ""
    programs: Sequence[str] = ()
    arguments: Sequence[str] = ()
    on_progress: Callable[[Progress], None] | None = None
    on_kept: Callable[[Sequence[Path]], None] | None = None
    static: Path | None = None
    static_info: StaticInfo | None = None
    is_static_guessed: bool = False
    on_graph: Callable[[str, str], None] | None = None
    on_doubt: Callable[[str], None] | None = None
    on_quiet: Callable[[str, bool], None] | None = None
    on_died: Callable[[DiedNode], None] | None = None
    on_mark: Callable[[Source, int], None] | None = None
    reports: bool = True


@dataclass(frozen=True, slots=True)
class MissionRun:
    """A mission that was recorded.

    ``ended`` is ``done``, ``ended`` (roslaunch did, as it does when a required node ends),
    ``timeout``, ``interrupted``, ``kept`` (the last minutes of a ring were), or ``failed`` where a
    node that was needed died. ``sim_s`` is how
    long it took on the graph's clock, ``wall_s`` on the wall's; ``done_ns`` is when on the former
    it was done, None where nobody said so. ``lost`` has for each node the messages on /rosout that
    did not reach the bag, ``missed_before`` those from before the recorder was connected to it.
    ``dropped`` has the reports that never left their process, ``broken`` for each node the
    connections that ended within a message. ``marks`` counts those of all observers, without those
    that were taken back. ``files``, ``reports_in_files`` and ``summaries_in_files`` count what
    nodes wrote to the folder's files. ``is_reporting`` says whether a report or a summary came over
    the graph. ``died`` has how each node that died did so last.
    """

    bag: Path
    params: Path
    ended: str
    sim_s: float
    wall_s: float
    reports: int
    messages: dict[str, int]
    lost: dict[str, int]
    missed_before: dict[str, int]
    done_ns: int | None = None
    dropped: tuple[Dropped, ...] = ()
    broken: dict[str, int] = field(default_factory=dict)
    files: int = 0
    reports_in_files: int = 0
    summaries_in_files: int = 0
    is_reporting: bool = False
    marks: int = 0
    died: tuple[DiedNode, ...] = ()

    @classmethod
    def of(
        cls,
        status: RecorderStatus,
        out_dir: Path,
        ended: str,
        wall_s: float,
        in_files: FileCounts = NO_FILES,
    ) -> MissionRun:
        """The run whose recorder ended with ``status``."""
        return cls(
            bag=out_dir / BAG_FILE,
            params=out_dir / PARAMS_FILE,
            ended=ended,
            sim_s=(status.now_ns - status.began_ns) / 1e9,
            wall_s=wall_s,
            reports=status.reports,
            messages=status.messages,
            lost=status.lost,
            missed_before=status.missed_before,
            done_ns=status.done_ns,
            dropped=status.dropped,
            broken=status.broken,
            files=in_files.files,
            reports_in_files=in_files.reports,
            summaries_in_files=in_files.summaries,
            is_reporting=status.is_reporting,
            marks=status.marks,
        )

    @property
    def has_reports(self) -> bool:
        """Whether there is anything to diagnose: a report or a summary."""
        in_files = self.reports_in_files + self.summaries_in_files
        return self.is_reporting or self.reports + in_files > 0


def marks_of(messages: Mapping[str, int]) -> int:
    """How many of the messages by topic are marks, also those that were taken back."""
    return sum(count for topic, count in messages.items() if topic_of_marks(topic) is not None)


def clear_earlier(out_dir: Path) -> list[Path]:
    """Take away an earlier mission's results: they would be read as if they were of the next one.

    Marks that a person made on it are not lost: their files get the ending ``.old``.

    Returns:
        The new names of these files.

    Raises:
        TpcError: a file of marks cannot be kept; then nothing is taken away.
    """
    kept = set_marks_aside(out_dir, {BAG_FILE, MCAP_FILE, EVENTS_FILE})
    for name in (
        BAG_FILE,
        MCAP_FILE,
        PARAMS_FILE,
        START_FILE,
        ORIGINS_FILE,
        GRAPH_FILE,
        RUN_FILE,
        EVENTS_FILE,
        SUMMARIES_FILE,
        MARKS_FILE,
        MERGED_FILE,
    ):
        (out_dir / name).unlink(missing_ok=True)
    shutil.rmtree(out_dir / REPORTS_FOLDER, ignore_errors=True)
    return kept


def keep_earlier_marks(out_dir: Path) -> list[Path]:
    """Rename the files of marks of a recording that is gone from a folder, so that none is read.

    Where other recordings are in the folder, the marks are theirs.

    Raises:
        TpcError: a file cannot be renamed.
    """
    if any(path.suffix in _RECORDINGS for path in out_dir.iterdir()):
        return []
    return set_marks_aside(out_dir, {BAG_FILE, MCAP_FILE})


def refuse_earlier(out_dir: Path) -> None:
    """Refuse a folder that has a recording: a robot's mission cannot be flown again.

    Raises:
        RunError: it has one, or an unfinished one.
    """
    bags = [out_dir / BAG_FILE, out_dir / MCAP_FILE]
    if any(bag.exists() for bag in bags) or is_converted(out_dir):
        raise RunError("already has a recording; give another folder", out_dir)
    how = ("recover it with rosbag reindex, or give", "it is read as it is: give")
    for bag, what in zip(bags, how, strict=True):
        active = bag.with_name(f"{bag.name}.active")
        if active.exists():
            raise RunError(f"is an unfinished recording; {what} another folder", active)


def keep_static(options: RecordOptions) -> None:
    """Copy the static information into the folder of the mission, if there is any.

    Raises:
        TpcError: the copy cannot be written.
    """
    copy = options.out_dir / MERGED_FILE
    # A robot may have what was built without the static information.
    if options.static is not None and options.static.is_file():
        write_atomic(copy, read_bytes(options.static))
    elif options.static_info is not None:
        options.static_info.save(copy)


def save_run(run: MissionRun, options: RecordOptions) -> None:
    """Write run.json: the fields of ``run``, the launch file and the static information, if any.

    Who died is left out.

    Raises:
        TpcError: the file cannot be written.
    """
    launch, static = options.launch, options.static
    copy = options.out_dir / MERGED_FILE
    document = {
        "schema": 1,
        "launch": None if launch is None else str(launch.absolute()),
        "args": dict(sorted(options.args.items())),
        "until": options.until,
        "static": None
        if static is None
        else {
            "path": str(static.absolute()),
            "sha256": sha256_of(copy) if copy.is_file() else None,
            "guessed": options.is_static_guessed,
        },
        **asdict(replace(run, died=())),
        "bag": run.bag.name,
        "params": run.params.name,
    }
    del document["died"]
    write_atomic(options.out_dir / RUN_FILE, json.dumps(document, indent=1).encode() + b"\n")


def read_status(path: Path) -> RecorderStatus | None:
    """The state that the recorder saved last; None if it has saved none."""
    try:
        status = json.loads(path.read_text(encoding="utf-8"))
        dropped = tuple(Dropped(**each) for each in status.pop("dropped"))
        heard = tuple(status.pop("heard"))
        return RecorderStatus(**status, dropped=dropped, heard=heard)
    except FileNotFoundError:
        return None


def save_status(status: RecorderStatus, path: Path) -> None:
    """Replace the status file; no reader ever sees half of it."""
    beside = path.with_name(path.name + ".new")
    beside.write_text(json.dumps(asdict(status)), encoding="utf-8")
    beside.replace(path)
