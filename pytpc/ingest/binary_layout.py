"""The records of the binary file of reports, as numpy reads them (docs/reference/formats.md).

The constants are those of the writer, `pytpc.python_runtime.log_layout`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pytpc.python_runtime.log_layout import (
    CHUNK_BYTES,
    CHUNK_HEADER_BYTES,
    HEADER,
    HEADER_BYTES,
    MAGIC,
    RECORD_BYTES,
)

RECORD = np.dtype(
    [("what", "<u4"), ("site", "<u4"), ("steady", "<i8"), ("cmp", "<f8"), ("thresh", "<f8")]
)
CHUNK = np.dtype([("kind", "<u4"), ("thread", "<u4"), ("first", "<u8"), ("tid", "<u8")])
KEPT = np.dtype(
    [
        ("what", "<u4"),
        ("site", "<u4"),
        ("begin_steady", "<i8"),
        ("cmp", "<f8"),
        ("thresh", "<f8"),
        ("end_steady", "<i8"),
        ("period", "<u4"),
        ("thread", "<u4"),
        *((name, "<u8") for name in ("count", "odd", "far")),
        *((name, "<f8") for name in ("diff_min", "diff_max", "diff_sum", "abs_sum")),
        *((name, "<f8") for name in ("low", "high")),
        ("flops", "<u8"),
        ("begin_ros", "<i8"),
        ("end_ros", "<i8"),
        ("spare", "<u8", 2),
    ]
)
SLOT = np.dtype([("kept", KEPT), ("begun", "<u8"), ("spare", "<u8", 3)])


def whole_bytes(count: int) -> int:
    """How many of the first ``count`` bytes of a chunk are its header and whole records."""
    return max(0, count - (count - CHUNK_HEADER_BYTES) % RECORD_BYTES)


@dataclass(frozen=True, slots=True)
class FileHeader:
    """The header of the file; times in ns of the clocks of its machine."""

    header_bytes: int
    record_bytes: int
    chunk_bytes: int
    pid: int
    steady_ns: int
    real_ns: int
    state: int
    not_recorded: int
    parent: int
    node: str
    host: str
    program: str

    @classmethod
    def of(cls, data: bytes) -> FileHeader:
        """Read it.

        Raises:
            ValueError: the bytes are too few, or no such header.
        """
        if len(data) < HEADER_BYTES:
            raise ValueError(f"the file ends at byte {len(data)}, within its header")
        magic, size, record, chunk, pid, steady, real, state, _, lost, parent, _, *texts = (
            HEADER.unpack_from(data)
        )
        if magic != MAGIC:
            raise ValueError("its first bytes are not those of a .tpc file")
        if (size, record, chunk) != (HEADER_BYTES, RECORD_BYTES, CHUNK_BYTES):
            raise ValueError(
                f"header, record and chunk of {size}, {record} and {chunk} bytes are not of this"
                " version"
            )
        node, host, program = (
            text.partition(b"\0")[0].decode("utf-8", "replace") for text in texts
        )
        return cls(size, record, chunk, pid, steady, real, state, lost, parent, node, host, program)
