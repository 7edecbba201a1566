"""Small wordings that several outputs share."""

from __future__ import annotations

import json
import math
import struct
import sys
from collections.abc import Sequence
from decimal import Decimal

Number = float | int | bool
_LONG = 10**15
_SIX_DIGITS = 10**6
_NOISE = 1e-12
_SURE_DIGITS = 9
_LARGEST = sys.float_info.max
_SMALLEST_SINGLE, _LARGEST_SINGLE = 1.1754943508222875e-38, 3.4028234663852886e38


def many(count: int, noun: str) -> str:
    """``1 report``, ``1,000 reports``."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def plain(text: str) -> str:
    """``text`` without control characters: a log must not steer the terminal."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)


def utf8_text(text: str) -> str:
    r"""``text`` as any file format can hold it: without halves of surrogate pairs and zero bytes.

    >>> utf8_text("caf\u00e9 \ud800\0") == "caf\u00e9 ?\ufffd"
    True
    """
    whole = text.encode("utf-8", "replace").decode()
    return whole.replace("\0", "\N{REPLACEMENT CHARACTER}")


def plain_json(document: object, *, indent: int | None = 1) -> str:
    r"""A document as JSON in printable ASCII.

    >>> plain_json("\u202e\x7f\ud800")
    '"\\u202e\\u007f\\ud800"'
    """
    return json.dumps(document, indent=indent).replace("\x7f", "\\u007f")


def listed(texts: Sequence[str], most: int) -> str:
    """The texts with commas between them; behind the first ``most`` only how many there are more.

    >>> listed(["a", "b", "c"], 3), listed(["a", "b", "c"], 2)
    ('a, b, c', 'a, b and 1 more')
    """
    shown = ", ".join(texts[:most])
    return shown if len(texts) <= most else f"{shown} and {len(texts) - most} more"


def tidy(value: Number) -> Number:
    """The number that a person wrote, of one that went through a float or some arithmetic.

    It has the fewest digits of all that differ by float noise alone: by a part of 1e-12, or not at
    all if both are kept in a 32-bit float.

    >>> tidy(-0.6499999999999926), tidy(0.20000000298023224), tidy(1 / 3)
    (-0.65, 0.2, 0.3333333333333333)
    """
    if not isinstance(value, float) or not math.isfinite(value) or value.is_integer():
        return value
    single = _single(value)
    for digits in range(1, _SURE_DIGITS + 1):
        short = float(f"{value:.{digits}g}")
        if abs(short - value) <= abs(value) * _NOISE or (single == value == _single(short)):
            return short
    return value


def _single(value: float) -> float | None:
    """The value as a 32-bit float; None if it is too large or too small for one."""
    if not _SMALLEST_SINGLE <= abs(value) <= _LARGEST_SINGLE:
        return None
    return float(struct.unpack("f", struct.pack("f", value))[0])


def show(value: Number | None) -> str:
    """A number as the user would write it: six digits of a float, true and false, ``?`` for None.

    >>> show(0.6000000238418579), show(3), show(True), show(1234567.0), show(10**400)
    ('0.6', '3', 'true', '1234567', '1.00000e+400')
    """
    if value is None:
        return "?"
    if isinstance(value, bool):
        return "true" if value else "false"
    short = tidy(value)
    # From here on six digits are less than the whole part.
    if abs(short) < _LONG and (short == round(short) or abs(short) >= _SIX_DIGITS):
        return str(round(short))
    # YAML has whole numbers that no float holds.
    is_huge = isinstance(short, int) and abs(short) > _LARGEST
    return f"{Decimal(short):.6g}" if is_huge else f"{short:.6g}"


def exact(value: Number | None) -> str:
    """Like ``show``, but with all the digits that the number needs: reading it gives ``value``.

    >>> exact(0.123456789), exact(100.0)
    ('0.123456789', '100')
    """
    if isinstance(value, float) and float(show(value)) != value:
        return repr(value)
    return show(value)


def shown_value(value: object, most: int = 60) -> str:
    """Any value of a parameter, cut to ``most`` characters; None is a parameter that is not set.

    >>> shown_value(0.25), shown_value(None), shown_value([1, 2]), shown_value("abcdef", 3)
    ('0.25', 'not set', '[1, 2]', 'abc...')
    """
    if value is None:
        return "not set"
    text = show(value) if isinstance(value, bool | int | float) else plain(str(value))
    return text if len(text) <= most else f"{text[:most]}..."


def percent(part: float) -> str:
    """``72 %``; only exactly 0 and 1 are shown as 0 % and 100 %.

    >>> percent(0.721), percent(0.001), percent(0.999), percent(0.0)
    ('72 %', '<1 %', '>99 %', '0 %')
    """
    whole = round(100 * part)
    if whole == 0 and part > 0:
        return "<1 %"
    return ">99 %" if whole == 100 and part < 1 else f"{whole} %"
