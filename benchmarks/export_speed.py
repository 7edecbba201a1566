"""How fast a mission is exported, how large the files are, and how much memory it takes.

The mission has 200,000 reports of 20 comparisons in an hour, and three marks. Peak memory is
compared with that of the same mission read and judged, and not written.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from figures import figure, measured

sys.path.insert(0, str(Path(__file__).parents[1] / "tests/python"))
from mission_samples import comparison, key, ns, static_info

from pytpc.recording.events import Events
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording, save_recording

COMPARISONS = 20
HOUR_S = 3600
MARKS = (1000.0, 2000.0, 3000.0)
OUTPUTS = {"mcap": "--mcap", "rrd": "--rerun", "parquet": "--parquet", "csv": "--csv"}
MOST_BYTES = {"mcap": 60, "rrd": 90, "parquet": 50, "csv": 220}


def made(folder: Path, reports: int) -> None:
    """Save the mission and its static information."""
    static_info(*(comparison(n, f"~limit{n}") for n in range(COMPARISONS))).save(
        folder / "static.json"
    )
    random = np.random.default_rng(1)
    cmp, thresh = random.normal(0.0, 1.0, reports), np.full(reports, 1.5)
    events = Events.of(
        time_ns=np.linspace(0, HOUR_S * 1e9, reports).astype(np.int64),
        key=np.arange(reports) % COMPARISONS,
        result=cmp > thresh,
        cmp=cmp,
        thresh=thresh,
        res=cmp > thresh,
        node=np.zeros(reports, np.int32),
        keys=[key(n) for n in range(COMPARISONS)],
        nodes=["/node"],
    )
    marks = tuple(Mark(ns(at), "I") for at in MARKS)
    save_recording(Recording("hour", events, marks, 0, HOUR_S * 10**9), folder)


def size_of(path: Path) -> int:
    """Bytes of a file, or of the table of evaluations in a folder."""
    return next(path.glob("evaluations.*")).stat().st_size if path.is_dir() else path.stat().st_size


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reports", type=int, default=200_000)
    reports = parser.parse_args().reports
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        mission = folder / "hour"
        mission.mkdir()
        made(mission, reports)
        export = [sys.executable, "-m", "pytpc", "export", str(mission), "--period", "10"]
        # The layout alone: all that is not writing.
        base_s, base_mb = measured(*export, "--foxglove", str(folder / "layout.json"))
        for kind, option in OUTPUTS.items():
            output = folder / f"hour.{kind}"
            seconds, mb = measured(*export, option, str(output))
            speed = reports / max(seconds - base_s, 1e-3)
            each = size_of(output) / reports
            more = mb / base_mb
            figure(
                "export",
                f"{kind}-reports-per-cpu-second",
                speed,
                unit="1/s",
                target=">=10000",
                hit=speed >= 10_000,
            )
            figure(
                "export",
                f"{kind}-bytes-per-report",
                each,
                unit="B",
                target=f"<={MOST_BYTES[kind]}",
                hit=each <= MOST_BYTES[kind],
            )
            figure(
                "export",
                f"{kind}-peak-memory-to-judging",
                more,
                unit="ratio",
                target="<=1.5",
                hit=more <= 1.5,
            )


if __name__ == "__main__":
    started = time.monotonic()
    main()
    print(f"{time.monotonic() - started:.0f} s", file=sys.stderr)
