"""Writes the binary file of reports by hand, from docs/reference/formats.md alone."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from pathlib import Path

CHUNK = 65536
FULL = 2046


def report(
    number: int,
    steady: int,
    cmp: float,
    thresh: float,
    *,
    result: int = 0,
    res: int | None = None,
) -> bytes:
    flags = result << 8 | (result if res is None else res) << 9
    return struct.pack("<IIqdd", 1 | flags, number, steady, cmp, thresh)


def site(number: int, key: str) -> bytes:
    return _text(2, number, key)


def name(text: str) -> bytes:
    """The name of a parameter: ``KEY,NAME``."""
    return _text(8, 0, text)


def _text(kind: int, number: int, text: str) -> bytes:
    raw = text.encode()
    blocks = -(-max(0, len(raw) - 16) // 32)
    head = struct.pack("<III4x16s", kind, number, len(raw), raw[:16])
    return head + raw[16:].ljust(32 * blocks, b"\0")


def sync(steady: int, real: int, ros: int = 0) -> bytes:
    return struct.pack("<IIqqq", 3, 0, steady, real, ros)


def simulated(steady: int, sim_ns: int) -> bytes:
    return struct.pack("<IIqq8x", 4, 0, steady, sim_ns)


def dropped(site_number: int, reason: int, count: int, flops: int) -> bytes:
    return struct.pack("<IIqQQ", 6 | reason << 16, site_number, 0, count, flops)


def summary(
    site_number: int,
    *,
    thread: int = 1,
    period: int = 0,
    begin: tuple[int, int] = (0, 0),
    end: tuple[int, int] = (0, 0),
    last: tuple[float, float] = (0.0, 0.0),
    counts: tuple[int, int, int, int] = (1, 0, 0, 0),
    diff: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
    span: tuple[float, float] = (0.0, 0.0),
    result: int = 0,
    res: int = 0,
) -> bytes:
    """``begin`` and ``end`` are steady and ROS time, ``counts`` count, odd, far and flops,
    ``diff`` smallest, largest, sum and sum of absolutes."""
    count, odd, far, flops = counts
    what = 5 | result << 8 | res << 9
    raw = struct.pack("<IIqddqII", what, site_number, begin[0], *last, end[0], period, thread)
    raw += struct.pack("<QQQdddddd", count, odd, far, *diff, *span)
    raw += struct.pack("<Qqq16x", flops, begin[1], end[1])
    assert len(raw) == 160
    return raw


def slot(kept: bytes, begun: int) -> bytes:
    return kept + struct.pack("<Q24x", begun)


def header(
    *,
    node: str = "/node",
    program: str = "/opt/ws/lib/pkg/node",
    state: int = 1,
    steady: int = 0,
    real: int = 0,
    not_recorded: int = 0,
    pid: int = 77,
    parent: int = 0,
) -> bytes:
    raw = b"TPCLOG1\n" + struct.pack("<IIII", 4096, 32, CHUNK, pid)
    raw += struct.pack("<qqIIQII", steady, real, state, 0, not_recorded, parent, 0)
    raw += struct.pack("<256s256s1024s", node.encode(), b"host", program.encode())
    return raw.ljust(4096, b"\0")


def chunk(kind: int, thread: int, first: int, records: bytes) -> bytes:
    raw = struct.pack("<IIQQ40x", kind, thread, first, 4242) + records
    assert len(raw) <= CHUNK
    return raw.ljust(CHUNK, b"\0")


@dataclass
class TpcFile:
    """Chunks in the order in which they are given; numbers of records are kept for each thread."""

    head: bytes = field(default_factory=header)
    chunks: list[bytes] = field(default_factory=list)
    written: dict[int, int] = field(default_factory=dict)

    def system(self, *records: bytes) -> None:
        first = self.written.get(0, 0)
        self.chunks.append(chunk(2, 0, first, b"".join(records)))
        self.written[0] = first + FULL

    def thread(self, number: int, *records: bytes, skip: int = 0) -> None:
        """``skip`` records are missing before these."""
        first = self.written.get(number, 0) + skip
        self.chunks.append(chunk(1, number, first, b"".join(records)))
        self.written[number] = first + sum(len(raw) // 32 for raw in records)

    def live(self, *slots: bytes) -> None:
        self.chunks.append(chunk(3, 1, 0, b"".join(slots)))

    def data(self) -> bytes:
        return self.head + b"".join(self.chunks)

    def write(self, path: Path, tail: bytes = b"") -> Path:
        path.write_bytes(self.data() + tail)
        return path
