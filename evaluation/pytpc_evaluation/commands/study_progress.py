"""How far a run of the study is: a bar with the time that is left, a line for each mission."""

from __future__ import annotations

import time
from types import TracebackType
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.progress import Progress as Bar
from rich.text import Text

from pytpc.base.wording import many, plain
from pytpc.cli.lines import progress_console, say
from pytpc.ros.mission_run import Progress
from pytpc.workspace.colcon import BuildError
from pytpc_evaluation.demo.demo_examples import Example
from pytpc_evaluation.study.plan import Flight
from pytpc_evaluation.study.run import Result

if TYPE_CHECKING:
    from typing_extensions import Self

_SILENT_S = 5.0


class StudyProgress:
    """A context manager; everything is told on standard error, and missions that ended by a line.

    Without a terminal there is no bar, but a line every five seconds about the work under way.
    """

    def __init__(self, what: str, console: Console | None = None) -> None:
        """``what`` is written in front of the bar."""
        self._console = console or progress_console()
        self._bar = Bar(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("left"),
            # A mission is a step of many seconds: the speed is that of the whole run.
            TimeRemainingColumn(),
            speed_estimate_period=24 * 3600.0,
            console=self._console,
            transient=True,
            disable=not self._console.is_terminal,
        )
        self._task = self._bar.add_task(what, total=None)
        self._told = time.monotonic()

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Take it away; where a build failed, show the end of what it said."""
        self._bar.stop()
        if isinstance(error, BuildError):
            for line in error.tail:
                say(line)

    def building(self, example: Example, line: str) -> None:
        """A line of a build."""
        self._at_work(f"building {example.name}", line.strip())

    def flying(self, flight: Flight, progress: Progress) -> None:
        """A mission is so far."""
        self._at_work(flight.name, f"{progress.sim_s:.0f} s simulated")

    def starts(self, flights: int) -> None:
        """So many are to be flown; the time runs from here."""
        self._bar.reset(self._task, total=flights)

    def ended(self, result: Result) -> None:
        """A mission has ended; those of an earlier run are not reported."""
        if result.kept:
            return
        self._bar.advance(self._task)
        style = "red" if result.error else "yellow" if result.done and result.done.remarks else ""
        text = Text(plain(result_line(result)), style=style)
        self._console.print(text, highlight=False, soft_wrap=True)
        self._told = time.monotonic()

    def _at_work(self, what: str, how_far: str) -> None:
        self._bar.update(self._task, description=Text(plain(f"{what}: {how_far}"[:60])).markup)
        if not self._console.is_terminal and time.monotonic() - self._told > _SILENT_S:
            self._told = time.monotonic()
            say(plain(f"{what}: {how_far}"))


def result_line(result: Result) -> str:
    """What became of a mission, in one line."""
    name = result.flight.label
    if result.done is None:
        return f"{name}: FAILED: {result.error}"
    done = result.done
    told = (
        f"{name}: {done.sim_s:.0f} s simulated in {result.seconds:.0f} s,"
        f" {many(done.reports, 'report')}, {many(done.causes, 'error')} seen,"
        f" {many(done.marks, 'mark')}"
    )
    if result.retried:
        told += f"; at the second try, the first one failed: {result.retried}"
    return "; ".join([told, *done.remarks])
