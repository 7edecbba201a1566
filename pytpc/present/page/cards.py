"""A suspect at a mark as plain texts and numbers, before any HTML: its row and its card."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from pytpc.base.wording import exact, show
from pytpc.diagnosis.results.advice import Advice, Suggestion, SuspectAnswer, WhatIf
from pytpc.diagnosis.results.suspects import Suspect
from pytpc.present.as_json import finite
from pytpc.present.page.payload import series_of
from pytpc.present.page.plots import EvidenceStyle, evidence_svg, value_span
from pytpc.present.page.reported_mission import ReportedMission
from pytpc.present.page.series import PlotData, plot_data
from pytpc.present.page.source import LONGEST_LINE, Line, StepView, source_lines, way_of
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark
from pytpc.static.link_unit import Comparison
from pytpc.values.origins import Origin, origin_for


@dataclass(frozen=True)
class SuspectView:
    """A suspect at a mark, as a row of the ranking."""

    position: str
    parameter: str
    culprit: bool
    current: str
    value: str
    direction: str
    suggestion: str
    impossible: bool
    bound: str
    limited: str
    place: str
    condition: str
    relation: str
    type: str
    score: str
    scored: str
    rank: str
    order: Mapping[str, float | int | str]


@dataclass(frozen=True)
class LeadView:
    """What to do with a suspect: the value to try, or the reason why there is none.

    ``smallest`` is the smallest change at this mark in words, if it is another value.
    """

    direction: str
    current: str
    value: str
    reason: str
    smallest: str


@dataclass(frozen=True)
class CardView:
    """A suspect at a mark with its evidence; ``ident`` names its figure."""

    ident: str
    row: SuspectView
    lead: LeadView
    why: str
    compared: str
    threshold: str
    result: str
    age: str
    node: str
    unit: str
    exposed: str
    others: int
    limit_name: str
    kept: bool
    plot: Markup
    alone: str
    source: list[Line]
    source_note: str
    way: list[StepView]
    origin: Origin | None
    declared: str
    declared_at: str
    what_if: WhatIf | None
    alternatives: list[tuple[str, str]]


class PageFigures:
    """The data of one mission's figures for the page's script: cards, and series by TPC."""

    def __init__(self, mission: ReportedMission) -> None:
        self._mission = mission
        self._numbers: dict[str, int] = {}
        self.series: list[dict[str, object]] = []
        self.cards: dict[str, dict[str, object]] = {}

    def add(self, ident: str, key: str, card: dict[str, object]) -> None:
        """Add a card's figure, and the evaluations of its TPC if they are new."""
        if key not in self._numbers:
            self._numbers[key] = len(self.series)
            self.series.append(series_of(self._mission.recording, key))
        self.cards[ident] = {**card, "series": self._numbers[key]}


def row_view(mission: ReportedMission, advice: Advice, *, mixed: bool = False) -> SuspectView:
    """The row of a suspect; ``mixed`` says that the ranking has scores of both types."""
    suspect, suggestion = advice.suspect, advice.suggestion
    found = suspect.comparison
    current = suggestion.current if suggestion.current is not None else suspect.last.thresh
    place = f"{found.file}:{found.lineno}"
    return SuspectView(
        position=f"{suspect.position}{'=' if suspect.tied else ''}",
        parameter=suspect.parameter,
        culprit=mission.is_changed(suspect.parameter),
        current=show(current),
        value=exact(suggestion.value) if suggestion.value is not None else "",
        direction=suggestion.direction or "",
        suggestion=suggestion.text,
        impossible=suggestion.direction is None,
        bound=_bound(suggestion),
        limited=suggestion.limited_by,
        place=place,
        condition=(found.source_code or "").strip()[:LONGEST_LINE],
        relation=found.relation,
        type=suspect.type,
        score=f"{suspect.score:.3g}",
        # Scores of different types in one column cannot be compared.
        scored=suspect.type if mixed else "",
        rank=f"{suspect.rank:.2f}",
        order={
            "position": suspect.position,
            "parameter": suspect.parameter,
            "current": _sortable(float(current)),
            "place": f"{found.file}:{found.lineno:08d}",
            "score": _sortable(suspect.score),
            "rank": suspect.rank,
        },
    )


