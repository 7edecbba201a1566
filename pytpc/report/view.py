"""What the report page says, as plain texts and numbers, before any HTML.

``mission_view`` turns a ``MissionReport`` into what the template prints. The figures are made here
too, for they are the larger part of the time; ``on_figure`` is called after each.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from markupsafe import Markup

from pytpc.advice.suggest import Suggestion, suggest
from pytpc.arithmetic import evaluate
from pytpc.complaints import complaints
from pytpc.ingest.recording import Recording
from pytpc.marks import Mark, MarkType
from pytpc.parameters import same_parameter
from pytpc.report.plots import EvidenceStyle, Lane, evidence_svg, timeline_svg
from pytpc.report.series import evidence, lane
from pytpc.report.source import LONGEST_LINE, Line, StepView, source_lines, way_of
from pytpc.scoring.ranking import MarkRanking, Suspect
from pytpc.scoring.scores import WINDOW_S
from pytpc.static_info import Comparison, StaticInfo
from pytpc.words import exact, show

CARDS = 3
"""Suspects of a mark that are shown with their evidence."""

ROWS = 8
"""Suspects of a mark that are listed."""

_LANES = 8

WHAT: dict[MarkType | None, str] = {
    "I": "it did something that it should not have",
    "II": "it should do something and does not",
    None: "something is wrong",
}


@dataclass(frozen=True)
class MissionReport:
    """One mission for the page.

    ``rankings`` are ``rank_marks``' answer for ``recording`` and ``static_info``. ``treatment``
    says what was done to the robot, and ``changed_parameter`` which parameter was changed, where
    that is known (in a study); it is shown in red.
    """

    name: str
    recording: Recording
    static_info: StaticInfo
    rankings: list[MarkRanking]
    treatment: str = ""
    changed_parameter: str | None = None

    def is_changed(self, parameter: str) -> bool:
        """True where ``parameter``, as in the source, is the one that was changed."""
        changed = self.changed_parameter
        return changed is not None and same_parameter(changed, parameter)


@dataclass(frozen=True)
class SuspectView:
    """A suspect at a mark; ``plot``, ``source`` and ``way`` only for those with their evidence."""

    position: int
    parameter: str
    culprit: bool
    current: str
    value: str
    direction: str
    suggestion: str
    impossible: bool
    bound: str
    place: str
    condition: str
    relation: str
    type: str
    score: str
    rank: str
    compared: str
    threshold: str
    result: str
    age: str
    node: str
    unit: str
    exposed: str
    others: int
    plot: Markup
    source: list[Line]
    source_note: str
    way: list[StepView]


@dataclass(frozen=True)
class MarkView:
    """One mark with its suspects."""

    number: int
    time: str
    type: str
    what: str
    observer: str
    suspects: list[SuspectView]
    cards: list[SuspectView]
    more: int
    parameters: int
    changed: str | None


@dataclass(frozen=True)
class MissionView:
    """One mission; ``first`` are the first suspects at its first mark."""

    ident: str
    name: str
    treatment: str
    seconds: str
    reports: str
    marks_i: int
    marks_ii: int
    marks_untyped: int
    first: list[SuspectView]
    changed_parameter: str | None
    changed_positions: str
    timeline: Markup
    marks: list[MarkView]
    facts: list[tuple[str, str]]
    warnings: list[str]


def figures(mission: MissionReport) -> int:
    """How many figures ``mission_view`` makes."""
    return 1 + sum(min(CARDS, len(ranking.suspects)) for ranking in mission.rankings)


def mission_view(mission: MissionReport, number: int, on_figure: Callable[[], None]) -> MissionView:
    """All that the page says about a mission; ``number`` keeps its ids apart from the others'."""
    ident = f"m{number}"
    recording = mission.recording
    kinds = [mark.type for mark in recording.marks]
    marks = [
        _mark_view(mission, ranking, place, f"{ident}-{place}", on_figure)
        for place, ranking in enumerate(mission.rankings, start=1)
    ]
    timeline = _timeline(mission, ident)
    on_figure()
    return MissionView(
        ident=ident,
        name=mission.name,
        treatment=mission.treatment,
        seconds=f"{recording.seconds:.1f}",
        reports=f"{len(recording.events):,}",
        marks_i=kinds.count("I"),
        marks_ii=kinds.count("II"),
        marks_untyped=kinds.count(None),
        first=marks[0].suspects[:CARDS] if marks else [],
        changed_parameter=mission.changed_parameter,
        changed_positions=_positions(mission),
        timeline=timeline,
        marks=marks,
        facts=_facts(mission),
        warnings=list(complaints(recording, mission.static_info)),
    )


