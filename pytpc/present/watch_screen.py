"""The screen of ``pytpc watch``: takes what to show, returns lines of styled text.

Every line fits its width, however long the names of parameters are, and is readable without colours
and without UTF-8. On narrow terminals the least important columns are left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from rich.cells import cell_len
from rich.text import Text

from pytpc.base.wording import many, plain, show
from pytpc.diagnosis.results.live import Kept, LiveRow, Look, TrendPart
from pytpc.recording.marking_session import (
    OTHER_KEYS,
    Session,
    View,
    asked,
    clock_text,
    cut,
    folded,
    to_choose,
)
from pytpc.recording.marks import Mark, MarkType, short_note

Layout = tuple[MarkType | None, ...]
LAYOUTS: tuple[Layout, ...] = (("I", "II"), (None,), ("I",), ("II",))
"""Which tables stand side by side, in the order of the key `v`."""

WATCH_HELP = ("v view", "m marks")
_SHORT = {"I": "should not have", "II": "should be doing", None: "wrong"}
_TITLES: dict[MarkType | None, str] = {
    "I": "Type I: what changed last",
    "II": "Type II: what is near its threshold",
    None: "Both types combined",
}
# Colour-blind people can tell blue and orange apart; the words say the same.
_COLOURS: dict[MarkType | None, str] = {"I": "bright_blue", "II": "dark_orange", None: "bold"}
_GAP = 2
_NUMBER = 3 + 1
_BETWEEN = 2
_LEAST_SIDE = 48
_LEAST_NAME = 12
_RECENT_S = 3.0
_BARS = {True: "▁▂▃▄▅▆▇█", False: "_.-=+*%#"}
_FLOP = "x"
_TREND = "Trend"
_WIDEST_NOW = 24
_FEWEST_DIGITS = 3
_ALL_DIGITS = 17
_ROOMY = 20
_LEGEND = (
    "Trend of the window: a low bar is near the threshold, an x is a flop (the result changed)."
    " Bold: just flopped. A low score is suspicious"
)
_SHORT_LEGEND = "Bold: the result has just changed. A low score is suspicious"


class WatchOptions(NamedTuple):
    """The observer's choices: tables, number of rows, the mark to look back at (None: now), and
    whether the terminal shows UTF-8."""

    layout: Layout = LAYOUTS[0]
    top: int = 10
    back: int | None = None
    utf8: bool = True


class Status(NamedTuple):
    """What has arrived: evaluations, also those of summaries, and how many per second (None for a
    recording), nodes, unknown keys, lost messages, evaluations too late to count, and the fault
    (empty if there is none).
    """

    evaluations: int = 0
    rate: float | None = None
    nodes: int = 0
    unknown: int = 0
    lost: int = 0
    late: int = 0
    fault: str = ""

    def words(self) -> str:
        """One line; the fault comes first."""
        text = f"{many(self.evaluations, 'evaluation')} of {many(self.nodes, 'node')}"
        if self.rate is not None:
            text += f", {self.rate:,.0f}/s"
        if self.lost:
            text += f", {self.lost:,} lost"
        if self.late:
            text += f", {self.late:,} too late"
        if self.unknown:
            text += f"; {many(self.unknown, 'key')} not in the static information (another build?)"
        return f"{self.fault}; {text}" if self.fault else text


class Panel(NamedTuple):
    """What to show besides the session and the view of `pytpc.recording.marking_session`."""

    look: Look
    kept: Sequence[Kept]
    status: Status
    options: WatchOptions


class _Column(NamedTuple):
    """A column of a table; the highest ``need`` is left out first where room is short."""

    heading: str
    width: int
    right: bool
    need: int
    text: Callable[[LiveRow, bool], str]


def watch_screen(session: Session, view: View, panel: Panel, width: int, height: int) -> list[Text]:
    """The lines to show, none wider than ``width``, at most ``height``: tables, marks, keys."""
    width, height = max(1, width), max(1, height)
    head = [Text(cut(view.title, width), style="bold")]
    head += _plain([*view.status, panel.status.words()], width)
    foot = _plain([_keys(view)], width, "dim")
    if session.is_typing:
        prompt = _plain(asked(session), width, "bold")
        room = (height - len(head) - len(foot) - len(prompt)) // 2
        foot += [*map(Text, to_choose(session, width, room)), *prompt]
    elif session.said:
        said = [session.said] if height >= _ROOMY else [cut(session.said, width)]
        foot += _plain(said, width, "bold")
    if height >= _ROOMY:
        head.append(Text())
    room = height - len(head) - len(foot)
    layout = panel.options.layout
    stacked = panel.options.back is None and _is_stacked(layout, width)
    marks = min(len(session.marks), max(0, room // 4))
    body = _body(panel, view, width, room - (marks + 1 if marks else 0), stacked)
    tail = _marks(session, view, panel, width, room - len(body)) if marks else []
    left = room - len(body) - len(tail)
    more = (
        _evidence(_shown_look(panel), width, stacked=stacked) if marks or not session.marks else []
    )
    more = more if len(more) <= left else []
    blank = [Text()] * max(0, left - len(more))
    lines = [*head, *body, *more, *blank, *tail, *foot]
    if len(lines) > height:
        # On a tiny terminal the last line matters most: a question or a message.
        lines = [*lines[: max(0, height - 1)], lines[-1]]
    return [_encodable(line, panel.options.utf8) for line in lines]


def table(look: Look, kind: MarkType | None, width: int, rows: int, *, utf8: bool) -> list[Text]:
    """A table of one type: its title, the headings, then at most ``rows`` suspects."""
    lines = [Text(cut(_TITLES[kind], width), style=f"bold {_COLOURS[kind]}")]
    found = look.rows[kind][:rows]
    if not found:
        why = look.reasons[kind] or "no parameter has a score yet"
        return lines + _plain(folded(why, width)[: max(1, rows)], width, "dim")
    columns, name_width = _columns(kind, width, found)
    name = _fit("#", 3, right=True) + " " + _fit("Parameter", name_width)
    heads = [_fit(one.heading, one.width, right=one.right) for one in columns]
    # Neither underlined nor coloured: bold shows on any terminal.
    lines.append(Text(cut(_joined([name, *heads]), width), style="bold"))
    if look.reasons[kind]:
        lines += _plain([look.reasons[kind]], width, "dim")[:1]
    for row in found:
        suspect = row.suspect
        number = f"{suspect.position}{'=' if suspect.tied else ''}"
        cells = [_fit(number, 3, right=True) + " " + _fit(suspect.parameter, name_width)]
        cells += [_fit(one.text(row, utf8), one.width, right=one.right) for one in columns]
        recent = row.flop_s is not None and row.flop_s < _RECENT_S
        style = "bold" if recent else ""
        lines.append(Text(cut(_joined(cells), width), style=style))
    return lines[: rows + 2]


def _shown_look(panel: Panel) -> tuple[Look, Layout]:
    """What is shown, of now or of a mark, and its tables."""
    if panel.options.back is None:
        return panel.look, panel.options.layout
    look = panel.kept[panel.options.back].look
    return look, tuple(look.rows)


def _is_stacked(layout: Layout, width: int) -> bool:
    """Whether the tables stand below one another."""
    return len(layout) > 1 and width < 2 * _LEAST_SIDE + _BETWEEN


def _side(layout: Layout, width: int, *, stacked: bool) -> int:
    """The width of each table."""
    return width if stacked else (width - _BETWEEN * (len(layout) - 1)) // len(layout)


def _evidence(shown: tuple[Look, Layout], width: int, *, stacked: bool) -> list[Text]:
    """Where the first suspect of each table is compared, and how to read what is shown of it."""
    look, layout = shown
    side = _side(layout, width, stacked=stacked)
    tables = [(kind, look.rows[kind]) for kind in layout if look.rows[kind]]
    has_bars = any(
        column.heading == _TREND
        for kind, rows in tables
        for column in _columns(kind, side, rows)[0]
    )
    legend = _LEGEND if has_bars else _SHORT_LEGEND
    lines = [Text(), Text(cut(legend, width), style="dim"), Text()]
    for row in (look.rows[kind][0] for kind in layout if look.rows[kind]):
        found = row.suspect.comparison
        line = Text(f"{row.suspect.position} {row.suspect.parameter}", style="bold")
        where = f"  {found.file}:{found.lineno}"
        where += f" in {row.last.node}" if row.last is not None else ""
        where += f", for {found.topic}" if found.topic else ""
        line.append(where, style="not bold")
        line.plain = plain(line.plain)
        line.truncate(width)
        lines += [line, Text(cut(f"    {(found.source_code or '').strip()}", width), style="dim")]
        group = look.group_of(row)
        others = () if group is None else group.parameters
        if group is not None and len(others) > 1:
            with_it = ", ".join(plain(one) for one in others if one != row.suspect.parameter)
            lines.append(Text(cut(f"    with {with_it}: they {group.text}", width)))
    return lines if len(lines) > 3 else []


def _body(panel: Panel, view: View, width: int, room: int, stacked: bool) -> list[Text]:
    """The tables of now or of a mark, side by side or below one another."""
    options = panel.options
    look, layout = _shown_look(panel)
    lines: list[Text] = []
    if options.back is not None:
        kept = panel.kept[options.back]
        when = clock_text(kept.mark.time_ns - view.start_ns)
        text = f"At the mark of {when} ({_named(kept.mark)}); m goes on"
        lines.append(Text(cut(text, width), style="bold reverse"))
    room -= len(lines)
    if stacked:
        each = max(1, room // len(layout) - 2)
        rows = min(options.top, each)
        for kind in layout:
            lines += table(look, kind, width, rows, utf8=options.utf8)
        return lines[: max(0, room + 1)]
    rows = max(1, min(options.top, room - 2))
    side = _side(layout, width, stacked=stacked)
    sides = [table(look, kind, side, rows, utf8=options.utf8) for kind in layout]
    for number in range(max(len(one) for one in sides)):
        line = Text()
        for place, one in enumerate(sides):
            part = one[number] if number < len(one) else Text()
            line.append_text(part)
            if place + 1 < len(sides):
                line.append(" " * (side - cell_len(part.plain) + _BETWEEN))
        lines.append(line)
    return lines[: max(0, room + 1)]


def _marks(session: Session, view: View, panel: Panel, width: int, room: int) -> list[Text]:
    """The newest marks, each with its first suspects, below a line that counts them."""
    shown = session.marks[-max(0, room - 1) :] if room > 1 else ()
    if not shown:
        return []
    lines = [Text(cut(f"{many(len(session.marks), 'mark')}:", width), style="bold")]
    for mark in shown:
        when = clock_text(mark.time_ns - view.start_ns)
        kept = next((one for one in panel.kept if one.mark == mark), None)
        named = "made earlier" if kept is None else kept.words()
        text = f"{when:>9}  {mark.type or '-':2}  {named}{_note(mark)}"
        lines.append(Text(cut(text.rstrip(), width), style=_COLOURS[mark.type]))
    return lines


def _note(mark: Mark) -> str:
    return f'  "{short_note(mark.note)}"' if mark.note else ""


def _named(mark: Mark) -> str:
    return f"type {mark.type}" if mark.type else "wrong"


def _keys(view: View) -> str:
    """What the keys do, in a few words that do not wrap."""
    marks = [f"{key} {_SHORT[kind]}" for key, kind in zip("123", ("I", "II", None), strict=True)]
    words = (*marks, *OTHER_KEYS, *WATCH_HELP, *view.help)
    return "  ".join(word.replace(" ", "\N{NO-BREAK SPACE}") for word in words)


def _columns(
    kind: MarkType | None, width: int, rows: Sequence[LiveRow]
) -> tuple[list[_Column], int]:
    """The columns that fit, in their order, and the width of the names."""
    longest = max(cell_len(plain(row.suspect.parameter)) for row in rows)
    score = _Column("Score", 6, True, 1, lambda row, _: score_text(row.suspect.score))
    now = _Column("Now", _now_width(rows), False, 2, lambda row, _: _now(row))
    parts = _Column(_TREND, len(rows[0].parts), False, 3, lambda row, utf8: bars(row.parts, utf8))
    flop = _Column("Flop", 6, True, 4, lambda row, _: ago(row.flop_s))
    of = _Column("By", 2, False, 5, lambda row, _: row.suspect.type)
    if kind == "I":
        flop, parts = flop._replace(need=0), parts._replace(need=4)
    chosen = [score, now, parts, flop] + ([of] if kind is None else [])
    while chosen:
        left = width - _NUMBER - sum(column.width + _GAP for column in chosen)
        if left >= min(longest, max(_LEAST_NAME, width // 3)):
            return chosen, min(left, max(longest, len("Parameter")))
        chosen.remove(max(chosen, key=lambda column: column.need))
    return [], max(1, width - _NUMBER)


def _now(row: LiveRow) -> str:
    """The last comparison: ``0.0527 > 0.058``."""
    if row.last is None:
        return ""
    relation = row.suspect.comparison.relation
    if relation == "flag":
        return "on" if row.last.result else "off"
    left, right = told_apart(row.last.cmp, row.last.thresh)
    return f"{left} {relation} {right}"


def told_apart(cmp: float, thresh: float) -> tuple[str, str]:
    """Both values with few digits, but enough that different numbers do not look equal.

    >>> told_apart(0.0527, 0.058), told_apart(1.00001, 1.0)
    (('0.0527', '0.058'), ('1.00001', '1'))
    """
    left, right = f"{cmp:.{_FEWEST_DIGITS}g}", show(thresh)
    digits = _FEWEST_DIGITS
    while left == right and cmp != thresh and digits < _ALL_DIGITS:
        digits += 1
        left, right = f"{cmp:.{digits}g}", f"{thresh:.{digits}g}"
    return left, right


def _now_width(rows: Sequence[LiveRow]) -> int:
    return min(_WIDEST_NOW, max(3, *(cell_len(_now(row)) for row in rows)))


def score_text(score: float) -> str:
    """A score with three digits, in at most six characters.

    >>> score_text(0.06021), score_text(28.16), score_text(1234.5), score_text(2.5e9)
    ('0.0602', '28.2', '1234', '2e+09')
    """
    if 0 < score < 1e-3:
        return f"{score:.0e}"
    if score < 1000:
        return f"{score:.3g}"
    return f"{score:.0f}" if score < 999_999 else f"{score:.0e}"


def ago(seconds: float | None) -> str:
    """How long ago, in at most six characters.

    >>> ago(None), ago(0.04), ago(75.0), ago(7200.0)
    ('never', '0.0 s', '75 s', '120 m')
    """
    if seconds is None:
        return "never"
    if seconds < 10:
        return f"{seconds:.1f} s"
    if seconds < 1000:
        return f"{seconds:.0f} s"
    minutes = int(seconds / 60)
    return f"{minutes} m" if minutes < 1000 else f"{minutes // 60} h"


def bars(parts: Sequence[TrendPart], utf8: bool) -> str:
    """A bar for each part of the window: a low one is near the threshold, an x is a flop.

    >>> parts = [(0.0, False), (1.0, False), (0.3, True), (math.nan, False)]
    >>> bars([TrendPart(*part) for part in parts], True)
    '▁█x '
    """
    levels = _BARS[utf8]
    text = ""
    for part in parts:
        if part.flopped:
            text += _FLOP
        elif math.isnan(part.distance):
            text += " "
        else:
            text += levels[min(len(levels) - 1, int(part.distance * len(levels)))]
    return text


def _plain(lines: Sequence[str], width: int, style: str = "") -> list[Text]:
    return [Text(part, style=style) for line in lines for part in folded(line, width)]


def _joined(cells: Sequence[str]) -> str:
    return (" " * _GAP).join(cells).rstrip()


def _fit(text: str, width: int, *, right: bool = False) -> str:
    """Exactly ``width`` columns."""
    shown = cut(text, width)
    room = " " * (width - cell_len(shown))
    return room + shown if right else shown + room


def _encodable(line: Text, utf8: bool) -> Text:
    """Replace what is not ASCII by question marks if the terminal has no UTF-8."""
    if utf8 or line.plain.isascii():
        return line
    # One character for one character, so that the styles stay where they are.
    line.plain = line.plain.encode("ascii", "replace").decode("ascii")
    return line