def card_view(
    mission: ReportedMission, answer: SuspectAnswer, mark: Mark, figures: PageFigures, ident: str
) -> CardView:
    """The card of a suspect at a mark; its figure is added to ``figures``."""
    advice = answer.advice
    suspect, declared = advice.suspect, advice.declared
    found, last = suspect.comparison, suspect.last
    unit = mission.static_info.unit_of(suspect.key)
    lines, note = source_lines(mission.static_info, found)
    data, style = _evidence(mission, answer, mark)
    label = (
        f"{suspect.parameter}: compared value and threshold around the mark at {style.mark:.1f} s;"
        f" {data.evaluations} evaluations, {data.flops.size} changes of the result"
    )
    figures.add(ident, suspect.key, _figure(data, style, suspect))
    return CardView(
        ident=ident,
        row=row_view(mission, advice),
        lead=_lead(advice),
        why=answer.why,
        compared=show(last.cmp),
        threshold=show(last.thresh),
        result="true" if last.result else "false",
        age=f"{(mark.time_ns - last.time_ns) / 1e9:.2f}",
        node=last.node,
        unit=f"{unit.package}/{unit.link_unit}",
        exposed=_exposed(found),
        others=len(suspect.keys) - 1,
        limit_name=found.name or suspect.parameter,
        kept=bool(data.kept.size),
        # Made of matplotlib's own XML, in which it escapes every text.
        plot=Markup(evidence_svg(data, style, ident, label)),
        alone=label,
        source=lines,
        source_note=note,
        way=way_of(found),
        origin=origin_for(mission.origins, suspect.parameter, last.node, found.default),
        declared=_declared(declared) if declared is not None else "",
        declared_at=declared.place if declared is not None else "",
        what_if=advice.what_if if advice.tried is None else advice.tried,
        alternatives=_alternatives(answer.others),
    )


def _lead(advice: Advice) -> LeadView:
    told, least = advice.told, advice.suggestion
    value = exact(told.value) if told.value is not None else ""
    why = told.text.partition(f" to {value} (")[2].removesuffix(")")
    return LeadView(
        direction=told.direction or "",
        current=show(told.current),
        value=value,
        reason=told.reason or why,
        smallest="" if least.value in {None, told.value} else least.text,
    )


def _evidence(
    mission: ReportedMission, answer: SuspectAnswer, mark: Mark
) -> tuple[PlotData, EvidenceStyle]:
    recording, suspect = mission.recording, answer.advice.suspect
    at = mission.seconds(mark.time_ns)
    style = EvidenceStyle(
        mark=at,
        mark_type=mark.type,
        window=at - mission.answer.question.window_s if suspect.type == "II" else None,
        suggested=answer.suggested,
        culprit=mission.is_changed(suspect.parameter),
        feasible=answer.feasible,
    )
    data = plot_data(recording, suspect.key, mark.time_ns)
    return data, style


def _figure(data: PlotData, style: EvidenceStyle, suspect: Suspect) -> dict[str, object]:
    low, high, beyond = value_span(data, style)
    return {
        "begin": data.begin,
        "end": data.end,
        "low": low,
        "high": high,
        "beyond": beyond,
        "mark": style.mark,
        "type": style.mark_type or "",
        "window": style.window,
        "suggested": finite(style.suggested),
        "feasible": [[finite(low), finite(high)] for low, high in style.feasible],
        "culprit": style.culprit,
        "kept": bool(data.kept.size),
        "flag": suspect.comparison.relation == "flag",
    }


def _bound(suggestion: Suggestion) -> str:
    """Which values would do: ``any value below 0.0527, or above 3``; empty for a switch."""
    if suggestion.direction == "switch" or not suggestion.feasible:
        return ""
    return f"any value {', or '.join(interval.words() for interval in suggestion.feasible)}"


def _exposed(found: Comparison) -> str:
    place = f"{found.exposed_at.file}:{found.exposed_at.lineno}"
    return f"{found.topic} ({place})" if found.topic else place


def _alternatives(others: Sequence[Advice]) -> list[tuple[str, str]]:
    """What the parameter's other comparisons suggest: sentence and place."""
    return [
        (
            f"{advice.suggestion.text}{f': {advice.what_if.text}' if advice.what_if else ''}",
            f"{advice.suspect.comparison.file}:{advice.suspect.comparison.lineno}",
        )
        for advice in others
    ]


def _declared(declared: Declared) -> str:
    """``double from 0 to 1, in steps of 0.1``; ``one of low (0), high (1)``."""
    if declared.choices:
        named = ", ".join(f"{name} ({value})" for name, value in declared.choices)
        return f"one of {named}"
    ends = [
        f"{word} {show(end)}"
        for word, end in (("from", declared.low), ("to", declared.high))
        if end is not None
    ]
    step = f", in steps of {show(declared.step)}" if declared.step is not None else ""
    return f"{' '.join([declared.type, *ends])}{step}"


def _sortable(value: float) -> float:
    """NaN sorts last, infinities at the ends; JSON and HTML have neither."""
    if math.isnan(value):
        return 1e308
    return max(-1e308, min(1e308, value))
