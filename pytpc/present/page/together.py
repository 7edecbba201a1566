"""What all marks of a mission say together, in the words of the page."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pytpc.base.wording import percent
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.suggestion.blamed import advise_blamed
from pytpc.present.page.mission import MissionReport


@dataclass(frozen=True)
class TogetherView:
    """The verdict, the value to try of the first suspect, and the next ones with probabilities.

    ``remedy`` is empty where nobody is suspected or nothing can be suggested. ``notes`` say what
    keeps it from being surer.
    """

    title: str
    text: str
    sure: bool
    remedy: str
    others: list[str]
    notes: list[str]


def together(mission: MissionReport) -> TogetherView | None:
    """The verdict on a mission, None where it has no mark."""
    if not mission.rankings:
        return None
    recording, static, question = mission.recording, mission.static_info, mission.question
    found = blame(recording, static, question)
    advice = advise_blamed(found, recording, static, replace(question, top=1))
    return TogetherView(
        title=found.title,
        text=found.text,
        sure=found.accused is not None,
        remedy=next((one.remedy.text for one in advice if one.remedy.value is not None), ""),
        others=[
            f"{one.parameter} ({percent(one.probability)})"
            for one in found.suspects[1 : question.top]
        ],
        notes=list(found.notes),
    )
