"""The report page: diagnoses missions, and lets `pytpc.present.page` show the answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from pathlib import Path

from pytpc.api.diagnosing import Rankings
from pytpc.api.missions import Source
from pytpc.base.atomic import write_atomic
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.diagnosis.suggestion.whole_mission import answer_mission
from pytpc.present.page.html import page_text
from pytpc.present.page.reported_mission import ReportedMission
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import read_known_change
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import Origin, read_origins

Progress = Callable[[int, int], None]
TITLE = "Suspected parameters"
CARDS = 3
"""Suspects of a mark that are shown with their evidence."""

CARDS_ALONE = Question(top=CARDS)
"""The question of a page without settings."""


@dataclass(frozen=True)
class MissionReport:
    """One mission to report on.

    ``rankings`` are the answer of ``rank_marks`` for ``recording``, ``static_info`` and
    ``question``, whose ``top`` is how many suspects have a card. ``treatment`` says what was done
    to the robot, and ``changed_parameter`` which parameter was changed, if that is known (in a
    study). ``origins`` are where the values came from.
    """

    name: str
    recording: Recording
    static_info: StaticInfo
    rankings: Sequence[MarkRanking]
    treatment: str = ""
    changed_parameter: str | None = None
    origins: Mapping[str, Origin] = field(default_factory=dict)
    question: Question = CARDS_ALONE

    @property
    def figures(self) -> int:
        """How many figures the page has of it: one of the whole mission, and one for each card."""
        top = self.question.top
        return 1 + sum(len(ranking.suspects[:top]) for ranking in self.rankings)

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


def report_of(rankings: Rankings, *, top: int = CARDS) -> MissionReport:
    """A ranked mission for the page.

    Its folder says where values came from (origins.json), and what was done to the robot
    (treatment.json).
    """
    source, recording = rankings.source, rankings.recording
    given = MissionReport(
        recording.name,
        recording,
        rankings.static_info,
        rankings.rankings,
        question=replace(rankings.question, top=top, declared=rankings.declared),
    )
    if source is None:
        return given
    # The bags of all missions may have the same name, but not their folders.
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

    For a mission that was ranked by its path, the page shows the rest of its folder, too.

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
    """Diagnose the missions and write the page, atomically. The same missions make the same bytes.

    Args:
        path: the HTML file.
        missions: in the order of the page. Only what the page shows of each is kept.
        title: its heading.
        on_progress: called with (figures made, figures in all); a figure takes a tenth of a second.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    total = sum(mission.figures for mission in missions)
    made = count(1)

    def figure_made() -> None:
        number = next(made)
        if on_progress is not None:
            on_progress(number, total)

    text = page_text((mission.answered() for mission in missions), title, figure_made)
    write_atomic(path, text.encode("utf-8", "replace"))
