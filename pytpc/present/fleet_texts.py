"""The answers about a fleet as texts, which the terminal and the pages share.

Texts may hold anything that a robot called itself: whoever prints them escapes them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from pytpc.base.wording import listed, many, percent, show
from pytpc.diagnosis.results.fleet import (
    WHOLE_FLEET,
    FleetCause,
    FleetDrift,
    FleetDrifts,
    FleetOutliers,
    FleetPlace,
    FleetRanking,
    FleetSuspect,
    FoundMission,
    FoundTurn,
    OtherDecision,
    OtherSetting,
    ValueInMissions,
)
from pytpc.present.margin_tables import short

Found = tuple[FoundMission, Sequence[FoundTurn]]
"""A mission that was found, and its turns; none where nobody asked for them."""
_VALUES = 3
_ROBOTS = 4
_FEW = 0.001


class SuspectTexts(NamedTuple):
    """A suspect; a text is empty where there is nothing to say."""

    position: str
    parameter: str
    probability: str
    reason: str
    bad: str
    good: str
    margin_bad: str
    margin_good: str
    robots: str
    importance: str
    importance_position: str
    differs: str
    mean_position: str
    place: str
    node: str

    @classmethod
    def of(cls, one: FleetSuspect) -> SuspectTexts:
        """How every output says it."""
        return cls(
            position=f"{one.position}=" if one.tied else str(one.position),
            parameter=one.parameter,
            probability=percent(one.probability),
            reason=one.reason,
            bad=_values([(value, value.bad) for value in one.values]),
            good=_values([(value, value.good) for value in one.values]),
            margin_bad=_number(one.margin_bad),
            margin_good=_number(one.margin_good),
            robots=listed(one.robots, _ROBOTS),
            importance=short(one.importance) if one.importance else "",
            importance_position=_whole(one.importance_position),
            differs="" if one.differs is None else percent(one.differs),
            mean_position="" if one.mean_position is None else f"{one.mean_position:.1f}",
            place="" if one.shows is None else one.shows.place,
            node="" if one.shows is None else one.shows.node,
        )


class CauseTexts(NamedTuple):
    """One of several causes."""

    parameter: str
    probability: str
    bad: str
    robots: str

    @classmethod
    def of(cls, one: FleetCause) -> CauseTexts:
        """How every output says it."""
        return cls(
            one.parameter, percent(one.probability), f"{one.bad:,}", listed(one.robots, _ROBOTS)
        )


class DriftTexts(NamedTuple):
    """A margin that drifts."""

    robot: str
    parameter: str
    measure: str
    now: str
    per_day: str
    turns_on: str
    interval: str
    chance: str
    clear: str
    days: str
    since: str
    until: str
    threshold: str
    turned: str
    place: str
    node: str

    @classmethod
    def of(cls, one: FleetDrift) -> DriftTexts:
        """How every output says it."""
        return cls(
            robot=robot_text(one.robot),
            parameter=one.where.parameter,
            measure=one.measure,
            now=short(one.now),
            per_day=f"{one.per_day:+.3g}",
            turns_on=one.turns_on or "",
            interval=interval_text(one),
            chance=chance_text(one.chance),
            clear="yes" if one.is_clear else "",
            days=f"{one.days:,}",
            since=one.since,
            until=one.until,
            threshold="" if one.threshold is None else show(one.threshold),
            turned=f"{one.turned:,}",
            place=one.where.place,
            node=one.where.node,
        )


class SettingTexts(NamedTuple):
    """A value that sisters do not have."""

    robot: str
    parameter: str
    value: str
    usual: str
    sisters: str
    score: str

    @classmethod
    def of(cls, one: OtherSetting) -> SettingTexts:
        """How every output says it."""
        return cls(
            one.robot,
            one.parameter,
            one.value,
            one.usual,
            f"{percent(one.share)} of {one.sisters:,}",
            _number(one.score),
        )


class DecisionTexts(NamedTuple):
    """A comparison that behaves otherwise than on the sisters."""

    robot: str
    parameter: str
    measure: str
    own: str
    usual: str
    sisters: str
    score: str
    chance: str
    set_otherwise: str
    place: str
    node: str

    @classmethod
    def of(cls, one: OtherDecision) -> DecisionTexts:
        """How every output says it."""
        return cls(
            one.robot,
            one.where.parameter,
            one.measure,
            short(one.own),
            short(one.usual),
            f"{one.sisters:,}",
            short(one.score),
            chance_text(one.chance),
            "yes" if one.is_set_otherwise else "",
            one.where.place,
            one.where.node,
        )


class MissionTexts(NamedTuple):
    """A mission that was found; ``turns`` are those that fit, of those of its comparisons."""

    robot: str
    day: str
    mission: str
    went: str
    turns: str
    least: str
    where: str

    @classmethod
    def of(cls, found: Found) -> MissionTexts:
        """How every output says it."""
        one, turns = found
        every = f"{one.turns:,}"
        return cls(
            one.robot,
            one.day,
            one.mission,
            "bad" if one.is_bad else "good",
            every if len(turns) in {0, one.turns} else f"{len(turns):,} of {every}",
            _number(one.least),
            listed([place_text(each) for each in one.where], _VALUES),
        )


class TurnTexts(NamedTuple):
    """A turn of a mission; ``seconds`` are those since its begin."""

    seconds: str
    parameter: str
    result: str
    value: str
    threshold: str
    margin: str
    place: str
    node: str

    @classmethod
    def of(cls, one: FoundTurn, start_ns: int) -> TurnTexts:
        """How every output says it."""
        return cls(
            f"{(one.time_ns - start_ns) / 1e9:.1f}",
            one.parameter,
            "true" if one.result else "false",
            show(one.value),
            show(one.threshold),
            _number(one.margin),
            one.place,
            one.node,
        )


def ranking_title(found: FleetRanking) -> str:
    """What was judged: ``3 bad and 9 good missions of 4 robots; 2 bad ones have a diagnosis``."""
    text = f"{found.bad:,} bad and {many(found.good, 'good mission')} of"
    has = "bad one has" if found.diagnosed == 1 else "bad ones have"
    diagnosed = f"; {found.diagnosed:,} {has} a diagnosis" if found.diagnosed else ""
    return f"{text} {many(found.robots, 'robot')}{diagnosed}"


def drifts_title(found: FleetDrifts) -> str:
    """How many margins drift, and which will turn first."""
    count = len(found.drifts)
    drifts = "drifts" if count == 1 else "drift"
    text = f"{count or 'none'} of {many(found.tested, 'tested margin')} {drifts}"
    if not count:
        return text
    clear = [one for one in found.drifts if one.is_clear]
    if len(clear) < count:
        text += f", {len(clear) or 'none'} clearly"
    # What may be by chance is named only where nothing else is.
    first = next((one for one in clear or found.drifts if one.turns_on is not None), None)
    if first is None:
        return f"{text}; none of {'them' if not clear else 'these'} towards turning"
    where = f"{first.where.parameter} on {robot_text(first.robot)}"
    return f"{text}; the first to turn: {where}, {first.turns_on}{interval_text(first, ' ')}"


def drifts_notes(found: FleetDrifts) -> tuple[str, ...]:
    """What to know of the drifts besides."""
    notes = []
    if found.drifts:
        notes.append(
            f"if nothing drifted, about {found.by_chance:.2g} of {found.tested:,} would still look"
            f" like this, with a chance of {found.chance:g} each"
        )
    if found.short:
        notes.append(f"not judged: {found.short:,} with fewer than {many(found.fewest, 'day')}")
    return tuple(notes)


def outliers_title(found: FleetOutliers) -> str:
    """How many robots differ in what."""
    robots = {one.robot for one in found.settings} | {one.robot for one in found.decisions}
    text = f"{len(robots) or 'none'} of {many(len(found.counts), 'robot')}"
    text += " differs from its sisters" if len(robots) <= 1 else " differ from their sisters"
    if not robots:
        return text
    settings, decisions = len(found.settings), len(found.decisions)
    return f"{text}: {many(decisions, 'decision')} and {many(settings, 'setting')}"


def found_title(found: Sequence[Found]) -> str:
    """How many missions were found."""
    if not found:
        return "no mission fits"
    bad = sum(mission.is_bad for mission, _ in found)
    robots = len({mission.robot for mission, _ in found})
    return f"{many(len(found), 'mission')} of {many(robots, 'robot')}, {bad:,} bad"


def robot_text(robot: str) -> str:
    """A robot, or all of them."""
    return "all robots" if robot == WHOLE_FLEET else robot


def interval_text(one: FleetDrift, before: str = "") -> str:
    """Between which days it will turn, in brackets and behind ``before``; empty if unknown."""
    if one.turns_on is None or (one.earliest is None and one.latest is None):
        return ""
    if one.latest is None:
        return f"{before}({one.earliest} or later)"
    if one.earliest is None:
        return f"{before}({one.latest} or earlier)"
    return f"{before}({one.earliest} to {one.latest})"


def chance_text(chance: float) -> str:
    """A small probability."""
    return f"<{_FEW}" if chance < _FEW else f"{chance:.2g}"


def place_text(one: FleetPlace) -> str:
    """A comparison in a few words."""
    return f"{one.parameter} ({one.place})" if one.place else one.parameter


def _values(counted: Sequence[tuple[ValueInMissions, int]]) -> str:
    return listed([f"{one.text} ({count:,})" for one, count in counted if count], _VALUES)


def _number(value: float | None) -> str:
    return "" if value is None else short(value)


def _whole(value: int | None) -> str:
    return "" if value is None else f"{value:,}"
