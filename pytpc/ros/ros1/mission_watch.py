"""Watches a launch file that runs and is recorded, until the mission ends or the user stops it."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path

from pytpc.base.errors import RunError
from pytpc.base.signals import Stop
from pytpc.ingest.file_counts import FileCounter, FileCounts
from pytpc.recording.mission import REPORTS_FOLDER
from pytpc.ros.mission_run import Deaths, Progress, RecorderStatus, RecordOptions, read_status
from pytpc.ros.ros1.graph import GraphProcess, RosGraph
from pytpc.ros.ros1.node_output import NodeOutput
from pytpc.ros.ros1.quiet_graph import QuietWatch
from pytpc.values.trace import Trace, name_on_server

_POLL_S = 0.1
_COUNT_S = 1.0
_CLOCK_PATIENCE_S = 30.0
_SET_PATIENCE_S = 10.0


def status_file(out_dir: Path) -> Path:
    """The file in which the recorder keeps its state."""
    return out_dir / "ros" / "recorder.json"


class MissionWatch:
    """Watches a running mission.

    Args:
        graph: on which it runs.
        launched: roslaunch.
        options: the folder, when to end, and who is told of the progress.
        stop: ends each wait when it is set.
        began: when the recording began, on the monotonic clock.
    """

    def __init__(
        self,
        graph: RosGraph,
        launched: GraphProcess,
        options: RecordOptions,
        stop: Stop,
        began: float,
    ) -> None:
        self._graph = graph
        self._launched = launched
        self._options = options
        self._stop = stop
        self._began = began
        self.deaths = Deaths(options.on_died)
        self._quiet = QuietWatch(graph.uri, options.on_quiet, is_own=True)
        self._output = NodeOutput(launched.log)
        self._files = FileCounter(options.out_dir / REPORTS_FOLDER)
        self._counts = FileCounts()
        self._counted = began

    @property
    def _is_over(self) -> bool:
        """Whether nothing more is to be waited for."""
        return self._stop.is_set() or self._launched.has_ended_well

    def look(self) -> RecorderStatus:
        """Check that all processes run, and tell of the progress.

        Raises:
            RunError: a process died.
        """
        self._graph.check()
        status = read_status(status_file(self._options.out_dir)) or RecorderStatus()
        now = time.monotonic()
        if now - self._counted > _COUNT_S:
            self._counted, self._counts = now, self._files.count()
            self._tell_died()
        self._quiet.see(status, self._counts.reports + self._counts.summaries)
        if self._options.on_progress is not None:
            self._options.on_progress(Progress.of(status, now - self._began, self._counts))
        return status

    def close(self) -> None:
        """Tell which nodes died last, and nothing more."""
        self._quiet.close()
        self._tell_died()

    def _tell_died(self) -> None:
        self.deaths.see(self._output.died())

    def wait_for_parameters(self, trace: Trace | None) -> bool:
        """Wait until roslaunch has set the parameters; it does so before any node runs.

        Returns:
            Whether it has, as far as that is known; False if the user did not wait for it.
        """
        wanted = set() if trace is None else trace.by_roslaunch
        limit = time.monotonic() + _SET_PATIENCE_S
        while time.monotonic() < limit and not self._launched.has_ended_well:
            self.look()
            # On a busy machine the master may be late: then the next look asks again.
            with contextlib.suppress(RunError):
                names = self._graph.call("getParamNames")
                known = set(names) if isinstance(names, list) else set()
                if not {n for n in wanted if not _stands(n, known)}:
                    return True
            if self._stop.is_set():
                return False
            time.sleep(_POLL_S)
        return True

    def wait_for_clock(self) -> None:
        """Wait for the first message on /clock.

        Raises:
            RunError: there is none for 30 s.
        """
        limit = time.monotonic() + _CLOCK_PATIENCE_S
        while self.look().now_ns == 0 and not self._is_over:
            if time.monotonic() > limit:
                raise RunError(
                    f"no /clock for {_CLOCK_PATIENCE_S:.0f} s: without a simulator, use --wall-time"
                )
            time.sleep(_POLL_S)

    def wait_for_end(self, settle_s: float) -> str:
        """Wait until the mission is over; the word of ``MissionRun.ended``.

        Args:
            settle_s: seconds of the graph's clock for which to go on after the mission is done.
        """
        timeout_s = self._options.timeout_s
        limit = float("inf") if timeout_s is None else time.monotonic() + timeout_s
        while not (status := self.look()).done:
            if self._stop.is_set():
                return "interrupted"
            if self._launched.has_ended_well:
                return "ended"
            if time.monotonic() > limit:
                return "timeout"
            time.sleep(_POLL_S)
        enough = status.now_ns + round(settle_s * 1e9)
        while self.look().now_ns < enough and time.monotonic() < limit and not self._is_over:
            time.sleep(_POLL_S)
        return "done"


def _stands(name: str, known: set[str]) -> bool:
    """Whether a parameter is set, or one below it: a ``<param type="yaml">`` may be a map."""
    full = name_on_server(name, known)
    return full in known or any(other.startswith(f"{full}/") for other in known)
