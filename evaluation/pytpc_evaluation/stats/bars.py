"""Figure 6.14: the share of the missions' seconds in which each parameter is compared with."""

from __future__ import annotations

from collections.abc import Collection

from matplotlib.figure import Figure

from pytpc.base.wording import many
from pytpc.static.parameters import same_parameter
from pytpc_evaluation.stats.drawing import COLOURS, CULPRIT, FAINT, GRID, INK, short
from pytpc_evaluation.stats.runtime import RuntimeStatistics

_WIDTH = 7.0
_LINE = 0.165
_AROUND = 0.95
_LONGEST = 34


def runtime_bars(found: RuntimeStatistics, changed: Collection[str] = ()) -> Figure:
    """A bar for each parameter, the most frequent first; call it within `drawing.style`.

    ``changed`` parameters are hatched and their names bold.
    """
    rows = sorted(found.rows, key=lambda row: (-row.runtime, row.parameter))
    height = _AROUND + _LINE * max(3, len(rows))
    figure = Figure(figsize=(_WIDTH, height))
    axes = figure.subplots()
    figure.subplots_adjust(left=0.36, right=0.94, top=1 - 0.35 / height, bottom=0.5 / height)
    axes.set_title(
        f"{many(len(rows), 'parameter')} in {many(found.missions, 'mission')} of"
        f" {found.seconds:.0f} s together",
        loc="left",
        fontsize=9,
    )
    for place, row in enumerate(rows):
        culprit = any(same_parameter(name, row.parameter) for name in changed)
        axes.barh(
            place,
            row.runtime,
            height=0.72,
            color="white" if culprit else COLOURS[0],
            edgecolor=CULPRIT if culprit else COLOURS[0],
            hatch="////" if culprit else None,
            linewidth=1.0 if culprit else 0.0,
        )
        axes.annotate(
            f"{row.runtime:.1f}",
            (row.runtime, place),
            xytext=(3, 0),
            textcoords="offset points",
            va="center",
            fontsize=6.5,
            color=FAINT,
        )
    axes.set_yticks(range(len(rows)), [short(row.parameter, _LONGEST) for row in rows], fontsize=7)
    for label, row in zip(axes.get_yticklabels(), rows, strict=True):
        if any(same_parameter(name, row.parameter) for name in changed):
            label.set_fontweight("bold")
            label.set_color(CULPRIT)
    axes.set_ylim(max(3, len(rows)) - 0.4, -0.6)
    axes.set_xlim(0, 100)
    axes.set_xticks(range(0, 101, 20))
    axes.tick_params(axis="y", length=0)
    axes.grid(axis="x", color=GRID, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel("% of the seconds in which it is compared with", color=INK)
    return figure
