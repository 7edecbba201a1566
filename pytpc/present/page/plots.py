"""The still figures of the report page, as SVG with the colours and the font of the page.

matplotlib writes literal colours into the SVG. Each of ours is replaced by a CSS variable of the
page, so that one figure serves a light page, a dark page and paper. Colour is never the only
signal: true and false differ in height and filling, the threshold is dashed, and the two types of
marks differ in line and label.
"""

from __future__ import annotations

import io
import math
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from pytpc.base.off_scale import off_scale
from pytpc.base.wording import show
from pytpc.present.page.environment import seen
from pytpc.present.page.series import SPANS, PlotData, joined_spans
from pytpc.recording.events import Floats
from pytpc.recording.marks import MarkType

# Stand-ins that matplotlib never writes by itself.
_COLOURS = {
    "#010101": "ink",
    "#020202": "faint",
    "#030303": "grid",
    "#040404": "value",
    "#050505": "limit",
    "#060606": "culprit",
    "#070707": "paper",
    "#080808": "span",
    "#090909": "would",
    "#0a0a0a": "lane",
}
COLOUR = {name: colour for colour, name in _COLOURS.items()}
_STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "tpc",
    "text.parse_math": False,
    "axes.unicode_minus": False,
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "axes.edgecolor": COLOUR["faint"],
    "axes.labelcolor": COLOUR["ink"],
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "text.color": COLOUR["ink"],
    "xtick.color": COLOUR["faint"],
    "ytick.color": COLOUR["faint"],
    "xtick.labelcolor": COLOUR["ink"],
    "ytick.labelcolor": COLOUR["ink"],
    "hatch.linewidth": 0.6,
    "lines.solid_capstyle": "butt",
}
_DOTS = 70
_HALF_BOX = 0.1
_HEADROOM = 0.16
_LARGEST = 1e150
_OUTLIER = 50.0
_FAR = 10.0
_FEW = 2
_FEW_OF_MANY = 0.02
MARK_LINES = {"I": "-", "II": (0, (5, 2)), None: (0, (1, 1.5))}


@dataclass(frozen=True, slots=True)
class EvidenceStyle:
    """What an evidence plot shows besides the evaluations; times in seconds.

    ``feasible`` are the thresholds that would do, as (low, high); either may be infinite. ``unit``
    is that of the values; empty if it is not known.
    """

    mark: float
    mark_type: MarkType | None
    window: float | None
    suggested: float | None
    culprit: bool
    feasible: tuple[tuple[float, float], ...] = ()
    unit: str = ""
    flag: bool = False

    @property
    def axis(self) -> str:
        """What the axis of values shows."""
        what = "flag" if self.flag else "value"
        return f"{what} in {self.unit}" if self.unit else what


def evidence_svg(data: PlotData, style: EvidenceStyle, ident: str, label: str) -> str:
    """Compared value and threshold over time, the mark, and the result below.

    Args:
        data: the evaluations.
        style: the rest.
        ident: prefix of all ids, unlike that of any other figure of the page.
        label: what the figure shows, for those who do not see it.

    Returns:
        An ``<svg>`` element.
    """
    with drawing(10.5):
        figure = Figure(figsize=(6.4, 2.9))
        upper, lower = figure.subplots(
            2, 1, sharex=True, gridspec_kw={"height_ratios": [5, 1], "hspace": 0.12}
        )
        figure.subplots_adjust(left=0.13, right=0.985, top=0.97, bottom=0.165)
        _values(upper, data, style)
        _outcomes(lower, data)
        for axes in (upper, lower):
            axes.axvline(
                style.mark,
                color=COLOUR["ink"],
                linewidth=1.3,
                linestyle=MARK_LINES[style.mark_type],
            )
            if style.window is not None:
                axes.axvspan(
                    max(style.window, data.begin),
                    style.mark,
                    color=COLOUR["span"],
                    linewidth=0,
                    # Behind the spans of summaries, too, which are no lines.
                    zorder=0.5,
                )
        _name_mark(upper, data, style)
        lower.set_xlabel("seconds since the recording began")
        margin = 0.01 * max(data.end - data.begin, 1e-3)
        lower.set_xlim(data.begin - margin, data.end + margin)
        return svg_of(figure, ident, label)


