"""What the report page says, as plain texts and numbers, before any HTML.

``mission_view`` turns a ``ReportedMission`` into what the template prints. It also draws the
figures, which takes most of the time, and calls ``on_figure`` after each.
"""

from __future__ import annotations

import math
import shlex
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from pytpc.base.wording import many
from pytpc.diagnosis.question import Types
from pytpc.diagnosis.results.mission_answer import MarkAnswer
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.present.page.cards import CardView, SuspectView, card_view, row_view
from pytpc.present.page.figure import PageFigures
from pytpc.present.page.margins import MarginsView, margins_view
from pytpc.present.page.payload import embedded, marks_json
from pytpc.present.page.reported_mission import ReportedMission
from pytpc.present.page.timeline import timeline
from pytpc.present.page.verdict import (
    DifferencesView,
    LeadView,
    VerdictView,
    differences_view,
    lead_view,
    verdict_view,
)
from pytpc.recording.marks import MarkType, short_note
from pytpc.static.parameters import base_key

ROWS = 8
"""How many suspects of a mark are listed before the reader asks for more."""


WHAT: dict[MarkType | None, str] = {
    "I": "it did something that it should not have",
    "II": "it should do something and does not",
    None: "something is wrong",
}


@dataclass(frozen=True)
class MarkView:
    """One mark with its suspects; ``scores`` says by which scores they are ranked."""

    ident: str
    number: int
    time: str
    type: str
    what: str
    observer: str
    note: str
    suspects: list[SuspectView]
    cards: list[CardView]
    more: int
    parameters: int
    reason: str
    scores: str
    changed: str | None


@dataclass(frozen=True)
class MissionView:
    """One mission; ``mark_command`` is how marks are added where there are none."""

    ident: str
    name: str
    treatment: str
    seconds: str
    window: str
    reports: str
    marks_i: int
    marks_ii: int
    marks_untyped: int
    verdict: VerdictView | None
    lead: LeadView | None
    differences: DifferencesView | None
    mark_command: str
    changed_parameter: str | None
    changed_positions: str
    timeline: Markup
    margins: MarginsView
    marks: list[MarkView]
    facts: list[tuple[str, str]]
    warnings: list[str]
    payload: Markup


def mission_view(
    mission: ReportedMission, number: int, on_figure: Callable[[], None]
) -> MissionView:
    """All that the page says about a mission; ``number`` makes its ids unique."""
    ident = f"m{number}"
    recording = mission.recording
    kinds = [mark.type for mark in recording.marks]
    drawn = PageFigures(mission)
    marks = [
        _mark_view(mission, answer, (ident, place), drawn, on_figure)
        for place, answer in enumerate(mission.answer.marks, start=1)
    ]
    lead = _lead_view(mission, ident, marks, drawn)
    if mission.answer.marks:
        on_figure()
    still, moving = timeline(mission, ident)
    on_figure()
    found, differing = mission.answer.diagnosis, mission.answer.differences
    return MissionView(
        ident=ident,
        name=mission.name,
        treatment=mission.treatment,
        seconds=f"{recording.seconds:.1f}",
        window=f"{mission.answer.question.window_s:g}",
        reports=f"{len(recording.events):,}",
        marks_i=kinds.count("I"),
        marks_ii=kinds.count("II"),
        marks_untyped=kinds.count(None),
        verdict=None if found is None else verdict_view(mission, found, _links(marks)),
        lead=lead,
        differences=None if differing is None else differences_view(differing),
        mark_command=_mark_command(mission),
        changed_parameter=mission.changed_parameter,
        changed_positions=_positions(mission),
        timeline=still,
        margins=margins_view(mission.answer),
        marks=marks,
        facts=_facts(mission),
        warnings=list(mission.answer.warnings),
        payload=embedded(
            {
                "seconds": recording.seconds,
                "marks": marks_json(
                    [(mission.seconds(mark.time_ns), mark.type) for mark in recording.marks]
                ),
                "series": drawn.series,
                "cards": drawn.cards,
                "timeline": moving,
            }
        ),
    )


def _lead_view(
    mission: ReportedMission, ident: str, marks: Sequence[MarkView], drawn: PageFigures
) -> LeadView | None:
    lead = mission.answer.lead
    if lead is None:
        return None
    cards = marks[lead.number - 1].cards
    links = [card.ident for card in cards if card.row.parameter == lead.accused.parameter]
    return lead_view(mission, lead, drawn, (f"{ident}-lead", links[0] if links else ""))


