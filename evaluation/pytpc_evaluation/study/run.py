"""All flights of a study, one after the other or some at a time; what fails is tried once more."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Protocol

from pytpc.base.errors import TpcError
from pytpc.base.signals import signals_end
from pytpc.ros.mission_run import Progress
from pytpc_evaluation.study.dataset import Done
from pytpc_evaluation.study.plan import Flight

TRIES = 2
_POLL_S = 0.2


class Flies(Protocol):
    """What ``Flier`` does, so that a test need not fly."""

    def kept(self, flight: Flight) -> Done | None:
        """What is there already."""

    def fly(self, flight: Flight, on_progress: Callable[[Progress], None] | None = None) -> Done:
        """Fly it."""


@dataclass(frozen=True)
class Result:
    """What became of a flight: ``done``, or the one line why it failed.

    ``kept``: it was done in an earlier run. ``retried`` is why the first try failed, if it did.
    ``seconds`` is wall time.
    """

    flight: Flight
    done: Done | None
    error: str = ""
    kept: bool = False
    retried: str = ""
    seconds: float = 0.0


class _Stopped(BaseException):
    """Thrown into a mission that is to end because the run is interrupted."""


class Runner:
    """Runs flights.

    Args:
        flies: for each flight what flies it.
        on_progress: called from the flights' threads about ten times a second.
        jobs: how many fly at a time.
    """

    def __init__(
        self,
        flies: Callable[[Flight], Flies],
        on_progress: Callable[[Flight, Progress], None] | None = None,
        jobs: int = 1,
    ) -> None:
        self._flies = flies
        self._on_progress = on_progress
        self._jobs = jobs
        self._stop = threading.Event()

    def kept(self, flights: Iterable[Flight]) -> tuple[list[Result], list[Flight]]:
        """Those that were done before with the same inputs, and those that are to be flown.

        Raises:
            TpcError: a treatment cannot be read.
        """
        results, rest = [], []
        for flight in flights:
            done = self._flies(flight).kept(flight)
            if done is None:
                rest.append(flight)
            else:
                results.append(Result(flight, done, kept=True))
        return results, rest

    def run(self, flights: Sequence[Flight]) -> Iterator[Result]:
        """Fly them; a result for each, as they end.

        What interrupts this, or leaves the iterator, ends the missions that are under way.
        """
        with signals_end(), ThreadPoolExecutor(self._jobs) as pool:
            waiting: set[Future[Result]] = {pool.submit(self._one, one) for one in flights}
            try:
                while waiting:
                    ended, waiting = wait(waiting, _POLL_S, FIRST_COMPLETED)
                    for future in ended:
                        yield future.result()
            finally:
                self._stop.set()
                pool.shutdown(wait=True, cancel_futures=True)

    def _one(self, flight: Flight) -> Result:
        began = time.monotonic()
        errors: list[str] = []
        while len(errors) < TRIES:
            try:
                done = self._flies(flight).fly(flight, lambda p: self._look(flight, p))
            except (TpcError, OSError) as error:
                errors.append(str(error))
            else:
                first = "".join(errors[:1])
                return Result(flight, done, retried=first, seconds=time.monotonic() - began)
        return Result(
            flight, None, error=errors[-1], retried=errors[0], seconds=time.monotonic() - began
        )

    def _look(self, flight: Flight, progress: Progress) -> None:
        if self._stop.is_set():
            raise _Stopped
        if self._on_progress is not None:
            self._on_progress(flight, progress)
