"""A folder of flown fleets: what their owner has, and apart from it what was done to the robots.

``flown/SYSTEM/ROBOT/MISSION`` is a mission as the study keeps it, with its truth.
``missions/SYSTEM/ROBOT/MISSION`` is the same recording as its user has it: with the marks of one
observer and nothing that tells what was changed. ``flights.json`` says of each flight what it is.
"""

from __future__ import annotations

import json
import os
import random
import shutil
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError, TpcError
from pytpc.recording.graph_file import GRAPH_FILE
from pytpc.recording.marks import Mark
from pytpc.recording.mission import (
    EVENTS_FILE,
    RUN_FILE,
    SUMMARIES_FILE,
    Recording,
    is_converted,
    read_marks_json,
    write_marks_json,
)
from pytpc.values.origins import ORIGINS_FILE, PARAMS_FILE
from pytpc_evaluation.demo.demo_examples import EXAMPLES, Example
from pytpc_evaluation.study.data import UserMark, user_marks
from pytpc_evaluation.study.dataset import MARKED_FILE, Done
from pytpc_evaluation.study.digest import people_digest
from pytpc_evaluation.study.fleet_plan import FleetFlight, all_fleet_flights
from pytpc_evaluation.study.fly import Flier
from pytpc_evaluation.study.flying import Listener, versions
from pytpc_evaluation.study.people import USERS
from pytpc_evaluation.study.plan import FlightSelection, check_treatments
from pytpc_evaluation.study.resume import alone_in
from pytpc_evaluation.study.run import Result, Runner
from pytpc_evaluation.study.system import prepare

FLIGHTS_FILE = "flights.json"
MISSIONS = "missions"
_SCHEMA = 1
_SHARED = (EVENTS_FILE, SUMMARIES_FILE, RUN_FILE, ORIGINS_FILE, PARAMS_FILE, GRAPH_FILE)


class Seen(NamedTuple):
    """Who watched a mission, and how many marks they set."""

    observer: str
    marks: int


@dataclass
class FleetRun:
    """Fleets that are flown: who flies each system, and what there is to fly.

    ``rows`` are those of ``flights.json`` by the flights' labels.
    """

    out: Path
    fliers: dict[str, Flier]
    flights: list[FleetFlight]
    rows: dict[str, dict[str, Any]] = field(default_factory=dict)

    def fly(self, wanted: Sequence[FleetFlight], listener: Listener, jobs: int = 1) -> list[Result]:
        """Fly what was not flown with the same inputs, and put each mission where its user has it.

        Args:
            wanted: in the order in which they are flown.
            listener: is told how far it is, and of each result, those of earlier runs first.
            jobs: how many fly at a time.

        Raises:
            TpcError: a treatment cannot be read, or a file not written.
        """
        runner = Runner(lambda flight: self.fliers[flight.example.name], listener.flying, jobs)
        kept, rest = runner.kept(wanted)
        self.rows = rows_of_all(self.out)
        by_label = {flight.label: flight for flight in wanted}
        results: list[Result] = []

        def take(result: Result) -> None:
            flight, seen = by_label[result.flight.label], None
            if result.done is not None:
                seen = publish(flight, self.out)
            self.rows[flight.label] = row_of(flight, result.done, seen, result.error)
            results.append(result)
            listener.ended(result)

        for result in kept:
            take(result)
        self.save()
        listener.starts(len(rest))
        for result in runner.run(rest):
            take(result)
            self.save()
        return results

    def save(self) -> None:
        """Write ``flights.json``.

        Raises:
            TpcError: it cannot be written.
        """
        document = {
            "schema": _SCHEMA,
            "versions": versions(),
            "flights": list(self.rows.values()),
        }
        write_atomic(self.out / FLIGHTS_FILE, json.dumps(document, indent=1).encode() + b"\n")


@contextmanager
def opened_fleets(
    out: Path,
    systems: Collection[str] = (),
    treatments: Collection[str] = (),
    *,
    rate: float | None = None,
    on_build: Callable[[Example, str], None] | None = None,
) -> Iterator[FleetRun]:
    """Open a folder of fleets, with the robots built; nobody else may be in it.

    Args:
        out: the folder; made where it is missing.
        systems: the robots; all where empty.
        treatments: the bad missions of these; of all where empty.
        rate: simulated s in a s of the wall; that of each system where None.
        on_build: called with each line of a build.

    Raises:
        TpcError: something named does not exist, a system does not build, or another run is on.
    """
    selection = FlightSelection(systems, treatments)
    examples = selection.examples(EXAMPLES)
    check_treatments(selection, examples)
    people = people_digest()
    with alone_in(out):
        fliers = {}
        for example in examples:
            told = None if on_build is None else _about(on_build, example)
            system, _ = prepare(example, out, told)
            flown_at = example.study_rate if rate is None else rate
            fliers[example.name] = Flier(system, out, flown_at, people)
        yield FleetRun(out, fliers, all_fleet_flights(examples, treatments))