def _mark_view(
    mission: MissionReport,
    ranking: MarkRanking,
    number: int,
    ident: str,
    on_figure: Callable[[], None],
) -> MarkView:
    mark, recording = ranking.mark, mission.recording
    views = []
    for suspect in ranking.suspects[:ROWS]:
        plain = suspect.position > CARDS
        views.append(_suspect_view(mission, suspect, mark, None if plain else ident))
        if not plain:
            on_figure()
    changed = mission.changed_parameter
    return MarkView(
        number=number,
        time=f"{(mark.time_ns - recording.start_ns) / 1e9:.1f}",
        type=mark.type or "",
        what=WHAT[mark.type],
        observer=mark.observer,
        suspects=views,
        cards=views[:CARDS],
        more=len(ranking.suspects) - len(views),
        parameters=ranking.parameters,
        changed=None if changed is None else _position(ranking, changed),
    )


def _suspect_view(
    mission: MissionReport, suspect: Suspect, mark: Mark, ident: str | None
) -> SuspectView:
    found = suspect.comparison
    unit = mission.static_info.unit_of(suspect.key)
    events = mission.recording.events
    summaries = mission.recording.summaries
    advice = suggest(events, found, mark.time_ns, suspect.type, unit=unit, summaries=summaries)
    culprit = mission.is_changed(suspect.parameter)
    lines, note = source_lines(mission.static_info, found) if ident else ([], "")
    plot = _evidence(mission, suspect, mark, advice, ident) if ident else Markup("")
    return SuspectView(
        position=suspect.position,
        parameter=suspect.parameter,
        culprit=culprit,
        current=show(advice.current if advice.current is not None else suspect.last.thresh),
        value=exact(advice.value) if advice.value is not None else "",
        direction=advice.direction or "",
        suggestion=advice.text,
        impossible=advice.direction is None,
        bound=_bound(advice),
        place=f"{found.file}:{found.lineno}",
        condition=(found.source_code or "").strip()[:LONGEST_LINE],
        relation=found.relation,
        type=suspect.type,
        score=f"{suspect.score:.3g}",
        rank=f"{suspect.rank:.2f}",
        compared=show(suspect.last.cmp),
        threshold=show(suspect.last.thresh),
        result="true" if suspect.last.result else "false",
        age=f"{(mark.time_ns - suspect.last.time_ns) / 1e9:.2f}",
        node=suspect.last.node,
        unit=f"{unit.package}/{unit.link_unit}",
        exposed=_exposed(found),
        others=len(suspect.keys) - 1,
        plot=plot,
        source=lines,
        source_note=note,
        way=way_of(found) if ident else [],
    )


def _evidence(
    mission: MissionReport, suspect: Suspect, mark: Mark, advice: Suggestion, ident: str
) -> Markup:
    recording, found = mission.recording, suspect.comparison
    data = evidence(
        recording.events, suspect.key, mark.time_ns, recording.start_ns, recording.end_ns
    )
    at = (mark.time_ns - recording.start_ns) / 1e9
    style = EvidenceStyle(
        mark=at,
        mark_type=mark.type,
        window=at - WINDOW_S if suspect.type == "II" else None,
        suggested=_suggested_threshold(found, advice),
        value_name="compared value" if found.relation != "flag" else "flag",
        limit_name=found.name or suspect.parameter,
        culprit=mission.is_changed(suspect.parameter),
    )
    label = (
        f"{suspect.parameter}: compared value and threshold around the mark at {at:.1f} s;"
        f" {data.evaluations} evaluations, {data.flops.size} changes of the result"
    )
    # Made of matplotlib's own XML, in which it escapes every text.
    return Markup(evidence_svg(data, style, f"{ident}-{suspect.position}", label))


