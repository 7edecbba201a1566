"""Angles in degrees where the code takes radians, and the other way round.

The name, the size of the value and what the code does with it must all say so.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from pytpc.base.wording import plain, show
from pytpc.lint.facts import Angle, Facts, NodeRead, own_part
from pytpc.lint.finding import Evidence, Finding

_WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+")
_DEGREES = frozenset({"deg", "degs", "degree", "degrees"})
_RADIANS = frozenset({"rad", "rads", "radian", "radians"})
_ANGLES = frozenset(
    {"angle", "angles", "angular", "yaw", "theta", "heading", "bearing", "pitch", "roll", "rot"}
    | {"rotation", "rotational", "orientation", "tilt", "azimuth", "fov", "turn"}
)
# Speeds may be above a whole turn.
_SPEEDS = frozenset({"vel", "velocity", "speed", "rate", "acc", "accel", "acceleration", "jerk"})
# These make another thing of an angle: a number of them, a weight, a noise.
_NO_ANGLES = frozenset(
    {"num", "number", "count", "samples", "sample", "steps", "bins", "index", "id", "weight"}
    | {"scale", "factor", "gain", "bias", "cost", "alpha", "noise", "ratio", "topic", "frame"}
    | {"time", "timeout", "period", "duration", "frequency", "hz", "distance", "dist", "size"}
    | {"p", "i", "d", "kp", "ki", "kd", "covariance", "channel", "axis", "port", "pin", "pulses"}
    | {"samp", "radius", "coef", "coefficient", "score", "penalty", "tries", "attempts", "pwm"}
)
_TURN = 2 * math.pi
_FAST = 30.0
_CLOSE = 2e-3
_PARTS = (1, 2, 3, 4, 6, 8, 12)


def units_of_angles(facts: Facts) -> Iterator[Finding]:
    """The findings."""
    for setting in facts.settings:
        value = setting.value
        if isinstance(value, bool) or not isinstance(value, int | float):
            continue
        reads = [read for _, read in facts.readers(setting.name)]
        if not reads:
            continue
        unit, because = _unit(setting.name, reads)
        doubt = _doubt(setting.name, float(value), unit)
        if not doubt:
            continue
        text = f"{plain(setting.name)} is {show(value)}, {doubt}: {because}"
        places = (Evidence("read", reads[0].spot),)
        yield Finding("degrees", "warning", setting.spot, setting.name, text, places)


def _unit(name: str, reads: list[NodeRead]) -> tuple[Angle, str]:
    """The unit in which the code takes a value, and why that is known."""
    units = {read.angle for read in reads} - {""}
    words = words_of(name)
    unit: Angle = ""
    because = ""
    if units == {"degrees"}:
        unit, because = "degrees", "the code makes radians of it"
    elif units == {"radians"}:
        unit, because = "radians", "the code takes it in radians"
    elif units or words & (_DEGREES | _NO_ANGLES):
        pass
    elif words & _RADIANS:
        unit, because = "radians", "its name says radians"
    elif words & _ANGLES and _has_small_default(reads):
        unit, because = "radians", f"its default, {show(_number(reads[0].default))}, is in radians"
    return unit, because


def words_of(name: str) -> frozenset[str]:
    """The words in the last part of a name.

    >>> sorted(words_of("/node/maxYaw_deg"))
    ['deg', 'max', 'yaw']
    """
    return frozenset(word.lower() for word in _WORDS.findall(own_part(name)))


def _has_small_default(reads: list[NodeRead]) -> bool:
    """Whether all reads have a default that is an angle in radians, and no whole number of them."""
    if any("int" in read.type for read in reads):
        return False
    numbers = [_number(read.default) for read in reads]
    return all(number is not None and 0 < abs(number) <= _TURN for number in numbers)


def _number(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value)


def _doubt(name: str, value: float, unit: Angle) -> str:
    """Why a value is hardly in this unit; empty where it may be."""
    if unit == "radians":
        most = _FAST if words_of(name) & _SPEEDS else _TURN
        if abs(value) > most * (1 + _CLOSE):
            return f"which seems to be in degrees ({show(math.radians(value))} rad)"
    elif unit == "degrees" and _is_part_of_turn(value):
        return f"which seems to be in radians ({show(math.degrees(value))} degrees)"
    return ""


def _is_part_of_turn(value: float) -> bool:
    """Whether a value is a well-known angle in radians, and no plain number of degrees.

    >>> _is_part_of_turn(1.5708), _is_part_of_turn(-0.785), _is_part_of_turn(1.5)
    (True, True, False)
    """
    size = abs(value)
    if size < 0.2 or round(size, 1) == size:
        return False
    turns = (_TURN * times / (2 * part) for part in _PARTS for times in range(1, 2 * part + 1))
    return any(abs(size - turn) <= _CLOSE * turn for turn in turns)
