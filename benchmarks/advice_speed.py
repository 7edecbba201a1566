"""How fast a mission is replayed with other values of a parameter (docs/reference/scores.md).

A million evaluations of one comparison, and of 50 comparisons of one parameter, ten minutes long,
with a mark each half minute. The target is a fifth of a second for one value.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "python"))

from figures import figure
from mission_samples import comparison, key, static_info

from pytpc.diagnosis.suggestion.what_if import what_if
from pytpc.recording.events import Events
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

TOPIC = "score-speed"
SECONDS = 600
REPORTS = 1_000_000
TARGET_S = 0.2
ROUNDS = 5


def mission(comparisons: int) -> tuple[Recording, StaticInfo]:
    """A million reports of so many comparisons of one parameter."""
    random = np.random.default_rng(1)
    cmp = random.normal(size=REPORTS)
    events = Events.of(
        time_ns=np.sort(random.integers(0, SECONDS * 10**9, REPORTS)),
        key=random.integers(0, comparisons, REPORTS),
        result=cmp > 0.5,
        cmp=cmp,
        thresh=np.full(REPORTS, 0.5),
        res=cmp > 0.5,
        node=np.zeros(REPORTS, dtype=np.int32),
        keys=[key(number) for number in range(comparisons)],
        nodes=["/node"],
    )
    marks = [Mark(t * 10**9, "II" if t % 60 else "I") for t in range(30, SECONDS, 30)]
    static = static_info(*[comparison(number, "~limit") for number in range(comparisons)])
    return Recording("mission", events, tuple(marks), 0, SECONDS * 10**9), static


def seconds(work: Callable[[], object]) -> float:
    """The shortest time of some rounds."""
    times = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return min(times)


def main() -> None:
    """Print a figure for one value."""
    for comparisons in (1, 50):
        recording, static = mission(comparisons)
        one = seconds(lambda: what_if(recording, static, "~limit", 0.7))  # noqa: B023
        name = f"what_if_{comparisons}_comparisons"
        target = f"<{TARGET_S}"
        figure(TOPIC, name, one, unit="s", target=target, hit=one < TARGET_S)


if __name__ == "__main__":
    main()