def _links(marks: Sequence[MarkView]) -> dict[str, str]:
    """The first card of each parameter that has one, by its place in the ranking of a mark."""
    found: dict[str, tuple[int, str]] = {}
    for mark in marks:
        for place, card in enumerate(mark.cards):
            known = found.get(card.row.parameter)
            if known is None or place < known[0]:
                found[card.row.parameter] = (place, card.ident)
    return {parameter: ident for parameter, (_, ident) in found.items()}


def _mark_command(mission: ReportedMission) -> str:
    source = mission.source
    if source is None or not str(source).isprintable():
        return "pytpc mark"
    return shlex.join(("pytpc", "mark", str(source)))


def spoken(texts: Sequence[str]) -> str:
    """Texts in their order, repetitions joined: ``1 (x4), 2``."""
    found: list[tuple[str, int]] = []
    for text in texts:
        count = found.pop()[1] + 1 if found and found[-1][0] == text else 1
        found.append((text, count))
    return ", ".join(text if count == 1 else f"{text} (x{count})" for text, count in found)


def _mark_view(
    mission: ReportedMission,
    answer: MarkAnswer,
    at: tuple[str, int],
    drawn: PageFigures,
    on_figure: Callable[[], None],
) -> MarkView:
    ranking = answer.ranking
    mark, ident = ranking.mark, f"{at[0]}-{at[1]}"
    cards = []
    for place, one in enumerate(answer.first, start=1):
        cards.append(card_view(mission, one, mark, drawn, f"{ident}-{place}"))
        on_figure()
    changed = mission.changed_parameter
    types = sorted({suspect.type for suspect in ranking.suspects})
    return MarkView(
        ident=ident,
        number=at[1],
        time=f"{mission.seconds(mark.time_ns):.1f}",
        type=mark.type or "",
        what=WHAT[mark.type],
        observer=mark.observer,
        note=short_note(mark.note),
        suspects=[
            row_view(mission, one) for one in (*(one.advice for one in answer.first), *answer.rest)
        ],
        cards=cards,
        more=max(0, len(ranking.suspects) - ROWS),
        parameters=ranking.parameters,
        reason=ranking.reason,
        scores=" and ".join(f"type {one}" for one in types),
        changed=None if changed is None else _position(ranking, changed),
    )


def _position(ranking: MarkRanking, parameter: str) -> str:
    position = ranking.position_of(parameter)
    return "not ranked" if position is None else str(position)


def _positions(mission: ReportedMission) -> str:
    """The changed parameter's positions at the marks, in order, repetitions joined."""
    if mission.changed_parameter is None:
        return ""
    positions = [ranking.position_of(mission.changed_parameter) for ranking in mission.rankings]
    return spoken(["-" if position is None else str(position) for position in positions])


_BELIEVED: dict[Types, str] = {
    "believe": "",
    "doubt": "doubted: suspects of the other type still compete",
    "ignore": "ignored: ranked by both scores combined",
}


def _facts(mission: ReportedMission) -> list[tuple[str, str]]:
    recording, static = mission.recording, mission.static_info
    events, summaries = recording.events, recording.summaries
    tables = (events, summaries)
    keys = {base_key(table.keys[code]) for table in tables for code in np.unique(table.key)}
    nodes = {table.nodes[code] for table in tables for code in np.unique(table.node)}
    known = {base_key(key) for key in static.thresholds}
    rate = len(events) / recording.seconds if recording.seconds > 0 else math.nan
    reports = f"{len(events):,} ({rate:.0f} per second)"
    if len(summaries):
        of = many(int(summaries.count.sum()), "evaluation")
        reports += f", and summaries of {of}"
    facts = [
        ("Length", f"{recording.seconds:.1f} s"),
        ("Reports", reports),
        ("Comparisons seen", f"{len(keys & known)} of {len(known)} found in the source"),
        ("Result changes", f"{int(events.flop.sum()):,}"),
        ("Reporting nodes", str(len(nodes))),
    ]
    believed = _BELIEVED[mission.answer.question.types]
    return [*facts, ("Types of the marks", believed)] if believed else facts
