"""Shows a mission in Rerun's viewer: as a file (.rrd), or as it happens.

The time line ``robot`` has the times of the robot's clock. The paths of the viewer's tree are the
topics of the MCAP file without ``/tpc``.
"""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pytpc.base.atomic import replacing
from pytpc.base.columns import Int64s
from pytpc.base.errors import MissingToolError, TpcError
from pytpc.base.wording import plain
from pytpc.diagnosis.results.exported import (
    ComparisonSeries,
    ExportedLine,
    ExportedRows,
    ExportedSuspects,
    ExportedValue,
    MissionExport,
    Progress,
)
from pytpc.present.viewers.layouts import title_of

TIME_LINE = "robot"
_APPLICATION = "tpc"
_PART = 1 << 18
_LISTED = 10
_SHOWN = 5
# A clock that is below this many ns is a simulator's: it counts from its own start.
_SIMULATED = 10**9 * 86400 * 365
_RED, _BLUE = 0xD62728FF, 0x1F77B4FF
_LEVELS = {"mark": "WARN", "verdict": "INFO", "turn": "DEBUG"}


def rerun_sdk() -> Any:  # noqa: ANN401
    """The module ``rerun``; its import takes a second.

    Raises:
        MissingToolError: it is not installed.
    """
    try:
        import rerun  # noqa: PLC0415
    except ImportError as error:
        raise MissingToolError(
            "Rerun is not installed: pip install 'pytpc[rerun]' (it needs Python 3.11 or newer)"
        ) from error
    return rerun


def write_rerun(found: MissionExport, path: Path, on_progress: Progress | None = None) -> None:
    """Write a recording of Rerun that shows the first suspects when it is opened.

    Args:
        found: the mission.
        path: the file, which is replaced.
        on_progress: called with (evaluations written, all evaluations).

    Raises:
        TpcError: it cannot be written, or Rerun is not installed.
    """
    rr = rerun_sdk()
    shown = [found.series[number] for number in found.first]
    likely = [] if not found.suspects else found.suspects[-1].suspects[:_SHOWN]
    probable = [found.probability_topics[one.parameter] for one in likely]
    with replacing(path) as staged:
        viewer = RerunViewer(rr, found.end_ns)
        viewer.stream.save(staged, default_blueprint=blueprint(rr, shown, probable))
        viewer.stream.send_recording_name(plain(found.name))
        viewer.describe(found.series)
        _write(viewer, found, on_progress)
        try:
            viewer.close()
        except RuntimeError as error:
            raise TpcError(f"cannot be written: {error}", path) from error


def _write(viewer: RerunViewer, found: MissionExport, on_progress: Progress | None) -> None:
    done = 0
    results = np.full(len(found.series), -1, np.int64)
    for rows in found.rows(_PART):
        viewer.add_rows(found.series, rows, results)
        done += rows.time_ns.size
        if on_progress is not None:
            on_progress(done, found.count)
    by_topic: defaultdict[str, list[ExportedValue]] = defaultdict(list)
    for value in found.values:
        by_topic[value.topic].append(value)
    for topic, values in by_topic.items():
        times = np.array([one.time_ns for one in values], np.int64)
        viewer.add_scalars(path_of(topic), times, [one.number for one in values])
    ranks = found.ranks
    for column, topic in enumerate(found.rank_topics):
        viewer.add_scalars(path_of(topic), ranks.times_ns, ranks.combined[:, column])
    for name, topic in found.probability_topics.items():
        probable = [
            (at.time_ns, one.probability)
            for at in found.suspects
            for one in at.suspects
            if one.parameter == name
        ]
        times = np.array([time_ns for time_ns, _ in probable], np.int64)
        viewer.add_scalars(path_of(topic), times, [number for _, number in probable])
    for at in found.suspects:
        viewer.add_suspects(at)
    viewer.add_lines(found.log)


