"""The diagnosis of a mission that runs: what all marks so far say, beside good runs.

It is worked out in a thread of its own, as the screen must not wait for it.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache
from pathlib import Path

from pytpc.api.comparing import RecordedRun
from pytpc.api.diagnosing import AskedMission
from pytpc.api.missions import find_declared
from pytpc.base.errors import TpcError
from pytpc.diagnosis.question import Question
from pytpc.recording.declaration import Declared
from pytpc.recording.growing import GrowingRecording
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.ros.graphs import values_at
from pytpc.static.static_info import StaticInfo
from pytpc.values.recording import is_of_ros

_AGAIN_S = 5.0
_SHARE = 10
"""How many times as long as a diagnosis took, the thread waits for the next one or for a mark."""

Ask = Callable[[Recording], AskedMission]


def asked_of_graph(
    master: str,
    static_info: StaticInfo,
    static_file: Path | None,
    question: Question,
    good: Sequence[RecordedRun],
) -> Ask:
    """Ask about the robot of a running graph.

    Args:
        master: its URI; the parameters are read anew each time.
        static_info: what the analysis found.
        static_file: from which it was read; None: the build is not known.
        question: about the mission.
        good: at least one good run.
    """

    @cache
    def declared() -> Sequence[Declared]:
        return find_declared(static_info, None)

    def ask(recording: Recording) -> AskedMission:
        asked = replace(question, declared=declared()) if question.declared is None else question
        server = {name: value for name, value in values_at(master).items() if not is_of_ros(name)}
        run = RecordedRun(recording, server=server, built=static_file)
        return AskedMission.of(run, static_info, asked, good)

    return ask


class LiveDiagnosis:
    """Keeps up the diagnosis; ``found`` is the last one, None before the first.

    Args:
        ask: puts the question about the mission so far.
        whole: the recording that is watched; None: the mission runs, and `take` has its reports.
    """

    def __init__(self, ask: Ask, whole: Recording | None = None) -> None:
        """See the class; the thread begins at once."""
        self.found: AskedMission | None = None
        self._ask = ask
        self._whole = whole
        self._log = GrowingRecording()
        self._marks: tuple[Mark, ...] = () if whole is None else whole.marks
        self._wake = threading.Event()
        self._ended = False
        self._fault = ""
        self._thread = threading.Thread(target=self._keep_up, name="diagnosis", daemon=True)
        self._thread.start()

    def take(self, items: Iterable[object]) -> None:
        """Take in what was reported."""
        if self._whole is None:
            for item in items:
                self._log.add(item)

    def restart(self) -> None:
        """Forget the reports and the marks: the clock was set back."""
        self._log.clear()
        if self._whole is None:
            self._marks = ()

    def mark(self, change: Callable[[Sequence[Mark]], tuple[Mark, ...]]) -> None:
        """Change the marks, and judge by them."""
        self._marks = change(self._marks)
        self._wake.set()

    @property
    def lines(self) -> list[str]:
        """What differs, and the verdict; before them, why there is none."""
        asked = self.found
        fault = [self._fault] if self._fault else []
        if asked is None or asked.question.differences is None:
            return fault
        differing = asked.question.differences
        lines = [*fault, differing.line or differing.title]
        if asked.run.recording.marks:
            found = asked.diagnosis
            lines.append(f"{found.blame.title}: {found.headline}")
        if self._log.is_full:
            lines.append("too many reports to judge the last ones now; `rank` judges all of them")
        return lines

    @property
    def differing(self) -> frozenset[str]:
        """The parameters that differ from the good runs."""
        asked = self.found
        found = None if asked is None else asked.question.differences
        return frozenset() if found is None else frozenset(one.parameter for one in found.found)

    def close(self) -> None:
        """End the thread; a diagnosis that is being worked out is not waited for."""
        self._ended = True
        self._wake.set()

    def _keep_up(self) -> None:
        while not self._ended:
            began = time.monotonic()
            # The graph may come back; until then the last answer stands.
            with suppress(TpcError):
                self._try_judging()
            took_s = time.monotonic() - began
            # Nothing happens to a recording but marks.
            again = None if self._whole is not None else max(_AGAIN_S, _SHARE * took_s)
            self._wake.wait(again)
            self._wake.clear()

    def _try_judging(self) -> None:
        """Judge; a fault of ours is told, as the screen goes on without this thread."""
        try:
            self._judge()
            self._fault = ""
        except TpcError:
            raise
        except Exception as error:
            what = f"{type(error).__name__}: {' '.join(str(error).split())}"
            self._fault = f"no verdict now ({what}); ask `rank` after the mission"

    def _judge(self) -> None:
        marks = self._marks
        whole = self._whole
        mission = self._log.recording(marks) if whole is None else replace(whole, marks=marks)
        asked = self._ask(mission)
        if marks:
            # Here and not where it is shown.
            _ = asked.diagnosis
        self.found = asked
