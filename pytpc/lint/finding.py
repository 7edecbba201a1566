"""One thing that is wrong with a robot's parameters, and the kinds of such things."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

Severity = Literal["error", "warning", "note"]
Kind = Literal[
    "unread",
    "unset",
    "set-twice",
    "type",
    "range",
    "limits",
    "degrees",
    "deprecated",
    "no-effect",
    "never-crossed",
]
SEVERITIES: tuple[Severity, ...] = ("error", "warning", "note")
"""The worst one first."""
KINDS: dict[Kind, str] = {
    "unread": "a value is set that no node reads",
    "unset": "a node needs a value that is not set, and has no default",
    "set-twice": "a value is set more than once",
    "type": "a value has another type than its node reads",
    "range": "a value is outside of the declared range",
    "limits": "limits contradict each other, as a minimum above its maximum",
    "degrees": "an angle seems to be in degrees where radians are read, or the other way round",
    "deprecated": "a name is set that its node calls deprecated",
    "no-effect": "a value was changed while the robot ran, and its node reads it only at its start",
    "never-crossed": "no recording was ever on the other side of a threshold",
}
"""The kinds of findings, and what each says."""


class Spot(NamedTuple):
    """A line of a file; 0 where only the file is known."""

    path: str
    lineno: int = 0

    def __str__(self) -> str:
        return f"{self.path}:{self.lineno}" if self.lineno else self.path


class Evidence(NamedTuple):
    """A second place, and what is there: ``read here``."""

    what: str
    spot: Spot


@dataclass(frozen=True, slots=True)
class Finding:
    """A finding: its place, the full name of the parameter, a sentence and further places."""

    kind: Kind
    severity: Severity
    spot: Spot
    parameter: str
    text: str
    evidence: tuple[Evidence, ...] = ()

    def order(self) -> tuple[str, int, str, str, str]:
        """Sorting by this puts findings of one file together, in the order of its lines."""
        return (self.spot.path, self.spot.lineno, self.kind, self.parameter, self.text)
