"""Units of parameters and thresholds: what names, descriptions and arithmetic tell."""

from __future__ import annotations

import math

import pytest
from mission_samples import comparison

from pytpc.static.link_unit import Transform
from pytpc.static.measures import described_unit, named_unit, parameter_unit, threshold_unit


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("~max_angle_deg", "°"),
        ("/mission/search_yaw_rad", "rad"),
        ("rangeM", "m"),
        ("wait_ms", "ms"),
        ("maxSpeedMps", "m/s"),
        ("speed_m_per_s", "m/s"),
        ("m_per_s", "m/s"),
        # Nobody says in what; or the letter is no unit; or two of them make another one.
        ("timeout", ""),
        ("turns_per_s", ""),
        ("k_s", ""),
        ("x_m", ""),
        ("speed_m_s", ""),
        ("deg", ""),
        ("range_min", ""),
        ("", ""),
        ("a_deg/limit", ""),
    ],
)
def test_units_in_names(name, unit):
    assert named_unit(name) == unit


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("Top speed [m/s]", "m/s"),
        ("Turning (deg/s)", "°/s"),
        ("The wait, in seconds", "s"),
        ("From [m] to [s]", ""),
        ("In the middle (or not)", ""),
        ("", ""),
    ],
)
def test_units_in_descriptions(text, unit):
    assert described_unit(text) == unit


def scaled(scale, source="~yaw", **changes):
    transform = Transform("affine", scale, 0.0)
    return comparison(0, source, name="limit", transform=transform, **changes)


# The threshold is what the axis shows: the parameter's unit does for it only if nothing is done.
def test_the_arithmetic_tells_degrees_from_radians():
    turned = scaled(math.pi / 180)
    assert (parameter_unit(turned), threshold_unit(turned)) == ("°", "rad")
    back = scaled(180 / math.pi)
    assert (parameter_unit(back), threshold_unit(back)) == ("rad", "°")
    doubled = scaled(2.0, "~range_m")
    assert (parameter_unit(doubled), threshold_unit(doubled)) == ("m", "")
    plain = comparison(0, "~range_m", name="limit")
    assert (parameter_unit(plain), threshold_unit(plain)) == ("m", "m")
    told = comparison(0, "~range", name="limit")
    assert threshold_unit(told, "How far [km]") == "km"
    squared = comparison(0, "~range_m", name="limit", transform=Transform("expression"))
    assert threshold_unit(squared) == ""
    assert parameter_unit(comparison(0, "~wait_s", "flag")) == ""
