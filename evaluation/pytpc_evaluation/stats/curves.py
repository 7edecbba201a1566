"""Figures 6.15 to 6.18: what the robot did, above the rank curves of both types, with the marks.

The changed parameter is red, thick and above all others. Of the others those that are ranked
highest are told apart by colour and dash and named; the rest are thin and grey. Where a parameter
has no score it has no line: the thesis draws those at rank 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib.patheffects as effects
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from pytpc.base.columns import Bools, Floats
from pytpc.base.wording import many
from pytpc.diagnosis.results.advice import RankCurves
from pytpc.diagnosis.scores.scores import NONE
from pytpc.recording.marks import MARK_TYPES, Mark
from pytpc.recording.mission import Recording
from pytpc.static.parameters import same_parameter
from pytpc_evaluation.stats.drawing import (
    COLOURS,
    CULPRIT,
    DASHES,
    FAINT,
    GRID,
    REST,
    draw_marks,
    mark_line,
    short,
)
from pytpc_evaluation.stats.states import Phases, RobotState

NAMED = 8
_SIZE = (8.6, 8.0)
_LEFT, _RIGHT = 0.095, 0.755
_LONGEST = 28
_SHORTEST = 12
_LANES = 12
_DENSITY_S = 5.0


@dataclass(frozen=True, slots=True)
class _Line:
    """How one parameter is drawn."""

    colour: str
    dash: object
    width: float
    label: str | None
    order: int


def mission_figure(
    title: str,
    recording: Recording,
    curves: RankCurves,
    state: RobotState,
    changed: str | None = None,
) -> Figure:
    """The figure of one mission; call it within `drawing.style`.

    Args:
        title: above it.
        recording: for its length and marks.
        curves: of the same mission.
        state: what is drawn at the top; where it is empty, how dense the marks are.
        changed: the parameter that the treatment changed.
    """
    figure = Figure(figsize=_SIZE)
    bands = len(state.phases)
    heights = [*(0.12 + 0.13 * len(_lanes(phases)) for phases in state.phases), 1.9, 2.3, 2.3]
    panels = figure.subplots(
        len(heights), 1, sharex=True, gridspec_kw={"height_ratios": heights, "hspace": 0.16}
    )
    figure.subplots_adjust(left=_LEFT, right=_RIGHT, top=0.92, bottom=0.06)
    figure.suptitle(short(title, 80), x=_LEFT, y=0.985, ha="left", fontsize=10.5, weight="bold")
    seconds = max(recording.seconds, 1e-3)
    for axes, phases in zip(panels[:bands], state.phases, strict=True):
        _phases(axes, phases, seconds)
    upper = panels[bands]
    if state.series:
        _state(upper, state)
    else:
        _density(upper, recording, seconds)
    lines = _lines(curves, [mark.time_ns for mark in recording.marks], changed)
    times = (curves.times_ns - recording.start_ns) / 1e9
    for axes, kind, rank, score in (
        (panels[-2], "I", curves.rank1, curves.score1),
        (panels[-1], "II", curves.rank2, curves.score2),
    ):
        _ranks(axes, times, np.where(score == NONE, np.nan, rank), lines)
        axes.set_ylabel(f"rank by type {kind}")
    # The lines are the same in both.
    _legend(panels[-2], reverse=True)
    inside = _inside(recording)
    for axes in panels:
        draw_marks(axes, inside, recording.start_ns)
        axes.set_xlim(-0.01 * seconds, 1.01 * seconds)
    panels[-1].set_xlabel("seconds since the mission began")
    if recording.marks:
        _legend_of_marks(figure, inside, len(recording.marks) - len(inside))
    return figure


def _inside(recording: Recording) -> list[Mark]:
    """The marks during the mission; others have no place in the figure."""
    begin, end = recording.start_ns, recording.end_ns
    return [mark for mark in recording.marks if begin <= mark.time_ns <= end]


def _legend_of_marks(figure: Figure, marks: Sequence[Mark], outside: int) -> None:
    kinds = {mark.type for mark in marks}
    handles = [mark_line(kind) for kind in (*MARK_TYPES, None) if kind in kinds]
    if outside:
        text = f"({many(outside, 'mark')} before or after the mission)"
        handles.append(Line2D([], [], linestyle="none", label=text))
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(_LEFT - 0.01, 0.97),
        ncols=4,
        frameon=False,
        fontsize=7.5,
        handlelength=2.6,
    )


def _phases(axes: Axes, phases: Phases, seconds: float) -> None:
    """A lane for each text, in the order in which they first occur; of many only the first."""
    names = _lanes(phases)
    ends = np.append(phases.times[1:], max(seconds, float(phases.times.max(initial=0.0))))
    for begin, end, name in zip(phases.times, ends, phases.names, strict=True):
        if name in names:
            axes.barh(names.index(name), end - begin, left=begin, height=0.7, color=FAINT)
    axes.set_yticks(range(len(names)), [short(name, _SHORTEST) for name in names], fontsize=6.5)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.grid(axis="y", color=GRID, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(axis="both", length=0)
    axes.spines["left"].set_visible(False)
    axes.spines["bottom"].set_visible(False)
    left_out = len(set(phases.names)) - len(names)
    more = f"\nand {left_out} more" if left_out else ""
    axes.annotate(
        short(phases.label, _LONGEST) + more, (1.0, 1.0), xycoords="axes fraction", xytext=(8, 0),
        textcoords="offset points", va="top", fontsize=7.5, annotation_clip=False,
    )  # fmt: skip


def _lanes(phases: Phases) -> list[str]:
    return list(dict.fromkeys(phases.names))[:_LANES]


def _state(axes: Axes, state: RobotState) -> None:
    for number, series in enumerate(state.series):
        axes.plot(
            series.times,
            series.values,
            color=COLOURS[number % len(COLOURS)],
            linestyle=DASHES[number % len(DASHES)],
            linewidth=1.5,
            label=short(series.label, _LONGEST),
        )
    axes.grid(axis="y", color=GRID, linewidth=0.6)
    axes.set_ylabel("robot")
    _legend(axes)


def _density(axes: Axes, recording: Recording, seconds: float) -> None:
    """How many marks there are around each time, where nothing is known of the robot."""
    times = [(mark.time_ns - recording.start_ns) / 1e9 for mark in recording.marks]
    edges = np.arange(0.0, max(seconds, _DENSITY_S) + _DENSITY_S, _DENSITY_S)
    counts, _ = np.histogram(times, edges)
    axes.stairs(counts, edges, fill=True, color=REST, edgecolor=FAINT, linewidth=0.8)
    axes.set_ylim(0, max(1, int(counts.max(initial=0))) * 1.1)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True, nbins=4))
    axes.set_ylabel(f"marks in {_DENSITY_S:.0f} s")


def _ranks(axes: Axes, times: Floats, ranks: Floats, lines: Sequence[_Line]) -> None:
    for column, line in enumerate(lines):
        halo = [effects.withStroke(linewidth=line.width + 2, foreground="white")]
        axes.plot(
            times,
            ranks[:, column],
            color=line.colour,
            linestyle=line.dash,
            linewidth=line.width,
            drawstyle="steps-post",
            zorder=line.order,
            label=line.label,
            path_effects=halo if line.order == 3 else None,
        )
    known = ranks[np.isfinite(ranks)]
    lowest = float(known.min(initial=0.9))
    axes.set_ylim(min(0.9, np.floor(lowest * 10) / 10) - 0.01, 1.01)
    axes.grid(axis="y", color=GRID, linewidth=0.6)
    axes.set_axisbelow(True)


def _legend(axes: Axes, *, reverse: bool = False) -> None:
    handles, labels = axes.get_legend_handles_labels()
    shown = list(zip(handles, labels, strict=True))
    if not shown:
        return
    if reverse:
        shown.sort(key=lambda pair: -pair[0].get_zorder())
    axes.legend(
        *zip(*shown, strict=True), loc="upper left", bbox_to_anchor=(1.005, 1.02), frameon=False,
        fontsize=7.2, handlelength=2.8, labelspacing=0.45,
    )  # fmt: skip


def _lines(curves: RankCurves, marks_ns: Sequence[int], changed: str | None) -> list[_Line]:
    """A line for each parameter; those are named that are ranked highest at the marks, if any."""
    culprit: Bools = np.array(
        [changed is not None and same_parameter(changed, name) for name in curves.parameters],
        dtype=np.bool_,
    )
    best = np.maximum(curves.rank1, curves.rank2)
    if marks_ns and best.size:
        # A mark after the mission is about its end.
        place_of = np.searchsorted(curves.times_ns, marks_ns, side="right") - 1
        best = best[np.clip(place_of, 0, best.shape[0] - 1)]
    weight = best.mean(axis=0) if best.size else np.zeros(len(curves.parameters))
    order = [n for n in np.argsort(-weight, kind="stable").tolist() if not culprit[n]]
    place = {n: number for number, n in enumerate(order[:NAMED]) if weight[n] > 0}
    lines = []
    for number, name in enumerate(curves.parameters):
        label = short(name, _LONGEST)
        if culprit[number]:
            lines.append(_Line(CULPRIT, "-", 2.6, f"{label}\n(changed)", 3))
        elif number in place:
            turn = place[number]
            dash = DASHES[turn % len(DASHES)]
            lines.append(_Line(COLOURS[turn % len(COLOURS)], dash, 1.3, label, 2))
        else:
            told = any(line.order == 1 for line in lines)
            lines.append(_Line(REST, "-", 0.7, None if told else "others", 1))
    return lines
