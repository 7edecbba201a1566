"""Both scores of every comparison on a 10 Hz grid, for a mission of a million reports.

Beside pandas on the same data, whose numbers are seen to be the same: pandas works out a few times
of the grid, spread evenly over it, and what it takes is multiplied. ``--growth`` shows how the time
grows with reports, comparisons and times; ``--live`` what a report costs while the mission runs.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from figures import figure
from score_by_pandas import frame_of, scores_at

from pytpc.diagnosis.scores.live_scores import LiveScores
from pytpc.diagnosis.scores.score_tables import Tpcs, parameter_tables, tpc_scores
from pytpc.diagnosis.scores.scores import NONE, type1, type2
from pytpc.diagnosis.scores.summary_scores import LogTables
from pytpc.recording.events import Events
from pytpc.recording.summaries import Summaries

REPORTS = 1_000_000
KEYS = 60
SECONDS = 1_000
STEP_NS = 10**8
ROUNDS = 5
SAMPLES = 20
TOPIC = "score-speed"


def mission(reports: int = REPORTS, keys: int = KEYS) -> Events:
    """A seeded mission: each comparison's value is about its threshold, one in 1,000 is NaN."""
    random = np.random.default_rng(1)
    key = random.integers(0, keys, reports).astype(np.int32)
    cmp = random.normal(0.0, 1.0, reports)
    cmp[random.integers(0, reports, reports // 1000)] = np.nan
    thresh = np.linspace(-3.0, 3.0, keys)[key]
    return Events.of(
        time_ns=np.sort(random.integers(0, SECONDS * 10**9, reports)),
        key=key,
        result=cmp > thresh,
        cmp=cmp,
        thresh=thresh,
        res=cmp > thresh,
        node=random.integers(0, 3, reports).astype(np.int32),
        keys=tuple(f"key{n}" for n in range(keys)),
        nodes=("/a", "/b", "/c"),
    )


def grid(times: int = SECONDS * 10**9 // STEP_NS) -> npt.NDArray[np.int64]:
    """So many times over the whole mission; a 10 Hz grid where it is not said how many."""
    return np.arange(times, dtype=np.int64) * (SECONDS * 10**9 // times)


def seconds_of(work: Callable[[], object]) -> float:
    """What ``work`` takes of one processor."""
    begin = time.process_time()
    work()
    return time.process_time() - begin


def ours(reports: int, keys: int, times: npt.NDArray[np.int64], rounds: int = ROUNDS) -> float:
    """The median time; a new table each round, so that nothing is remembered."""
    distance = np.ones(keys)
    seconds = []
    for _ in range(rounds):
        events = mission(reports, keys)
        seconds.append(
            seconds_of(
                lambda events=events: (
                    type1(events, times, distance),
                    type2(events, times, distance),
                )
            )
        )
    return statistics.median(seconds)


def same(events: Events, marks: npt.NDArray[np.int64]) -> float:
    """See that pandas gives the same numbers, and say what it takes for a time.

    Raises:
        AssertionError: it gives others.
    """
    frame = frame_of(events)
    theirs: list[tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]] = []
    taken = seconds_of(
        lambda: theirs.extend(scores_at(frame, int(mark), len(events.keys)) for mark in marks)
    )
    distance = np.ones(len(events.keys))
    tables = type1(events, marks, distance), type2(events, marks, distance)
    for table, column in zip(tables, zip(*theirs, strict=True), strict=True):
        expected = np.nan_to_num(np.stack(column), nan=NONE)
        np.testing.assert_allclose(table, expected, rtol=1e-9, atol=0)
    return taken / marks.size


def speed() -> None:
    """A million reports, and beside pandas."""
    times = grid()
    median = ours(REPORTS, KEYS, times)
    figure(TOPIC, "million_reports_10hz_grid", median, unit="s", target="<1", hit=median < 1)
    events = mission()
    tpcs = Tpcs(events.keys, np.ones(KEYS), tuple(f"p{code // 2}" for code in range(KEYS)))
    none = Summaries.empty()
    ranked = seconds_of(
        lambda: parameter_tables(tpcs, tpc_scores(tpcs, LogTables(events, none), times))
    )
    figure(TOPIC, "the_same_with_ranks", ranked, unit="s", target="<1", hit=ranked < 1)
    # The middles of as many parts of the grid: pandas is slower the more has been before.
    some = times[(2 * np.arange(SAMPLES) + 1) * times.size // (2 * SAMPLES)]
    each = same(events, some)
    whole = each * times.size
    figure(TOPIC, f"pandas_for_a_time_of_{SAMPLES}", each, unit="s", target="none", hit=True)
    figure(TOPIC, "pandas_whole_grid_extrapolated", whole, unit="s", target="none", hit=True)
    ratio = whole / median
    figure(TOPIC, "faster_than_pandas", ratio, unit="times", target=">=100", hit=ratio >= 100)


def growth() -> None:
    """The time for ten times the reports, comparisons and times: ten times it, at most."""
    table = [
        *(("reports", reports, KEYS, 10_000) for reports in (10_000, 100_000, 1_000_000)),
        *(("comparisons", REPORTS, keys, 10_000) for keys in (6, 60, 600)),
        *(("times", REPORTS, KEYS, times) for times in (1_000, 10_000, 100_000)),
    ]
    before: dict[str, float] = {}
    for what, reports, keys, times in table:
        seconds = ours(reports, keys, grid(times), 3)
        hit = what not in before or seconds < 12 * before[what]
        count = {"reports": reports, "comparisons": keys, "times": times}[what]
        target = "<12x_the_last" if what in before else "none"
        figure(TOPIC, f"growth_{what}_{count}", seconds, unit="s", target=target, hit=hit)
        before[what] = seconds


def live() -> None:
    """What a report costs, at the begin of a mission and after many, and what scores cost."""
    events = mission(200_000)
    rows = list(
        zip(
            events.time_ns.tolist(),
            [events.keys[code] for code in events.key.tolist()],
            [events.nodes[code] for code in events.node.tolist()],
            events.result.tolist(),
            events.cmp.tolist(),
            events.thresh.tolist(),
            events.res.tolist(),
            strict=True,
        )
    )
    scores = LiveScores(events.keys, np.ones(KEYS))

    def add(part: slice) -> None:
        for row in rows[part]:
            scores.add(*row)

    quarter = len(rows) // 4
    first = seconds_of(lambda: add(slice(0, quarter))) / quarter * 1e6
    seconds_of(lambda: add(slice(quarter, 3 * quarter)))
    last = seconds_of(lambda: add(slice(3 * quarter, None))) / quarter * 1e6
    figure(TOPIC, "live_report", last, unit="us", target="<10", hit=last < 10)
    slower = last / first
    figure(TOPIC, "live_report_last_to_first", slower, unit="times", target="<2", hit=slower < 2)
    now = int(events.time_ns[-1])
    each = seconds_of(lambda: [scores.scores_at(now) for _ in range(20)]) / 20 * 1e3
    figure(TOPIC, "live_scores_200_reports_a_s", each, unit="ms", target="<100", hit=each < 100)


def main() -> None:
    """Prints the figures; exits with an error where pandas gives other numbers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--growth", action="store_true")
    parser.add_argument("--live", action="store_true")
    chosen = parser.parse_args()
    if chosen.growth:
        growth()
    if chosen.live:
        live()
    if not (chosen.growth or chosen.live):
        speed()


if __name__ == "__main__":
    main()
