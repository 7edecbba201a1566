"""How much the files of nodes hold, to show while they are written."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pytpc.base.errors import InputError
from pytpc.ingest.binary_chunks import RECORD, ChunkFile, FileHeader
from pytpc.ingest.binary_system import open_summaries, written_summaries
from pytpc.python_runtime import log_layout as layout


class FileCounts(NamedTuple):
    """How many files there are, and how many reports and summaries are in them."""

    files: int = 0
    reports: int = 0
    summaries: int = 0


NO_FILES = FileCounts()


class FileCounter:
    """Counts what is in the files of a folder. A chunk that is full is read once.

    Args:
        folder: it need not exist.
        since_ns: leave out files that were last written before this time, in ns since 1970.
        rings: count the files of rings, too.
    """

    def __init__(self, folder: Path, since_ns: int = 0, *, rings: bool = True) -> None:
        self._folder = folder
        self._since_ns = since_ns
        self._rings = rings
        self._full: dict[tuple[str, int], int] = {}

    def count(self) -> FileCounts:
        """What is there now; a report that is just being written may be missed."""
        files = reports = summaries = 0
        for path in sorted(self._folder.glob("*.tpc")):
            try:
                found = self._count(path)
            except (OSError, ValueError, InputError):
                # Whoever reads the recording says what is wrong with it.
                found = 0, 0
            if found is not None:
                files += 1
                reports += found[0]
                summaries += found[1]
        return FileCounts(files, reports, summaries)

    def _count(self, path: Path) -> tuple[int, int] | None:
        """Reports and summaries of a file; None where it is an older one."""
        with path.open("rb", buffering=0) as stream:
            if os.fstat(stream.fileno()).st_mtime_ns < self._since_ns:
                return None
            header = FileHeader.of(stream.read(layout.HEADER_BYTES) or b"")
            if header.segment and not self._rings:
                return None
            file = ChunkFile(path, stream.fileno())
            reports = 0
            for thread in file.find(lambda _: None):
                for place in thread.chunks:
                    known = self._full.get((path.name, place))
                    if known is None:
                        records = file.load_one(place)[layout.CHUNK_HEADER_BYTES :].view(RECORD)
                        known = int(np.count_nonzero(records["what"] & 0xFF == layout.REPORT))
                        if place != thread.chunks[-1]:
                            self._full[path.name, place] = known
                    reports += known
            summaries = sum(written_summaries(file.load_one(one)).size for one in file.system)
            summaries += sum(open_summaries(file.load_one(one))[0].size for one in file.live)
        return reports, summaries
