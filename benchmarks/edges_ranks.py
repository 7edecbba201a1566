"""How often the ranks of type II under ``edges`` differ from those of every evaluation.

Takes a mission that was recorded with the policy ``every``, summarises its evaluations as the
runtime does under ``edges``, and ranks both at 10 Hz and at the marks.
``benchmarks/edges_ranks.py [MISSION]``; without a mission, `examples/recorded_mission`.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
from figures import figure

from pytpc.base.columns import Floats
from pytpc.diagnosis.scores.score_tables import Tpcs, parameter_tables, tpc_scores
from pytpc.diagnosis.scores.scores import NONE
from pytpc.diagnosis.scores.summary_scores import LogTables
from pytpc.ingest.reading import read
from pytpc.recording.events import Events
from pytpc.recording.summaries import Summaries, Summary
from pytpc.static.static_info import read_static

MISSION = Path(__file__).resolve().parents[1] / "examples" / "recorded_mission"
DEFAULT_PERIOD_S = 0.1


def summarised(events: Events, period_ns: int) -> tuple[Events, Summaries]:
    """First evaluations and flops, and a summary of each key, node and period."""
    telling = events.flop | (events.previous < 0)
    periods = defaultdict(list)
    for row, time_ns in enumerate(events.time_ns.tolist()):
        periods[int(events.key[row]), int(events.node[row]), time_ns // period_ns].append(row)
    summaries = []
    for (key, node, _), rows in periods.items():
        cmp, thresh = events.cmp[rows], events.thresh[rows]
        good = np.isfinite(cmp) & np.isfinite(thresh)
        diff = (cmp - thresh)[good] if good.any() else np.array([np.nan])
        values = np.concatenate([cmp[good], thresh[good]]) if good.any() else diff
        last = rows[-1]
        summaries.append(
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
    return events.take(telling), Summaries.of_rows(summaries)


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
    for period_s in (0.02, DEFAULT_PERIOD_S, 1.0, 5.0):
        estimate, other = ranked(*summarised(events, round(period_s * 1e9)))
        both = (exact < NONE) & (estimate < NONE) & (exact > 0)
        shares = {
            "ranks": np.mean(other != ranks),
            "first_suspects": np.mean(np.argmax(other, axis=1) != np.argmax(ranks, axis=1)),
            "ranks_at_marks": np.mean((other != ranks)[times.size - len(recording.marks) :]),
            "median_score": np.median(np.abs(estimate[both] / exact[both] - 1)),
        }
        for name, share in shares.items():
            value = 100.0 * float(share)
            of = f"{name}_{period_s:g}s_off"
            if period_s <= DEFAULT_PERIOD_S:
                figure("edges", of, value, unit="%", target="<=0.1", hit=value <= 0.1)
            else:
                # A longer period is a user's choice; this is what it costs.
                print(f"edges {of} {value:.4g} %")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else MISSION)
