"""Small recordings of every format, as bytes, for ``readers`` to change."""

from __future__ import annotations

import sys
import tempfile
from functools import cache
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "python"))

import tpc_file
from mission_samples import BagFile, key, line
from ros2_bags import Ros2Bag
from rosbags.rosbag1 import Writer
from tpc_file import TpcFile

from pytpc.ingest.rosout_line import PREFIX

EXTENSIONS = {
    "bag": ".bag",
    "mcap": ".mcap",
    "db3": ".db3",
    "tpc": ".tpc",
    "log": ".log",
    "csv": ".csv",
}
_SUMMARY = (
    f"threshold_summary:{key(1)},1,cmp:1,thresh:0.5,res:1,count:3,flops:1,diff:-0.25;0.5;0.1,"
    "abs:0.3,range:0.25;1,far:3,odd:0,span:10.0;10.1"
)
_DROPPED = f"threshold_dropped:{key(2)},count:12,flops:3,why:site"
_STAMPED = [
    f"170000000{n}.1234567,{line(n, n % 2, n / 3, 1.5).removeprefix(PREFIX)}" for n in range(5)
]
_BATCH = "\n".join(
    [
        "#seq:7,count:5,dropped:2,pid:12,steady:3.000000000",
        *_STAMPED,
        f"12.5,{_SUMMARY}",
        f"12.5,{_DROPPED}",
    ]
)
WORDS = tuple(
    word.encode()
    for word in (
        *("threshold_information:", "threshold_summary:", "threshold_dropped:", "#seq:", ","),
        *(key(1), key(2), "0", "1", "True", ",cmp:", ",thresh:", ",res:", "0.5", "nan", "-inf"),
        *(
            "1e400",
            "1e-400",
            "1700000000.1234567",
            "0.0",
            "9999999999.999999999",
            "[ INFO] [",
            "]: ",
        ),
        *("\n", "\r\n", "\x1b[0m", "\x1b[", "\0", "count:", "flops:", "diff:1;2;3", "span:1.0;2.0"),
        *(_SUMMARY, _DROPPED, _STAMPED[0], line(3, 1, 2, 1), "pid:1,steady:1.0", "\ufffd", "é"),
        *("99999999999999999999", ";", "why:site", "[topics: /a]", "/node", "SQLite format 3\0"),
    )
)


@cache
def samples(reader: str) -> tuple[bytes, ...]:
    """Recordings of one format; those with little in them are more often hit where it counts."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        return tuple(_MAKERS[reader](folder))


def _bags(folder: Path) -> list[bytes]:
    made = []
    for number, compression in enumerate(
        (None, Writer.CompressionFormat.LZ4, Writer.CompressionFormat.BZ2)
    ):
        bag = BagFile(folder / f"{number}.bag")
        if compression is not None:
            bag.writer.set_compression(compression)
        with bag:
            for step in range(12):
                bag.log(step, "/uav", line(step % 3, step % 2, step, 5))
                bag.log(step, "/uav", line(step % 3, step % 2, step, 5), topic="/rosout_agg")
            bag.log(13, "/uav", _SUMMARY)
            bag.log(13, "/uav", _DROPPED)
            bag.text(14, "/threshold_information", "/x", _STAMPED[0])
            bag.text(14, "/threshold_information", "/x", _BATCH)
            bag.mark(15, "/marks1/mark_action")
        made.append((folder / f"{number}.bag").read_bytes())
    return made


def _ros2(kind: str, folder: Path) -> list[bytes]:
    made = []
    for count in (1, 12):
        with Ros2Bag(folder / f"m{count}", kind) as bag:
            for step in range(count):
                bag.log(step, "uav", line(step % 3, step % 2, step, 5))
                bag.text(14, "/threshold_information", _BATCH)
            bag.mark(15, "/mark_action", 15)
        made.append(bag.file.read_bytes())
    return made


def _tpcs(_: Path) -> list[bytes]:
    one = TpcFile(tpc_file.header(real=10**18))
    one.system(tpc_file.site(1, key(1)), tpc_file.sync(0, 10**18), tpc_file.sync(9, 10**18 + 11))
    one.thread(1, *(tpc_file.report(1, n, n, 5, result=n % 2) for n in range(20)))
    two = TpcFile(tpc_file.header(real=10**18, state=2, not_recorded=4))
    two.system(
        tpc_file.site(1, key(1)),
        tpc_file.site(2, "k" * 70),
        tpc_file.sync(0, 10**18),
        tpc_file.summary(1, begin=(3, 0), counts=(5, 1, 2, 2)),
        tpc_file.dropped(1, 1, 7, 1),
    )
    full = [tpc_file.report(1 + n % 2, n, n, 5) for n in range(tpc_file.FULL)]
    two.thread(3, *full)
    two.thread(5, tpc_file.report(1, 1, 1, 1), tpc_file.simulated(2, 77), full[3])
    two.thread(3, *full[:50])
    two.live(tpc_file.slot(tpc_file.summary(2, period=3), 1))
    return [one.data(), two.data()]


def _logs(_: Path) -> list[bytes]:
    lines = [
        f"\x1b[0m[ INFO] [1700000000.1]: {line(1, 1, 2, 1)}\x1b[0m",
        f"[ INFO] [1700000001.1, 12.25]: {line(2, 0, 2, 3)}",
        f"1700000004.0 INFO /brain [brain.cpp:12(step)] [topics: /rosout] {line(1, 0, 1, 1)}",
        f"[INFO] [/a/b] [3.5]: {_SUMMARY}",
        _DROPPED,
    ]
    return ["\n".join(lines).encode(), "\n".join(lines * 4).encode()]


def _csvs(_: Path) -> list[bytes]:
    return ["\n".join(_STAMPED * 5).encode(), ("time,key\n" + _BATCH + "\n").encode()]


_MAKERS = {
    "bag": _bags,
    "mcap": lambda folder: _ros2("mcap", folder),
    "db3": lambda folder: _ros2("db3", folder),
    "tpc": _tpcs,
    "log": _logs,
    "csv": _csvs,
}
