"""An animated SVG of a terminal: what a screen of pyte's shows over time, as text and CSS.

Each line of the screen is a film of its own: all that it ever shows stands in a column, of which
one piece is seen. So a piece is written once, however long it stays, and a viewer without
animation, or whose user wants none, sees the last screen.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Sequence
from html import escape
from itertools import groupby
from typing import Any, NamedTuple

import pyte

COLUMN, LINE, BASE, SIZE, EDGE = 8.4, 18, 13, 14, 14
"""Width of a character, height of a line and of its part above the baseline, size of the font,
and margin, in pixels."""

_ALTERNATE = 1049 << 5
"""As pyte numbers the private mode in which programs use the whole screen."""

_DEFAULT = ("#1f2328", "#e6edf3")
_GROUND = ("#ffffff", "#0d1117")
_NAMED = {
    "black": ("#24292f", "#6e7681"),
    "red": ("#cf222e", "#ff7b72"),
    "green": ("#116329", "#3fb950"),
    "brown": ("#7d4e00", "#d29922"),
    "blue": ("#0550ae", "#58a6ff"),
    "magenta": ("#8250df", "#bc8cff"),
    "cyan": ("#1b6c75", "#39c5cf"),
    "white": ("#57606a", "#b1bac4"),
}
"""What pyte calls a colour, on a light and on a dark ground."""


class Style(NamedTuple):
    """Colours in pyte's words, ``ground`` being that behind the text."""

    colour: str = "default"
    ground: str = "default"
    bold: bool = False


class Run(NamedTuple):
    """Characters of one style, from a column on."""

    column: int
    text: str
    style: Style


Line = tuple[Run, ...]


class Frame(NamedTuple):
    """What the screen shows from a time on, in seconds."""

    at_s: float
    lines: tuple[Line, ...]


class Screen(pyte.Screen):
    """A screen that shows the earlier text again after a program that used all of it."""

    _kept: tuple[Any, Any] | None = None

    def set_mode(self, *modes: int, **kwargs: bool) -> None:
        """Keep the text before the whole screen is used."""
        super().set_mode(*modes, **kwargs)
        if _ALTERNATE in self.mode and self._kept is None:
            self._kept = copy.deepcopy(self.buffer), copy.copy(self.cursor)
            self.erase_in_display(2)

    def reset_mode(self, *modes: int, **kwargs: bool) -> None:
        """Show it again."""
        super().reset_mode(*modes, **kwargs)
        if _ALTERNATE not in self.mode and self._kept is not None:
            self.buffer, self.cursor = self._kept
            self._kept = None
            self.dirty.update(range(self.lines))


def lines_of(screen: pyte.Screen) -> tuple[Line, ...]:
    """What a screen shows now, with its cursor."""
    return tuple(tuple(_runs(screen, number)) for number in range(screen.lines))


def _runs(screen: pyte.Screen, number: int) -> Iterator[Run]:
    """The runs of a line; two spaces without a ground end one, so that columns stay in place."""
    cells = []
    for column in range(screen.columns):
        cell = screen.buffer[number][column]
        turned = cell.reverse
        if (number, column) == (screen.cursor.y, screen.cursor.x) and not screen.cursor.hidden:
            turned = not turned
        colour, ground = (cell.bg, cell.fg) if turned else (cell.fg, cell.bg)
        style = Style("ground" if turned and colour == "default" else colour, ground, cell.bold)
        if turned and ground == "default":
            style = style._replace(ground="text")
        cells.append((column, cell.data, style))
    for style, group in groupby(cells, key=lambda cell: cell[2]):
        some = list(group)
        column, text = some[0][0], "".join(cell[1] for cell in some)
        if style.ground != "default":
            yield Run(column, text, style)
            continue
        for piece in text.split("  "):
            if piece.strip():
                lead = len(piece) - len(piece.lstrip())
                yield Run(column + lead, piece.strip(), style)
            column += len(piece) + 2


class Film:
    """Frames in the order of their times, in seconds of the film."""

    def __init__(self) -> None:
        """Nothing is shown yet."""
        self.frames: list[Frame] = []

    def show(self, at_s: float, lines: tuple[Line, ...], least_s: float = 0.0) -> None:
        """Show these lines from a time on; frames shorter than ``least_s`` become one."""
        if self.frames and self.frames[-1].lines == lines:
            return
        if self.frames and at_s - self.frames[-1].at_s < least_s:
            at_s = self.frames.pop().at_s
        self.frames.append(Frame(at_s, lines))

    def draw(
        self,
        title: str,
        description: str,
        end_s: float,
        made_by: str = "tools/draw-terminal from a real session",
    ) -> str:
        """The film as an SVG that begins again at ``end_s``.

        Args:
            title: what it is, in a few words, for those who cannot see it.
            description: what happens in it.
            end_s: until then the last frame stays.
            made_by: the program and what it showed.
        """
        count = max(len(frame.lines) for frame in self.frames)
        width = 2 * EDGE + COLUMN * max(1, self._columns())
        height = 2 * EDGE + LINE * count
        strips = [_Strip.of(self.frames, number) for number in range(count)]
        body = [strip.draw(number, width) for number, strip in enumerate(strips)]
        style = _css(strips, end_s) + _colours(self.frames)
        size = f"{width:g} {height:g}"
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size}" width="{width:g}"'
            f' height="{height:g}" role="img" aria-labelledby="title desc">\n'
            f"<!-- Made by {made_by}. Do not edit. -->\n"
            f'<title id="title">{escape(title)}</title>\n'
            f'<desc id="desc">{escape(description)}</desc>\n'
            f"<style>\n{style}</style>\n"
            f'<rect class="screen" x="0.5" y="0.5" width="{width - 1:g}" height="{height - 1:g}"'
            ' rx="8"/>\n' + "".join(body) + "</svg>\n"
        )

    def _columns(self) -> int:
        return max(
            (
                run.column + _cells(run.text)
                for frame in self.frames
                for line in frame.lines
                for run in line
            ),
            default=0,
        )


