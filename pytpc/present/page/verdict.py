"""The top of a mission on the page: the verdict, what to try and where, and what differs.

All of it says what the `Diagnosis` says; nothing here decides anything.
"""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass

from pytpc.base.wording import exact, percent, shown_value
from pytpc.diagnosis.results.advice import BlamedAdvice
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.differences import Difference, RunDifferences
from pytpc.diagnosis.results.mission_answer import LeadAnswer
from pytpc.present.page.cards import declared_text
from pytpc.present.page.figure import FigureView, PageFigures, Wanted
from pytpc.present.page.reported_mission import ReportedMission
from pytpc.present.page.source import LONGEST_LINE
from pytpc.values.origins import Origin, origin_for
from pytpc.values.target import options_to_apply

DIFFERENCES = 8
"""So many differences are listed before the reader asks for more."""


@dataclass(frozen=True)
class SuspectLink:
    """A suspect of all marks together; ``link`` is its card's id, empty if it has none.

    ``value`` is what to try; empty if nothing is, and ``reason`` says why.
    """

    parameter: str
    changed: bool
    probability: str
    value: str
    reason: str
    link: str


@dataclass(frozen=True)
class VerdictView:
    """The verdict: the headline, and the action if there is one.

    The action is in two parts, what to do and ``why``. ``title`` says which marks were judged.
    ``suspects`` are those behind the accused one, or all if it is not ``sure``: then each may be
    the cause, and none is set above the others. ``folded`` counts those that are not listed.
    ``groups`` name those that turn as one. ``notes`` say what limits the verdict.
    """

    title: str
    headline: str
    sure: bool
    action: str
    why: str
    direction: str
    suspects: list[SuspectLink]
    folded: str
    groups: list[str]
    notes: list[str]


@dataclass(frozen=True)
class LeadView:
    """The evidence for the first suspect of the verdict at one mark.

    ``is_likeliest`` is False where "none of the parameters" is likelier. ``setting`` is where its
    value was set; None if that is not known, and ``unset`` says why. ``command`` writes the value
    to try there; empty if no file can be changed, or nothing is to be tried. ``followed`` says what
    other nodes did after its comparison turned.
    """

    parameter: str
    changed: bool
    probability: str
    is_likeliest: bool
    current: str
    number: int
    type: str
    why: str
    place: str
    condition: str
    reason: str
    replayed: str
    caveats: tuple[str, ...]
    declared: str
    declared_at: str
    setting: Origin | None
    unset: str
    command: str
    link: str
    figure: FigureView
    followed: tuple[str, ...] = ()


@dataclass(frozen=True)
class DifferenceView:
    """A parameter that differs from the good runs, as a row of a table."""

    parameter: str
    good: str
    bad: str
    place: str
    effect: str
    telling: bool


@dataclass(frozen=True)
class DifferencesView:
    """What differs from the good runs: ``first`` are listed, ``rest`` is folded."""

    title: str
    first: list[DifferenceView]
    rest: list[DifferenceView]
    notes: tuple[str, ...]


def verdict_view(
    mission: ReportedMission, found: Diagnosis, links: Mapping[str, str]
) -> VerdictView:
    """The verdict on a mission; ``links`` has the cards' ids by parameter."""
    first = found.to_try
    sure = found.accused is not None
    action, why = _in_two(found.action, "" if first is None else exact(first.remedy.value))
    return VerdictView(
        title=found.blame.title,
        headline=found.headline,
        sure=sure,
        action=action,
        why=why,
        direction=(first.remedy.direction or "") if first is not None else "",
        suspects=[
            _suspect_link(mission, one, links)
            for one in (found.next_suspects if sure else found.shown)
        ],
        folded=found.folded_text,
        groups=[one.sentence for one in found.groups],
        notes=list(found.blame.notes),
    )


def _in_two(action: str, value: str) -> tuple[str, str]:
    """``lower x from 3 to 2`` and ``(the default)``; the second part is empty if there is none."""
    told, to, why = action.partition(f" to {value} (")
    return (f"{told} to {value}", f"({why}") if to else (action, "")


def _suspect_link(
    mission: ReportedMission, one: BlamedAdvice, links: Mapping[str, str]
) -> SuspectLink:
    accused, told = one.accused, one.remedy
    value = "" if told.value is None else f"{told.direction} to {exact(told.value)}"
    return SuspectLink(
        parameter=accused.parameter,
        changed=mission.is_changed(accused.parameter, accused.key),
        probability=percent(accused.probability),
        value=value,
        reason=told.reason or "",
        link=links.get(accused.parameter, ""),
    )


def lead_view(
    mission: ReportedMission, lead: LeadAnswer, figures: PageFigures, ids: tuple[str, str]
) -> LeadView:
    """The evidence for the first suspect.

    Args:
        mission: the mission.
        lead: of its answer.
        figures: gets the figure.
        ids: of the figure, and of the suspect's card at this mark, which may be empty.
    """
    accused, told = lead.accused, lead.advised.remedy
    found, replayed = accused.comparison, lead.advised.what_if
    diagnosis = mission.answer.diagnosis
    to_try = diagnosis is not None and diagnosis.to_try is not None
    tried = (told.value, lead.suggested) if to_try else (None, None)
    wanted = Wanted("to try", *tried, lead.feasible)
    node = accused.last.node
    setting = origin_for(mission.origins, accused.parameter, node, found.default)
    declared = lead.declared
    return LeadView(
        parameter=accused.parameter,
        changed=mission.is_changed(accused.parameter, accused.key),
        probability=percent(accused.probability),
        is_likeliest=to_try,
        current=lead.advised.current,
        number=lead.number,
        type=accused.type,
        why=lead.why,
        place=f"{found.file}:{found.lineno}",
        condition=(found.source_code or "").strip()[:LONGEST_LINE],
        reason=told.reason or "",
        replayed="" if replayed is None or not to_try else replayed.text,
        caveats=() if replayed is None or not to_try else replayed.caveats,
        declared="" if declared is None else declared_text(declared),
        declared_at="" if declared is None else declared.place,
        setting=setting,
        unset="not known" if mission.origins else "not recorded; pytpc record writes it down",
        command=_command(mission, setting, lead.advised) if to_try else "",
        link=ids[1],
        figure=figures.draw(accused, lead.mark, wanted, declared, ids[0]),
        followed=tuple(one.sentence for one in accused.followed),
    )


def _command(mission: ReportedMission, setting: Origin | None, one: BlamedAdvice) -> str:
    """``pytpc apply out/today /mission/limit 0.035``, safe to paste; else empty."""
    value = one.remedy.value
    if setting is None or mission.source is None or value is None:
        return ""
    options = options_to_apply(setting)
    if options is None or not setting.name.startswith("/"):
        return ""
    words = ("pytpc", "apply", str(mission.source), setting.name, exact(value), *options)
    # A line end or a character that nobody sees must not get into somebody's terminal.
    if not all(word.isprintable() for word in words):
        return ""
    return shlex.join(words)


def differences_view(found: RunDifferences) -> DifferencesView:
    """What differs from the good runs, the most telling first."""
    rows = [_difference(one) for one in found.found]
    return DifferencesView(found.title, rows[:DIFFERENCES], rows[DIFFERENCES:], found.notes)


def _difference(one: Difference) -> DifferenceView:
    return DifferenceView(
        parameter=one.name,
        good=shown_value(one.good.value),
        bad=shown_value(one.bad.value),
        place=one.bad.place,
        effect=one.effect,
        telling=one.turned > 0,
    )
