"""The report page: missions are diagnosed here, and `pytpc.present.page` shows the answers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from pytpc.api.mark_rankings import Rankings
from pytpc.api.missions import Source
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.diagnosis.suggestion.whole_mission import answer_mission
from pytpc.present.page.html import Progress, write_page
from pytpc.present.page.reported_mission import ReportedMission
from pytpc.recording.declaration import Declared
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import read_known_change
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import Origin, read_origins

TITLE = "Suspected parameters"
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


def report_of(
    rankings: Rankings, *, top: int = CARDS, declared: Sequence[Declared] | None = None
) -> MissionReport:
    """A ranked mission for the page, with what its folder says of it.

    That is where values came from (origins.json), and what had been done to the robot
    (treatment.json). ``declared`` are the declared ranges of parameters; None: they are looked for
    in the sources.
    """
    source, recording = rankings.source, rankings.recording
    about = rankings.declared if declared is None else declared
    given = MissionReport(
        recording.name,
        recording,
        rankings.static_info,
        rankings.rankings,
        question=replace(rankings.question, top=top, declared=about),
    )
    if source is None:
        return given
    # The bags of all missions may have the same name, their folders have not.
    name = source.absolute().name if source.is_dir() else recording.name
    done = read_known_change(source)
    return replace(
        given,
        name=name,
        origins=read_origins(source),
        treatment=done.effect,
        changed_parameter=done.parameter,
    )


def write_report(path: Source, *rankings: Rankings, title: str = TITLE) -> Path:
    """Write the report page of one or several missions: one HTML file that opens offline.

    A mission that was ranked by its path is shown with what else is in its folder.

    Returns:
        Its path.

    Raises:
        TpcError: it cannot be written.
    """
    write_missions(Path(path), [report_of(one) for one in rankings], title=title)
    return Path(path)


def write_missions(
    path: Path,
    missions: Sequence[MissionReport],
    *,
    title: str = TITLE,
    on_progress: Progress | None = None,
) -> None:
    """Diagnose the missions and write the page, atomically; see `write_page`.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    write_page(
        path, [mission.answered() for mission in missions], title=title, on_progress=on_progress
    )
