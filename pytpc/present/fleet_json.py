"""The answers about a fleet as JSON; docs/reference/fleet-answers.md has the fields."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, is_dataclass

from pytpc.diagnosis.results.fleet import (
    WHOLE_FLEET,
    DayMargin,
    FleetDrift,
    FleetDrifts,
    FleetOutliers,
    FleetPlace,
    FleetRanking,
    FoundMission,
    OtherDecision,
)
from pytpc.present.as_json import Json, finite, without_nan
from pytpc.present.fleet_texts import Found, drifts_notes


def ranking_json(ranking: FleetRanking) -> Json:
    """The judgement, its notes, and all suspects."""
    return {**judgement_json(ranking), "suspects": [_fields(one) for one in ranking.suspects]}


def judgement_json(ranking: FleetRanking) -> Json:
    """The judgement without the suspects."""
    return {
        "text": ranking.text,
        "accused": ranking.accused,
        "causes": [_fields(one) for one in ranking.causes],
        "none": finite(ranking.none),
        "bad": ranking.bad,
        "good": ranking.good,
        "robots": ranking.robots,
        "diagnosed": ranking.diagnosed,
        "notes": list(ranking.notes),
    }


def drifts_json(drifts: FleetDrifts) -> Json:
    """All drifts, and how many were tested; the robot of the whole fleet is null."""
    return {**tested_json(drifts), "drifts": [_drift(one) for one in drifts.drifts]}


def tested_json(drifts: FleetDrifts) -> Json:
    """What was tested, without the drifts."""
    return {
        "tested": drifts.tested,
        "chance": finite(drifts.chance),
        "by_chance": finite(drifts.by_chance),
        "short": drifts.short,
        "fewest": drifts.fewest,
        "notes": list(drifts_notes(drifts)),
    }


def _drift(one: FleetDrift) -> Json:
    found = _fields(one)
    robot = None if one.robot == WHOLE_FLEET else one.robot
    clear = found.pop("is_clear")
    return {**found, "robot": robot, "clear": clear}


def outliers_json(outliers: FleetOutliers) -> Json:
    """What differs, and the counts of each robot."""
    return {
        "decisions": [_decision(one) for one in outliers.decisions],
        "settings": [_fields(one) for one in outliers.settings],
        "robots": [one._asdict() for one in outliers.counts],
        "tested": outliers.tested,
        "notes": list(outliers.notes),
    }


def _decision(one: OtherDecision) -> Json:
    found = _fields(one)
    set_otherwise = found.pop("is_set_otherwise")
    return {**found, "set_otherwise": set_otherwise}


def found_json(found: Sequence[Found]) -> list[Json]:
    """The missions, each with its turns."""
    return [
        {**_mission(mission), "turned": [_fields(turn) for turn in turns]}
        for mission, turns in found
    ]


def _mission(one: FoundMission) -> Json:
    """A mission without its turns."""
    found = _fields(one)
    bad = found.pop("is_bad")
    return {**found, "bad": bad}


def _fields(one: object) -> Json:
    """All fields of an answer."""
    assert is_dataclass(one)
    return {field.name: _plain(getattr(one, field.name)) for field in fields(one)}


def _plain(value: object) -> object:
    """A value of an answer, with what is inside; a number that JSON lacks is null."""
    if isinstance(value, FleetPlace | DayMargin):
        return {name: without_nan(one) for name, one in value._asdict().items()}
    if isinstance(value, tuple):
        return [_plain(one) for one in value]
    return _fields(value) if is_dataclass(value) else without_nan(value)
