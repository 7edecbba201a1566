"""A study from its folder's point of view: builds, plans, flies, and keeps ``study.json``."""

from __future__ import annotations

import platform
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Protocol

from pytpc.ros.mission_run import Progress
from pytpc_evaluation.demo.demo_examples import EXAMPLES, Example
from pytpc_evaluation.study.dataset import StudyFile
from pytpc_evaluation.study.digest import people_digest
from pytpc_evaluation.study.fly import Flier
from pytpc_evaluation.study.plan import Flight, FlightSelection, check_treatments, flights_of
from pytpc_evaluation.study.resume import alone_in
from pytpc_evaluation.study.run import Result, Runner
from pytpc_evaluation.study.system import prepare


class Listener(Protocol):
    """Who is told how far a run is."""

    def starts(self, flights: int) -> None:
        """So many are to be flown."""

    def flying(self, flight: Flight, progress: Progress) -> None:
        """A flight is so far; called from its own thread, about ten times a second."""

    def ended(self, result: Result) -> None:
        """A flight has ended, now or in an earlier run."""


@dataclass
class StudyRun:
    """What a run needs to know of its study.

    ``fliers`` and ``flights`` are by system: who flies, and what there is to fly.
    """

    out: Path
    file: StudyFile
    fliers: dict[str, Flier] = field(default_factory=dict)
    flights: dict[str, list[Flight]] = field(default_factory=dict)

    def flier(self, flight: Flight) -> Flier:
        """Who flies a flight."""
        return self.fliers[flight.example.name]

    def all(self) -> list[Flight]:
        """The flights of all systems."""
        return [flight for flights in self.flights.values() for flight in flights]

    def fly(
        self,
        flights: Sequence[Flight],
        listener: Listener,
        jobs: int = 1,
    ) -> list[Result]:
        """Fly what was not flown with the same inputs; results in the order of ``flights``.

        Args:
            flights: what is wanted.
            listener: is told how far it is, and of each result, those of earlier runs first.
            jobs: see ``Runner``.

        Raises:
            TpcError: a treatment cannot be read, or study.json not written.
        """
        runner = Runner(self.flier, listener.flying, jobs)
        kept, rest = runner.kept(flights)
        results: dict[str, Result] = {}

        def take(result: Result) -> None:
            label = result.flight.label
            results[label] = result
            self.file.errors.pop(label, None)
            if result.error:
                self.file.errors[label] = result.error
            listener.ended(result)

        for result in kept:
            take(result)
        self.file.save()
        listener.starts(len(rest))
        for result in runner.run(rest):
            take(result)
            self.file.save()
        return [results[flight.label] for flight in flights]


@contextmanager
def opened(
    out: Path,
    selection: FlightSelection,
    *,
    rate: float | None = None,
    on_build: Callable[[Example, str], None] | None = None,
) -> Iterator[StudyRun]:
    """Open a study's folder, with the systems of the selection built; nobody else may be in it.

    Args:
        out: the folder; made where it is missing.
        selection: what is to be flown.
        rate: simulated s in a s of the wall; that of each system where None.
        on_build: called with each line of a build.

    Raises:
        TpcError: something named does not exist, a system does not build, or another run is on.
    """
    examples = selection.examples(EXAMPLES)
    check_treatments(selection, examples)
    people = people_digest()
    with alone_in(out):
        study = StudyRun(out, StudyFile.of(out, versions()))
        for example in examples:
            system, _ = prepare(example, out, _told(on_build, example))
            flown_at = example.study_rate if rate is None else rate
            study.fliers[example.name] = Flier(system, out, flown_at, people)
            study.flights[example.name] = flights_of(example, selection)
        yield study


def _told(
    on_build: Callable[[Example, str], None] | None, example: Example
) -> Callable[[str], None] | None:
    return None if on_build is None else lambda line: on_build(example, line)


def versions() -> dict[str, str]:
    """What the study was flown with."""
    found = {"python": platform.python_version()}
    for package in ("pytpc", "numpy", "pyarrow"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found
