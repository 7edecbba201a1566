"""`rank` and `report` of whole missions, as commands with all imports: a long and a usual one.

Long: a binary file of ``--gb`` (4) with every evaluation of 300 comparisons in 64 s, most of them
of a few in inner loops. Usual: the same 300 comparisons with 3.4 million evaluations a second, of
which the policy light kept summaries and flops. Seconds are those of the processor (user and
system), which other work on the machine changes least; they are also given next to those of the
imports alone, and of reading the file once, in the same run.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import uuid
from pathlib import Path

import numpy as np
from figures import figure, measured

from pytpc.ingest.binary_chunks import RECORD

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "tests/python")]

import tpc_file  # noqa: E402
from static_units import comparison, unit  # noqa: E402

TOPIC = "mission-speed"
KEYS = [str(uuid.uuid5(uuid.NAMESPACE_URL, f"comparison {number}")) for number in range(300)]
BEGIN_NS = 1_700_000_000 * 10**9
SECONDS = 64
MARKS_S = (20.0, 41.5, 60.0)
FULL = tpc_file.FULL
POOL = 1024
"""Chunks of different records; they repeat, with other times and values."""


def rates() -> np.ndarray:
    """Relative evaluations a second: one comparison in an inner loop, a few more, many slow."""
    each = np.full(len(KEYS), 20.0)
    each[:40] = 500.0
    each[:6] = 60_000.0
    each[0] = 1_800_000.0
    return each


def write_static(path: Path) -> None:
    """Static information of the comparisons, in 17 packages; each parameter has two."""
    units = []
    for number in range(17):
        found = [
            comparison(
                key=key, source=f"limit_{code // 2}", name=f"limit_{code // 2}_", lineno=code + 1
            )
            for code, key in enumerate(KEYS)
            if code % 17 == number
        ]
        units.append(unit(link_unit=f"node{number}", package=f"p{number}", comparisons=found))
    path.write_text(json.dumps({"schema": 1, "units": units}))


def write_marks(path: Path) -> None:
    """Three marks beside the recording."""
    lines = ["time_ns,type,observer,note"]
    lines += [f"{BEGIN_NS + round(at * 1e9)},II,," for at in MARKS_S[:2]]
    lines += [f"{BEGIN_NS + round(MARKS_S[2] * 1e9)},I,,"]
    path.with_name(f"{path.name}.marks.csv").write_text("\n".join(lines) + "\n")


def system_records() -> list[bytes]:
    """The sites and a sync record."""
    sites = [tpc_file.site(code + 1, key) for code, key in enumerate(KEYS)]
    return [tpc_file.sync(0, BEGIN_NS), *sites]


def write_long(path: Path, gigabytes: float) -> None:
    """Every evaluation, of three threads that take turns."""
    random = np.random.default_rng(1)
    chunks = int(gigabytes * 2**30 / tpc_file.CHUNK)
    step = SECONDS * 10**9 // (chunks * FULL)
    share = rates() / rates().sum()
    records = np.zeros((POOL, FULL), RECORD)
    site = random.choice(len(KEYS), records.shape, p=share)
    records["site"] = site + 1
    records["thresh"] = np.linspace(0.5, 3.0, len(KEYS))[site]
    # What is compared is mostly well below its threshold.
    distance = np.abs(random.normal(0.0, 0.3, records.shape)) + 0.05
    with path.open("wb") as stream:
        head = tpc_file.header(node="/move_base", real=BEGIN_NS)
        system = system_records()
        stream.write(head)
        for first in range(0, len(system), 1000):
            stream.write(
                tpc_file.chunk(2, 0, first and FULL, b"".join(system[first : first + 1000]))
            )
        for chunk in range(chunks):
            turn, thread = divmod(chunk, 3)
            one = records[chunk % POOL]
            at = np.arange(turn * FULL, (turn + 1) * FULL, dtype=np.int64) * 3 + thread
            one["steady"] = at * step
            # Once in a while it goes beyond for a moment, at other times for each comparison.
            phase = (chunk / chunks * 37 + one["site"] * 0.618) % 1.0
            one["cmp"] = one["thresh"] - distance[chunk % POOL] + 0.2 * (phase < 0.002)
            one["what"] = 1 | (one["cmp"] > one["thresh"]).astype(np.uint32) * 0x300
            stream.write(tpc_file.chunk(1, thread + 1, turn * FULL, one.tobytes()))
    write_marks(path)


def write_light(path: Path) -> None:
    """A summary a second of each comparison, and its flops: 3.4 million evaluations a second."""
    random = np.random.default_rng(2)
    file = tpc_file.TpcFile(tpc_file.header(node="/move_base", real=BEGIN_NS))
    counts = np.maximum(1, rates() * 3.4e6 / rates().sum()).astype(int)
    records = system_records()
    flops = []
    for second in range(SECONDS):
        begin, end = second * 10**9, (second + 1) * 10**9 - 1
        flopping = set(random.choice(len(KEYS), 12, replace=False).tolist())
        for code, count in enumerate(counts.tolist()):
            thresh = 0.5 + code / 100
            low = thresh - float(random.uniform(0.5, 1.5))
            high = thresh + (0.1 if code in flopping else -0.05)
            diff = low - thresh, high - thresh, -0.4 * count, 0.41 * count
            changes = 2 if code in flopping and count > 2 else 0
            records.append(
                tpc_file.summary(
                    code + 1,
                    period=second,
                    begin=(begin, 0),
                    end=(end, 0),
                    last=(low, thresh),
                    counts=(count, 0, count, changes),
                    diff=diff,
                    span=(low, max(high, thresh)),
                )
            )
            if second == 0:
                flops.append((begin, code, low, thresh, 0))
            if changes:
                flops.append((begin + 10**8 * (1 + code % 7), code, high, thresh, 1))
                flops.append((begin + 10**8 * (2 + code % 7), code, low, thresh, 0))
    for first in range(0, len(records), 390):
        file.system(*records[first : first + 390])
    flops.sort()
    reports = [tpc_file.report(c + 1, at, cmp, t, result=r) for at, c, cmp, t, r in flops]
    for first in range(0, len(reports), FULL):
        file.thread(1, *reports[first : first + FULL])
    file.write(path)
    write_marks(path)


def best(*command: str, rounds: int) -> tuple[float, float]:
    """The least of some rounds: other work on the machine only adds to it."""
    return min(measured(*command) for _ in range(rounds))


def main() -> None:
    """Prints the figures; files stand below ``--folder`` and are removed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--gb", type=float, default=4.0, metavar="GB")
    parser.add_argument("--folder", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=arguments.folder) as name:
        folder = Path(name)
        static = folder / "static.json"
        write_static(static)
        usual, long = folder / "usual.tpc", folder / "long.tpc"
        write_light(usual)
        page = str(folder / "page.html")
        plain, _ = best(sys.executable, "-c", "import numpy, json, click", rounds=3)
        for command, most, options in (("rank", 1.5, []), ("report", 4.0, ["-o", page])):
            pytpc = sys.executable, "-m", "pytpc", command
            seconds, _ = best(*pytpc, str(usual), "--static", str(static), *options, rounds=3)
            target, hit = f"<{most}", seconds < most
            figure(TOPIC, f"{command}_usual", seconds, unit="s", target=target, hit=hit)
            ratio = seconds / plain
            figure(
                TOPIC, f"{command}_usual_to_imports", ratio, unit="ratio", target="none", hit=True
            )
        if arguments.gb <= 0:
            return
        write_long(long, arguments.gb)
        for command, options in (("rank", []), ("report", ["-o", page])):
            once, _ = measured("dd", f"if={long}", "of=/dev/null", "bs=1M")
            pytpc = sys.executable, "-m", "pytpc", command
            seconds, peak = measured(*pytpc, str(long), "--static", str(static), *options)
            figure(TOPIC, f"{command}_long", seconds, unit="s", target="<60", hit=seconds < 60)
            figure(TOPIC, f"{command}_long_peak", peak, unit="MB", target="<2000", hit=peak < 2000)
            ratio = seconds / once
            figure(TOPIC, f"{command}_long_to_dd", ratio, unit="ratio", target="none", hit=True)


if __name__ == "__main__":
    main()
