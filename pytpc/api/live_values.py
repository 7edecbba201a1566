"""Changes of a value that somebody asks for on the page: shown first, made only as shown."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path

from pytpc.api import values
from pytpc.api.live_observers import Answer
from pytpc.base.errors import InputError, TpcError
from pytpc.base.wording import plain
from pytpc.values.apply import diff_of, shown

_MOST_PLANS = 20


@dataclass(frozen=True)
class Planned:
    """A change that is shown, and not made.

    Attributes:
        number: by which it is made.
        title: what changes, in one line.
        lines: its diff.
    """

    number: int
    title: str
    lines: tuple[str, ...]


class LiveValues:
    """Plans changes and makes them, on the robot that runs or in the file that a mission names.

    Args:
        graph: the address of the robot's graph; empty for a recording.
        recording: the recording, whose files are changed; None for a robot.
    """

    def __init__(self, graph: str, recording: Path | None) -> None:
        """Nothing is planned."""
        self._graph = graph
        self._recording = recording
        self._numbers = itertools.count(1)
        self._plans: dict[int, tuple[str, str, Planned]] = {}

    def plan(self, parameter: str, value: str) -> Planned:
        """What giving a parameter a value would change.

        Raises:
            TpcError: it cannot be changed.
        """
        title, lines = self._look(parameter, value)
        planned = Planned(next(self._numbers), title, lines)
        self._plans[planned.number] = parameter, value, planned
        while len(self._plans) > _MOST_PLANS:
            del self._plans[min(self._plans)]
        return planned

    def apply(self, number: int) -> Answer:
        """Make a change that was planned, if it still is what was shown."""
        if number not in self._plans:
            return Answer(False, "this change is not planned any more: look at it again")
        parameter, value, planned = self._plans.pop(number)
        try:
            if self._look(parameter, value) != (planned.title, planned.lines):
                return Answer(False, "the value has changed since: look at the change again")
            return Answer(True, self._make(parameter, value))
        except TpcError as error:
            return Answer(False, str(error))

    def _look(self, parameter: str, value: str) -> tuple[str, tuple[str, ...]]:
        if self._recording is None:
            found = values.apply_live(
                (parameter, value), values.journal(), graph=self._graph, dry_run=True
            )
            old, new = plain(shown(found.change.old)), plain(shown(found.change.new))
            name = plain(found.name)
            return f"{name} on the robot: {old} -> {new}", (f"-{name}: {old}", f"+{name}: {new}")
        change = values.plan(values.Place(self._recording), parameter, value)
        names = plain(", ".join(change.parameters))
        title = f"{plain(str(change.path))}:{change.lineno}: {names} -> {plain(shown(change.new))}"
        lines = diff_of(change).splitlines()
        return title, tuple(plain(line) for line in [*lines, *change.notes])

    def _make(self, parameter: str, value: str) -> str:
        journal = values.journal()
        if self._recording is None:
            done = values.apply_live((parameter, value), journal, graph=self._graph)
            taken = "the node uses it now" if done.taken else "the node may read it later"
            number = done.entry.number if done.entry is not None else 0
            said = f"{done.name} is {shown(done.holds)}: {taken}"
        else:
            change = values.plan(values.Place(self._recording), parameter, value)
            entry = values.apply(change, journal)
            if entry is None:
                raise InputError("has this value already", change.path, change.lineno)
            number, said = entry.number, f"written to {change.path}"
        return plain(f"{said}; to take it back: pytpc apply --undo {number}")
