"""Treatments: what was done to a robot before a mission, as in the thesis's studies.

A treatment is a folder with ``params.yaml``, loaded over the robot's own parameters, and
``treatment.json``, which says what it changes and what comes of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.recording.marks import MarkType

TREATMENT_FILE = "treatment.json"
OVERLAY_FILE = "params.yaml"

TreatmentType = Literal["clean", "type1", "type2", "fault"]
_MARK_TYPES: Mapping[str, MarkType] = {"type1": "I", "type2": "II"}
_FIELDS = ("name", "type", "parameter", "node", "old", "new", "launch", "effect")
_TIPPING, _ROUND = "tipping", "round"


@dataclass(frozen=True, slots=True)
class Treatment:
    """One treatment.

    ``parameter`` is the changed one, by the name that the source reads it by (its namespace may be
    left out), ``node`` whose it is,
    ``old`` and ``new`` its values; all None where no parameter is changed. ``launch`` are arguments
    for the launch file, ``overlay`` is the file with the parameters, ``effect`` a sentence.
    ``tipping`` is the value at which the behaviour tips, None where it was not searched for.
    ``round`` counts the rounds of the study: in which it was added.
    """

    name: str
    type: TreatmentType
    parameter: str | None
    node: str | None
    old: float | None
    new: float | None
    launch: dict[str, str]
    effect: str
    overlay: Path
    tipping: float | None = None
    round: int = 1

    @property
    def mark_type(self) -> MarkType | None:
        """The type of the marks that an observer who sees rightly sets; None for no error."""
        return _MARK_TYPES.get(self.type)

    @property
    def change(self) -> str:
        """``~min_coverage_limit 0.035 -> 0.062``, or a dash."""
        if self.parameter is None:
            return "-"
        return f"{self.parameter} {self.old:g} -> {self.new:g}"


def load_treatment(folder: Path) -> Treatment:
    """Read a treatment's folder.

    Raises:
        InputError: a file is missing, is no JSON, or a field is missing or wrong.
    """
    path = folder / TREATMENT_FILE
    document = parse_json(path)
    overlay = folder / OVERLAY_FILE
    if not overlay.is_file():
        raise InputError("no such file; every treatment has one", overlay)
    try:
        return _treatment(document, overlay)
    except ValueError as error:
        raise InputError(f"not a treatment: {error}", path) from error


def save_treatment(treatment: Treatment, mission: Path) -> None:
    """Copy what was done into a mission's folder, for those who read the mission later.

    Raises:
        InputError: the treatment's file can no longer be read.
        TpcError: the copy cannot be written.
    """
    path = treatment.overlay.with_name(TREATMENT_FILE)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", path) from error
    write_atomic(mission / TREATMENT_FILE, data)


def _treatment(document: object, overlay: Path) -> Treatment:
    optional = {_TIPPING, _ROUND}
    if not isinstance(document, dict) or sorted({*document} - optional) != sorted(_FIELDS):
        fields = ", ".join(_FIELDS)
        may = " and ".join(sorted(optional))
        raise ValueError(f"it has to have exactly the fields {fields}, and may have {may}")
    kind = document["type"]
    if kind not in get_args(TreatmentType):
        raise ValueError(f"type is {kind!r}, not one of {', '.join(get_args(TreatmentType))}")
    texts = ("name", "effect", *(() if document["parameter"] is None else ("parameter", "node")))
    for field in texts:
        if not isinstance(document[field], str):
            raise ValueError(f"{field} is not a text")
    changed = document["parameter"] is not None
    if changed != (kind in _MARK_TYPES):
        raise ValueError(f"type {kind} has {'no ' if changed else 'a '}changed parameter")
    for field in ("old", "new"):
        if _is_number(document[field]) != changed:
            raise ValueError(f"{field} is not {'a number' if changed else 'null'}")
    if document.get(_TIPPING) is not None and not (changed and _is_number(document[_TIPPING])):
        raise ValueError(f"{_TIPPING} is not {'a number or ' if changed else ''}null")
    number = document.get(_ROUND, 1)
    if not isinstance(number, int) or isinstance(number, bool) or number < 1:
        raise ValueError(f"{_ROUND} is not a whole number from 1")
    launch = document["launch"]
    if not isinstance(launch, dict) or not all(isinstance(v, str) for v in launch.values()):
        raise ValueError("launch is not an object of texts")
    return Treatment(**{**document, "overlay": overlay})


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
