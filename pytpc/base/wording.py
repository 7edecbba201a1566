"""Small wordings that several outputs share."""

from __future__ import annotations

from collections.abc import Sequence

Number = float | int | bool
_LONG = 10**15


def many(count: int, noun: str) -> str:
    """``1 report``, ``1,000 reports``."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def plain(text: str) -> str:
    """``text`` without control characters: a log must not steer the terminal."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)


def listed(texts: Sequence[str], most: int) -> str:
    """The texts with commas between them; behind the first ``most`` only how many there are more.

    >>> listed(["a", "b", "c"], 3), listed(["a", "b", "c"], 2)
    ('a, b, c', 'a, b and 1 more')
    """
    shown = ", ".join(texts[:most])
    return shown if len(texts) <= most else f"{shown} and {len(texts) - most} more"


def show(value: Number | None) -> str:
    """A number as the user would write it: six digits of a float, true and false, ``?`` for None.

    >>> show(0.6000000238418579), show(3), show(True)
    ('0.6', '3', 'true')
    """
    if value is None:
        return "?"
    if isinstance(value, bool):
        return "true" if value else "false"
    short = isinstance(value, int) and abs(value) < _LONG
    return str(value) if short else f"{value:.6g}"


def exact(value: Number | None) -> str:
    """Like ``show``, but with all the digits that the number needs."""
    if isinstance(value, float) and float(f"{value:.6g}") != value:
        return repr(value)
    return show(value)


def percent(part: float) -> str:
    """``72 %``; only exactly 0 and 1 are shown as 0 % and 100 %.

    >>> percent(0.721), percent(0.001), percent(0.999), percent(0.0)
    ('72 %', '<1 %', '>99 %', '0 %')
    """
    whole = round(100 * part)
    if whole == 0 and part > 0:
        return "<1 %"
    return ">99 %" if whole == 100 and part < 1 else f"{whole} %"
