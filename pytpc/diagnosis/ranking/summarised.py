"""The log with what summaries tell: each is taken as a few evaluations.

The policies ``light`` and ``edges`` report the flops, and of all other evaluations a summary each
period. A summary without a flop is read as three evaluations with its one result: at its begin the
extreme that is farther from its last value, halfway the other extreme, at its end the last value.
So its values keep the result, the range and the end that they had; how long they were at which
value is not known. Of a summary with flops, which are in the log, only the last evaluation is
taken.
"""

from __future__ import annotations

from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from pytpc.base.columns import Bools, Floats, Int64s, recode
from pytpc.recording.events import Events
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries


def with_summarised(recording: Recording) -> Events:
    """The events of a recording, and those that its summaries are read as; cached."""
    events, summaries = recording.events, recording.summaries
    if not len(summaries):
        return events
    known = _KEPT.get(events)
    if known is not None and known[0] is summaries:
        return known[1]
    made = _joined(events, summaries)
    _KEPT[events] = summaries, made
    return made


_KEPT: WeakKeyDictionary[Events, tuple[Summaries, Events]] = WeakKeyDictionary()


def _joined(events: Events, summaries: Summaries) -> Events:
    keys = tuple(dict.fromkeys((*events.keys, *summaries.keys)))
    nodes = tuple(dict.fromkeys((*events.nodes, *summaries.nodes)))
    key = recode(summaries.key, summaries.keys, keys)
    node = recode(summaries.node, summaries.nodes, nodes)
    one_result = (summaries.flops == 0) & (summaries.count > summaries.odd + 1)
    one_result &= np.isfinite(summaries.diff_min) & np.isfinite(summaries.diff_max)
    low, high = summaries.thresh + summaries.diff_min, summaries.thresh + summaries.diff_max
    rises = np.abs(summaries.cmp - low) >= np.abs(high - summaries.cmp)
    halfway = summaries.begin_ns + (summaries.end_ns - summaries.begin_ns) // 2
    every = np.ones_like(one_result)
    parts: list[tuple[Bools, Int64s, Floats]] = [
        (one_result, summaries.begin_ns, np.where(rises, low, high)),
        (one_result, halfway, np.where(rises, high, low)),
        (every, summaries.end_ns, summaries.cmp),
    ]
    columns: dict[str, list[npt.NDArray[Any]]] = {
        "time_ns": [events.time_ns],
        "key": [recode(events.key, events.keys, keys)],
        "result": [events.result],
        "cmp": [events.cmp],
        "thresh": [events.thresh],
        "res": [events.res],
        "node": [recode(events.node, events.nodes, nodes)],
    }
    for rows, times, cmp in parts:
        columns["time_ns"].append(times[rows])
        columns["key"].append(key[rows])
        columns["result"].append(summaries.result[rows])
        columns["cmp"].append(cmp[rows])
        columns["thresh"].append(summaries.thresh[rows])
        columns["res"].append(summaries.res[rows])
        columns["node"].append(node[rows])
    joined = {name: np.concatenate(found) for name, found in columns.items()}
    return Events.of(**joined, keys=keys, nodes=nodes)
