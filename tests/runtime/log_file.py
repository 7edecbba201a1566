"""The binary file read record by record, as docs/reference/formats.md has it: no code of pytpc's.

Slow and plain: what the log library writes is compared with this, and so is what pytpc reads.
"""

from __future__ import annotations

import struct
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

HEADER, CHUNK, RECORD = 4096, 65536, 32
SUMMARY = struct.Struct("<IIqddqIIQQQddddddQqqQQ")
NAMES = [
    "what",
    "site",
    "begin",
    "cmp",
    "thresh",
    "end",
    "period",
    "thread",
    "count",
    "odd",
    "far",
    "diff_min",
    "diff_max",
    "diff_sum",
    "abs_sum",
    "low",
    "high",
    "flops",
    "begin_ros",
    "end_ros",
    "seen",
    "about",
]


@dataclass
class LogFile:
    """What a file holds; reports are (steady_ns, site, result, res, cmp, thresh, is_edge)."""

    state: int
    node: str
    not_recorded: int
    size: int
    reports: dict[int, list[tuple]] = field(default_factory=lambda: defaultdict(list))
    keys: dict[int, str] = field(default_factory=dict)
    syncs: list[tuple[int, int, int]] = field(default_factory=list)
    summaries: list[dict] = field(default_factory=list)
    live: list[dict] = field(default_factory=list)
    dropped: list[tuple[int, int, int, int]] = field(default_factory=list)
    policies: list[tuple[int, int]] = field(default_factory=list)
    torn: int = 0
    steady_ns: int = 0
    segment: int = 0

    @property
    def all_reports(self) -> list[tuple]:
        return [report for thread in self.reports.values() for report in thread]

    @property
    def all_summaries(self) -> list[dict]:
        """Those that were written, and those that were open when the process ended."""
        written = {(s["thread"], s["site"], s["period"]) for s in self.summaries}
        still = [s for s in self.live if (s["thread"], s["site"], s["period"]) not in written]
        return self.summaries + still


def read(path: Path) -> LogFile:
    data = path.read_bytes()
    assert data[:8] == b"TPCLOG1\n"
    assert struct.unpack_from("<III", data, 8) == (HEADER, RECORD, CHUNK)
    state, _clock, not_recorded = struct.unpack_from("<IIQ", data, 40)
    node = data[64 : data.index(b"\0", 64)].decode()
    file = LogFile(state, node, not_recorded, len(data))
    (file.steady_ns,) = struct.unpack_from("<q", data, 24)
    (file.segment,) = struct.unpack_from("<I", data, 60)
    expected: dict[int, int] = defaultdict(int)
    for place in range(HEADER, len(data) - 63, CHUNK):
        kind, thread, first, _tid = struct.unpack_from("<IIQQ", data, place)
        if kind == 3:
            _slots(file, data[place : place + CHUNK])
        elif kind:
            assert first == expected[thread], "chunks of a thread follow one another"
            expected[thread] += (CHUNK - 64) // RECORD
            _records(file, thread, data[place : place + CHUNK].ljust(CHUNK, b"\0"))
    return file


def _slots(file: LogFile, chunk: bytes) -> None:
    for place in range(64, CHUNK - 191, 192):
        slot = dict(zip(NAMES, SUMMARY.unpack_from(chunk, place), strict=True))
        if slot["count"]:
            (begun,) = struct.unpack_from("<Q", chunk, place + 160)
            assert begun in (slot["count"], slot["count"] + 1)
            file.live.append(slot)


def _records(file: LogFile, thread: int, chunk: bytes) -> None:
    place = 64
    while place < CHUNK:
        what, site, steady = struct.unpack_from("<IIq", chunk, place)
        if not what:
            file.torn += any(chunk[place : place + RECORD])
            assert not any(chunk[place + RECORD :])
            return
        kind = what & 0xFF
        a, b = struct.unpack_from("<qq", chunk, place + 16)
        if kind == 1:
            cmp, thresh = struct.unpack_from("<dd", chunk, place + 16)
            bits = (bool(what & 0x100), bool(what & 0x200))
            file.reports[thread].append((steady, site, *bits, cmp, thresh, bool(what & 0x400)))
        elif kind == 2:
            blocks = max(0, -(-(steady - 16) // RECORD))
            text = chunk[place + 16 : place + RECORD * (1 + blocks)]
            assert site not in file.keys
            file.keys[site] = text[:steady].decode()
            place += RECORD * blocks
        elif kind == 3:
            file.syncs.append((steady, a, b))
        elif kind == 5:
            values = SUMMARY.unpack_from(chunk, place)
            file.summaries.append(dict(zip(NAMES, values, strict=True)))
            place += RECORD * 4
        elif kind == 6:
            file.dropped.append((what >> 16 & 0xFF, site, a, b))
        elif kind == 7:
            file.policies.append((site, a))
        else:
            raise AssertionError(f"a record of kind {kind}")
        place += RECORD
