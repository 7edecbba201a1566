"""What the report page is made from: one mission, ranked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.ranking import MarkRanking
from pytpc.recording.mission import Recording
from pytpc.static.parameters import same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import Origin

CARDS = 3
"""Suspects of a mark that are shown with their evidence."""

CARDS_ALONE = Question(top=CARDS)
"""What a page answers where nothing else is asked."""


@dataclass(frozen=True)
class MissionReport:
    """One mission for the page.

    ``rankings`` are ``rank_marks``' answer for ``recording`` and ``static_info``. ``treatment``
    says what was done to the robot, and ``changed_parameter`` which parameter was changed, where
    that is known (in a study); it is shown in red. ``origins`` are where the values came from.
    ``question`` is what the marks were ranked with; its ``top`` is how many suspects have a card.
    """

    name: str
    recording: Recording
    static_info: StaticInfo
    rankings: list[MarkRanking]
    treatment: str = ""
    changed_parameter: str | None = None
    origins: Mapping[str, Origin] = field(default_factory=dict)
    question: Question = CARDS_ALONE

    def is_changed(self, parameter: str) -> bool:
        """True where ``parameter``, as in the source, is the one that was changed."""
        changed = self.changed_parameter
        return changed is not None and same_parameter(changed, parameter)

    def seconds(self, time_ns: int) -> float:
        """A time of the recording's clock as seconds since the recording began."""
        return (time_ns - self.recording.start_ns) / 1e9
