"""Which margins of a fleet rise or fall from day to day, and when they will be 0.

Per robot and comparison, the medians of each day form a series: of the least margins of the
missions, as long as the comparison never turns, and of their median margins. Another setting begins
a new series, and only the last one says what will come. Over the fleet the series of all robots
are judged together; only days of one robot are compared, so that it does not matter which robots
flew on a day. A robot that flew at another time than most of its sisters, as by a clock that is
off, does not count there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from datetime import date
from math import ceil
from typing import Literal, NamedTuple

import numpy as np

from pytpc.base.columns import Bools, Floats, Int64s
from pytpc.base.errors import InputError
from pytpc.base.wording import tidy
from pytpc.diagnosis.fleet.group_medians import group_medians
from pytpc.diagnosis.fleet.rows import Rows
from pytpc.diagnosis.fleet.settings import same_numbers
from pytpc.diagnosis.results.fleet import (
    WHOLE_FLEET,
    DayMargin,
    FleetDrift,
    FleetDrifts,
    FleetPlace,
)
from pytpc.diagnosis.trend import Line, joint_trend, levels_of, lines_of

FEWEST_DAYS = 5
"""Fewer days have no trend."""

CHANCE_OF_DRIFT = 0.02
"""A series drifts if chance orders its days so in at most this part: five days that rise or fall
all along just do (2 of 120 orders)."""

FALSE_SHARE = 0.1
"""Of the drifts that are clear at most this part is by chance (Benjamini and Hochberg 1995)."""

AHEAD = 10
"""A line is followed for at most so many times the days that were seen."""

Measure = Literal["least", "median"]


class _Days(NamedTuple):
    """A series, or those of several robots: ``which`` comparison, and days with medians of each.

    ``threshold`` is nan if there are several, ``turned`` counts turns.
    """

    robot: str
    which: int
    measure: Measure
    parts: tuple[tuple[Floats, Floats], ...]
    threshold: float
    turned: int

    @property
    def days(self) -> Floats:
        """All days, sorted."""
        return np.unique(np.concatenate([day for day, _ in self.parts]))


class _Found(NamedTuple):
    """A drift, and the day by which it is sorted."""

    zero: float
    drift: FleetDrift


def fleet_drift(rows: Rows) -> FleetDrifts:
    """The margins that drift, by the day on which they will be 0, those that rise behind.

    Args:
        rows: the digests of all missions, whatever their verdict.

    Raises:
        InputError: a day is not ``YYYY-MM-DD``.
    """
    ordinal = np.array([_ordinal(day) for day in rows.days] or [0], np.int64)
    days = ordinal[rows.day]
    found: dict[tuple[str, int], _Found] = {}
    chances: list[float] = []
    short = 0
    for series in _all_series(rows, days):
        trend = joint_trend(series.parts)
        if trend is None or series.days.size < FEWEST_DAYS:
            short += 1
            continue
        chances.append(trend.chance)
        if trend.slope == 0.0 or trend.chance > CHANCE_OF_DRIFT:
            continue
        drift = _drift(rows, series, trend.chance)
        own = series.robot, series.which
        # Of both measures the one that is 0 first; of equal ones the least margin.
        if own not in found or drift.zero < found[own].zero:
            found[own] = drift
    most = _clear(chances)
    drifts = tuple(
        replace(one.drift, is_clear=one.drift.chance <= most)
        for one in sorted(found.values(), key=_order)
    )
    return FleetDrifts(drifts, len(chances), short, FEWEST_DAYS, CHANCE_OF_DRIFT)


def _clear(chances: list[float]) -> float:
    """Up to which chance a drift is clear."""
    ordered = sorted(chances)
    limits = [FALSE_SHARE * (place + 1) / len(ordered) for place in range(len(ordered))]
    passed = [one for one, limit in zip(ordered, limits, strict=True) if one <= limit]
    return max(passed, default=-1.0)


def _order(one: _Found) -> tuple[float, float, FleetPlace, str]:
    return one.zero, one.drift.chance, one.drift.where, one.drift.robot


def _ordinal(day: str) -> int:
    try:
        return date.fromisoformat(day).toordinal()
    except ValueError as error:
        raise InputError(f"the day {day!r} of a mission is not YYYY-MM-DD") from error


def _all_series(rows: Rows, days: Int64s) -> Iterator[_Days]:
    """Those of each robot, then those of the fleet."""
    last, group = _last_settings(rows)
    columns = {"least": rows.least[last], "median": rows.median[last]}
    day, turns, thresh = days[rows.mission[last]], rows.turns[last], rows.thresh[last]
    robots = max(1, len(rows.robots))
    starts = np.flatnonzero(np.append(True, group[1:] != group[:-1])) if group.size else group
    turned = np.add.reduceat(turns, starts) if starts.size else turns
    threshold = dict(zip(group[starts].tolist(), thresh[starts].tolist(), strict=True))
    turns_of = dict(zip(group[starts].tolist(), turned.tolist(), strict=True))
    never = np.repeat(turned == 0, np.diff(np.append(starts, group.size)))
    for measure, values in _measured(columns, never):
        alike: dict[int, list[_Days]] = {}
        for own, at, medians in _by_day(group, day, values):
            name, part = rows.robots[own % robots], ((at, medians),)
            one = _Days(name, own // robots, measure, part, threshold[own], turns_of[own])
            alike.setdefault(one.which, []).append(one)
            yield one
        for which, own_series in alike.items():
            several = _at_one_time(own_series)
            if len(several) > 1:
                settings = {one.threshold for one in several}
                yield _Days(
                    WHOLE_FLEET,
                    which,
                    measure,
                    tuple(part for one in several for part in one.parts),
                    settings.pop() if len(settings) == 1 else np.nan,
                    sum(one.turned for one in several),
                )


def _at_one_time(series: list[_Days]) -> list[_Days]:
    """Those whose time overlaps with that of half of the others, if most do; else all.

    The days of a robot whose clock is off say nothing of when its sisters' margins will be 0.
    """
    begin, end = np.array([(one.days[0], one.days[-1]) for one in series]).T
    overlaps = (begin[:, None] <= end) & (begin <= end[:, None])
    kept = 2 * (overlaps.sum(axis=1) - 1) >= len(series) - 1
    if 2 * np.count_nonzero(kept) <= len(series):
        return series
    return [one for one, is_kept in zip(series, kept.tolist(), strict=True) if is_kept]


def _measured(columns: dict[str, Floats], never: Bools) -> Iterator[tuple[Measure, Floats]]:
    """The least margin of what turns is about 0, whatever the rest does."""
    yield "least", np.where(never, columns["least"], np.nan)
    yield "median", columns["median"]


def _last_settings(rows: Rows) -> tuple[Int64s, Int64s]:
    """The rows since the last change of their threshold, and their group, by group and time."""
    group = rows.which.astype(np.int64) * max(1, len(rows.robots)) + rows.robot[rows.mission]
    order = np.lexsort((rows.mission, group))
    group, thresh = group[order], same_numbers(rows.thresh[order])
    new_group = np.append(True, group[1:] != group[:-1])[: group.size]
    same = (thresh[1:] == thresh[:-1]) | (np.isnan(thresh[1:]) & np.isnan(thresh[:-1]))
    part = np.cumsum(new_group | np.append(True, ~same)[: group.size])
    ends = np.append(np.flatnonzero(new_group)[1:], group.size) - 1
    sizes = np.diff(np.append(np.flatnonzero(new_group), group.size))
    kept = part == np.repeat(part[ends] if group.size else part, sizes)
    return order[kept], group[kept]


def _by_day(group: Int64s, day: Int64s, values: Floats) -> Iterator[tuple[int, Floats, Floats]]:
    """Each group with its days and the medians of these."""
    first = int(day.min(initial=0)) if day.size else 0
    width = int(day.max(initial=0)) - first + 1
    found = group_medians(group * width + day - first, values)
    own, at = found.group // width, found.group % width + first
    starts = np.flatnonzero(np.append(True, own[1:] != own[:-1])) if own.size else own
    for begin, end in zip(starts.tolist(), [*starts[1:].tolist(), own.size], strict=False):
        yield int(own[begin]), at[begin:end].astype(np.float64), found.median[begin:end]


def _drift(rows: Rows, series: _Days, chance: float) -> _Found:
    days = series.days
    begin, end = float(days[0]), float(days[-1])
    parts = [(day - begin, one) for day, one in series.parts]
    line, steepest, flattest = lines_of(parts)
    furthest = end + AHEAD * (end - begin)
    zero = _day_of_zero(line, begin, (end, furthest))
    early, late = (_day_of_zero(one, begin, (end, furthest)) for one in (steepest, flattest))
    one = rows.series[series.which]
    drift = FleetDrift(
        robot=series.robot,
        where=one.where,
        measure=series.measure,
        since=_text(begin),
        until=_text(end),
        days=days.size,
        threshold=None if np.isnan(series.threshold) else float(tidy(series.threshold)),
        now=line.at(end - begin),
        per_day=line.slope,
        unit=one.unit,
        chance=chance,
        is_clear=False,
        turns_on=None if zero is None else _text(zero),
        earliest=None if zero is None or early is None else _text(early),
        latest=None if zero is None or late is None else _text(late),
        turned=series.turned,
        margins=_margins(parts, line, begin),
    )
    return _Found(np.inf if zero is None else zero, drift)


def _margins(
    parts: Sequence[tuple[Floats, Floats]], line: Line, begin: float
) -> tuple[DayMargin, ...]:
    """The median of each day; each robot's margins are moved to the level that the line has."""
    if len(parts) > 1:
        levels = levels_of(parts, line.slope).tolist()
        parts = [
            (day, one + line.start - level) for (day, one), level in zip(parts, levels, strict=True)
        ]
    day, values = (np.concatenate(column) for column in zip(*parts, strict=True))
    found = group_medians(day.astype(np.int64), values)
    pairs = zip(found.group.tolist(), found.median.tolist(), strict=True)
    return tuple(DayMargin(_text(begin + one), median) for one, median in pairs)


def _day_of_zero(line: Line, begin: float, span: tuple[float, float]) -> float | None:
    """The day on which a line is 0, at least the last one seen; None if it is too far or never."""
    end, furthest = span
    if line.zero is None or begin + line.zero > furthest:
        return None
    return max(end, begin + line.zero)


def _text(day: float) -> str:
    return date.fromordinal(min(ceil(day), date.max.toordinal())).isoformat()
