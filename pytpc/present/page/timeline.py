"""The figure of a whole mission: the results of the suspects' comparisons, their ranks, the marks.

It is drawn twice: as a still SVG, and as numbers for the figure that can be moved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pytpc.base.columns import Floats
from pytpc.present.page.payload import curves_of, lanes_of
from pytpc.present.page.plots import COLOUR, MARK_LINES, drawing, shortened, svg_of
from pytpc.present.page.reported_mission import ReportedMission
from pytpc.present.page.series import BINS, BOTH, FALSE, TRUE, lane, runs
from pytpc.recording.marks import MarkType
from pytpc.static.parameters import same_parameter

_LANES = 8
_HEIGHTS = {TRUE: 0.62, BOTH: 0.34, FALSE: 0.08}
_DASHES = ((6, 2.5), (1.5, 2), (7, 2, 1.5, 2), (3, 3), (9, 2), (1.5, 4), (5, 1.5, 1.5, 1.5))
_LANE_INCHES, _CURVE_INCHES = 0.25, 0.95
_STILL_STEPS = 600


@dataclass(frozen=True, slots=True)
class Lane:
    """One parameter: int8[BINS] states of ``series``, and whether it stands out."""

    label: str
    states: npt.NDArray[np.int8]
    accent: bool
    culprit: bool


def timeline(mission: ReportedMission, ident: str) -> tuple[Markup, dict[str, object] | None]:
    """The still figure, and the numbers of the moving one; nothing without a suspect.

    Its lanes are the parameters that come first at some mark, and the one that stands out: the
    changed one in a study, else the first suspect of all marks together.
    """
    recording = mission.recording
    best: dict[str, tuple[int, str]] = {}
    for ranking in mission.rankings:
        for suspect in ranking.suspects:
            known = best.get(suspect.parameter)
            if known is None or suspect.position < known[0]:
                best[suspect.parameter] = (suspect.position, suspect.key)
    ranked = sorted(best, key=lambda name: (best[name][0], name))
    order, curves = ranked[:_LANES], mission.answer.curves
    if not order or curves is None:
        return Markup(""), None
    out = _standing_out(mission, ranked)
    if out not in order:
        order[-1] = out
    start = recording.start_ns
    accent = order.index(out)
    culprit = mission.is_changed(out, best[out][1])
    lanes = [
        Lane(name, lane(recording, best[name][1]), name == out, name == out and culprit)
        for name in order
    ]
    marks = [(mission.seconds(mark.time_ns), mark.type) for mark in recording.marks]
    places = [curves.parameters.index(name) for name in order]
    every = max(1, curves.times_ns.size // _STILL_STEPS)
    still = (
        (curves.times_ns[::every] - start) / 1e9,
        curves.rank1[::every, places],
        curves.rank2[::every, places],
    )
    svg = _svg(lanes, still, marks, recording.seconds, ident=f"{ident}-t")
    moving = lanes_of(recording, [(name, best[name][1]) for name in order])
    moving["curves"] = curves_of(curves, order, start)
    moving["accent"] = accent
    moving["culprit"] = culprit
    return Markup(svg), moving


def _standing_out(mission: ReportedMission, ranked: Sequence[str]) -> str:
    if mission.changed_parameter is not None:
        named = (name for name in ranked if same_parameter(mission.changed_parameter, name))
        return next(named, ranked[0])
    lead = mission.answer.lead
    return lead.accused.parameter if lead and lead.accused.parameter in ranked else ranked[0]


def _svg(
    lanes: Sequence[Lane],
    curves: tuple[Floats, Floats, Floats],
    marks: Sequence[tuple[float, MarkType | None]],
    seconds: float,
    *,
    ident: str,
) -> str:
    """Every suspect's results and ranks over the whole mission, and the marks, numbered from 1.

    Times are seconds since the recording began; no other figure has ids that begin as ``ident``.
    ``curves`` are float64[t] times, and float64[t, lanes] ranks of the lanes' parameters by types I
    and II.
    """
    label = f"results and ranks of {len(lanes)} parameters over {seconds:.0f} s, {len(marks)} marks"
    seconds = max(seconds, 1e-3)
    heights = [0.25 + _LANE_INCHES * len(lanes), _CURVE_INCHES, _CURVE_INCHES]
    with drawing(8.8):
        figure = Figure(figsize=(10.0, 0.75 + sum(heights)))
        height = figure.get_figheight()
        upper, first, second = figure.subplots(
            3, 1, sharex=True, gridspec_kw={"height_ratios": heights, "hspace": 0.14}
        )
        figure.subplots_adjust(left=0.22, right=0.985, top=1 - 0.22 / height, bottom=0.42 / height)
        _lanes(upper, lanes, seconds)
        for axes, ranks, kind in ((first, curves[1], "I"), (second, curves[2], "II")):
            _ranks(axes, lanes, curves[0], ranks)
            axes.set_ylabel(f"rank, type {kind}")
        for number, (time, mark_type) in enumerate(marks, start=1):
            for axes in (upper, first, second):
                axes.axvline(
                    time, color=COLOUR["ink"], linewidth=1.1, linestyle=MARK_LINES[mark_type]
                )
            if number in _labelled([time for time, _ in marks], seconds):
                upper.annotate(
                    f"{number}",
                    (time, 1.0),
                    xycoords=("data", "axes fraction"),
                    xytext=(0, 2),
                    textcoords="offset points",
                    ha="center",
                    annotation_clip=False,
                )
        upper.set_xlim(-0.005 * seconds, 1.005 * seconds)
        upper.tick_params(axis="x", length=0, labelbottom=False)
        first.tick_params(axis="x", length=0, labelbottom=False)
        second.set_xlabel("seconds since the recording began")
        return svg_of(figure, ident, label)


def _lanes(axes: Axes, lanes: Sequence[Lane], seconds: float) -> None:
    width = seconds / BINS
    for row, one in enumerate(lanes):
        for state, first, length in runs(one.states):
            height = _HEIGHTS[state]
            axes.broken_barh(
                [(first * width, length * width)],
                (row - height / 2, height),
                facecolors=_colour(one),
                linewidth=0,
                hatch="////" if state == BOTH else None,
                edgecolor=COLOUR["paper"],
            )
    axes.set_ylim(len(lanes) - 0.4, -0.6)
    axes.set_yticks(range(len(lanes)), [shortened(one.label, 30) for one in lanes])
    for tick, one in zip(axes.get_yticklabels(), lanes, strict=True):
        if one.accent:
            tick.set_color(_colour(one))
            tick.set_fontweight("bold")
    axes.tick_params(axis="y", length=0)


def _ranks(axes: Axes, lanes: Sequence[Lane], seconds: Floats, ranks: Floats) -> None:
    """The one that stands out is a thick line in front, the others have dashes of their own."""
    for row, one in enumerate(lanes):
        axes.step(
            seconds,
            ranks[:, row],
            where="post",
            color=_colour(one),
            linewidth=1.9 if one.accent else 0.8,
            linestyle="-" if one.accent else (0, _DASHES[row % len(_DASHES)]),
            zorder=3 if one.accent else 2,
        )
    axes.set_ylim(-0.04, 1.06)
    axes.set_yticks([0, 0.5, 1])
    axes.grid(axis="y", color=COLOUR["grid"], linewidth=0.7)
    axes.tick_params(axis="y", length=0)


def _colour(one: Lane) -> str:
    if not one.accent:
        return COLOUR["lane"]
    return COLOUR["culprit" if one.culprit else "value"]


def _labelled(times: Sequence[float], seconds: float) -> set[int]:
    """Numbers of the marks that have room for their number: those far enough from the last one."""
    chosen: set[int] = set()
    last = -seconds
    for number, time in enumerate(times, start=1):
        if time - last >= 0.018 * seconds:
            chosen.add(number)
            last = time
    return chosen
