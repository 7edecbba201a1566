"""What is asked of a mission: the settings that every verb of the diagnosis takes as one object."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark, MarkType
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change

WINDOW_S = 12.0
"""The window of type II, in seconds."""

Types = Literal["believe", "doubt", "ignore"]
"""How far the observer's types of the marks are believed, see `mark_ranking`."""

Source = Literal["reference", "default", "declared"]
"""Who says of a value that it is good."""

EVERY_SOURCE: frozenset[Source] = frozenset(get_args(Source))


@dataclass(frozen=True, slots=True)
class Question:
    """What is asked of a mission, beside its log and the static information.

    A verb takes from it what concerns it; each setting means the same to all of them.

    Attributes:
        types: how far the types of the marks are believed.
        window_s: the window of type II, and how long before a mark counts as near to it, in
            seconds.
        top: for how many suspects a value is suggested.
        reference: a good run of the same build.
        changes: what was changed since the robot went right, newest last; empty where that is not
            known. Of several changes of one parameter the oldest has the value that was right.
        declared: ranges, types and defaults that are declared of parameters.
        flown: values of the one parameter that is asked about that did not help.
        sources: which known values may be suggested.
        kind: the type of error that a replay is about; None: of each mark its own.
        marks: the marks that a replay looks at; None: those of the mission that are of ``kind`` or
            have no type.

    Raises:
        ValueError: ``types`` is none of `Types`, or ``window_s`` is negative.
    """

    types: Types = "believe"
    window_s: float = WINDOW_S
    top: int = 5
    reference: Recording | None = None
    changes: Sequence[Change] = ()
    declared: Sequence[Declared] = ()
    flown: Sequence[float] = ()
    sources: Collection[Source] = EVERY_SOURCE
    kind: MarkType | None = None
    marks: Sequence[Mark] | None = None

    def __post_init__(self) -> None:
        """Check what a type cannot say."""
        if self.types not in get_args(Types):
            raise ValueError(f"types is {self.types!r}, not one of {', '.join(get_args(Types))}")
        if not self.window_s >= 0:
            raise ValueError("window_s is negative")

    def about(self, declared: Declared | None) -> Question:
        """The same about one parameter, of which only this is declared."""
        return replace(self, declared=() if declared is None else (declared,))

    @property
    def declaration(self) -> Declared | None:
        """What is declared of the one parameter that is asked about.

        Raises:
            ValueError: something else is declared, too; see ``about``.
        """
        if len(self.declared) > 1:
            raise ValueError("more is declared than of one parameter")
        return self.declared[0] if self.declared else None

    def replayed(self, kind: MarkType | None, marks: Sequence[Mark]) -> Question:
        """The same about these marks."""
        return replace(self, kind=kind, marks=marks)


PLAIN = Question()
"""The default of every setting."""