def _suggested_threshold(found: Comparison, advice: Suggestion) -> float | None:
    """The suggested value as it would be compared."""
    if advice.value is None or advice.direction == "switch":
        return None
    how = found.transform
    if how is not None and how.tree is not None:
        return evaluate(how.tree, float(advice.value))
    if how is None or how.scale is None or how.offset is None:
        return float(advice.value)
    return how.scale * float(advice.value) + how.offset


def _timeline(mission: MissionReport, ident: str) -> Markup:
    recording = mission.recording
    best: dict[str, tuple[int, str]] = {}
    for ranking in mission.rankings:
        for suspect in ranking.suspects:
            known = best.get(suspect.parameter)
            if known is None or suspect.position < known[0]:
                best[suspect.parameter] = (suspect.position, suspect.key)
    ranked = sorted(best, key=lambda name: (best[name][0], name))
    order = ranked[:_LANES]
    changed = next((name for name in ranked if mission.is_changed(name)), None)
    if changed is not None and changed not in order:
        order[-1] = changed
    lanes = [
        Lane(
            name,
            lane(recording.events, best[name][1], recording.start_ns, recording.end_ns),
            name == changed,
        )
        for name in order
    ]
    if not lanes:
        return Markup("")
    marks = [((mark.time_ns - recording.start_ns) / 1e9, mark.type) for mark in recording.marks]
    label = f"results of {len(lanes)} parameters over {recording.seconds:.0f} s, {len(marks)} marks"
    svg = timeline_svg(lanes, marks, recording.seconds, f"{ident}-t", label)
    return Markup(svg)


def _bound(advice: Suggestion) -> str:
    """The words in parentheses of the sentence; a switch has none."""
    _, found, rest = advice.text.rpartition(" (")
    return rest.rstrip(")") if found and advice.direction in {"raise", "lower"} else ""


def _exposed(found: Comparison) -> str:
    place = f"{found.exposed_at.file}:{found.exposed_at.lineno}"
    return f"{found.topic} ({place})" if found.topic else place


def _position(ranking: MarkRanking, parameter: str) -> str:
    position = ranking.position_of(parameter)
    return "not ranked" if position is None else str(position)


def _positions(mission: MissionReport) -> str:
    """The changed parameter's positions at the marks, in order, repetitions joined."""
    if mission.changed_parameter is None:
        return ""
    found: list[tuple[str, int]] = []
    for ranking in mission.rankings:
        text = ranking.position_of(mission.changed_parameter)
        shown = "-" if text is None else str(text)
        count = found.pop()[1] + 1 if found and found[-1][0] == shown else 1
        found.append((shown, count))
    return ", ".join(text if count == 1 else f"{text} (x{count})" for text, count in found)


def _facts(mission: MissionReport) -> list[tuple[str, str]]:
    recording, static = mission.recording, mission.static_info
    events = recording.events
    seen = sum(
        1
        for code, key in enumerate(events.keys)
        if key in static.thresholds and events.by_key.rows(code).size
    )
    rate = len(events) / recording.seconds if recording.seconds > 0 else math.nan
    return [
        ("Length", f"{recording.seconds:.1f} s"),
        ("Reports", f"{len(events):,} ({rate:.0f} per second)"),
        ("Comparisons seen", f"{seen} of {len(static.thresholds)} found in the source"),
        ("Changes of a result", f"{int(events.flop.sum()):,}"),
        ("Nodes that report", str(len(set(events.node.tolist())))),
    ]
