"""The unit of an angle, by what the code does with the parameter."""

from __future__ import annotations

import math
import re
from typing import Literal

from pytpc.static.link_unit import Comparison, LinkUnit, ParameterRead

Angle = Literal["", "degrees", "radians"]
_TO_RADIANS = math.pi / 180
_CLOSE = 1e-6
# What gives an angle in radians, or takes one.
_IN_RADIANS = re.compile(
    r"\b(?:atan2|atan|asin|acos|getYaw|get_yaw|normalize_angle|shortest_angular_distance"
    r"|normalizeAngle|wrap_to_pi|angle_diff|euler_from_quaternion)\b"
)


def angle_of(unit: LinkUnit, read: ParameterRead) -> Angle:
    """The unit in which code takes what a call reads; empty where it does not tell.

    A factor of pi/180 on the way to a comparison makes radians of degrees. A comparison beside the
    functions that give angles is one in radians, if nothing was done with the parameter.
    """
    place = read.file, read.lineno
    found: set[Angle] = set()
    for one in unit.comparisons:
        if one.source == read.name and place in {(at.file, at.lineno) for at in one.param_reads}:
            found.add(_of_comparison(one))
    found.discard("")
    return found.pop() if len(found) == 1 else ""


def _of_comparison(one: Comparison) -> Angle:
    if one.transform is not None:
        scale = one.transform.scale
        if scale is not None and abs(abs(scale) - _TO_RADIANS) < _CLOSE:
            return "degrees"
        return ""
    text = one.source_code or ""
    return "radians" if one.type == "parameter" and _IN_RADIANS.search(text) else ""