def _values(axes: Axes, data: PlotData, style: EvidenceStyle) -> None:
    colour = COLOUR["culprit" if style.culprit else "value"]
    finite, limit = drawable(data.cmp), drawable(data.thresh)
    axes.plot(data.time, finite, color=colour, linewidth=1.4)
    _boxes(axes, data.kept, colour)
    # A parameter keeps its value while nothing is compared with it.
    known = np.flatnonzero(np.isfinite(data.time))
    around = [*known[:1], *known, *known[-1:]]
    axes.step(
        [data.begin, *data.time[known], data.end] if known.size else [],
        limit[around],
        where="post",
        color=COLOUR["limit"],
        linewidth=1.6,
        linestyle=(0, (6, 2.5)),
    )
    if data.evaluations <= _DOTS:
        _dots(axes, data, finite, colour)
    suggested = np.nan if style.suggested is None else style.suggested
    if np.isfinite(suggested):
        axes.axhline(
            suggested,
            color=COLOUR["limit"],
            linewidth=1.3,
            linestyle=(0, (1, 1.6)),
        )
    low, high, _ = value_span(data, style)
    axes.set_ylim(low, high)
    for begin, end in style.feasible:
        shown = max(begin, low), min(end, high)
        if shown[0] < shown[1]:
            axes.axhspan(
                *shown, facecolor="none", edgecolor=COLOUR["would"], hatch="//", linewidth=0
            )
    if beyond_text(data, style):
        _at_the_edge(axes, data, style, colour)
    axes.grid(axis="y", color=COLOUR["grid"], linewidth=0.7)
    axes.set_axisbelow(True)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    axes.tick_params(axis="x", length=0, labelbottom=False)
    axes.set_ylabel(style.axis, labelpad=3)


def _boxes(axes: Axes, kept: Floats, colour: str, around: float = 0.0) -> None:
    """A box for each summary, from its lowest to its highest value and ``around`` beyond both."""
    begin, end, lowest, highest = joined_spans(kept, SPANS)
    end = np.maximum(end, begin + 1e-3)
    low, high = lowest - around, highest + around
    corners = [(begin, low), (begin, high), (end, high), (end, low)]
    boxes = np.array(corners).transpose(2, 0, 1)
    axes.add_collection(PolyCollection(list(boxes), color=colour, alpha=0.35, linewidth=1))


def _at_the_edge(axes: Axes, data: PlotData, style: EvidenceStyle, colour: str) -> None:
    """A triangle at the edge wherever a compared value is beyond it."""
    for times, edge, sign in zip(times_beyond(data, style), (0.0, 1.0), "v^", strict=True):
        axes.plot(
            times,
            np.full(times.size, edge),
            transform=axes.get_xaxis_transform(),
            linestyle="none",
            marker=sign,
            markersize=6,
            color=colour,
            clip_on=False,
        )


def _dots(axes: Axes, data: PlotData, values: Floats, colour: str) -> None:
    """Single evaluations: filled where the result was true, hollow where it was false."""
    after = np.searchsorted(data.steps, data.time, side="right") - 1
    drawn = np.isfinite(data.time)
    true = drawn & data.outcome[np.clip(after, 0, None)]
    for chosen, face in ((true, colour), (drawn & ~true, COLOUR["paper"])):
        axes.plot(
            data.time[chosen],
            values[chosen],
            linestyle="none",
            marker="o",
            markersize=4,
            markeredgecolor=colour,
            markerfacecolor=face,
        )


def drawable(values: Floats) -> Floats:
    """Drawable values: finite, and small enough for matplotlib to subtract."""
    return np.clip(np.where(np.isfinite(values), values, np.nan), -_LARGEST, _LARGEST)


def value_span(data: PlotData, style: EvidenceStyle) -> tuple[float, float, bool]:
    """The ends of the axis of values, and whether values lie beyond them."""
    suggested = np.nan if style.suggested is None else style.suggested
    limits = np.append(drawable(data.thresh), suggested)
    low, high, beyond = _span(drawable(_compared(data)), limits)
    margin = 0.08 * (high - low)
    return low - margin, high + margin + _HEADROOM * (high - low), beyond


