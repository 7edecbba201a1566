"""A good run made small: what a diagnosis needs of it, in a few rows for each comparison.

Thresholds, results, and how far values were from their thresholds stay as they were; so do when a
comparison was evaluated first and last, and its first changes. How often it was evaluated does not.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pytpc.base.columns import Int64s
from pytpc.diagnosis.ranking.summarised import with_summarised
from pytpc.recording.events import Events
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries

EVENLY = 64
"""So many rows of each comparison in a node are evenly spread over its evaluations."""
CHANGES = 16
"""So many of its changes are kept, the first ones."""


def thinned(recording: Recording) -> Recording:
    """The recording with a few rows of each comparison in each node, and without summaries.

    At most ``EVENLY`` rows that are evenly spread, two for each of ``CHANGES`` changes, one for
    each of its first thresholds, and the extremes of the value and of its distance.
    """
    events = with_summarised(recording)
    kept = [rows[_chosen(events, rows)] for rows in _streams(events)]
    every = np.sort(np.concatenate([np.zeros(0, np.int64), *kept]))
    return replace(recording, events=events.take(every), summaries=Summaries.empty())


def _streams(events: Events) -> list[Int64s]:
    """The rows of each comparison in each node, by time."""
    if not len(events):
        return []
    order = np.lexsort((events.node, events.key))
    key, node = events.key[order], events.node[order]
    begins = np.flatnonzero((key[1:] != key[:-1]) | (node[1:] != node[:-1])) + 1
    return np.split(order, begins)


def _chosen(events: Events, rows: Int64s) -> Int64s:
    """The places in ``rows`` to keep, in any order."""
    last = rows.size - 1
    changed = np.flatnonzero(events.res[rows][1:] != events.res[rows][:-1])[:CHANGES]
    _, new = np.unique(events.thresh[rows], return_index=True)
    cmp = events.cmp[rows]
    with np.errstate(invalid="ignore"):
        far = np.abs(cmp - events.thresh[rows])
    extremes = [
        int(pick(np.where(np.isfinite(values), values, least)))
        for values in (cmp, far)
        for pick, least in ((np.argmin, np.inf), (np.argmax, -np.inf))
    ]
    evenly = np.linspace(0, last, min(EVENLY, rows.size)).round().astype(np.int64)
    chosen = [evenly, changed, changed + 1, np.sort(new)[:CHANGES], np.array(extremes, np.int64)]
    return np.unique(np.concatenate(chosen))
