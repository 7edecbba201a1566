"""The study's own two figures: the main result, and how well confidence is calibrated.

Call them within `pytpc_evaluation.stats.drawing.style`.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pytpc_evaluation.stats.drawing import COLOURS, CULPRIT, FAINT, GRID, INK
from pytpc_evaluation.study.data import LABELS
from pytpc_evaluation.study.metrics import CONFIDENT, Estimate
from pytpc_evaluation.study.report.confidence import Calibration
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.positions import Position, ordered
from pytpc_evaluation.study.report.ranked import (
    BESIDE_CLEAN,
    METHODS,
    OURS,
    TARGETS,
    changed_rows,
    top,
)

_WIDTH = 8.6
_NUMBER_WIDTH = 11
"""So much of the axis, in %, does a number take."""
_BOLD = (OURS, BESIDE_CLEAN)


def result_chart(rows: Sequence[Position], part: Part) -> Figure:
    """Top 3 by method, a panel for each labels, with the intervals and the targets."""
    own = changed_rows(rows, part)
    methods = ordered((row.method for row in own), METHODS)
    height = 1.3 + 0.26 * max(3, len(methods))
    figure = Figure(figsize=(_WIDTH, height))
    panels = figure.subplots(1, len(LABELS), sharey=True)
    figure.subplots_adjust(
        left=0.165, right=0.985, top=1 - 0.62 / height, bottom=0.5 / height, wspace=0.13
    )
    figure.suptitle(
        f"Changed parameter among the first three, the {part.title}", x=0.008, y=1 - 0.08 / height,
        ha="left", va="top", fontsize=10.5, weight="bold",
    )  # fmt: skip
    for axes, labels in zip(panels, LABELS, strict=True):
        for place, method in enumerate(methods):
            here = [row for row in own if (row.method, row.labels) == (method, labels)]
            _bar(axes, place, top(here, 3), method in _BOLD)
        axes.axvline(100 * TARGETS[labels], color=CULPRIT, linewidth=1.2, linestyle=(0, (4, 2)))
        axes.set_title(f"{labels} marks", loc="left", fontsize=9)
        axes.set_xlim(0, 100)
        axes.set_xticks([0, 20, 40, 60, 80, 100])
        axes.set_xlabel("% of the treatments")
        axes.set_yticks(range(len(methods)), methods)
        axes.set_ylim(len(methods) - 0.4, -0.6)
        axes.tick_params(axis="y", length=0)
        axes.grid(axis="x", color=GRID, linewidth=0.6)
        axes.set_axisbelow(True)
    for label, method in zip(panels[0].get_yticklabels(), methods, strict=True):
        label.set_fontweight("bold" if method in _BOLD else "normal")
    return figure


def reliability_chart(found: Calibration, method: str) -> Figure:
    """Share of right verdicts over confidence; the dashed line is where they would be equal.

    Sparse bins have no bar.
    """
    figure = Figure(figsize=(4.6, 4.2))
    axes = figure.subplots()
    figure.subplots_adjust(left=0.13, right=0.97, top=0.9, bottom=0.12)
    axes.plot([0, 1], [0, 1], color=FAINT, linewidth=1.0, linestyle=(0, (4, 2)))
    axes.axvline(CONFIDENT, color=CULPRIT, linewidth=1.0, linestyle=(0, (1, 1.5)))
    axes.annotate(
        "accuses from here on",
        (CONFIDENT, 1.17),
        xytext=(4, 0),
        textcoords="offset points",
        va="top",
        fontsize=7.5,
        color=CULPRIT,
    )
    for one in found.drawn:
        axes.bar(
            one.low, one.right, width=one.high - one.low, align="edge", color="#cfe3f1",
            edgecolor=COLOURS[0], linewidth=0.8,
        )  # fmt: skip
        axes.plot([one.confidence], [one.right], marker="o", color=COLOURS[0], markersize=5)
        # Above the bar: beside the point the dashed line would run through it.
        axes.annotate(
            f"n = {one.verdicts}", ((one.low + one.high) / 2, one.right), xytext=(0, 8),
            textcoords="offset points", ha="center", fontsize=7.5,
            bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none"},
        )  # fmt: skip
    axes.set_title(f"{method}: {found.said}", loc="left", fontsize=9, weight="bold")
    axes.set_xlim(0, 1)
    axes.set_ylim(0, 1.18)
    axes.set_yticks([0, 0.2, 0.4, 0.6, 0.8, 1.0])
    axes.set_xlabel("confidence of the verdict", color=INK)
    axes.set_ylabel("share of verdicts whose first is to blame")
    axes.grid(axis="y", color=GRID, linewidth=0.6)
    axes.set_axisbelow(True)
    return figure


def _bar(axes: Axes, place: int, share: Estimate, ours: bool) -> None:
    if not share.treatments:
        axes.annotate("-", (0, place), xytext=(4, 0), textcoords="offset points", va="center")
        return
    value, low, high = (100 * number for number in (share.value, share.low, share.high))
    axes.barh(
        place, value, height=0.66, color=COLOURS[0] if ours else "#a9b8c4",
    )  # fmt: skip
    axes.plot([low, high], [place, place], color=INK, linewidth=1.3, solid_capstyle="butt")
    for end in (low, high):
        axes.plot([end, end], [place - 0.16, place + 0.16], color=INK, linewidth=1.3)
    # Within the bar there has to be room for it before the interval begins.
    inside = low > _NUMBER_WIDTH or high > 100 - _NUMBER_WIDTH
    axes.annotate(
        f"{value:.0f}", (0 if inside else high, place), xytext=(4, 0), textcoords="offset points",
        va="center", fontsize=7.5, color="white" if inside and ours else INK,
    )  # fmt: skip