def _about(on_build: Callable[[Example, str], None], example: Example) -> Callable[[str], None]:
    return lambda line: on_build(example, line)


def rows_of_all(out: Path) -> dict[str, dict[str, Any]]:
    """The rows of ``flights.json`` by the flights' labels, in the order of the plan.

    What an earlier run said of a flight is kept; a flight that nobody flew is planned.

    Raises:
        InputError: a treatment cannot be read.
    """
    earlier = {row["folder"]: row for row in load_rows(out)}
    found = {}
    for flight in all_fleet_flights():
        planned = row_of(flight, None)
        found[flight.label] = earlier.get(planned["folder"], planned)
    return found


def load_rows(out: Path) -> list[dict[str, Any]]:
    """What ``flights.json`` says; nothing where there is none.

    Raises:
        InputError: it is broken.
    """
    path = out / FLIGHTS_FILE
    if not path.is_file():
        return []
    document = parse_json(path)
    rows = document.get("flights") if isinstance(document, dict) else None
    if not isinstance(rows, list) or not all(
        isinstance(row, dict) and isinstance(row.get("folder"), str) for row in rows
    ):
        raise InputError("not the flights of a fleet; delete it, and fly on", path)
    return rows


def mission_folder(flight: FleetFlight, out: Path) -> Path:
    """Where a flight is as its user has it."""
    return out / MISSIONS / flight.name


def publish(flight: FleetFlight, out: Path) -> Seen:
    """Put a flown mission where its user has it: the recording, and one observer's marks.

    A mission that is there as it was flown is left as it is, so that nobody takes it for another.

    Raises:
        InputError: the flown mission is broken.
        TpcError: the mission cannot be written.
    """
    flown, folder = flight.folder(out), mission_folder(flight, out)
    recording, events, summaries = read_marks_json(flown)
    every = user_marks(flown / MARKED_FILE)
    observer = observer_of(flight, every)
    own = sorted((m.mark("confused") for m in every if m.observer == observer), key=Mark.order)
    recording = replace(recording, name=flight.name, marks=tuple(own))
    seen = Seen(observer, len(own))
    if _is_published(recording, flown, folder):
        return seen
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for file in _SHARED:
            _share(flown / file, folder / file)
    except OSError as error:
        raise TpcError(f"cannot be written: {error.strerror}", folder) from error
    write_marks_json(recording, folder, events, summaries)
    return seen


def observer_of(flight: FleetFlight, marks: Sequence[UserMark]) -> str:
    """Who watched a mission: drawn from those who marked an error of it, or else from all."""
    who = sorted({mark.observer for mark in marks if mark.cause >= 0})
    everybody = [f"user{number + 1}" for number in range(USERS)]
    return random.Random(f"observer {flight.people}").choice(who or everybody)


def row_of(
    flight: FleetFlight, done: Done | None, seen: Seen | None = None, error: str = ""
) -> dict[str, Any]:
    """What ``flights.json`` says of a flight."""
    treatment = flight.treatment
    return {
        "folder": f"{MISSIONS}/{flight.name}",
        "system": flight.example.name,
        "robot": flight.robot,
        "number": flight.number,
        "treatment": treatment.name,
        "type": treatment.type,
        "parameter": treatment.parameter,
        "node": treatment.node,
        "old": treatment.old,
        "new": treatment.new,
        "half": flight.half,
        "extra": flight.is_extra,
        "seed": flight.seed,
        "state": "failed" if error else "planned" if done is None else "done",
        "reached": None if done is None else done.reached,
        "errors": None if done is None else done.causes,
        "observer": None if seen is None else seen.observer,
        "marks": None if seen is None else seen.marks,
        "remarks": [] if done is None else list(done.remarks),
        "error": error,
    }


def _is_published(recording: Recording, flown: Path, folder: Path) -> bool:
    if not is_converted(folder):
        return False
    same = all(_size(folder / file) == _size(flown / file) for file in _SHARED)
    there, _, _ = read_marks_json(folder)
    return same and (there.name, there.marks) == (recording.name, recording.marks)


def _size(file: Path) -> tuple[int, int] | None:
    """How a file is told from another one: its size and when it was written; None without one."""
    if not file.is_file():
        return None
    found = file.stat()
    return (found.st_size, found.st_mtime_ns)


def _share(source: Path, target: Path) -> None:
    """Have ``target`` be the file ``source``, or a copy where the file system has no links."""
    if not source.is_file():
        target.unlink(missing_ok=True)
        return
    if target.is_file() and target.samefile(source):
        return
    target.unlink(missing_ok=True)
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)
