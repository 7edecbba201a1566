"""Changes on the robot that are known beside a recorded mission."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError

_FILE = "treatment.json"


@dataclass(frozen=True)
class Change:
    """A parameter that was changed on the robot, by the name that its node reads it by."""

    parameter: str
    node: str
    old: float
    new: float


@dataclass(frozen=True, slots=True)
class KnownChange:
    """A sentence about what was done, and the parameter that was changed, if one was."""

    effect: str = ""
    parameter: str | None = None


def read_known_change(mission: Path) -> KnownChange:
    """The change that the folder of ``mission``, or ``mission`` itself, tells of; may be empty.

    Raises:
        InputError: the file is no JSON, or one of the two fields is missing or wrong.
    """
    path = (mission if mission.is_dir() else mission.parent) / _FILE
    if not path.is_file():
        return KnownChange()
    document = parse_json(path)
    found = document if isinstance(document, dict) else {}
    effect, parameter = found.get("effect"), found.get("parameter", "")
    if not isinstance(effect, str) or parameter == "" or not isinstance(parameter, str | None):
        raise InputError("effect must be a text, and parameter a name or null", path)
    return KnownChange(effect, parameter)
