"""A launch file that runs and is recorded in a thread, so that another one can take keys."""

from __future__ import annotations

import threading
from dataclasses import replace
from pathlib import Path

from pytpc.api.record import record_launch
from pytpc.base.signals import Stop
from pytpc.ros.mission_run import MissionRun, Progress, RecordOptions


class FlownMission:
    """A mission of a launch file; it begins at once.

    Args:
        workspace: of the launch file.
        options: see `pytpc.api.record.record_launch`, as are the others.
        python: Python nodes report, too.
        use_sim_time: the graph's clock.
        stop: ends it.
    """

    def __init__(
        self,
        workspace: Path,
        options: RecordOptions,
        stop: Stop,
        *,
        python: bool = True,
        use_sim_time: bool | None = None,
    ) -> None:
        """See the class."""
        self.master = ""
        self.host = ""
        self.progress: Progress | None = None
        self._begun = threading.Event()
        self._run: MissionRun | None = None
        self._error: BaseException | None = None

        def begin(master: str, host: str) -> None:
            self.master, self.host = master, host
            self._begun.set()

        def advance(progress: Progress) -> None:
            self.progress = progress

        told = replace(options, on_graph=begin, on_progress=advance)

        def fly() -> None:
            try:
                self._run = record_launch(
                    workspace, told, python=python, use_sim_time=use_sim_time, stop=stop
                )
            except BaseException as error:
                # `result` raises it.
                self._error = error
            finally:
                self._begun.set()

        self._thread = threading.Thread(target=fly, name="mission")
        self._thread.start()

    @property
    def is_over(self) -> bool:
        """Whether it has ended, and all that there is of it is in its folder."""
        return not self._thread.is_alive()

    def wait_for_graph(self, patience_s: float) -> bool:
        """Wait for the graph; whether it stands, or never will."""
        return self._begun.wait(patience_s)

    def wait(self, patience_s: float) -> bool:
        """Wait for the end; whether it has come."""
        self._thread.join(patience_s)
        return self.is_over

    def result(self) -> MissionRun:
        """How it went.

        Raises:
            TpcError: what `record_launch` raises.
        """
        self._thread.join()
        if self._error is not None:
            raise self._error
        assert self._run is not None
        return self._run
