"""The verdict of all marks of a mission, in the words of the page."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.base.wording import percent
from pytpc.diagnosis.results.mission_answer import MissionAnswer


@dataclass(frozen=True)
class TogetherView:
    """The verdict, the value to try of the first suspect, and the next ones with probabilities.

    ``remedy`` is empty without a suspect or a suggestion. ``notes`` say what limits the verdict.
    """

    title: str
    text: str
    sure: bool
    remedy: str
    others: list[str]
    notes: list[str]


def together(answer: MissionAnswer) -> TogetherView | None:
    """The verdict on a mission, None where it has no mark."""
    found, first = answer.blame, answer.first
    if found is None:
        return None
    return TogetherView(
        title=found.title,
        text=found.text,
        sure=found.accused is not None,
        remedy="" if first is None or first.remedy.value is None else first.remedy.text,
        others=[
            f"{one.parameter} ({percent(one.probability)})"
            for one in found.suspects[1 : answer.question.top]
        ],
        notes=list(found.notes),
    )
