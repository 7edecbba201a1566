"""A value that is set on a running robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class LiveChange:
    """A value that is set on a running robot.

    ``old`` is None if it was not set. ``service`` is that of dynamic_reconfigure, empty
    where the node has none. ``nodes`` run in whose namespace the name is.
    """

    master: str
    name: str
    old: object
    new: object
    service: str
    nodes: tuple[str, ...]


class LiveRobot(Protocol):
    """A graph whose parameters can be set."""

    def parameters(self) -> list[str]:
        """The names of all parameters."""

    def values(self) -> dict[str, object]:
        """All parameters, by full names."""

    def value(self, name: str) -> object:
        """The value of a parameter, None where there is none."""

    def plan(self, name: str, given: str, *, force: bool = False) -> LiveChange:
        """Work out what to set; nothing is set."""

    def put(self, name: str, value: object, service: str) -> tuple[object, bool]:
        """Set a value; what holds then, and whether the node has taken it at once."""

    def take_back(self, name: str, old: object, service: str) -> None:
        """Set the value of before."""

    def close(self) -> None:
        """Leave the graph."""
