"""A robot of rclpy nodes: analysed, and flown on a graph of its own.

The nodes run under the interpreter that ``tools/setup ros2`` makes, from the package's folder: the
scripts of its entry points are written as an installation of it writes them.
"""

from __future__ import annotations

import fcntl
import json
import os
import signal
import subprocess
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.api.building import analyse
from pytpc.base.errors import MissingToolError, RunError
from pytpc.base.paths import MERGED_FILE, project_root
from pytpc.ingest.file_counts import FileCounter
from pytpc.python_analysis.rules_file import load_rules
from pytpc.recording.marks import Mark, topic_of_marks
from pytpc.recording.mission import REPORTS_FOLDER
from pytpc.ros.mission_run import MARK_TOPICS, MISSION_DONE, Progress, clear_earlier
from pytpc.ros.node_start import RUN
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.demo.demo_examples import SHARED_PACKAGE, Example
from pytpc_evaluation.demo.ros2_params import params_of, save_params
from pytpc_evaluation.treatment import Treatment

PYTHON = project_root() / ".venv-ros2" / "bin" / "python"
_LISTENER = Path(__file__).with_name("ros2_listener.py")
_POLL_S = 0.1
_STOP_S = 5.0
# Those that DDS allows on Linux whatever the range of the ports that the kernel gives to others.
_DOMAINS = range(1, 100)


@dataclass(frozen=True)
class Ros2Robot:
    """The robot, its static information, and the scripts of its nodes by their names."""

    example: Example
    static: StaticInfo
    scripts: Mapping[str, Path]

    @property
    def static_file(self) -> Path:
        """The file with the static information."""
        return next(iter(self.scripts.values())).parents[2] / MERGED_FILE


@dataclass
class Heard:
    """What the listener heard: times in ns, of the wall and of the graph."""

    messages: Counter[str] = field(default_factory=Counter)
    clock: list[tuple[int, int]] = field(default_factory=list)
    marks: list[Mark] = field(default_factory=list)
    done_ns: int | None = None

    def add(self, line: str) -> None:
        """Take in a line of the listener."""
        message = json.loads(line)
        topic = message["topic"]
        self.messages[topic] += 1
        mark = topic_of_marks(topic)
        if topic == "/clock":
            self.clock.append((message["wall_ns"], message["time"]))
        elif mark is not None:
            self.marks.append(Mark(message["time"], mark[0], mark[1]))
        elif topic == MISSION_DONE:
            self.done_ns = message["graph_ns"]


@dataclass(frozen=True)
class Flown:
    """How a mission went; ``clock`` has (wall, graph) times in ns, ``ended`` as `MissionRun`'s."""

    ended: str
    wall_s: float
    heard: Heard
    reports: int


def prepared(example: Example, out: Path) -> Ros2Robot:
    """Analyse the package, and write the scripts of its entry points below ``out``.

    Raises:
        MissingToolError: ROS 2 is not set up.
        TpcError: the package cannot be analysed, or a file cannot be written.
    """
    if not PYTHON.exists():
        raise MissingToolError("ROS 2 is not set up; run tools/setup ros2", PYTHON)
    static = analyse([example.folder], load_rules())
    folder = out / "lib" / example.name
    folder.mkdir(parents=True, exist_ok=True)
    scripts = {}
    for unit in static.units:
        module = (unit.script or "").removesuffix(".py").replace("/", ".")
        if not module.startswith(f"{example.name}."):
            continue
        path = folder / unit.link_unit
        path.write_text(_ENTRY.format(python=PYTHON, module=module), encoding="utf-8")
        path.chmod(0o755)
        scripts[unit.link_unit] = path
    robot = Ros2Robot(example, static, scripts)
    static.save(robot.static_file)
    return robot


_ENTRY = """\
#!{python}
# -*- coding: utf-8 -*-
import re
import sys
from {module} import main
if __name__ == '__main__':
    sys.exit(main())
"""


_TOPICS = {
    "/clock": "rosgraph_msgs/Clock",
    MISSION_DONE: "+std_msgs/Bool",
    **dict.fromkeys(MARK_TOPICS, "builtin_interfaces/Time"),
}
"""What is heard of every robot."""


