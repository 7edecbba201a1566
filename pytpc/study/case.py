"""What a method of ranking may see of a mission."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Change:
    """A parameter that was changed before a mission: whose it is, its values before and after."""

    parameter: str
    node: str
    old: float
    new: float
