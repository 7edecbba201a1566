"""Summaries of evaluations as columns: what the policy ``edges`` keeps of a site in a period.

Under ``edges`` the events hold the first evaluation of each comparison and its flops; all
evaluations, those too, are in the summaries. The columns are those of docs/reference/formats.md.
"""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.base import columns as tables
from pytpc.base.columns import Bools, Floats, Int32s, Int64s


@dataclass(frozen=True, slots=True)
class Summary:
    """All evaluations of one comparison in one thread and period, in the order of the columns.

    ``begin_ns`` and ``end_ns`` enclose them; ``result``, ``res``, ``cmp`` and ``thresh`` are those
    of the last. ``count``, ``flops`` and ``odd`` count all of them, the flops, and those whose cmp
    or thresh is not finite. The rest describes only the finite ones, and is NaN where there are
    none: diff is cmp - thresh, ``abs_mean`` the mean of its absolute value, ``far`` counts those
    where that is above 1e-4, ``low`` and ``high`` are the extremes of all cmp and thresh.
    """

    key: str
    node: str
    begin_ns: int
    end_ns: int
    count: int
    flops: int
    far: int
    odd: int
    result: bool
    res: bool
    cmp: float
    thresh: float
    diff_min: float
    diff_max: float
    diff_mean: float
    abs_mean: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Summaries(tables.WordTable):
    """n summaries, sorted by ``begin_ns``; equal ones keep their recorded order.

    ``key`` and ``node`` are int32[n], codes into ``keys`` and ``nodes``; the other columns are
    int64, bool or float64[n] by their types, and mean what ``Summary`` says. The arrays
    are read-only. Make one with ``of``, which sorts and checks.
    """

    key: Int32s
    node: Int32s
    begin_ns: Int64s
    end_ns: Int64s
    count: Int64s
    flops: Int64s
    far: Int64s
    odd: Int64s
    result: Bools
    res: Bools
    cmp: Floats
    thresh: Floats
    diff_min: Floats
    diff_max: Floats
    diff_mean: Floats
    abs_mean: Floats
    low: Floats
    high: Floats
    keys: tuple[str, ...]
    nodes: tuple[str, ...]

    order = "begin_ns"
    what = "summaries"
