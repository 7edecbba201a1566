"""How often the ranks of type II under ``edges`` differ from those of every evaluation.

Takes a mission that was recorded with the policy ``every``, summarises its evaluations as the
runtime does under ``edges``, and ranks both at 10 Hz: ``benchmarks/edges_ranks.py MISSION``.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

from pytpc.base.columns import Floats
from pytpc.diagnosis.scores.score_tables import Tpcs, parameter_tables, tpc_scores
from pytpc.diagnosis.scores.scores import NONE
from pytpc.diagnosis.scores.summary_scores import LogTables
from pytpc.ingest import read
from pytpc.recording.events import Events
from pytpc.recording.summaries import Summaries, Summary, SummaryBuilder
from pytpc.static.static_info import read_static


def summarised(events: Events, period_ns: int) -> tuple[Events, Summaries]:
    """First evaluations and flops, and a summary of each key, node and period."""
    telling = events.flop | (events.previous < 0)
    periods = defaultdict(list)
    for row, time_ns in enumerate(events.time_ns.tolist()):
        periods[int(events.key[row]), int(events.node[row]), time_ns // period_ns].append(row)
    builder = SummaryBuilder()
    for (key, node, _), rows in periods.items():
        cmp, thresh = events.cmp[rows], events.thresh[rows]
        good = np.isfinite(cmp) & np.isfinite(thresh)
        diff = (cmp - thresh)[good] if good.any() else np.array([np.nan])
        values = np.concatenate([cmp[good], thresh[good]]) if good.any() else diff
        last = rows[-1]
        builder.add(
            Summary(
                key=events.keys[key],
                node=events.nodes[node],
                begin_ns=int(events.time_ns[rows[0]]),
                end_ns=int(events.time_ns[last]),
                count=len(rows),
                flops=int(events.flop[rows].sum()),
                far=int((np.abs(diff) > 1e-4).sum()),
                odd=int((~good).sum()),
                result=bool(events.result[last]),
                res=bool(events.res[last]),
                cmp=float(events.cmp[last]),
                thresh=float(events.thresh[last]),
                diff_min=float(diff.min()),
                diff_max=float(diff.max()),
                diff_mean=float(diff.mean()),
                abs_mean=float(np.abs(diff).mean()),
                low=float(values.min()),
                high=float(values.max()),
            )
        )
    return events.take(telling), builder.build()


def main(mission: Path) -> None:
    """Print, for several periods, how many ranks differ."""
    recording, static = read(mission), read_static(mission / "static.json")
    tpcs = Tpcs.of(static)
    events = recording.events.with_keys(tpcs.keys)
    times = np.arange(recording.start_ns, recording.end_ns, 100_000_000, dtype=np.int64)
    times = np.concatenate([times, [mark.time_ns for mark in recording.marks]])

    def ranked(some: Events, summaries: Summaries) -> tuple[Floats, Floats]:
        scores = tpc_scores(tpcs, LogTables(some.with_keys(tpcs.keys), summaries), times)
        return scores.second, parameter_tables(tpcs, scores).second.ranks

    exact, ranks = ranked(events, Summaries.empty())
    print("period  other ranks  other first suspect  other ranks at marks  score off by")
    for period_s in (0.02, 0.1, 1.0, 5.0):
        estimate, other = ranked(*summarised(events, round(period_s * 1e9)))
        both = (exact < NONE) & (estimate < NONE) & (exact > 0)
        off = np.median(np.abs(estimate[both] / exact[both] - 1))
        first = np.mean(np.argmax(other, axis=1) != np.argmax(ranks, axis=1))
        marks = np.mean((other != ranks)[times.size - len(recording.marks) :])
        print(
            f"{period_s:4g} s {np.mean(other != ranks):12.2%} {first:20.2%} {marks:21.2%}"
            f" {off:13.2e}"
        )


main(Path(sys.argv[1]))
