"""Both scores of every comparison on a 10 Hz grid, for a mission of a million reports."""

from __future__ import annotations

import statistics
import time

import numpy as np
from figures import figure

from pytpc.events import Events
from pytpc.scoring.scores import type1, type2

REPORTS = 1_000_000
KEYS = 60
SECONDS = 1_000
ROUNDS = 5


def mission() -> Events:
    """A seeded mission: each comparison's value wanders about its threshold."""
    random = np.random.default_rng(1)
    key = random.integers(0, KEYS, REPORTS).astype(np.int32)
    cmp = random.normal(0.0, 1.0, REPORTS)
    thresh = np.linspace(-2.0, 2.0, KEYS)[key]
    return Events.of(
        time_ns=np.sort(random.integers(0, SECONDS * 10**9, REPORTS)),
        key=key,
        result=cmp > thresh,
        cmp=cmp,
        thresh=thresh,
        res=cmp > thresh,
        node=np.zeros(REPORTS, np.int32),
        keys=tuple(f"key{n}" for n in range(KEYS)),
        nodes=("/node",),
    )


def main() -> None:
    """Prints the median time; a new table each round, so that nothing is remembered."""
    grid = np.arange(0, SECONDS * 10**9, 10**8, dtype=np.int64)
    distance = np.arange(1, KEYS + 1)
    seconds = []
    for _ in range(ROUNDS):
        events = mission()
        begin = time.perf_counter()
        type1(events, grid, distance)
        type2(events, grid, distance)
        seconds.append(time.perf_counter() - begin)
    median = statistics.median(seconds)
    figure(
        "score-speed", "million_reports_10hz_grid", median, unit="s", target="<1", hit=median < 1
    )


if __name__ == "__main__":
    main()
