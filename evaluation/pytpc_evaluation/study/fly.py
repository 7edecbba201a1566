"""One flight: flown on a graph of its own, converted, looked at, and written down as done."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.errors import InputError, RunError, TpcError
from pytpc.ingest.reading import read
from pytpc.recording.marks import Mark
from pytpc.recording.mission import (
    EVENTS_FILE,
    MARKS_FILE,
    REPORTS_FOLDER,
    Recording,
    read_marks_json,
    save_recording,
    write_marks_json,
)
from pytpc.ros.mission_run import MISSION_DONE, Progress, RecordOptions
from pytpc.ros.ros1.record_mission import run_mission
from pytpc_evaluation.study.changes import CHANGES_FILE, save_changes
from pytpc_evaluation.study.dataset import (
    CAUSES_FILE,
    DONE_FILE,
    MARKED_FILE,
    SIGHTS_FILE,
    Cause,
    Done,
    load_causes,
    load_done,
    save_done,
)
from pytpc_evaluation.study.digest import flight_digest, marks_digest
from pytpc_evaluation.study.people import cut_sights, mark, read_marked, see
from pytpc_evaluation.study.plan import Flight, overlay_text
from pytpc_evaluation.study.system import BuiltSystem
from pytpc_evaluation.treatment import Treatment, save_treatment

SETTLE_S = 15.0
TIMEOUT_S = 300.0
DECOYS_FILE = "decoys.yaml"
_OF_FLIGHT = (EVENTS_FILE, MARKS_FILE, SIGHTS_FILE, CHANGES_FILE)
_OF_PEOPLE = (CAUSES_FILE, MARKED_FILE)


@dataclass(frozen=True)
class Flier:
    """Flies missions of one robot into the study's folder.

    ``people`` is the digest of those who look on; ``rate`` is in simulated s for a s of the wall.
    """

    system: BuiltSystem
    out: Path
    rate: float
    people: str
    timeout_s: float = TIMEOUT_S

    def digests(self, flight: Flight) -> tuple[str, str]:
        """Of the flight, and of its marks.

        Raises:
            InputError: a file of the treatment cannot be read.
        """
        flown = flight_digest(flight, self.system.digest, self.rate, SETTLE_S)
        return flown, marks_digest(flight, self.people)

    def kept(self, flight: Flight) -> Done | None:
        """What was done in an earlier run, where that is with the same inputs.

        Raises:
            TpcError: a file of the treatment cannot be read, or copied into the mission's folder.
        """
        folder = flight.folder(self.out)
        done = load_done(folder)
        if done is None or (done.flight, done.marked) != self.digests(flight):
            return None
        if not _has(folder, (*_OF_FLIGHT, *_OF_PEOPLE)):
            return None
        try:
            causes = load_causes(folder / CAUSES_FILE)
        except InputError:
            return None
        # What the treatment says of itself may be put better than it was.
        save_treatment(flight.treatment, folder)
        remarks = remarks_of(flight, causes, reached=done.reached)
        if remarks != done.remarks:
            done = replace(done, remarks=remarks)
            save_done(done, folder)
        return done

    def fly(self, flight: Flight, on_progress: Callable[[Progress], None] | None = None) -> Done:
        """Do all of a flight anew, or its marks alone where only the people are others.

        Raises:
            TpcError: the mission or its observer fails.
        """
        folder = flight.folder(self.out)
        before = load_done(folder)
        flown, marked = self.digests(flight)
        # Whatever happens from here on, the mission is not whole.
        _remove(folder / DONE_FILE)
        if before is not None and before.flight == flown and _has(folder, _OF_FLIGHT):
            recording, events, summaries = read_marks_json(folder)
            causes, marks = self._mark(flight, folder)
            write_marks_json(replace(recording, marks=marks), folder, events, summaries)
            remarks = remarks_of(flight, causes, reached=before.reached)
            done = replace(
                before, marked=marked, causes=len(causes), marks=len(marks), remarks=remarks
            )
        else:
            done = self._fly(flight, folder, flown, marked, on_progress)
        save_done(done, folder)
        return done

    def _fly(
        self,
        flight: Flight,
        folder: Path,
        flown: str,
        marked: str,
        on_progress: Callable[[Progress], None] | None,
    ) -> Done:
        example = flight.example
        _clear(folder)
        options = RecordOptions(
            folder,
            example.launch,
            self._arguments(flight, folder),
            self.timeout_s,
            until=MISSION_DONE,
            topics=example.watched,
            on_progress=on_progress,
        )
        run = run_mission(self.system.env, options, settle_s=SETTLE_S)
        if run.ended != "done" or run.done_ns is None:
            what = {"timeout": "was not over", "ended": "ended before it was done"}
            raise RunError(
                f"the mission {what.get(run.ended, run.ended)} after {run.wall_s:.0f} s", folder
            )
        save_treatment(flight.treatment, folder)
        save_changes(flight.changes, folder)
        end_ns = round(run.done_ns + SETTLE_S * 1e9)
        see(example, self.system.plain_env, run.bag, folder)
        cut_sights(folder / SIGHTS_FILE, end_ns / 1e9)
        causes, marks = self._mark(flight, folder)
        recording = replace(cut(read(folder), end_ns), marks=marks)
        if not len(recording.events):
            raise RunError("no node reported a comparison", folder)
        save_recording(recording, folder)
        _remove(run.bag)
        for name in (REPORTS_FOLDER, "ros"):
            shutil.rmtree(folder / name, ignore_errors=True)
        reached = run.messages.get(example.goal_topic, 0) > 0
        return Done(
            flight=flown,
            marked=marked,
            rate=self.rate,
            seed=flight.seed,
            people=flight.people,
            sim_s=recording.seconds,
            wall_s=run.wall_s,
            reports=len(recording.events),
            reached=reached,
            causes=len(causes),
            marks=len(marks),
            remarks=remarks_of(flight, causes, reached=reached),
        )

    def _arguments(self, flight: Flight, folder: Path) -> dict[str, str]:
        arguments = {
            "rate": f"{self.rate:g}",
            "seed": str(flight.seed),
            "treatment": str(flight.overlay.absolute()),
            "observer": "false",
            **flight.treatment.launch,
        }
        settings = flight.settings()
        if settings:
            path = folder / DECOYS_FILE
            write_atomic(path, overlay_text(settings).encode())
            arguments["overlay2"] = str(path.absolute())
        return arguments

    def _mark(self, flight: Flight, folder: Path) -> tuple[list[Cause], tuple[Mark, ...]]:
        mark(flight.example, self.system.plain_env, folder, flight.people)
        return load_causes(folder / CAUSES_FILE), read_marked(folder / MARKED_FILE)


def remarks_of(flight: Flight, causes: Sequence[Cause], *, reached: bool) -> tuple[str, ...]:
    """Where a mission did not go as its treatment demands, in sentences.

    A flight that tries a suggestion has no demands: it is judged against the treated mission.
    """
    if flight.kind == "suggested":
        return ()
    return (
        *_seen(flight.treatment, causes),
        *flight.example.goal_remarks(flight.treatment, reached=reached),
    )


def _seen(treatment: Treatment, causes: Sequence[Cause]) -> list[str]:
    wanted = treatment.mark_type
    if treatment.type == "clean" and causes:
        return [f"an error was seen where there is none: {_told(causes[0])}"]
    if wanted is None:
        return []
    if not causes:
        return [f"no error was seen, and one of type {wanted} is demanded"]
    first = min(causes, key=lambda cause: cause.start)
    if first.kind != wanted:
        return [
            f"the first error that was seen is of type {first.kind}, not {wanted}: {_told(first)}"
        ]
    return []


def _told(cause: Cause) -> str:
    return f"{cause.reason} ({cause.start:.1f} s)"


def _clear(folder: Path) -> None:
    try:
        if folder.exists():
            shutil.rmtree(folder)
        folder.mkdir(parents=True)
    except OSError as error:
        raise TpcError(f"cannot be cleared: {error.strerror}", folder) from error


def cut(recording: Recording, end_ns: int) -> Recording:
    """The recording until ``end_ns``.

    How long a graph goes on after that depends on the machine, and so would the results.
    """
    events = recording.events.between(recording.start_ns, end_ns)
    return replace(recording, events=events, end_ns=min(recording.end_ns, end_ns))


def _has(folder: Path, names: Sequence[str]) -> bool:
    return all((folder / name).is_file() for name in names)


def _remove(path: Path) -> None:
    with contextlib.suppress(FileNotFoundError):
        path.unlink()
