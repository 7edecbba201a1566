"""The settings of a diagnosis, as one object that every verb takes."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

from pytpc.diagnosis.results.differences import RunDifferences
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark, MarkType
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change

WINDOW_S = 12.0
"""The window of type II, in seconds."""

Types = Literal["believe", "doubt", "ignore"]
"""How far the observer's types of the marks are believed, see `mark_ranking`."""

Source = Literal["reference", "default", "declared"]
"""Who says that a value is good."""

EVERY_SOURCE: frozenset[Source] = frozenset(get_args(Source))


@dataclass(frozen=True, slots=True)
class Question:
    """What to find out about a mission.

    Each verb uses the settings that concern it; a setting means the same everywhere.

    Attributes:
        types: how far the types of the marks are believed.
        window_s: the window of type II, and how long before a mark counts as near to it, in
            seconds.
        top: for how many suspects a value is suggested.
        references: good runs of the same build, the last one last.
        others: runs of the same build of which nobody says that they went right. A value that one
            of them had may be wrong, too; what another value would have changed is replayed.
        differences: what differs from these runs, as far as that is known.
        changes: what was changed since the robot worked, newest last; empty if not known. If a
            parameter was changed several times, the oldest change has the value that worked.
        declared: ranges, types and defaults that parameters are declared with; None: nobody has
            looked for any.
        flown: values of the parameter in question that were tried and did not help.
        sources: which known values may be suggested.
        kind: the type of error that a replay is about; None: of each mark its own.
        marks: the marks that a replay looks at; None: the mission's marks of ``kind`` or without a
            type.

    Raises:
        ValueError: ``types`` is not one of `Types`, or ``window_s`` is negative.
    """

    types: Types = "believe"
    window_s: float = WINDOW_S
    top: int = 5
    references: Sequence[Recording] = ()
    others: Sequence[Recording] = ()
    differences: RunDifferences | None = None
    changes: Sequence[Change] = ()
    declared: Sequence[Declared] | None = None
    flown: Sequence[float] = ()
    sources: Collection[Source] = EVERY_SOURCE
    kind: MarkType | None = None
    marks: Sequence[Mark] | None = None

    def __post_init__(self) -> None:
        """Check the values."""
        if self.types not in get_args(Types):
            raise ValueError(f"types is {self.types!r}, not one of {', '.join(get_args(Types))}")
        if not self.window_s >= 0:
            raise ValueError("window_s is negative")

    @property
    def reference(self) -> Recording | None:
        """The last good run, whose values are suggested."""
        return self.references[-1] if self.references else None

    def about(self, declared: Declared | None) -> Question:
        """The question about one parameter, with only its own declaration."""
        return replace(self, declared=() if declared is None else (declared,))

    @property
    def declaration(self) -> Declared | None:
        """The declaration of the parameter in question, see ``about``.

        Raises:
            ValueError: there are several.
        """
        declared = self.declared or ()
        if len(declared) > 1:
            raise ValueError("more is declared than of one parameter")
        return declared[0] if declared else None


PLAIN = Question()
"""The default of every setting."""
