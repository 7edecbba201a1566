"""Sorts any number of rows by time: in memory, or in runs on disk that are merged on reading.

External merge sort (Knuth, The Art of Computer Programming 3, section 5.4): rows are kept until
there are ``run_rows`` of them, then sorted (stably) and written to a file as a run. In the end the
runs are read side by side, a block of each at a time. Rows that came in sorted need no merge: a run
that begins where another ends is read after it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from pytpc.base.columns import Int64s

Rows = npt.NDArray[np.void]

RUN_ROWS = 1 << 20
_BLOCK_ROWS = 1 << 18
_SMALLEST_BLOCK = 1 << 10


@dataclass(frozen=True, slots=True)
class _Run:
    """``count`` sorted rows from row ``start`` of the file."""

    first_ns: int
    last_ns: int
    count: int
    start: int


class Spool:
    """Collects rows of one structured type in any order and returns them sorted by a field.

    Args:
        kind: the type of a row; ``time`` is an int64 field of it.
        time: by which field rows are sorted; rows with equal times keep the order of ``append``.
        path: the file in which runs are kept; None: all stays in memory.
        run_rows: how many rows are held in memory before they are written.
    """

    def __init__(
        self,
        kind: npt.DTypeLike,
        time: str,
        path: Path | None = None,
        run_rows: int = RUN_ROWS,
    ) -> None:
        self.kind = np.dtype(kind)
        self._time = time
        self._path = path
        self._run_rows = run_rows
        self._held: list[Rows] = []
        self._held_rows = 0
        self._runs: list[_Run] = []
        self._written = 0

    def __len__(self) -> int:
        return self._held_rows + sum(run.count for run in self._runs)

    def append(self, rows: Rows) -> None:
        """Add rows; the spool then owns the array."""
        if not rows.size:
            return
        self._held.append(rows)
        self._held_rows += rows.size
        if self._path is not None and self._held_rows >= self._run_rows:
            self._close_run(self._path)

    def blocks(self) -> Iterator[Rows]:
        """All rows in order of time, in blocks; the spool may be read more than once.

        Raises:
            OSError: the file of runs cannot be written or read.
        """
        if self._path is not None and self._runs and self._held:
            self._close_run(self._path)
        if not self._runs:
            self._held = [self._sorted()] if self._held else []
            yield from self._held
            return
        chains = self._chains()
        block = max(_SMALLEST_BLOCK, _BLOCK_ROWS // len(chains))
        streams = [_Stream(self._read(chain, block), self._time) for chain in chains]
        yield from _merged(streams)

    def close(self) -> None:
        """Delete the file of runs."""
        if self._path is not None:
            self._path.unlink(missing_ok=True)

    def _sorted(self) -> Rows:
        rows = self._held[0] if len(self._held) == 1 else np.concatenate(self._held)
        times = rows[self._time]
        if bool(np.any(times[1:] < times[:-1])):
            rows = rows[np.argsort(times, kind="stable")]
        return rows

    def _close_run(self, path: Path) -> None:
        rows = self._sorted()
        with path.open("ab") as stream:
            rows.tofile(stream)
        times = rows[self._time]
        run = _Run(int(times[0]), int(times[-1]), rows.size, self._written)
        self._runs.append(run)
        self._written += rows.size
        self._held, self._held_rows = [], 0

    def _chains(self) -> list[list[_Run]]:
        """Joins runs that follow one another in time.

        Only the last chain is extended: equal times must keep the order of their runs.
        """
        chains: list[list[_Run]] = []
        for run in self._runs:
            if chains and chains[-1][-1].last_ns <= run.first_ns:
                chains[-1].append(run)
            else:
                chains.append([run])
        return chains

    def _read(self, chain: Sequence[_Run], block: int) -> Iterator[Rows]:
        assert self._path is not None
        with self._path.open("rb") as stream:
            for run in chain:
                for begin in range(0, run.count, block):
                    stream.seek((run.start + begin) * self.kind.itemsize)
                    count = min(block, run.count - begin)
                    yield np.frombuffer(stream.read(count * self.kind.itemsize), self.kind)


class _Stream:
    """A sorted stream of blocks; the first one is loaded."""

    def __init__(self, blocks: Iterator[Rows], time: str) -> None:
        self._blocks = blocks
        self._time = time
        self.rows: Rows | None = next(blocks, None)

    @property
    def last_ns(self) -> int:
        assert self.rows is not None
        return int(self.rows[self._time][-1])

    def take(self, bound: int, side: str) -> Rows:
        """The loaded rows before ``bound`` (side left) or up to it (right)."""
        assert self.rows is not None
        times: Int64s = self.rows[self._time]
        cut = int(np.searchsorted(times, bound, side=side))  # type: ignore[call-overload]
        taken, self.rows = self.rows[:cut], self.rows[cut:]
        if not self.rows.size:
            self.rows = next(self._blocks, None)
        return taken


def _merged(streams: list[_Stream]) -> Iterator[Rows]:
    """Blocks of all ``streams`` in order of time; equal times in the order of the streams.

    Each turn goes up to the smallest last time that is loaded. More rows with exactly this time may
    follow in each stream, so these rows are given stream by stream.
    """
    streams = [stream for stream in streams if stream.rows is not None]
    while len(streams) > 1:
        bound = min(stream.last_ns for stream in streams)
        parts = [part for part in (s.take(bound, "left") for s in streams) if part.size]
        if parts:
            rows = np.concatenate(parts)
            order = np.argsort(rows[streams[0]._time], kind="stable")
            yield rows[order]
        for stream in streams:
            while stream.rows is not None and (part := stream.take(bound, "right")).size:
                yield part
        streams = [stream for stream in streams if stream.rows is not None]
    for stream in streams:
        while stream.rows is not None:
            yield stream.take(stream.last_ns, "right")
