"""Medians of many small groups at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Floats, Int64s


class GroupMedians(NamedTuple):
    """The groups that have a value, sorted: ``group`` int64[g], ``median`` float64[g], ``size``."""

    group: Int64s
    median: Floats
    size: Int64s


def group_medians(group: Int64s, values: Floats) -> GroupMedians:
    """The median of the values of each group.

    Args:
        group: int64[n].
        values: float64[n]; nan is left out.
    """
    known = np.flatnonzero(~np.isnan(values))
    order = known[np.lexsort((values[known], group[known]))]
    group, values = group[order], values[order]
    starts = np.flatnonzero(np.append(True, group[1:] != group[:-1])) if order.size else order
    size = np.diff(np.append(starts, order.size))
    middle = (values[starts + (size - 1) // 2] + values[starts + size // 2]) / 2.0
    return GroupMedians(group[starts], middle, size.astype(np.int64))
