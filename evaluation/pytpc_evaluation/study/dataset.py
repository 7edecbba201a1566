"""The files of the study's folder: what each mission leaves, and ``study.json`` about all.

What lies where stands in docs/reference/study-data.md.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc_evaluation.demo.demo_examples import EXAMPLES, Example
from pytpc_evaluation.study.plan import SEEDS, Flight, flights_of

STUDY_FILE = "study.json"
DONE_FILE = "done.json"
CAUSES_FILE = "causes.json"
SIGHTS_FILE = "sights.parquet"
MARKED_FILE = "marks.parquet"
SCHEMA = 1


@dataclass(frozen=True, slots=True)
class Cause:
    """What was seen to be wrong: kind "I" or "II", its begin and end in simulated s, and why."""

    kind: str
    start: float
    end: float
    reason: str


@dataclass(frozen=True)
class Done:
    """What ``done.json`` says; it is written last, so where it is, the mission is whole.

    ``flight`` and ``marked`` are digests: of all that the flight was made from, and of the people
    who looked on. ``marks`` counts those of all people. ``remarks`` say in sentences where the
    mission did not go as its treatment demands. ``rate`` is in simulated s for a s of the wall.
    """

    flight: str
    marked: str
    rate: float
    seed: int
    people: int
    sim_s: float
    wall_s: float
    reports: int
    reached: bool
    causes: int
    marks: int
    remarks: tuple[str, ...] = ()

    @property
    def digest(self) -> str:
        """Of the flight and of its marks: what was made of others is out of date."""
        return f"{self.flight}-{self.marked}"


def save_done(done: Done, folder: Path) -> None:
    """Write ``done.json``.

    Raises:
        TpcError: it cannot be written.
    """
    document = {"schema": SCHEMA, **asdict(done)}
    write_atomic(folder / DONE_FILE, json.dumps(document, indent=1).encode() + b"\n")


def load_done(folder: Path) -> Done | None:
    """What stands in ``done.json``; None where the mission is not whole, or of another version."""
    try:
        document = parse_json(folder / DONE_FILE)
    except InputError:
        return None
    if not isinstance(document, dict) or document.pop("schema", None) != SCHEMA:
        return None
    try:
        return Done(**{**document, "remarks": tuple(document["remarks"])})
    except (TypeError, KeyError):
        return None


def load_causes(path: Path) -> list[Cause]:
    """What the observer saw to be wrong in a mission, in order of time.

    Raises:
        InputError: the file cannot be read, or is not of causes.
    """
    found = parse_json(path)
    try:
        if not isinstance(found, list):
            raise ValueError("a list is expected")
        causes = [Cause(**one) for one in found]
        for cause in causes:
            if cause.kind not in ("I", "II") or not isinstance(cause.reason, str):
                raise ValueError(f"kind {cause.kind!r}, reason {cause.reason!r}")
            _ = float(cause.start), float(cause.end)
    except (TypeError, ValueError) as error:
        raise InputError(f"not the causes of a mission: {error}", path) from error
    return causes


@dataclass(frozen=True)
class State:
    """How far a mission is: ``planned``, ``done`` or ``failed``, and why it failed."""

    flight: Flight
    done: Done | None
    error: str = ""

    @property
    def word(self) -> str:
        """In one word."""
        return "failed" if self.error else "planned" if self.done is None else "done"

    def to_json(self) -> dict[str, Any]:
        """The object in study.json."""
        treatment = self.flight.treatment
        return {
            "folder": self.flight.label,
            "system": self.flight.example.name,
            "treatment": treatment.name,
            "type": treatment.type,
            "parameter": treatment.parameter,
            "node": treatment.node,
            "old": treatment.old,
            "new": treatment.new,
            "tipping": treatment.tipping,
            "round": treatment.round,
            "seed": self.flight.seed,
            "half": self.flight.half,
            "state": self.word,
            "rate": None if self.done is None else self.done.rate,
            "remarks": [] if self.done is None else list(self.done.remarks),
            "error": self.error,
        }


@dataclass
class StudyFile:
    """Keeps ``study.json`` up to date, with all missions of all systems."""

    out: Path
    versions: Mapping[str, str]
    errors: dict[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, out: Path, versions: Mapping[str, str]) -> StudyFile:
        """With the errors of what failed in an earlier run and was not flown since."""
        errors: dict[str, str] = {}
        try:
            document = parse_json(out / STUDY_FILE)
        except InputError:
            document = None
        if isinstance(document, dict):
            missions = (one for one in document.get("missions", []) if isinstance(one, dict))
            errors = {one["folder"]: one["error"] for one in missions if one.get("error")}
        return cls(out, versions, errors)

    def save(self, examples: Sequence[Example] = EXAMPLES) -> None:
        """Write it.

        Raises:
            InputError: a treatment cannot be read.
            TpcError: it cannot be written.
        """
        states = [
            State(flight, load_done(flight.folder(self.out)), self.errors.get(flight.label, ""))
            for example in examples
            for flight in flights_of(example)
        ]
        document = {
            "schema": SCHEMA,
            "versions": dict(self.versions),
            "seeds": list(SEEDS),
            "systems": [
                {"name": one.name, "title": one.title, "rate": one.study_rate} for one in examples
            ],
            "missions": [state.to_json() for state in states],
        }
        write_atomic(self.out / STUDY_FILE, json.dumps(document, indent=1).encode() + b"\n")
