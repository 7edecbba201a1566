"""The chart of a margin that drifts: a dot for each day, the trend, and the day of turning."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date

import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from pytpc.base.columns import Floats
from pytpc.diagnosis.results.fleet import DayMargin, FleetDrift
from pytpc.present.page.plots import COLOUR, drawable, drawing, svg_of

_AHEAD = 2.0
_DAYS_AHEAD = 14.0
_DOTS = 45
_TICKS = 3


@dataclass(frozen=True)
class DriftChart:
    """A chart for the page, and whether it shows what its legend names.

    ``has_zero``: the margin 0; ``turns`` and ``between``: the day of turning, and its interval.
    """

    svg: Markup
    has_days: bool
    has_zero: bool
    turns: bool
    between: bool


def drift_chart(drift: FleetDrift, ident: str, label: str) -> DriftChart | None:
    """Draw a drift.

    Args:
        drift: the margins of the days, the trend, and when it turns.
        ident: prefix of all ids, unlike that of any other figure of the page.
        label: what the chart shows, for those who do not see it.

    Returns:
        The chart; None where the days of the drift are no days.
    """
    since, until = day_number(drift.since), day_number(drift.until)
    if since is None or until is None:
        return None
    days, values = _points(drift.margins)
    begin = min([since, *days.tolist()])
    seen = max([until, *days.tolist()])
    turn = day_number(drift.turns_on)
    # A day that is far off would leave no room for those that were seen.
    if turn is not None and not begin <= turn <= seen + _AHEAD * (seen - begin) + _DAYS_AHEAD:
        turn = None
    end = max(seen, turn or seen)
    between = (day_number(drift.earliest), day_number(drift.latest)) if turn is not None else None
    with drawing(10.5):
        figure = Figure(figsize=(5.2, 2.3))
        axes = figure.subplots()
        figure.subplots_adjust(left=0.13, right=0.97, top=0.96, bottom=0.15)
        room = 0.04 * max(end - begin, 1.0)
        axes.set_xlim(begin - room, end + room)
        if turn is not None and between is not None:
            _turning(axes, turn, between)
        _margins(axes, days, values)
        _trend(axes, drift, (since, until, end), values, reaches_zero=turn is not None)
        _days(axes)
        low, high = axes.get_ylim()
        svg = svg_of(figure, ident, label)
    # Made of matplotlib's own XML, in which it escapes every text.
    has_interval = between is not None and between != (None, None)
    return DriftChart(
        Markup(svg), bool(days.size), low <= 0.0 <= high, turn is not None, has_interval
    )


def day_number(day: str | None) -> int | None:
    """A day as a number that rises by 1 from day to day; None for what is no day."""
    try:
        return None if day is None else date.fromisoformat(day).toordinal()
    except ValueError:
        return None


def _points(margins: Sequence[DayMargin]) -> tuple[Floats, Floats]:
    """float64[n] days and their margins, without those that are none."""
    pairs = [
        (number, value)
        for day, value in margins
        for number in [day_number(day)]
        if number is not None and math.isfinite(value)
    ]
    found = np.array(sorted(pairs), np.float64).reshape(-1, 2)
    return found[:, 0], drawable(found[:, 1])


def _margins(axes: Axes, days: Floats, values: Floats) -> None:
    axes.plot(days, values, color=COLOUR["value"], linewidth=1.2)
    if days.size <= _DOTS:
        axes.plot(
            days,
            values,
            linestyle="none",
            marker="o",
            markersize=4,
            markeredgecolor=COLOUR["value"],
            markerfacecolor=COLOUR["paper"],
        )


def _trend(
    axes: Axes,
    drift: FleetDrift,
    days: tuple[int, int, int],
    values: Floats,
    *,
    reaches_zero: bool,
) -> None:
    """The line from the first day up to the last, and on to the day of turning."""
    since, until, end = days
    times = np.array([since, end], np.float64)
    line = drawable(drift.now + drift.per_day * (times - until))
    axes.plot(times, line, color=COLOUR["ink"], linewidth=1.3, linestyle=(0, (1, 1.6)))
    shown = np.concatenate([line, values])
    shown = shown[np.isfinite(shown)]
    low, high = (float(shown.min()), float(shown.max())) if shown.size else (0.0, 1.0)
    # 0 belongs to the picture where the margin comes near it.
    if reaches_zero or (0 < low < high - low):
        low = min(low, 0.0)
    around = 0.08 * (high - low) or 0.08 * abs(high) or 0.5
    axes.set_ylim(low - around, high + around)
    axes.axhline(0.0, color=COLOUR["limit"], linewidth=1.4, linestyle=(0, (6, 2.5)))
    axes.grid(axis="y", color=COLOUR["grid"], linewidth=0.7)
    axes.set_axisbelow(True)
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _place: f"{value:.6g}"))


def _turning(axes: Axes, turn: int, between: tuple[int | None, int | None]) -> None:
    """A line at the day of turning before the days between which it may be; their ends are open."""
    low, high = axes.get_xlim()
    if between != (None, None):
        first, last = (low if between[0] is None else between[0]), between[1]
        axes.axvspan(
            max(first, low),
            high if last is None else min(last, high),
            color=COLOUR["span"],
            linewidth=0,
            zorder=0.5,
        )
    axes.axvline(turn, color=COLOUR["culprit"], linewidth=1.6)


def _days(axes: Axes) -> None:
    axes.xaxis.set_major_locator(MaxNLocator(_TICKS, integer=True))
    axes.xaxis.set_major_formatter(FuncFormatter(_day))


def _day(number: float, _place: int | None) -> str:
    return (
        date.fromordinal(round(number)).isoformat() if 1 <= number <= date.max.toordinal() else ""
    )
