"""A suspect at a mark as plain texts and numbers, before any HTML: its row and its card."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pytpc.base.wording import exact, show
from pytpc.diagnosis.results.advice import Advice, Suggestion, WhatIf
from pytpc.diagnosis.results.mission_answer import SuspectAnswer
from pytpc.present.page.figure import FigureView, PageFigures, Wanted
from pytpc.present.page.reported_mission import ReportedMission
from pytpc.present.page.source import Line, StepView, source_lines, way_of
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark
from pytpc.static.across import across
from pytpc.static.link_unit import Comparison
from pytpc.values.origins import Origin, origin_for


@dataclass(frozen=True)
class SuspectView:
    """A suspect at a mark, as a row of the ranking."""

    position: str
    parameter: str
    changed: bool
    current: str
    value: str
    direction: str
    suggestion: str
    bound: str
    limited: str
    place: str
    relation: str
    type: str
    score: str
    rank: str
    order: Mapping[str, float | int | str]


@dataclass(frozen=True)
class CardView:
    """A suspect at a mark with its evidence; ``ident`` names it and its figure."""

    ident: str
    row: SuspectView
    why: str
    compared: str
    threshold: str
    result: str
    age: str
    node: str
    unit: str
    across: str
    processes: str
    exposed: str
    others: int
    distance: int
    figure: FigureView
    source: list[Line]
    source_note: str
    way: list[StepView]
    origin: Origin | None
    declared: str
    declared_at: str
    what_if: WhatIf | None
    alternatives: list[tuple[str, str]]


def row_view(mission: ReportedMission, advice: Advice) -> SuspectView:
    """The row of a suspect."""
    suspect, suggestion = advice.suspect, advice.suggestion
    found = suspect.comparison
    current = suggestion.current if suggestion.current is not None else suspect.last.thresh
    place = f"{found.file}:{found.lineno}"
    return SuspectView(
        position=f"{suspect.position}{'=' if suspect.tied else ''}",
        parameter=suspect.parameter,
        changed=mission.is_changed(suspect.parameter, suspect.key),
        current=show(current),
        value=exact(suggestion.value) if suggestion.value is not None else "",
        direction=suggestion.direction or "",
        suggestion=suggestion.text,
        bound=_bound(suggestion),
        limited=suggestion.limited_by,
        place=place,
        relation=found.relation,
        type=suspect.type,
        score=f"{suspect.score:.3g}",
        rank=f"{suspect.rank:.2f}",
        order={
            "position": suspect.position,
            "parameter": suspect.parameter,
            "current": _sortable(float(current)),
            "place": f"{found.file}:{found.lineno:08d}",
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
    least = advice.suggestion
    wanted = Wanted("smallest change", least.value, answer.suggested, answer.feasible)
    return CardView(
        ident=ident,
        row=row_view(mission, advice),
        why=answer.why,
        compared=show(last.cmp),
        threshold=show(last.thresh),
        result="true" if last.result else "false",
        age=f"{(mark.time_ns - last.time_ns) / 1e9:.2f}",
        node=last.node,
        unit=f"{unit.package}/{unit.link_unit}",
        across=across(found.path),
        processes=", ".join(found.processes or ()),
        exposed=_exposed(found),
        others=len(suspect.keys) - 1,
        distance=found.distance,
        figure=figures.draw(suspect, mark, wanted, declared, ident),
        source=lines,
        source_note=note,
        way=way_of(found),
        origin=origin_for(mission.origins, suspect.parameter, last.node, found.default),
        declared=declared_text(declared) if declared is not None else "",
        declared_at=declared.place if declared is not None else "",
        what_if=advice.what_if,
        alternatives=_alternatives(answer.others),
    )


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


def declared_text(declared: Declared) -> str:
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
