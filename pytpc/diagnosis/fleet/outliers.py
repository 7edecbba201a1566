"""Which robot of a fleet is set or behaves otherwise than its sisters.

Settings are facts: a robot has, in most of its missions, a value that its sisters do not have. They
stand out if ``SHARE`` of the sisters have one other value; or, where the values of all differ, if a
number is more than ``FAR`` median absolute deviations off those of the sisters (the robust z score
of Iglewicz and Hoaglin 1993), beyond all of them. Where more than half of the sisters have one
value that deviation is 0, and the mean absolute one counts. Settings with which the robot also
decides otherwise come first, then those that are further off: of a fleet in which each robot has
settings of its own, most are a little off.

Decisions are measured (`behaviour_evidence.MEASURES`), and must be off in two ways: the median over
the robot's missions by more than ``FAR`` deviations from the medians of the sisters; and its
missions by a rank sum against those of the sisters, which has the exact distribution of all orders
for few missions, times the number of tests (Bonferroni).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Floats, Int32s, Int64s
from pytpc.base.wording import listed
from pytpc.diagnosis.fleet.behaviour_evidence import MEASURES, measures
from pytpc.diagnosis.fleet.group_medians import group_medians
from pytpc.diagnosis.fleet.rank_sum import each_against_rest
from pytpc.diagnosis.fleet.rows import Rows
from pytpc.diagnosis.fleet.settings import Settings
from pytpc.diagnosis.results.fleet import (
    FleetOutliers,
    OtherDecision,
    OtherSetting,
    RobotCounts,
)

FEWEST_ROBOTS = 3
"""Of two robots that differ nobody knows which is the other one."""

FEWEST_MISSIONS = 3
"""A robot with fewer missions that evaluated a comparison does not count there."""

SHARE = 2 / 3
FAR = 3.5
CHANCE = 0.01
"""How likely one decision is to stand out in a fleet in which no robot differs."""

MOST_SCORE = 99.0
"""The score of what differs from sisters that do not differ at all."""

_SIGMA = 1.4826
"""The standard deviation of a normal distribution, in median absolute deviations."""
_MEAN_SIGMA = 1.2533
"""The same in mean absolute deviations."""
_NAMED = 3


class _Sisters(NamedTuple):
    """What the others have: their median, and how far they are from it, in standard deviations."""

    median: float
    spread: float
    low: float
    high: float


def fleet_outliers(rows: Rows, settings: Settings | None = None) -> FleetOutliers:
    """The settings and decisions by which robots differ from their sisters.

    Args:
        rows: the digests of all missions, whatever their verdict.
        settings: the values of the parameters; None takes the thresholds of ``rows``.
    """
    settings = Settings.of(rows) if settings is None else settings
    robots = np.unique(rows.robot).tolist()
    if len(robots) < FEWEST_ROBOTS:
        alone = listed([rows.robots[one] for one in robots], _NAMED) or "none"
        note = f"robots: {alone}; it takes {FEWEST_ROBOTS} to tell which one differs"
        return FleetOutliers((), (), (), 0, (note,))
    other = list(_settings(rows, settings))
    decisions, tested = _decisions(rows, _own_values(rows, settings))
    matter = frozenset((one.robot, one.where.parameter) for one in decisions)
    other.sort(key=lambda one: ((one.setting.robot, one.setting.parameter) not in matter, one.rank))
    set_so = Counter(one.setting.robot for one in other)
    decided = Counter(one.robot for one in decisions)
    names = [rows.robots[one] for one in robots]
    counts = [RobotCounts(name, decided[name], set_so[name]) for name in names]
    counts.sort(key=lambda one: (-one.decisions, -one.settings, one.robot))
    return FleetOutliers(
        tuple(one.setting for one in other),
        tuple(decisions),
        tuple(counts),
        tested,
        tuple(_notes(rows)),
    )


def _notes(rows: Rows) -> Iterator[str]:
    few = np.flatnonzero(np.bincount(rows.robot) < FEWEST_MISSIONS)
    few = np.intersect1d(few, rows.robot)
    if few.size:
        names = listed([rows.robots[one] for one in few.tolist()], _NAMED)
        yield f"fewer than {FEWEST_MISSIONS} missions, so that no decision is judged: {names}"


class _Set(NamedTuple):
    """A setting, and how far it is off: from 0 to 1."""

    setting: OtherSetting
    off: float

    @property
    def rank(self) -> tuple[float, float, str, str]:
        one = self.setting
        return -self.off, -one.share, one.parameter, one.robot


def _each(rows: Rows, settings: Settings) -> Iterator[tuple[int, Int64s, Int32s]]:
    """The parameters that enough robots have, and differ in; the robots, and the value of each."""
    robot_of = rows.robot[settings.mission]
    for parameter in range(len(settings.parameters)):
        own = settings.entries(parameter)
        robot, value = _usual_values(robot_of[own], settings.value[own])
        if robot.size >= FEWEST_ROBOTS and np.any(value != value[0]):
            yield parameter, robot, value


def _own_values(rows: Rows, settings: Settings) -> frozenset[tuple[str, str]]:
    """The robots and parameters whose value fewer than half of the sisters have."""
    return frozenset(
        (rows.robots[one], settings.parameters[parameter])
        for parameter, robot, value in _each(rows, settings)
        for one, own in zip(robot.tolist(), value.tolist(), strict=True)
        if 2 * (np.count_nonzero(value == own) - 1) < value.size - 1
    )


def _settings(rows: Rows, settings: Settings) -> Iterator[_Set]:
    for parameter, robot, value in _each(rows, settings):
        numbers = settings.numbers[value]
        is_scale = not settings.flags[parameter] and bool(np.isfinite(numbers).all())
        for place in range(robot.size):
            rest = np.delete(value, place)
            codes, counts = np.unique(rest, return_counts=True)
            usual, share = int(codes[counts.argmax()]), float(counts.max() / rest.size)
            score = _score(numbers, place) if is_scale else None
            alike = share >= SHARE and value[place] != usual
            if not alike and not (share < SHARE and score is not None and score > FAR):
                continue
            setting = OtherSetting(
                robot=rows.robots[int(robot[place])],
                parameter=settings.parameters[parameter],
                value=settings.setting(parameter, int(value[place])).text,
                usual=settings.setting(parameter, usual).text,
                sisters=rest.size,
                share=share,
                score=score,
            )
            yield _Set(setting, _apart(numbers, place) if is_scale else 1.0)


def _apart(numbers: Floats, place: int) -> float:
    """By which part of the larger one a number and the sisters' median differ; 1 at most."""
    own, usual = float(numbers[place]), float(np.median(np.delete(numbers, place)))
    largest = max(abs(own), abs(usual))
    return min(1.0, abs(own - usual) / largest) if largest else 0.0


