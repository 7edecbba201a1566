"""The files of a recorded mission, its options, and how it went.

A recorded mission's folder has ``mission.bag``, ``params.yaml`` (the parameters at the end;
``params_start.yaml`` right after the launch), ``origins.json`` (where these values came from),
``run.json`` (how it went) and ``tpc/`` (the files of nodes with the sink ``file``).
"""

from __future__ import annotations

import contextlib
import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.recording.marks import marks_beside, topic_of_marks
from pytpc.recording.mission import (
    EVENTS_FILE,
    MARKS_FILE,
    REPORTS_FOLDER,
    RUN_FILE,
    SUMMARIES_FILE,
    Dropped,
)
from pytpc.values.origins import ORIGINS_FILE, START_FILE

BAG_FILE = "mission.bag"
MISSION_DONE = "/mission/done"
"""On this topic the simulated missions say that they are done."""
PARAMS_FILE = "params.yaml"
MARK_TOPICS = ("/mark_action", "/mark_no_action")
DEFAULT_TOPICS = ("/rosout", "/threshold_information", *MARK_TOPICS)


@dataclass(frozen=True)
class RecorderStatus:
    """The state of the recorder; times in ns on the graph's clock, at the start and now.

    ``done_ns`` is when a topic said that the mission is done, None before.
    ``missed_before`` has the messages on /rosout that a node sent before the recorder was
    connected, ``lost`` those that went missing afterwards. ``dropped`` has for each comparison the
    reports that its process says never left it.
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

    @property
    def done(self) -> bool:
        """Whether the mission is done."""
        return self.done_ns is not None


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a mission is: seconds of the graph's clock and of the wall, reports and marks."""

    sim_s: float
    wall_s: float
    reports: int
    marks: int

    @classmethod
    def of(cls, status: RecorderStatus, wall_s: float) -> Progress:
        """The progress of the mission whose recorder has this status."""
        sim_s = (status.now_ns - status.began_ns) / 1e9 if status.began_ns else 0.0
        return cls(sim_s, wall_s, status.reports, marks_of(status.messages))


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
        on_progress: called several times a second.
    """

    out_dir: Path
    launch: Path | None = None
    args: Mapping[str, str] = field(default_factory=dict)
    timeout_s: float | None = None
    until: str | None = None
    topics: Sequence[str] = ()
    on_progress: Callable[[Progress], None] | None = None


@dataclass(frozen=True, slots=True)
class MissionRun:
    """A mission that was recorded.

    ``ended`` is ``done``, ``ended`` (roslaunch did, as it does when a required node ends),
    ``timeout`` or ``interrupted``. ``sim_s`` is how long it took on the
    graph's clock, ``wall_s`` on the wall's; ``done_ns`` is when on the former it was done, None
    where nobody said so. ``lost`` has for each node the messages on /rosout that
    did not reach the bag, ``missed_before`` those from before the recorder was connected to it.
    ``dropped`` has the reports that never left their process.
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

    @classmethod
    def of(cls, status: RecorderStatus, out_dir: Path, ended: str, wall_s: float) -> MissionRun:
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
        )

    @property
    def marks(self) -> int:
        """Marks of all observers."""
        return marks_of(self.messages)


def marks_of(messages: Mapping[str, int]) -> int:
    """How many of the messages by topic are marks."""
    return sum(count for topic, count in messages.items() if topic_of_marks(topic) is not None)


def clear_earlier(out_dir: Path) -> None:
    """Take away an earlier mission's results: they would be read as if they were of the next one.

    Marks that a person made on its bag are not lost: their file gets the ending ``.old``.
    """
    for name in (
        BAG_FILE,
        PARAMS_FILE,
        START_FILE,
        ORIGINS_FILE,
        RUN_FILE,
        EVENTS_FILE,
        SUMMARIES_FILE,
        MARKS_FILE,
    ):
        (out_dir / name).unlink(missing_ok=True)
    shutil.rmtree(out_dir / REPORTS_FOLDER, ignore_errors=True)
    marks = marks_beside(out_dir / BAG_FILE)
    with contextlib.suppress(FileNotFoundError):
        marks.replace(marks.with_name(f"{marks.name}.old"))


def save_run(run: MissionRun, options: RecordOptions) -> None:
    """Write run.json: the fields of ``run``, the launch file, if any, and its arguments.

    Raises:
        TpcError: the file cannot be written.
    """
    launch = options.launch
    document = {
        "schema": 1,
        "launch": None if launch is None else str(launch.absolute()),
        "args": dict(sorted(options.args.items())),
        **asdict(run),
        "bag": run.bag.name,
        "params": run.params.name,
    }
    write_atomic(options.out_dir / RUN_FILE, json.dumps(document, indent=1).encode() + b"\n")


def read_status(path: Path) -> RecorderStatus | None:
    """The state that the recorder saved last; None if it has saved none."""
    try:
        status = json.loads(path.read_text(encoding="utf-8"))
        dropped = tuple(Dropped(**each) for each in status.pop("dropped"))
        return RecorderStatus(**status, dropped=dropped)
    except FileNotFoundError:
        return None


def save_status(status: RecorderStatus, path: Path) -> None:
    """Replace the status file; no reader ever sees half of it."""
    beside = path.with_name(path.name + ".new")
    beside.write_text(json.dumps(asdict(status)), encoding="utf-8")
    beside.replace(path)