class RerunViewer:
    """A stream of Rerun's, which goes to a file or to a viewer.

    Args:
        rr: the module.
        end_ns: a time on the clock of the robot, by which a simulator's clock is known; None: the
            first one that is sent.

    Attributes:
        stream: where it goes is still to be said.
    """

    def __init__(self, rr: Any, end_ns: int | None) -> None:  # noqa: ANN401
        """Nothing is sent yet."""
        self._rr = rr
        self._is_simulated = None if end_ns is None else end_ns < _SIMULATED
        self.stream: Any = rr.RecordingStream(_APPLICATION)

    def describe(self, series: Sequence[ComparisonSeries]) -> None:
        """Say how the lines of some comparisons look."""
        rr = self._rr
        for one in series:
            for part, colour in (("value", _BLUE), ("threshold", _RED)):
                name = f"{plain(one.parameter)} {part}"
                look = rr.SeriesLines(colors=[colour], names=[name])
                self.stream.log(f"{path_of(one.topic)}/{part}", look, static=True)

    def add_rows(
        self, series: Sequence[ComparisonSeries], rows: ExportedRows, results: Int64s
    ) -> None:
        """Add evaluations; ``results`` int64[series], the last ones, -1 for none, is kept up."""
        order = np.argsort(rows.series, kind="stable")
        numbers = rows.series[order]
        first = np.flatnonzero(np.diff(numbers, prepend=-1) != 0)
        for number, own in zip(numbers[first].tolist(), np.split(order, first[1:]), strict=False):
            path = path_of(series[number].topic)
            times = rows.time_ns[own]
            self.add_scalars(f"{path}/value", times, rows.value[own])
            self.add_scalars(f"{path}/threshold", times, rows.threshold[own])
            if series[number].relation != "flag":
                self.add_scalars(f"{path}/margin", times, rows.margin[own])
            result = rows.result[own].astype(np.int64)
            turned = np.flatnonzero(np.diff(result, prepend=results[number]) != 0)
            words = ["true" if result[row] else "false" for row in turned]
            if words:
                states = self._rr.StateChange.columns(state=words)
                self.stream.send_columns(f"{path}/result", [self._times(times[turned])], states)
            results[number] = result[-1]

    def add_scalars(self, path: str, times: Int64s, numbers: Any) -> None:  # noqa: ANN401
        """Add numbers (float64[n]) at times (int64[n])."""
        columns = self._rr.Scalars.columns(scalars=np.asarray(numbers, np.float64))
        self.stream.send_columns(path, [self._times(times)], columns)

    def add_lines(self, lines: Sequence[ExportedLine]) -> None:
        """Add lines of the log."""
        if not lines:
            return
        columns = self._rr.TextLog.columns(
            text=[f"{plain(one.name)}: {plain(one.text)}" for one in lines],
            level=[_LEVELS.get(one.kind, "INFO") for one in lines],
        )
        times = np.array([one.time_ns for one in lines], np.int64)
        self.stream.send_columns("log", [self._times(times)], columns)

    def add_suspects(self, at: ExportedSuspects) -> None:
        """Add the text of a verdict, which holds until the next one."""
        rows = [
            f"{one.position:>3}  {one.probability:6.1%}  {plain(one.parameter)}  {plain(one.place)}"
            + (f"  try {one.to_try}" if one.to_try else "")
            for one in at.suspects[:_LISTED]
        ]
        text = "\n".join([plain(at.text), *([plain(at.action)] if at.action else []), "", *rows])
        columns = self._rr.TextDocument.columns(text=[text])
        times = np.array([at.time_ns], np.int64)
        self.stream.send_columns("suspects", [self._times(times)], columns)

    def reaches(self, patience_s: float) -> bool:
        """Send what waits; False if nobody can get it any more.

        A viewer that is only slow still gets it. Rerun does not connect again by itself.

        Args:
            patience_s: how long to wait at most.
        """
        until = time.monotonic() + patience_s
        try:
            self.stream.flush(timeout_sec=patience_s)
        except RuntimeError:
            # Rerun has one error for both; a connection that is lost fails at once.
            return time.monotonic() >= until
        return True

    def close(self, patience_s: float = 1e38) -> None:
        """Send or write what waits, and end.

        Args:
            patience_s: how long to wait at most; a viewer may be gone.

        Raises:
            RuntimeError: not all of it was sent or written.
        """
        try:
            self.stream.flush(timeout_sec=patience_s)
        finally:
            self.stream.disconnect()

    def _times(self, times: Int64s) -> Any:  # noqa: ANN401
        column = self._rr.TimeColumn
        if self._is_simulated is None and times.size:
            self._is_simulated = bool(times[0] < _SIMULATED)
        if self._is_simulated:
            return column(TIME_LINE, duration=times.astype("timedelta64[ns]"))
        return column(TIME_LINE, timestamp=times.astype("datetime64[ns]"))


def blueprint(
    rr: Any,  # noqa: ANN401
    shown: Sequence[ComparisonSeries],
    probabilities: Sequence[str] = (),
) -> Any:  # noqa: ANN401
    """What the viewer shows first.

    Args:
        rr: the module.
        shown: the comparisons to show, with their results.
        probabilities: topics of the probabilities to show; empty: all.
    """
    rrb = rr.blueprint
    axis = rrb.TimeAxis(link="LinkToGlobal")
    left = [
        rrb.TimeSeriesView(
            origin="/",
            contents=[f"/{path_of(one.topic)}/{part}" for part in ("value", "threshold")],
            name=title_of(one),
            axis_x=axis,
        )
        for one in shown
    ]
    right = [
        rrb.TimeSeriesView(
            origin="/probabilities",
            contents=[f"/{path_of(topic)}" for topic in probabilities] or "$origin/**",
            name="Probability after each mark",
            axis_x=axis,
        ),
        rrb.StateTimelineView(
            origin="/",
            contents=[f"/{path_of(one.topic)}/result" for one in shown],
            name="Results",
        ),
        rrb.TextDocumentView(origin="/suspects", name="Suspects"),
        rrb.TextLogView(origin="/log", name="Marks, verdicts and turns"),
    ]
    return rrb.Blueprint(
        rrb.Horizontal(rrb.Vertical(*left), rrb.Vertical(*right)), collapse_panels=True
    )


def path_of(topic: str) -> str:
    """The path of a topic in the viewer's tree."""
    return topic.removeprefix("/tpc/")
