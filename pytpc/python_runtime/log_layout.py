"""The layout of the binary file of reports, and the place of a new file.

docs/reference/formats.md has the layout in words, runtime_log/Layout.h in C++. The reader of these
files, `pytpc.ingest.binary`, uses these numbers too.
"""

from __future__ import annotations

import os
import struct
import sys
from time import time_ns
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pytpc.python_runtime.config import Config

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
REPORT, SITE, SYNC, SIMULATED, SUMMARY, DROPPED, POLICY = range(1, 8)
RESULT_BIT, OUTCOME_BIT, EDGE_BIT = 1 << 8, 1 << 9, 1 << 10
REASONS = {"site": 1, "process": 2, "nested": 3, "stopped": 4}

LONGEST_KEY = 4096
SECOND = 1_000_000_000

HEADER = struct.Struct("<8sIIIIqqIIQII256s256s1024s")
STATE_AT, LOST_AT, NODE_AT, NODE_BYTES = 40, 48, 64, 256
CHUNK = struct.Struct("<IQQ")
pack_report = struct.Struct("<Iqdd").pack_into
pack_integers = struct.Struct("<Iqqq").pack_into

# What holds of what is reported: 4 for the pairs of outcomes.
WHATS = tuple(
    REPORT | (RESULT_BIT if result else 0) | (OUTCOME_BIT if res else 0)
    for result in (False, True)
    for res in (False, True)
)


def bounded(text: str, size: int) -> bytes:
    """UTF-8 with room for a NUL behind it, not cut within a character."""
    return text.encode("utf-8", "replace")[: size - 1].decode("utf-8", "ignore").encode("utf-8")


def program() -> str:
    """The script that runs, else the interpreter."""
    script = getattr(sys.modules.get("__main__"), "__file__", None)
    return os.path.abspath(script) if isinstance(script, str) else sys.executable or "python"


def folder_of(config: Config) -> str:
    """Where files are made."""
    if config.folder:
        return config.folder
    home = os.environ.get("ROS_HOME")
    if home:
        return os.path.join(home, "tpc")
    return os.path.join(os.environ.get("HOME") or "/tmp", ".ros", "tpc")


def created(config: Config, node: str) -> tuple[str, int]:
    """The path of a new file, and the descriptor of the same with ``.new`` behind it.

    It gets its name when it can be read. Until then the other one keeps out whoever has the same
    number in another container, and so the same names.
    """
    folder = folder_of(config)
    os.makedirs(folder, exist_ok=True)
    name = (node or os.path.basename(program())).lstrip("/")
    name = "".join(c if c.isascii() and (c.isalnum() or c in "_-") else "_" for c in name)[:100]
    stem = os.path.join(folder, f"{name or 'process'}-{os.getpid()}-{time_ns() // SECOND}")
    for number in range(1, 1000):
        path = f"{stem}-{number}.tpc" if number > 1 else f"{stem}.tpc"
        flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
        try:
            descriptor = os.open(f"{path}.new", flags, 0o666)
        except FileExistsError:
            continue
        if not os.path.exists(path):
            return path, descriptor
        os.close(descriptor)
        os.unlink(f"{path}.new")
    raise FileExistsError(17, "File exists", stem)