def times_beyond(data: PlotData, style: EvidenceStyle) -> tuple[Floats, Floats]:
    """When compared values lie below the axis, and when above; float64 each, at most ``SPANS``."""
    low, high, beyond = value_span(data, style)
    times = np.clip(np.concatenate([data.time, *data.kept[[0, 0]]]), data.begin, data.end)
    values = _compared(data)
    below, above = (np.unique(times[far & beyond]) for far in (values < low, values > high))
    return below[:: 1 + below.size // SPANS], above[:: 1 + above.size // SPANS]


def beyond_text(data: PlotData, style: EvidenceStyle) -> str:
    """``compared values beyond this plot, up to 1795763972``; empty if none are."""
    low, high, beyond = value_span(data, style)
    values = _compared(data)
    below, above = values[values < low], values[values > high]
    if not beyond or not below.size + above.size:
        return ""
    ends = [f"down to {show(float(below.min()))}"] if below.size else []
    ends += [f"up to {show(float(above.max()))}"] if above.size else []
    return f"compared values beyond this plot, {' and '.join(ends)}"


def _compared(data: PlotData) -> Floats:
    """The compared values and the ends of the summaries, which belong to the times of both."""
    return np.concatenate([data.cmp, data.kept[2], data.kept[3]])


def _span(values: Floats, limits: Floats) -> tuple[float, float, bool]:
    """Lowest and highest of the axis, and whether values lie beyond them.

    Outliers (a distance that starts as the largest double, a time since the epoch) must not flatten
    all others. If what is left without them fills less than a fiftieth, only that is shown.
    """
    everything = np.concatenate([values, limits])
    everything = everything[np.isfinite(everything)]
    if not everything.size:
        return 0.0, 1.0, False
    low, high = float(everything.min()), float(everything.max())
    inner = _without_outliers(values[np.isfinite(values)], limits[np.isfinite(limits)])
    if inner[0] < inner[1] and (high - low) > _OUTLIER * (inner[1] - inner[0]):
        return *inner, True
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        around = 0.5 * abs(low) or 0.5
        return low - around, high + around, False
    return low, high, False


def _without_outliers(values: Floats, limits: Floats) -> tuple[float, float]:
    """The ends of the limits and of the values that are no outliers.

    Outliers are values off the scale, however many, and a few that are far from the others: at most
    2 % of those drawn, two of a short series, and never half of it. What is not few sets the axis,
    however far away: a signal with two levels is to be seen moving.
    """
    if not values.size:
        return math.nan, math.nan
    values = values[~off_scale(values, limits)]
    few = min(max(_FEW, int(_FEW_OF_MANY * values.size)), (values.size - 1) // 2)
    inward = np.argsort(np.abs(values - np.median(values)), kind="stable")
    most = np.append(values[inward[: values.size - few]], limits)
    low, high = float(most.min()), float(most.max())
    reach = _FAR * (high - low)
    near = values[(values >= low - reach) & (values <= high + reach)]
    shown = np.append(near, limits)
    return float(shown.min()), float(shown.max())


def _name_mark(axes: Axes, data: PlotData, style: EvidenceStyle) -> None:
    """Name the mark beside its line, on the side with room."""
    right = style.mark - data.begin < 0.85 * (data.end - data.begin)
    axes.annotate(
        f"mark, type {style.mark_type}" if style.mark_type else "mark",
        (style.mark, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(4 if right else -4, -3),
        textcoords="offset points",
        ha="left" if right else "right",
        va="top",
        bbox={"facecolor": COLOUR["paper"], "edgecolor": "none", "pad": 1.0, "alpha": 0.8},
    )


def _outcomes(axes: Axes, data: PlotData) -> None:
    """The results: a line of those reported one by one, and a box for each summary."""
    _boxes(axes, data.kept_results, COLOUR["value"], _HALF_BOX)
    if data.steps.size:
        time = np.append(data.steps, data.ends)
        level = np.append(data.outcome, data.outcome[-1]).astype(np.float64)
        axes.fill_between(
            time, 0, level, step="post", color=COLOUR["value"], alpha=0.3, linewidth=0
        )
        axes.step(time, level, where="post", color=COLOUR["value"], linewidth=1.2)
        # The last result still holds, but was not evaluated again.
        axes.plot(
            [data.ends, data.end], level[-2:], color=COLOUR["value"], linewidth=1.2, linestyle=":"
        )
    axes.set_ylim(-0.25, 1.3)
    axes.set_yticks([0, 1], ["false", "true"])
    axes.tick_params(axis="y", length=0)


def shortened(text: str, most: int) -> str:
    """``text``, cut to so many characters."""
    return text if len(text) <= most else f"{text[: most - 1]}…"


@contextmanager
def drawing(size: float) -> Iterator[None]:
    """Our settings, with text of ``size`` points."""
    with mpl.rc_context({**_STYLE, "font.size": size}), warnings.catch_warnings():
        # The page's own font draws the text; glyphs that matplotlib's font lacks do not matter.
        warnings.filterwarnings("ignore", message="Glyph")
        yield


def svg_of(figure: Figure, ident: str, label: str) -> str:
    """The figure as an element of a page: own ids, the page's colours and font, no fixed size."""
    stream = io.StringIO()
    FigureCanvasSVG(figure)
    figure.savefig(stream, format="svg", metadata={"Date": None})
    text = stream.getvalue()
    text = seen(text[text.index("<svg") :].rstrip())
    text = re.sub(r"<(metadata|style)\b.*?</\1>\s*", "", text, flags=re.DOTALL)
    text = re.sub(r'\bid="', f'id="{ident}-', text)
    text = re.sub(r'(href="#|url\(#)', rf"\g<1>{ident}-", text)
    for colour, name in _COLOURS.items():
        text = text.replace(colour, f"var(--{name})")
    text = re.sub(r"font: ((?:bold |[0-9]+ )?[0-9.]+px) [^;\"]*", r"font: \1 var(--sans)", text)
    text = re.sub(r"\n\s*", "\n", text)
    head, _, body = text.partition(">")
    view = re.search(r'viewBox="([^"]*)"', head)
    assert view is not None, "matplotlib writes a viewBox"
    return (
        f'<svg role="img" aria-label="{escape(seen(label))}" viewBox="{view[1]}"'
        f' xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">{body}'
    )
