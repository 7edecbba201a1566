"""`pytpc rank` of a mission of a million reports beside 20 good runs of as many, learned before.

The missions are seeded; each good run has other thresholds for three of 60 comparisons.
"""

from __future__ import annotations

import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from figures import figure, measured

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "tests/python")]

from mission_samples import comparison, key, static_info  # noqa: E402

from pytpc.api.learning import learn  # noqa: E402
from pytpc.diagnosis.thinned import thinned  # noqa: E402
from pytpc.recording.events import Events  # noqa: E402
from pytpc.recording.marks import Mark  # noqa: E402
from pytpc.recording.mission import Recording, save_recording  # noqa: E402

TOPIC = "learned-speed"
RUNS, REPORTS, KEYS, SECONDS = 20, 1_000_000, 60, 1_000
MOST_S, MOST_MB = 5.0, 0.5


def mission(seed: int) -> Recording:
    """Each comparison's value goes about its threshold; three thresholds are this mission's own."""
    random = np.random.default_rng(seed)
    keys = random.integers(0, KEYS, REPORTS).astype(np.int32)
    thresholds = np.linspace(-2.0, 2.0, KEYS)
    thresholds[random.choice(KEYS, 3, replace=False)] += 1.0
    cmp = random.normal(0.0, 1.0, REPORTS)
    thresh = thresholds[keys]
    events = Events.of(
        time_ns=np.sort(random.integers(0, SECONDS * 10**9, REPORTS)) + seed * 10**13,
        key=keys,
        result=cmp > thresh,
        cmp=cmp,
        thresh=thresh,
        res=cmp > thresh,
        node=np.zeros(REPORTS, np.int32),
        keys=tuple(key(n) for n in range(KEYS)),
        nodes=("/node",),
    )
    begin, end = int(events.time_ns[0]), int(events.time_ns[-1])
    return Recording(f"run{seed}", events, (), begin, end)


def main() -> None:
    """Learn the runs, then judge."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        static_info(*(comparison(n, f"~p{n}") for n in range(KEYS))).save(folder / "static.json")
        learned = 0.0
        for seed in range(1, RUNS + 1):
            recording = mission(seed)
            begin = time.process_time()
            thinned(recording)
            learned += time.process_time() - begin
            learn(recording, folder / f"run{seed}", folder / "good")
        wrong = mission(0)
        marks = tuple(Mark(wrong.start_ns + at * 10**9, None) for at in (400, 420, 700))
        save_recording(replace(wrong, marks=marks), folder / "today")
        size = sum(file.stat().st_size for file in (folder / "good").rglob("*") if file.is_file())
        command = (
            *(sys.executable, "-m", "pytpc", "rank", str(folder / "today"), "--json"),
            *("--static", str(folder / "static.json"), "--reference", str(folder / "good")),
        )
        seconds, _ = measured(*command)
    figure(TOPIC, "verdict", seconds, unit="s", target=f"<={MOST_S:g}", hit=seconds <= MOST_S)
    each = size / RUNS / 1e6
    figure(TOPIC, "profile-run", each, unit="MB", target=f"<={MOST_MB:g}", hit=each <= MOST_MB)
    per_run = learned / RUNS
    figure(TOPIC, "learn-run", per_run, unit="s", target="<=5", hit=per_run <= MOST_S)


if __name__ == "__main__":
    main()
