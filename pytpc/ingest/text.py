"""Reports in text: logs of roscpp and of the rosout node, console output, CSV.

A line of a log may have anything in front of the report: what ROSCONSOLE_FORMAT says, colours, the
name of a node. The reader takes the time from it (the simulated one of ``[wall, simulated]``) and
the node's name, if there is one. A report without a time gets the last time before it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.base.wording import many
from pytpc.ingest.gathering import Gathering, Progress
from pytpc.ingest.lines import Batches, Lines
from pytpc.ingest.rosout_line import (
    BATCH_PREFIX,
    LATEST_NS,
    PREFIX,
    BatchHead,
    as_text,
    nanoseconds,
    parse_batch,
)
from pytpc.ingest.short_summary import is_short

_BLOCK = 1 << 20
_LONGEST = 1 << 16
# A spreadsheet may have replaced the commas, or quoted the whole line.
_REPORT_LIKE = re.compile(rb"[01e][\s,;\"]+cmp:.*thresh:.*res:")
_CSV_FORM = "TIME,KEY,RESULT,cmp:C,thresh:T,res:R with decimals in TIME"
_PREFIX = PREFIX.encode()
_BATCH = BATCH_PREFIX.encode()
_IN_BATCH = re.compile(rb"[@~]|[0-9]{1,10}\.[0-9]{1,9},")
_COLOUR = re.compile(rb"\x1b\[[0-9;]*[A-Za-z]")
_TIME = re.compile(
    rb"(?<![0-9.])([0-9]{1,10}\.[0-9]{1,9})(?:, *([0-9]{1,10}\.[0-9]{1,9}))?(?![0-9.])"
)
_NODE = re.compile(rb"(?:^|[\[\s(])(/[A-Za-z][A-Za-z0-9_/]*)(?=[\]\s:),])")
_BEGIN = re.compile(rb"threshold_(?:information|summary|dropped|batch|name):")
_BOM = b"\xef\xbb\xbf"
_CSV = re.compile(rb"[0-9]{1,10}\.[0-9]{1,9},|#seq:")


def read_text_into(path: Path, gathering: Gathering, on_progress: Progress | None = None) -> None:
    """Read a log, console output or CSV; the first two lines tell which.

    In CSV every line but the first must be a report. In a log only lines that begin like a report
    are read.

    Raises:
        InputError: the file cannot be read.
    """
    try:
        size = max(1, path.stat().st_size)
        reader = _reader_for(path, gathering)
        for number, lines, done in _lines(path):
            if number == 1:
                lines[0] = lines[0].removeprefix(_BOM)
            reader.take_many(number, lines)
            if on_progress is not None:
                on_progress(done, size)
        reader.close()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", path) from error


def _reader_for(path: Path, gathering: Gathering) -> _Taker:
    with path.open("rb") as stream:
        first = stream.read(_LONGEST).removeprefix(_BOM).split(b"\n", 2)[:2]
    # The second line of a log may be that of a batch.
    is_csv = any(_CSV.match(line) for line in first) and _BATCH not in first[0]
    return (_Csv if is_csv else _Log)(path, gathering)


class _Taker:
    """What both kinds of files have in common."""

    def __init__(self, path: Path, gathering: Gathering, *, stamped: bool) -> None:
        self.path = path
        self.gathering = gathering
        self._malformed = gathering.malformed
        self.others = 0
        self.channel = gathering.channel(str(path), "text", path.name)
        self.batches = Batches(gathering)
        self.lines = Lines(self.batches, self.channel, stamped=stamped)
        self.node = path.stem

    def take(self, number: int, line: bytes) -> None:
        raise NotImplementedError

    def take_many(self, number: int, lines: list[bytes]) -> None:
        """Take consecutive lines; ``number`` is the number of the first."""
        for at, line in enumerate(lines, start=number):
            self.take(at, line)

    def close(self) -> None:
        self.lines.flush()
        self.batches.close()
        if not (self.channel.count or self.others or self.gathering.malformed > self._malformed):
            self.gathering.without_reports.append(str(self.path))


class _Log(_Taker):
    """Lines with arbitrary text before the report."""

    def __init__(self, path: Path, gathering: Gathering) -> None:
        super().__init__(path, gathering, stamped=False)
        self._last_ns = 0
        self._without_time = 0
        self._stamped = Lines(self.batches, self.channel, stamped=True)
        self._batch_of: str | None = None

    def take(self, number: int, line: bytes) -> None:
        if b"\x1b" in line:
            line = _COLOUR.sub(b"", line)
        if self._batch_of is not None and _IN_BATCH.match(line):
            self._in_batch(number, line, self._batch_of)
            return
        self._batch_of = None
        found = _BEGIN.search(line)
        front = line if found is None else line[: found.start()]
        stamp = _TIME.search(front)
        time_ns = -1 if stamp is None else nanoseconds((stamp[2] or stamp[1]).decode())
        if 0 <= time_ns <= LATEST_NS:
            self._last_ns = time_ns
        else:
            stamp = None
        if found is None:
            if _REPORT_LIKE.search(line):
                what = f"line {number}: neither a line of a log nor {_CSV_FORM}"
                self.gathering.skip(self.channel.topic, 0, what, as_text(line))
            return
        self._without_time += stamp is None
        named = _NODE.search(front)
        node = self.node if named is None else named[1].decode()
        rest = line[found.start() :]
        if rest.startswith(_PREFIX):
            code = self.gathering.nodes.code(node)
            self.lines.add(rest[len(_PREFIX) :], self._last_ns, code, number)
        elif rest.startswith(_BATCH):
            batch = parse_batch(as_text(rest[len(_BATCH) :]))
            self._batch_of = node
            if isinstance(batch, BatchHead):
                self.batches.see(node, batch)
            else:
                what = f"line {number}: {batch.what}, column {batch.column}"
                self.gathering.skip(self.channel.topic, 0, what, as_text(rest))
        else:
            self.others += 1
            self.lines.add_other(as_text(rest), node, number=number)

    def _in_batch(self, number: int, line: bytes, node: str) -> None:
        """Take a line of the batch that a line before has begun."""
        if is_short(line) or _BEGIN.search(line):
            self.others += 1
            self._stamped.add_other(as_text(line), node, number=number)
        else:
            self._stamped.add(line, 0, self.gathering.nodes.code(node), number)

    def close(self) -> None:
        self._stamped.flush()
        super().close()
        if self._without_time:
            self.gathering.late_notes.append(
                f"{self.channel.topic}: {many(self._without_time, 'line')} without a time got that"
                " of the line before"
            )


class _Csv(_Taker):
    """Lines of the form ``TIME,KEY,RESULT,cmp:C,thresh:T,res:R`` below a header line."""

    def __init__(self, path: Path, gathering: Gathering) -> None:
        super().__init__(path, gathering, stamped=True)
        self._code = gathering.nodes.code(self.node)

    def take(self, number: int, line: bytes) -> None:
        if not line.strip() or (number == 1 and not _CSV.match(line) and b"cmp:" not in line):
            return
        if line.startswith(b"#"):
            batch = parse_batch(as_text(line))
            if isinstance(batch, BatchHead):
                self.batches.see(self.node, batch)
            else:
                what = f"line {number}: {batch.what}, column {batch.column}"
                self.gathering.skip(self.channel.topic, 0, what, as_text(line))
        elif is_short(line) or _BEGIN.search(line):
            self.others += 1
            self.lines.add_other(as_text(line), self.node, number=number)
        else:
            self.lines.add(line, 0, self._code, number)

    def take_many(self, number: int, lines: list[bytes]) -> None:
        if number == 1 or any(line.startswith(b"#") or b"threshold_" in line for line in lines):
            super().take_many(number, lines)
            return
        numbers = [at for at, line in enumerate(lines, start=number) if line.strip()]
        kept = [line for line in lines if line.strip()]
        self.lines.extend(kept, [0] * len(kept), [self._code] * len(kept), numbers)


def _lines(path: Path) -> Iterator[tuple[int, list[bytes], int]]:
    """The file in parts: the number (from 1) of the first line, the lines without line ends, and
    the bytes read so far. Only the beginning of an endless line is kept.
    """
    rest, number, done, cut = b"", 1, 0, False
    with path.open("rb") as stream:
        while block := stream.read(_BLOCK):
            done += len(block)
            lines = (rest + block).split(b"\n")
            rest = lines.pop()
            if cut and lines:
                # The end of a line that was too long.
                del lines[0]
                cut = False
            if len(rest) > _LONGEST:
                if not cut:
                    lines.append(rest)
                rest, cut = b"", True
            if lines:
                yield number, [line[:_LONGEST].rstrip(b"\r") for line in lines], done
                number += len(lines)
    if rest and not cut:
        yield number, [rest.rstrip(b"\r")], done