class _Strip(NamedTuple):
    """All that a line of the screen shows, one below the other, and from when on which of it."""

    pieces: tuple[Line, ...]
    shown: tuple[tuple[float, int], ...]

    @classmethod
    def of(cls, frames: Sequence[Frame], number: int) -> _Strip:
        pieces: dict[Line, int] = {}
        shown: list[tuple[float, int]] = []
        for frame in frames:
            piece = pieces.setdefault(frame.lines[number], len(pieces))
            if not shown or shown[-1][1] != piece:
                shown.append((frame.at_s, piece))
        return cls(tuple(pieces), tuple(shown))

    def draw(self, number: int, width: float) -> str:
        if not any(self.pieces):
            return ""
        pieces = "".join(
            f'<g transform="translate(0 {place * LINE + BASE})">{"".join(map(_run, piece))}</g>\n'
            for place, piece in enumerate(self.pieces)
            if piece
        )
        return (
            f'<svg x="{EDGE}" y="{EDGE + number * LINE}" width="{width - 2 * EDGE:g}"'
            f' height="{LINE}"><g class="l{number}">\n{pieces}</g></svg>\n'
        )


def _run(run: Run) -> str:
    left, wide = f"{run.column * COLUMN:.4g}", f"{_cells(run.text) * COLUMN:.4g}"
    ground = ""
    if run.style.ground != "default":
        box = f'x="{left}" y="{-BASE}" width="{wide}" height="{LINE}"'
        ground = f'<rect class="{_class(run.style.ground)}" {box}/>'
    if not run.text.strip():
        return ground
    words = [_class(run.style.colour)] * (run.style.colour != "default") + ["b"] * run.style.bold
    style = f' class="{" ".join(words)}"' if words else ""
    return f'{ground}<text{style} x="{left}" textLength="{wide}">{escape(run.text, False)}</text>'


def _css(strips: Sequence[_Strip], end_s: float) -> str:
    """The movement of each line; without animation it stands where it ends."""
    css = (
        f"text {{ font: {SIZE}px ui-monospace, SFMono-Regular, Menlo, Consolas, 'DejaVu Sans Mono',"
        " monospace; white-space: pre }\n.b { font-weight: bold }\n"
    )
    moved = [(number, strip) for number, strip in enumerate(strips) if len(strip.shown) > 1]
    for number, strip in moved:
        steps = "".join(f"{100 * at_s / end_s:.4g}%{{{_at(piece)}}}" for at_s, piece in strip.shown)
        css += f"@keyframes k{number} {{{steps}}}\n"
        css += (
            f".l{number} {{ {_at(strip.shown[-1][1])};"
            f" animation: k{number} {end_s:g}s step-end infinite }}\n"
        )
    names = ", ".join(f".l{number}" for number, _ in moved)
    if names:
        css += f"@media (prefers-reduced-motion: reduce) {{ {names} {{ animation: none }} }}\n"
    return css


def _at(piece: int) -> str:
    return f"transform:translateY({-piece * LINE}px)"


def _colours(frames: Sequence[Frame]) -> str:
    """The colours that are used, on a light ground, and on a dark one where that is wished."""
    runs = {run.style for frame in frames for line in frame.lines for run in line}
    used = sorted({one for style in runs for one in style[:2]} - {"default", "ground", "text"})
    rules = [_rules(used, number) for number in (0, 1)]
    return f"{rules[0]}@media (prefers-color-scheme: dark) {{\n{rules[1]}}}\n"


def _rules(colours: Sequence[str], dark: int) -> str:
    text, ground = _DEFAULT[dark], _GROUND[dark]
    css = f"text, .text {{ fill: {text} }}\n.ground {{ fill: {ground} }}\n"
    css += f".screen {{ fill: {ground}; stroke: {text}; stroke-opacity: 0.25 }}\n"
    for colour in colours:
        css += f".{_class(colour)} {{ fill: {_value(colour)[dark]} }}\n"
    return css


def _class(colour: str) -> str:
    return colour if colour in ("text", "ground") else f"c-{colour}"


def _value(colour: str) -> tuple[str, str]:
    """A colour on a light ground and on a dark one."""
    # A bright colour's name has a prefix, which pyte 0.8 misspells once.
    for name, both in _NAMED.items():
        if colour.endswith(name):
            return both
    channels = [int(colour[at : at + 2], 16) for at in (0, 2, 4)]
    # Most colours of terminals are chosen for a dark ground.
    darker = "".join(f"{channel * 5 // 8:02x}" for channel in channels)
    return f"#{darker}", f"#{colour}"


def _cells(text: str) -> int:
    return sum(map(pyte.screens.wcwidth, text))
