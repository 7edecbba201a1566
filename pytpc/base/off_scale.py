"""Compared values that are no measurements, such as a time since the epoch among durations."""

from __future__ import annotations

import numpy as np

from pytpc.base.columns import Bools, Floats

_MANY = 1e6


def off_scale(values: Floats, thresholds: Floats) -> Bools:
    """bool[n]: which finite values are no measurements, as they are a million times the usual size.

    The usual size is the median of the values, that of the thresholds they are compared with, or 1,
    whichever is largest; of two in the middle the larger counts, and zeros do not. A time since the
    epoch is off the scale of durations, and the largest double off that of distances.

    The median of the values alone may be noise: a robot that stands measures 1e-9 m/s, and 0.5 m/s
    seldom. Nor is a threshold of 0 or 1e-6 the size of what is measured. ROS measures in SI units
    (REP 103), so that a million is off the scale of what is usually below 1.
    """
    usual = max(_usual_size(values), _usual_size(thresholds[np.isfinite(thresholds)]), 1.0)
    return np.asarray(np.abs(values) / _MANY > usual)


def _usual_size(values: Floats) -> float:
    """The median size of finite values without the zeros, of two the larger; 0 if there is none."""
    sizes = np.abs(values[values != 0])
    return float(np.quantile(sizes, 0.5, method="higher")) if sizes.size else 0.0
