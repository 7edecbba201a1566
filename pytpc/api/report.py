"""The report page: missions are diagnosed here, and `pytpc.present.page` shows the answers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.diagnosis.suggestion.whole_mission import answer_mission
from pytpc.present.page.html import Progress, write_page
from pytpc.present.page.mission import ReportedMission
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import Origin

CARDS = 3
"""Suspects of a mark that are shown with their evidence."""

CARDS_ALONE = Question(top=CARDS)
"""What a page answers where nothing else is asked."""


@dataclass(frozen=True)
class MissionReport:
    """One mission to report on.

    ``rankings`` are ``rank_marks``' answer for ``recording`` and ``static_info``. ``treatment``
    says what was done to the robot, and ``changed_parameter`` which parameter was changed, where
    that is known (in a study). ``origins`` are where the values came from. ``question`` is what the
    marks were ranked with; its ``top`` is how many suspects have a card.
    """

    name: str
    recording: Recording
    static_info: StaticInfo
    rankings: Sequence[MarkRanking]
    treatment: str = ""
    changed_parameter: str | None = None
    origins: Mapping[str, Origin] = field(default_factory=dict)
    question: Question = CARDS_ALONE

    def answered(self) -> ReportedMission:
        """The mission with its diagnosis, as the page takes it."""
        return ReportedMission(
            self.name,
            self.recording,
            self.static_info,
            answer_mission(self.recording, self.static_info, self.rankings, self.question),
            self.treatment,
            self.changed_parameter,
            self.origins,
        )


def write_report(
    path: Path,
    missions: Sequence[MissionReport],
    *,
    title: str = "Suspected parameters",
    on_progress: Progress | None = None,
) -> None:
    """Diagnose the missions and write the page, atomically; see `write_page`.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    write_page(
        path, [mission.answered() for mission in missions], title=title, on_progress=on_progress
    )
