"""What a value of a parameter would have changed in a recorded run, before the robot is touched."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.words import Number


@dataclass(frozen=True, slots=True)
class WhatIf:
    """The recorded comparisons of one parameter, replayed with another value.

    ``marks`` marks were looked at (those of the type that the question is about), ``answered`` of
    them would have been answered: type I, the last flop before the mark would not have happened;
    type II, an evaluation in the window would have gone the other way. ``evaluations`` of the
    parameter's TPCs were replayed. ``flipped_near`` of them have another outcome within a window
    before a mark, ``flipped_away`` elsewhere: the decisions that were right as far as anybody said.
    ``text`` is the sentence to show, ``caveats`` what the replay could not know.
    """

    parameter: str
    value: Number
    marks: int
    answered: int
    evaluations: int
    flipped_near: int
    flipped_away: int
    text: str
    caveats: tuple[str, ...]