def _usual_values(robot: Int32s, value: Int32s) -> tuple[Int64s, Int32s]:
    """The robots, and the value that each has in most of its missions, of equal ones the last."""
    pair, last, count = np.unique(
        np.column_stack([robot, value])[::-1], axis=0, return_index=True, return_counts=True
    )
    order = np.lexsort((-last, count, pair[:, 0]))
    robots = pair[order, 0]
    ends = np.flatnonzero(np.append(robots[1:] != robots[:-1], True)) if robots.size else order
    return robots[ends].astype(np.int64), pair[order, 1][ends]


def _score(numbers: Floats, place: int) -> float | None:
    """How far a number is off the others beyond all of them; None if it is not, or all are one."""
    sisters = _sisters(np.delete(numbers, place))
    own = float(numbers[place])
    if sisters.low <= own <= sisters.high or not sisters.spread:
        return None
    return min(MOST_SCORE, abs(own - sisters.median) / sisters.spread)


def _sisters(values: Floats) -> _Sisters:
    median = float(np.median(values))
    away = np.abs(values - median)
    spread = _SIGMA * float(np.median(away)) or _MEAN_SIGMA * float(away.mean())
    return _Sisters(median, spread, float(values.min()), float(values.max()))


class _Off(NamedTuple):
    """A decision that may stand out, before it is known how many were tested."""

    chance: float
    measure: int
    robot: int
    which: int
    own: float
    sisters: _Sisters
    others: int


