"""How many of the evaluations in summaries came out true.

Of a summary without a flop all have its one outcome. In one with flops, which are in the log, they
count as spread evenly over its time.
"""

from __future__ import annotations

import numpy as np

from pytpc.base.columns import Int64s
from pytpc.recording.events import Events
from pytpc.recording.summaries import Summaries


def true_in(events: Events, own: Int64s, summaries: Summaries, rows: Int64s) -> float:
    """How many evaluations in the summaries ``rows`` of one key came out true.

    Args:
        events: the log.
        own: int64[m], the rows of the key in it.
        summaries: those of the recording.
        rows: int64[n], the rows of the key in them.
    """
    steady = rows[summaries.flops[rows] == 0]
    total = float(summaries.count[steady[summaries.result[steady]]].sum())
    for row in rows[summaries.flops[rows] > 0].tolist():
        node = summaries.nodes[summaries.node[row]]
        code = events.nodes.index(node) if node in events.nodes else -1
        mine = own[events.node[own] == code]
        share = _share_true(events, mine, summaries, row)
        total += share * float(summaries.count[row])
    return total


def _share_true(events: Events, mine: Int64s, summaries: Summaries, row: int) -> float:
    """The share of a summary's time in which its predicate was true.

    Between the evaluations that are known, all of which flops are, the outcome stays.
    """
    begin, end = sorted((int(summaries.begin_ns[row]), int(summaries.end_ns[row])))
    times = events.time_ns[mine]
    inside = mine[(times > begin) & (times <= end) & events.flop[mine]]
    if not inside.size or end == begin:
        return float(summaries.result[row])
    edges = np.concatenate([[begin], events.time_ns[inside], [end]])
    outcome = np.concatenate([[not events.result[inside[0]]], events.result[inside]])
    return float(np.diff(edges)[outcome].sum() / (end - begin))
