"""The scores as somebody would write them with pandas: what score_speed compares with."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pandas as pd

from pytpc.recording.events import Events

WINDOW_NS = 12 * 10**9


def frame_of(events: Events) -> pd.DataFrame:
    """The table, with its flops: results that differ from the last one of the same key and node."""
    frame = pd.DataFrame(
        {
            "time_ns": events.time_ns,
            "key": events.key,
            "node": events.node,
            "result": events.result,
            "cmp": events.cmp,
            "thresh": events.thresh,
        }
    )
    last = frame.groupby(["key", "node"])["result"].shift()
    frame["flop"] = last.notna() & (last != frame["result"])
    return frame


def scores_at(
    frame: pd.DataFrame, mark_ns: int, keys: int
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Both scores of all keys at one time, with the default exponents; NaN where there is none."""
    past = frame[frame["time_ns"] <= mark_ns]
    flops = past[past["flop"]].groupby("key")["time_ns"].agg(["max", "count"])
    first = (mark_ns - flops["max"]) / 1e9 * (1 + flops["count"])

    finite = past[np.isfinite(past["cmp"]) & np.isfinite(past["thresh"])]
    extremes = finite.groupby("key")[["cmp", "thresh"]].agg(["min", "max"])
    highest = extremes.xs("max", axis=1, level=1).max(axis=1)
    lowest = extremes.xs("min", axis=1, level=1).min(axis=1)
    span = (highest - lowest).replace(0, np.nan)

    begin = mark_ns - WINDOW_NS
    window = finite[finite["time_ns"] >= begin]
    difference = (window["cmp"] - window["thresh"]).abs().groupby(window["key"]).mean()
    recent = past[past["flop"] & (past["time_ns"] >= begin)].groupby("key").size()
    factor = recent.reindex(range(keys), fill_value=0).clip(lower=1)
    second = difference / span * factor
    every = range(keys)
    return first.reindex(every).to_numpy(), second.reindex(every).to_numpy()
