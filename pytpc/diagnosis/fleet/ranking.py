"""Which parameter makes missions of a fleet go wrong, or none of them.

The score of a parameter, in log odds, is

    prior + diagnoses + values + behaviour

- *prior*: four of five fleets have a parameter to blame (``NONE``), each compared one as likely;
  what no comparison reports and has several values in the fleet less (``UNKNOWN_CHARGE``).
- *diagnoses*: what the bad missions' own diagnoses say (`mission_evidence`).
- *values*: how well the parameter's values explain which missions went wrong (`value_evidence`).
  The diagnoses do not count them again: they are made among missions that may have gone wrong
  unseen (`Question.others`).
- *behaviour*: bounded, see `behaviour_evidence`.

The probabilities are the scores' softmax with what the diagnoses say of "none of them", which is 0
without any. Beside them stand two methods of the study: Importance (`pytpc.diagnosis.importance`)
with missions as runs, and the share of bad missions with a value that no good one has.
docs/reference/scores.md#fleets has all formulas.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from pytpc.base.columns import Bools, Floats, Int64s
from pytpc.base.errors import InputError
from pytpc.base.wording import listed, many
from pytpc.diagnosis.fleet.behaviour_evidence import MEASURES, Differing, differing
from pytpc.diagnosis.fleet.causes import causes_in
from pytpc.diagnosis.fleet.fleet_importance import fleet_importance
from pytpc.diagnosis.fleet.mission_evidence import NONE, Diagnoses, joined
from pytpc.diagnosis.fleet.rows import Rows
from pytpc.diagnosis.fleet.settings import Settings
from pytpc.diagnosis.fleet.value_evidence import Missions, value_evidence
from pytpc.diagnosis.fleet.values_in_missions import Verdicts, values_in
from pytpc.diagnosis.ranking.posterior import softmax
from pytpc.diagnosis.ranking.replayed_outcomes import UNKNOWN_CHARGE
from pytpc.diagnosis.results.fleet import (
    FleetEvidence,
    FleetRanking,
    FleetSuspect,
)

_DIGITS = 9
"""Scores that differ by rounding only are tied."""
_ORDERED = frozenset({"<", "<=", ">", ">="})
_NAMED = 3
_NAMES, _NAME_SHARE = 5, 0.9
"""What has other values in more than this part of so many good missions names each of them."""
_CLEAR = 0.05


def rank_fleet(
    rows: Rows, *, values: pa.Table | None = None, diagnoses: pa.Table | None = None
) -> FleetRanking:
    """Judge all parameters by which missions went wrong.

    Args:
        rows: the digests of good and bad missions; missions that are neither do not count.
        values: the recorded parameters of the missions, see `Settings.of`; None if there are none.
        diagnoses: of the bad missions, see `mission_evidence.joined`; None if there are none.

    Raises:
        InputError: no mission is bad, or a table is not as it should be.
    """
    if not rows.bad.any():
        raise InputError("no mission is bad: add missions with marks, or say which are bad")
    settings = Settings.of(rows, values)

    @cache
    def judged(bad: bytes) -> _Scored:
        own = replace(rows, bad=np.frombuffer(bad, np.bool_))
        return _scored(own, settings, joined(own, settings.parameters, diagnoses))

    def probabilities(bad: Bools) -> Floats:
        return judged(bad.tobytes()).probability

    scored = judged(rows.bad.tobytes())
    return FleetRanking(
        suspects=_suspects(rows, settings, scored),
        none=scored.none,
        bad=int(rows.bad.sum()),
        good=int(rows.good.sum()),
        robots=len({*rows.robot[rows.bad | rows.good].tolist()}),
        diagnosed=scored.diagnoses.missions,
        notes=_notes(rows, scored.diagnoses),
        causes=causes_in(settings, Verdicts.of(rows), len(rows.parameters), probabilities),
    )


class _Scored(NamedTuple):
    """The evidence, float64 for each of ``Settings.parameters``; a score of -inf is no suspect."""

    prior: Floats
    diagnoses: Diagnoses
    values: Floats
    differing: Differing
    behaviour: Floats
    scores: Floats
    probability: Floats
    none: float
    importance: Floats


def _scored(rows: Rows, settings: Settings, diagnoses: Diagnoses) -> _Scored:
    compared, every = len(rows.parameters), len(settings.parameters)
    values = _value_evidence(rows, settings)
    found = differing(rows)
    behaviour = np.append(found.evidence, np.zeros(every - compared))
    suspected = np.ones(every, np.bool_)
    suspected[compared:] = [_may_matter(rows, settings, one) for one in range(compared, every)]
    prior = np.full(every, math.log((1.0 - NONE) / NONE) - math.log(max(1, suspected.sum())))
    prior[compared:] += UNKNOWN_CHARGE
    scores = prior + diagnoses.evidence + values + behaviour
    scores = np.where(suspected, scores, -np.inf)
    probability, none = softmax(scores, diagnoses.none)
    importance = np.append(fleet_importance(rows), np.zeros(every - compared))
    return _Scored(
        prior, diagnoses, values, found, behaviour, scores, probability, none, importance
    )


def _may_matter(rows: Rows, settings: Settings, parameter: int) -> bool:
    """Whether what no comparison reports has several values, and is no name of the mission.

    A seed, a time or a folder is another one in each mission, and those of bad missions follow each
    other like these do.
    """
    own = settings.entries(parameter)
    values = settings.value[own]
    good = values[rows.good[settings.mission[own]]]
    is_name = good.size >= _NAMES and np.unique(good).size > _NAME_SHARE * good.size
    return not is_name and np.unique(values).size > 1


def _value_evidence(rows: Rows, settings: Settings) -> Floats:
    judged = np.flatnonzero(rows.bad | rows.good)
    place = np.full(len(rows.missions), -1, np.int64)
    place[judged] = np.arange(judged.size)
    missions = Missions.of(rows.robot[judged], rows.bad[judged])
    several = bool(np.unique(missions.robot).size > 1)
    equality = {
        int(rows.of_series[n]) for n, one in enumerate(rows.series) if one.relation not in _ORDERED
    }
    equality -= {
        int(rows.of_series[n]) for n, one in enumerate(rows.series) if one.relation in _ORDERED
    }
    found = np.zeros(len(settings.parameters))
    for parameter in range(found.size):
        own = settings.entries(parameter)
        known, value = place[settings.mission[own]], settings.value[own].astype(np.int64)
        is_number = ~np.isnan(settings.numbers[value])
        is_flag = bool(settings.flags[parameter])
        ordered = parameter not in equality and not is_flag and 2 * is_number.sum() > value.size
        # A value that changed during the mission is neither above nor below another.
        kept = (known >= 0) & (is_number | (not ordered))
        found[parameter] = value_evidence(
            missions, known[kept], value[kept], ordered=ordered, several=several
        )
    return found


def _suspects(rows: Rows, settings: Settings, scored: _Scored) -> tuple[FleetSuspect, ...]:
    scores = np.round(scored.scores, _DIGITS)
    names = settings.parameters
    suspected = np.flatnonzero(np.isfinite(scores)).tolist()
    order = sorted(suspected, key=lambda one: (-scores[one], names[one]))
    by_importance = np.sort(-np.round(scored.importance, _DIGITS))
    verdicts = Verdicts.of(rows)
    found, position = [], 0
    for place, one in enumerate(order):
        alike = [other for other in order[max(0, place - 1) : place + 2] if other != one]
        if not place or scores[order[place - 1]] != scores[one]:
            position = place + 1
        own = round(float(scored.importance[one]), _DIGITS)
        before = int(np.searchsorted(by_importance, -own, side="left"))
        stands = _Position(
            position,
            any(scores[other] == scores[one] for other in alike),
            before + 1 if own > 0 else None,
        )
        found.append(_suspect((rows, settings, verdicts), scored, one, stands))
    return tuple(found)


class _Position(NamedTuple):
    """Where a parameter stands, see `FleetSuspect`."""

    position: int
    tied: bool
    by_importance: int | None


def _suspect(
    known: tuple[Rows, Settings, Verdicts], scored: _Scored, one: int, stands: _Position
) -> FleetSuspect:
    rows, settings, verdicts = known
    held = values_in(settings, verdicts, one)
    is_compared = one < len(rows.parameters)
    shows = int(scored.differing.shows[one]) if is_compared else -1
    margins = _margins(rows, shows)
    mean = float(scored.diagnoses.position[one])
    return FleetSuspect(
        position=stands.position,
        tied=stands.tied,
        parameter=settings.parameters[one],
        probability=float(scored.probability[one]),
        evidence=FleetEvidence(
            float(scored.prior[one]),
            float(scored.diagnoses.evidence[one]),
            float(scored.values[one]),
            float(scored.behaviour[one]),
        ),
        importance=float(scored.importance[one]),
        importance_position=stands.by_importance,
        differs=held.differs,
        mean_position=None if math.isnan(mean) else mean,
        values=held.values,
        more_values=held.more,
        margin_bad=margins[0],
        margin_good=margins[1],
        unit=rows.series[shows].unit if shows >= 0 else "",
        shows=rows.series[shows].where if shows >= 0 else None,
        robots=held.robots,
        reason="; ".join((*held.reasons, *_behaviour(scored.differing, one, is_compared))),
    )


def _margins(rows: Rows, series: int) -> tuple[float | None, float | None]:
    """The median over bad and over good missions of a comparison's median margin."""
    first, last = np.searchsorted(rows.which, [series, series + 1])
    mission, median = rows.mission[first:last], rows.median[first:last]
    return _median(median[rows.bad[mission]]), _median(median[rows.good[mission]])


