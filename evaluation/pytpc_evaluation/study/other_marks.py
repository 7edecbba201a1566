"""The same observer's marks, had they come late, been fewer, of wrong types, or said more.

Each is made from the marks that one of the study's observers set.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from pytpc.recording.marks import MarkType, with_began
from pytpc_evaluation.study.data import Mission, UserMark

SPAN_S = 10.0
"""Who says when an error began names a span of this length."""

WRONG_SPANS = 0.1
"""The share of spans that are one span too early or too late."""

_OTHER: Mapping[MarkType, MarkType] = {"I": "II", "II": "I"}

Marks = Sequence[UserMark]


def _late(marks: Marks, seconds: float) -> list[UserMark]:
    return [replace(one, time_ns=one.time_ns + round(seconds * 1e9)) for one in marks]


def _of_other_types(marks: Marks) -> list[UserMark]:
    return [replace(one, right=_OTHER[one.right], said=_OTHER[one.said]) for one in marks]


def _with_began(marks: Marks, mission: Mission) -> list[UserMark]:
    """With a span in which the error of each mark began; a false alarm has none."""
    dice = random.Random(f"{mission.system} {mission.treatment} {mission.seed}")
    return [_dated(one, mission, dice) for one in marks]


def _dated(one: UserMark, mission: Mission, dice: random.Random) -> UserMark:
    if not 0 <= one.cause < len(mission.causes):
        return one
    ago = one.time_ns / 1e9 - mission.causes[one.cause].start
    early = ago + dice.uniform(0.0, SPAN_S)
    if dice.random() < WRONG_SPANS:
        early += dice.choice((-SPAN_S, SPAN_S))
    return replace(one, note=with_began("", max(early, 0.0), max(early - SPAN_S, 0.0)))


VARIANTS: Mapping[str, tuple[str, Callable[[Marks, Mission], Marks]]] = {
    "own": ("as they are", lambda marks, _: marks),
    "own-began": ("and say when it began", _with_began),
    "late-15": ("15 s late", lambda marks, _: _late(marks, 15.0)),
    "late-30": ("30 s late", lambda marks, _: _late(marks, 30.0)),
    "late-30-began": (
        "30 s late, and say when it began",
        lambda marks, mission: _with_began(_late(marks, 30.0), mission),
    ),
    "first": ("only the first one", lambda marks, _: marks[:1]),
    "last": ("only the last one", lambda marks, _: marks[-1:]),
    "wrong-types": ("all of the wrong type", lambda marks, _: _of_other_types(marks)),
}
"""By name: in words, and how they are made of one observer's marks in order of time."""


def other_marks(mission: Mission, variant: str) -> list[Mission]:
    """The mission with the marks of each of its observers alone; those after its end are left out.

    If nobody marked it, it is there once, without marks.

    Args:
        mission: with its marks, sorted by time.
        variant: of ``VARIANTS``.
    """
    _, made = VARIANTS[variant]
    found = []
    for who in sorted({one.observer for one in mission.marks}) or [""]:
        own = [one for one in mission.marks if one.observer == who]
        kept = [m for m in made(own, mission) if m.time_ns <= mission.recording.end_ns]
        found.append(replace(mission, marks=tuple(kept)))
    return found