def flown(
    robot: Ros2Robot,
    treatment: Treatment,
    out_dir: Path,
    domain: Mapping[str, str],
    *,
    seed: int,
    rate: float,
    timeout_s: float,
    on_progress: Callable[[Progress], None] | None = None,
) -> Flown:
    """Fly one mission; the folder gets the reports, the values and where they came from.

    Args:
        robot: what flies.
        treatment: its file is loaded after the robot's own.
        out_dir: of the mission.
        domain: the variables that choose the graph.
        seed: of all noise.
        rate: simulated seconds in one second.
        timeout_s: wall time after which the mission is ended.
        on_progress: called several times a second.

    Raises:
        RunError: a process of the mission ended before it.
    """
    out_dir.mkdir(parents=True, exist_ok=True)
    clear_earlier(out_dir)
    example = robot.example
    files = [example.parameters, treatment.overlay]
    save_params(params_of(files, sorted(robot.scripts)), {"seed": str(seed)}, out_dir)
    robot.static.save(out_dir / MERGED_FILE)
    began = time.monotonic()
    heard = Heard()
    counter = FileCounter(out_dir / REPORTS_FOLDER)
    with ExitStack() as started:
        processes = _Processes(out_dir / "ros", domain)
        started.callback(processes.stop)
        topics = {**_TOPICS, **dict(example.ros2_types)}
        processes.listen([_LISTENER, *(f"{name}={kind}" for name, kind in topics.items())], heard)
        path = str(SHARED_PACKAGE / "src")
        processes.start("observer", [example.observer, str(seed)], PYTHONPATH=path)
        _start_nodes(processes, robot, files, out_dir, seed=seed, rate=rate)
        ended = ""
        while not ended:
            time.sleep(_POLL_S)
            wall_s = time.monotonic() - began
            processes.check()
            if on_progress is not None:
                now_s = heard.clock[-1][1] / 1e9 if heard.clock else 0.0
                marks = len(heard.marks)
                on_progress(Progress(now_s, wall_s, 0, marks, counter.count(), bool(heard.clock)))
            if heard.done_ns is not None:
                ended = "done"
            elif wall_s > timeout_s:
                ended = "timeout"
    return Flown(ended, time.monotonic() - began, heard, counter.count().reports)


def _start_nodes(
    processes: _Processes,
    robot: Ros2Robot,
    files: Sequence[Path],
    out_dir: Path,
    *,
    seed: int,
    rate: float,
) -> None:
    """Start the robot's nodes with these files of parameters; they report to files."""
    example = robot.example
    given = [word for file in files for word in ("--params-file", str(file.absolute()))]
    given += ["-p", f"rate:={rate}"] if rate else []
    for name, script in robot.scripts.items():
        own = ["-p", f"seed:={seed}"] if f"/{name}" == example.simulator else []
        words = ["--static", str(out_dir / MERGED_FILE), "--", str(script), "--ros-args"]
        processes.start(
            name,
            [RUN, *words, *given, *own],
            PYTHONPATH=str(example.folder),
            TPC_SINK="file",
            TPC_FOLDER=str(out_dir / REPORTS_FOLDER),
        )


class _Processes:
    """The processes of a mission; what they print is in files of ``folder``."""

    def __init__(self, folder: Path, domain: Mapping[str, str]) -> None:
        folder.mkdir(exist_ok=True)
        self._folder = folder
        kept = {name: os.environ[name] for name in ("HOME", "LANG") if name in os.environ}
        self._env = {**kept, "PATH": os.defpath, **domain}
        self._running: dict[str, subprocess.Popen[str]] = {}
        self._reader: threading.Thread | None = None

    def listen(self, words: Sequence[Path | str], heard: Heard) -> None:
        """Start the listener, and take in what it tells until it is stopped."""
        listener = self.start("listener", words, output=subprocess.PIPE)

        def take_in() -> None:
            assert listener.stdout is not None
            with listener.stdout:
                for line in listener.stdout:
                    heard.add(line)

        self._reader = threading.Thread(target=take_in, daemon=True)
        self._reader.start()

    def start(
        self, name: str, words: Sequence[Path | str], *, output: int | None = None, **env: str
    ) -> subprocess.Popen[str]:
        """Start a program under the interpreter of ROS 2."""
        with (self._folder / f"{name}.log").open("w", encoding="utf-8") as log:
            process = subprocess.Popen(
                [PYTHON, *words],
                env={**self._env, **env},
                stdin=subprocess.DEVNULL,
                stdout=log if output is None else output,
                stderr=log,
                text=True,
            )
        self._running[name] = process
        return process

    def check(self) -> None:
        """Raise a `RunError` if one has ended."""
        for name, process in self._running.items():
            if process.poll() is not None:
                log = self._folder / f"{name}.log"
                last = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
                why = f": {last[-1]}" if last else ""
                raise RunError(f"{name} ended with status {process.returncode}{why}", log)

    def stop(self) -> None:
        """End all of them."""
        for process in self._running.values():
            process.send_signal(signal.SIGINT)
        until = time.monotonic() + _STOP_S
        for process in self._running.values():
            try:
                process.wait(max(0.0, until - time.monotonic()))
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        if self._reader is not None:
            self._reader.join()


@contextmanager
def own_domain() -> Iterator[dict[str, str]]:
    """The environment of a graph that no other demonstration or test on this machine is on.

    Raises:
        RunError: no domain is free.
    """
    # Tests and demonstrations of all checkouts use the same locks.
    folder = Path("/tmp") / f"tpc-test-domains-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    for number in _DOMAINS:
        with (folder / str(number)).open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield {"ROS_DOMAIN_ID": str(number), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
            return
    raise RunError("no ROS domain is free")
