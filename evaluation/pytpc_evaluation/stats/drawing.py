"""What the study's figures share: settings, colours that differ in grey too, and files.

Colours are those of Okabe and Ito, which colour-blind readers tell apart; nothing is told by colour
alone. The same input gives the same bytes.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from pytpc.base.atomic import write_atomic
from pytpc.base.wording import plain
from pytpc.recording.marks import Mark, MarkType

FORMATS = ("png", "svg", "pdf")

INK = "#1a1a1a"
FAINT = "#6b6b6b"
GRID = "#dcdcdc"
REST = "#c4c4c4"
CULPRIT = "#d00000"
COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#8a6d00", "#5e3c99", "#000000")
DASHES: Sequence[Any] = ("-", (0, (5, 1.5)), (0, (1, 1)), (0, (5, 1.5, 1, 1.5)))

_STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "tpc",
    "pdf.fonttype": 42,
    "text.parse_math": False,
    "axes.unicode_minus": False,
    "figure.facecolor": "white",
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "axes.grid": False,
    "text.color": INK,
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "lines.solid_capstyle": "butt",
    "hatch.linewidth": 0.8,
    "font.family": "DejaVu Sans",
    "font.size": 9,
}
# How the types of marks differ: colour, line, and what stands at its upper end.
_MARKS: dict[MarkType | None, tuple[str, Any, str, str]] = {
    "I": ("#0b4f9e", "-", "v", "mark of type I"),
    "II": ("#007a4d", (0, (4, 2)), "s", "mark of type II"),
    None: (FAINT, (0, (1, 1.5)), "o", "mark without a type"),
}
_METADATA: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}
_DPI = 150
# More of them are drawn thin, for the curves are to be seen between them.
_FEW_MARKS = 12


@contextmanager
def style() -> Iterator[None]:
    """Our settings, whatever the user's own are."""
    with mpl.rc_context(), warnings.catch_warnings():
        mpl.rcdefaults()
        mpl.rcParams.update(_STYLE)
        # A name may have characters that the font lacks; they are drawn as boxes.
        warnings.filterwarnings("ignore", message="Glyph")
        yield


def save(
    figure: Figure, target: Path, form: str, dpi: int = _DPI, *, palette: bool = False
) -> None:
    """Write a figure, atomically; call it within ``style``.

    Args:
        figure: it keeps its size.
        target: the file.
        form: one of ``FORMATS``.
        dpi: dots per inch, for ``png``.
        palette: write a ``png`` with 256 colours, which takes a third of the room.

    Raises:
        TpcError: the file cannot be written.
    """
    stream = io.BytesIO()
    FigureCanvasAgg(figure)
    figure.savefig(stream, format=form, dpi=dpi, metadata=_METADATA[form])
    if palette and form == "png":
        stream = _with_palette(stream)
    write_atomic(target, stream.getvalue())


def _with_palette(png: io.BytesIO) -> io.BytesIO:
    stream = io.BytesIO()
    with Image.open(png) as image:
        image.convert("RGB").quantize(256, dither=Image.Dither.NONE).save(
            stream, format="PNG", optimize=True
        )
    return stream


def short(text: str, length: int) -> str:
    """``text`` without what cannot be printed, its beginning left out where it is too long."""
    text = plain(text)
    return text if len(text) <= length else f"\N{HORIZONTAL ELLIPSIS}{text[1 - length :]}"


def draw_marks(axes: Axes, marks: Sequence[Mark], start_ns: int) -> None:
    """A vertical line for each mark, with its type's sign at the upper end.

    Args:
        axes: time in seconds of the mission is to the right.
        marks: of any types.
        start_ns: begin of the mission.
    """
    width = 1.2 if len(marks) <= _FEW_MARKS else 0.7
    for mark in marks:
        time = (mark.time_ns - start_ns) / 1e9
        colour, dash, _, _ = _MARKS[mark.type]
        axes.axvline(time, color=colour, linewidth=width, linestyle=dash, zorder=4)
        line = mark_line(mark.type)
        line.set_linestyle("none")
        line.set_data([time], [1.0])
        line.set_transform(axes.get_xaxis_transform())
        line.set_clip_on(False)
        line.set_zorder(6)
        line.set_label("_mark")
        axes.add_line(line)


def mark_line(kind: MarkType | None) -> Line2D:
    """How a mark of a type is drawn, for a legend."""
    colour, line, sign, label = _MARKS[kind]
    return Line2D(
        [], [], color=colour, linestyle=line, linewidth=1.2, marker=sign, markersize=5, label=label
    )