def _decisions(
    rows: Rows, set_otherwise: frozenset[tuple[str, str]]
) -> tuple[list[OtherDecision], int]:
    """Those that stand out, the least likely first; and how many were tested."""
    robot = rows.robot[rows.mission].astype(np.int64)
    which = rows.which.astype(np.int64)
    best: dict[tuple[int, int], _Off] = {}
    tested = 0
    for measure, values in enumerate(measures(rows)):
        for one in _measured(rows, (which, robot), values, measure):
            tested += 1
            spread = one.sisters.spread
            far = abs(one.own - one.sisters.median) > FAR * spread
            pair = one.robot, one.which
            if far and (pair not in best or one.chance < best[pair].chance):
                best[pair] = one
    found = []
    for one in best.values():
        chance = min(1.0, one.chance * tested)
        if chance > CHANCE:
            continue
        off = abs(one.own - one.sisters.median)
        score = min(MOST_SCORE, off / one.sisters.spread) if one.sisters.spread else MOST_SCORE
        where, name = rows.series[one.which].where, rows.robots[one.robot]
        found.append(
            OtherDecision(
                robot=name,
                where=where,
                measure=MEASURES[one.measure],
                own=one.own,
                usual=one.sisters.median,
                sisters=one.others,
                score=score,
                chance=chance,
                is_set_otherwise=(name, where.parameter) in set_otherwise,
            )
        )
    found.sort(key=lambda one: (one.chance, -one.score, one.where, one.robot))
    return found, tested


def _measured(
    rows: Rows, of: tuple[Int64s, Int64s], values: Floats, measure: int
) -> Iterator[_Off]:
    """Each robot in each comparison that enough robots evaluated often enough."""
    width = len(rows.robots)
    which, robot = of
    cell = which * width + robot
    medians = group_medians(cell, values)
    often = medians.size >= FEWEST_MISSIONS
    counted = np.isin(cell, medians.group[often])
    values = np.where(counted, values, np.nan)
    within = _within(cell, values, medians.group, medians.median)
    chances = each_against_rest(which, robot, values, (len(rows.series), width))
    group, median = medians.group[often], medians.median[often]
    size = medians.size[often]
    starts = np.flatnonzero(np.append(True, np.diff(group // width) > 0)) if group.size else group
    for begin, end in zip(starts.tolist(), [*starts[1:].tolist(), group.size], strict=False):
        if end - begin < FEWEST_ROBOTS:
            continue
        for place in range(begin, end):
            sisters = _sisters(np.delete(median[begin:end], place - begin))
            # The median over few missions is off by as much as these missions are.
            noise = _SIGMA * within[int(group[place])] / np.sqrt(size[place])
            own_which, own_robot = divmod(int(group[place]), width)
            yield _Off(
                float(chances[own_which, own_robot]),
                measure,
                own_robot,
                own_which,
                float(median[place]),
                sisters._replace(spread=max(sisters.spread, float(noise))),
                end - begin - 1,
            )


def _within(cell: Int64s, values: Floats, groups: Int64s, medians: Floats) -> dict[int, float]:
    """The median absolute deviation of the missions of each robot and comparison."""
    level = np.full(int(cell.max(initial=0)) + 1, np.nan)
    level[groups] = medians
    found = group_medians(cell, np.abs(values - level[cell]))
    return dict(zip(found.group.tolist(), found.median.tolist(), strict=True))
