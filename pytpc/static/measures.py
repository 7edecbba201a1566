"""The units of parameters and thresholds, where a name, a description or the arithmetic tells them.

Nothing is guessed: a ``timeout`` may be in seconds or in milliseconds.
"""

from __future__ import annotations

import math
import re

from pytpc.static.link_unit import Comparison

DEGREES, RADIANS = "°", "rad"

_WORDS = {
    "deg": DEGREES, "degs": DEGREES, "degree": DEGREES, "degrees": DEGREES,
    "rad": RADIANS, "rads": RADIANS, "radian": RADIANS, "radians": RADIANS,
    "m": "m", "meter": "m", "meters": "m", "metre": "m", "metres": "m",
    "km": "km", "cm": "cm", "mm": "mm",
    "s": "s", "sec": "s", "secs": "s", "second": "s", "seconds": "s",
    "ms": "ms", "msec": "ms", "msecs": "ms", "millisecond": "ms", "milliseconds": "ms",
    "usec": "µs", "nsec": "ns",
    "hz": "Hz", "hertz": "Hz", "khz": "kHz", "rpm": "rpm",
    "mps": "m/s", "kmh": "km/h", "kph": "km/h",
    "percent": "%", "pct": "%", "px": "px", "pixel": "px", "pixels": "px",
    "kg": "kg", "volt": "V", "volts": "V", "newton": "N", "newtons": "N",
}  # fmt: skip
_SIGNS = {
    "°": DEGREES, "m/s": "m/s", "m/sec": "m/s", "km/h": "km/h", "m/s^2": "m/s²", "m/s2": "m/s²",
    "rad/s": "rad/s", "rad/sec": "rad/s", "deg/s": "°/s", "deg/sec": "°/s", "rad/s^2": "rad/s²",
    "%": "%", "V": "V", "A": "A", "N": "N", "N*m": "N m", "Nm": "N m",
}  # fmt: skip
_LONGEST_NAME = 200
# A letter alone is a unit only behind a word: of `k_s` nobody knows.
_LEAST_WORD = 3
_PARTS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+")
_BRACKETED = re.compile(r"[\[(]\s*(?:in\s+)?([^\s\[\]()]{1,12})\s*[\])]")
_SPELT = re.compile(r"\bin ([a-z]{3,12})\b")


def named_unit(name: str) -> str:
    """The unit at the end of a name; empty if it tells none.

    >>> named_unit("~max_angle_deg"), named_unit("rangeM"), named_unit("turns_per_s")
    ('°', 'm', '')
    """
    parts = _PARTS.findall(name[-_LONGEST_NAME:].rpartition("/")[2])
    if len(parts) < 2:
        return ""
    *before, last = (part.lower() for part in parts)
    if before[-1] == "per":
        top = _WORDS.get(before[-2], "") if len(before) > 1 else ""
        return f"{top}/{_WORDS[last]}" if top and last in _WORDS else ""
    if before[-1] in _WORDS or (len(last) == 1 and len(before[-1]) < _LEAST_WORD):
        return ""
    return _WORDS.get(last, "")


def described_unit(text: str) -> str:
    """The unit in a description, ``[m/s]`` or ``in seconds``; empty if it names none, or several.

    >>> described_unit("Top speed [m/s]"), described_unit("Wait, in seconds"), described_unit("x")
    ('m/s', 's', '')
    """
    found = {_SIGNS.get(word) or _WORDS.get(word.lower()) for word in _BRACKETED.findall(text)}
    found |= {_WORDS.get(word) for word in _SPELT.findall(text)}
    units = found - {None}
    return units.pop() or "" if len(units) == 1 else ""


def parameter_unit(comparison: Comparison, description: str = "") -> str:
    """The unit of the parameter of a comparison; empty if it is not known.

    Args:
        comparison: not a flag; of a flag nothing is known.
        description: with which the parameter is declared.
    """
    if comparison.relation == "flag":
        return ""
    told = named_unit(comparison.source or "") or described_unit(description)
    return told or {math.pi / 180: DEGREES, 180 / math.pi: RADIANS}.get(_factor(comparison), "")


def threshold_unit(comparison: Comparison, description: str = "") -> str:
    """The unit of the threshold, and so of the compared value; empty if it is not known.

    The arguments are those of ``parameter_unit``.
    """
    if comparison.relation == "flag":
        return ""
    factor = _factor(comparison)
    turned = {math.pi / 180: RADIANS, 180 / math.pi: DEGREES}.get(factor, "")
    own = parameter_unit(comparison, description) if factor == 1 else ""
    return turned or named_unit(comparison.name or "") or own


def _factor(comparison: Comparison) -> float:
    """By what the threshold is scaled: of degrees and radians exactly; NaN if it is more."""
    how = comparison.transform
    if how is None:
        return 1.0
    if how.kind != "affine" or how.scale is None:
        return math.nan
    for known in (1.0, math.pi / 180, 180 / math.pi):
        if math.isclose(how.scale, known, rel_tol=1e-6):
            return known
    return math.nan
