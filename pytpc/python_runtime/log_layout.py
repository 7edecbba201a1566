"""The layout of the binary file of reports.

docs/reference/formats.md describes it, and runtime_log/Layout.h has it in C++.
`pytpc.ingest.binary` reads these files with the same constants.
"""

from __future__ import annotations

import struct

MAGIC = b"TPCLOG1\n"
HEADER_BYTES = 4096
RECORD_BYTES = 32
CHUNK_BYTES = 65536
CHUNK_HEADER_BYTES = 64
RECORDS_OF_CHUNK = (CHUNK_BYTES - CHUNK_HEADER_BYTES) // RECORD_BYTES

SLOT_BYTES = 192
SLOTS_OF_CHUNK = (CHUNK_BYTES - CHUNK_HEADER_BYTES) // SLOT_BYTES

OPEN, CLOSED, STOPPED = 0, 1, 2
THREAD_CHUNK, SYSTEM_CHUNK, LIVE_CHUNK = 1, 2, 3
REPORT, SITE, SYNC, SIMULATED, SUMMARY, DROPPED, POLICY, NAME = range(1, 9)
RESULT_BIT, OUTCOME_BIT, EDGE_BIT = 1 << 8, 1 << 9, 1 << 10
REASONS = {"site": 1, "process": 2, "nested": 3, "stopped": 4}

LONGEST_KEY = 4096
SECOND = 1_000_000_000

HEADER = struct.Struct("<8sIIIIqqIIQII256s256s1024s")
STATE_AT, LOST_AT, NODE_AT, NODE_BYTES = 40, 48, 64, 256
CHUNK = struct.Struct("<IQQ")
pack_report = struct.Struct("<Iqdd").pack_into
pack_integers = struct.Struct("<Iqqq").pack_into

# The first word of a report, by its two outcomes.
WHATS = tuple(
    REPORT | (RESULT_BIT if result else 0) | (OUTCOME_BIT if res else 0)
    for result in (False, True)
    for res in (False, True)
)
