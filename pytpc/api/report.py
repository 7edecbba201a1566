"""The report page: diagnoses missions, and lets `pytpc.present.page` show the answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import count
from pathlib import Path

from pytpc.api.diagnosing import Rankings
from pytpc.api.missions import Source
from pytpc.base.atomic import write_atomic
from pytpc.diagnosis.diagnose import diagnose_mission
from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.diagnosis.suggestion.whole_mission import answer_mission
from pytpc.present.page.html import page_text
from pytpc.present.page.reported_mission import ReportedMission
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import KnownChange, read_known_change
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
    to the robot, and ``changed_parameter`` which parameter was changed; only a study knows that.
    ``origins`` are where the values came from. ``source`` is the path of the mission that commands
    on the page name; None if it has none. ``diagnosed`` is the answer by all marks, if somebody has
    worked it out; the page lists at least as many suspects as `rank` does.
    """

    name: str
    recording: Recording
    static_info: StaticInfo
    rankings: Sequence[MarkRanking]
    treatment: str = ""
    changed_parameter: str | None = None
    origins: Mapping[str, Origin] = field(default_factory=dict)
    question: Question = CARDS_ALONE
    source: Path | None = None
    diagnosed: Diagnosis | None = None

    @cached_property
    def diagnosis(self) -> Diagnosis | None:
        """What all marks say together; None without a mark."""
        if not self.rankings:
            return None
        if self.diagnosed is not None:
            return self.diagnosed
        asked = replace(self.question, top=max(self.question.top, PLAIN.top))
        return diagnose_mission(self.recording, self.static_info, asked)

    @property
    def figures(self) -> int:
        """How many figures are made of it: the whole mission, the first suspect, and each card."""
        top = self.question.top
        cards = sum(len(ranking.suspects[:top]) for ranking in self.rankings)
        return cards + (2 if self.rankings else 1)

    def answered(self) -> ReportedMission:
        """The mission with its diagnosis, as the page takes it."""
        return ReportedMission(
            self.name,
            self.recording,
            self.static_info,
            answer_mission(
                self.recording, self.static_info, self.rankings, self.question, self.diagnosis
            ),
            self.treatment,
            self.changed_parameter,
            self.origins,
            self.source,
        )


def report_of(
    rankings: Rankings,
    *,
    top: int = CARDS,
    with_treatment: bool = False,
    diagnosed: Diagnosis | None = None,
) -> MissionReport:
    """A ranked mission for the page; its folder says where values came from (origins.json).

    Args:
        rankings: of the mission.
        top: how many suspects of a mark are shown with their evidence.
        with_treatment: also show what a study did to the robot (treatment.json), and mark the
            parameter that it changed.
        diagnosed: the answer by all marks, if it was worked out before.

    Raises:
        InputError: a file of the folder is there and cannot be read.
    """
    source, recording = rankings.source, rankings.recording
    given = MissionReport(
        recording.name,
        recording,
        rankings.static_info,
        rankings.rankings,
        question=replace(rankings.question, top=top, declared=rankings.declared),
        diagnosed=diagnosed,
    )
    if source is None:
        return given
    # The bags of all missions may have the same name, but not their folders.
    name = source.absolute().name if source.is_dir() else recording.name
    done = read_known_change(source) if with_treatment else KnownChange()
    return replace(
        given,
        name=name,
        origins=read_origins(source),
        treatment=done.effect,
        changed_parameter=done.parameter,
        source=source.absolute(),
    )


def write_report(
    path: Source, *rankings: Rankings, title: str = TITLE, with_treatment: bool = False
) -> Path:
    """Write the report page of one or several missions: one HTML file that opens offline.

    For a mission that was ranked by its path, the page also shows where its values were set.

    Args:
        path: the HTML file.
        *rankings: one for each mission.
        title: its heading.
        with_treatment: see `report_of`.

    Returns:
        Its path.

    Raises:
        TpcError: it cannot be written.
    """
    reports = [report_of(one, with_treatment=with_treatment) for one in rankings]
    write_missions(Path(path), reports, title=title)
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