def _median(values: Floats) -> float | None:
    known = values[~np.isnan(values)]
    return float(np.median(known)) if known.size else None


def _behaviour(found: Differing, one: int, is_compared: bool) -> list[str]:
    if not is_compared:
        return ["no comparison reports it"]
    if found.chance[one] > _CLEAR:
        return []
    side = "higher" if found.side[one] > 0 else "lower"
    measure = MEASURES[int(found.measure[one])]
    return [f"{measure} {side} in bad missions than in good ones (p = {found.chance[one]:.2g})"]


def _notes(rows: Rows, diagnoses: Diagnoses) -> tuple[str, ...]:
    notes = []
    if not rows.good.any():
        notes.append("no mission is good, so that values say little: add good missions")
    alone = np.setdiff1d(rows.robot[rows.bad], rows.robot[rows.good])
    if alone.size and rows.good.any():
        names = [rows.robots[one] for one in alone.tolist()]
        notes.append(f"robots with bad missions and no good one: {listed(names, _NAMED)}")
    missing = int(rows.bad.sum()) - diagnoses.missions
    if diagnoses.missions and missing:
        notes.append(f"{many(missing, 'bad mission')} without a diagnosis")
    neither = _neither(rows)
    if neither.size:
        notes.append(f"{many(neither.size, 'mission')} neither good nor bad, not counted")
    return tuple(notes)


def _neither(rows: Rows) -> Int64s:
    return np.flatnonzero(~(rows.bad | rows.good))
