"""A change of a parameter on the robot, as it is known beside a recorded mission."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Change:
    """A parameter that was changed on the robot, by the name that its node reads it by."""

    parameter: str
    node: str
    old: float
    new: float
