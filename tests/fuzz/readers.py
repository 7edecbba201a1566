"""Changed and made-up recordings through every reader: no crash, no hang, no unbounded memory.

An input is good when it is read, or refused with one line. Inputs are the samples of
``reader_samples``, changed at random: bytes and numbers overwritten with telling ones, spans cut
out, doubled, exchanged or taken from another sample, the end cut off; or lines put together from
the words of the formats. Each comes from its number alone, so that a finding can be made again:
``tools/fuzz-readers --reader bag --first 4711 --count 1``.
"""

from __future__ import annotations

import argparse
import faulthandler
import random
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fuzz.reader_samples import EXTENSIONS, WORDS, samples
from pytpc.base.errors import TpcError
from pytpc.ingest.gathering import Gathering
from pytpc.ingest.merged import Merged
from pytpc.ingest.reading import gather

SECONDS = 5
GROWTH_MB = 200
_HANG_S = 30
_TELLING = (0, 1, 2, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)
_TELLING += (0x7FFFFFFFFFFFFFFF, 0x8000000000000000, 0xFFFFFFFFFFFFFFFF, 4096, 65536, 1 << 40)


class HangError(BaseException):
    """An input took too long; no reader may take this for an error of its own."""


@dataclass
class Tally:
    """How many inputs were read, refused and found wanting."""

    read: int = 0
    refused: int = 0
    events: int = 0
    findings: list[str] = field(default_factory=list)
    reasons: Counter[str] = field(default_factory=Counter)

    @property
    def inputs(self) -> int:
        return self.read + self.refused + len(self.findings)


def make(reader: str, number: int) -> bytes:
    """The input with this number."""
    source = random.Random(f"{reader} {number}")
    known = samples(reader)
    if reader in {"log", "csv"} and source.random() < 0.3:
        return _lines(source)
    data = bytearray(source.choice(known))
    for _ in range(source.choice((1, 1, 2, 3, 8))):
        source.choice(_CHANGES)(data, source, known)
    return bytes(data)


def read_input(path: Path) -> int:
    """Read one input as a user would; the number of events."""
    gathering = Gathering()
    gather([path], gathering)
    recording = Merged(gathering, "fuzz").recording()
    return len(recording.events)


def run(
    reader: str,
    numbers: range,
    folder: Path,
    *,
    until: float = float("inf"),
    one: Callable[[Path], int] = read_input,
) -> Tally:
    """Feed the inputs with these numbers to a reader until ``until`` (of time.monotonic).

    What is wrong is kept in ``folder`` as ``READER-NUMBER``.
    """
    tally = Tally()
    path = folder / f"input{EXTENSIONS[reader]}"
    before = signal.signal(signal.SIGALRM, _hang)
    try:
        for number in numbers:
            if time.monotonic() > until:
                break
            data = make(reader, number)
            path.write_bytes(data)
            finding = _check(path, tally, one)
            if finding:
                tally.findings.append(f"{reader} {number}: {finding}")
                (folder / f"{reader}-{number}{EXTENSIONS[reader]}").write_bytes(data)
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
        path.unlink(missing_ok=True)
    return tally


def _check(path: Path, tally: Tally, one: Callable[[Path], int]) -> str:
    memory = _peak_mb()
    signal.alarm(SECONDS)
    try:
        tally.events += one(path)
        tally.read += 1
    except TpcError as error:
        if "\n" in str(error):
            return f"a message of several lines: {str(error)!r}"
        tally.refused += 1
        tally.reasons[error.message[:40]] += 1
    except HangError:
        return f"longer than {SECONDS} s"
    except MemoryError:
        return "out of memory"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    finally:
        signal.alarm(0)
    grown = _peak_mb() - memory
    return f"{grown:.0f} MB of memory" if grown > GROWTH_MB else ""


def _hang(*_: object) -> None:
    raise HangError


def _peak_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


# --- changes


def _flip(data: bytearray, source: random.Random, _: Sequence[bytes]) -> None:
    if data:
        data[source.randrange(len(data))] ^= 1 << source.randrange(8)


def _number(data: bytearray, source: random.Random, _: Sequence[bytes]) -> None:
    size, form = source.choice(((1, "B"), (2, "<H"), (4, "<I"), (8, "<Q"), (4, ">I")))
    if len(data) > size:
        place = source.randrange(len(data) - size)
        value = source.choice((*_TELLING, len(data), source.randrange(256)))
        data[place : place + size] = struct.pack(form, value % (1 << 8 * size))


def _cut_out(data: bytearray, source: random.Random, _: Sequence[bytes]) -> None:
    begin = source.randrange(len(data) + 1)
    del data[begin : begin + source.choice((1, 4, 32, 200, 5000))]


def _double(data: bytearray, source: random.Random, _: Sequence[bytes]) -> None:
    begin = source.randrange(len(data) + 1)
    span = data[begin : begin + source.choice((1, 8, 64, 1000, 70000))]
    place = source.randrange(len(data) + 1)
    data[place:place] = span


def _overwrite(data: bytearray, source: random.Random, known: Sequence[bytes]) -> None:
    other = source.choice(known)
    begin = source.randrange(len(other) + 1)
    span = other[begin : begin + source.choice((4, 16, 300, 5000))]
    place = source.randrange(len(data) + 1)
    data[place : place + len(span)] = span


def _end(data: bytearray, source: random.Random, _: Sequence[bytes]) -> None:
    del data[source.randrange(len(data) + 1) :]


def _noise(data: bytearray, source: random.Random, _: Sequence[bytes]) -> None:
    place = source.randrange(len(data) + 1)
    data[place : place + source.choice((0, 8))] = source.randbytes(source.choice((1, 8, 100)))


def _word(data: bytearray, source: random.Random, _: Sequence[bytes]) -> None:
    place = source.randrange(len(data) + 1)
    word = source.choice(WORDS)
    data[place : place + source.choice((0, len(word)))] = word


_CHANGES = (_flip, _flip, _number, _number, _cut_out, _double, _overwrite, _end, _noise, _word)


def _lines(source: random.Random) -> bytes:
    return b"".join(
        b"".join(source.choice(WORDS) for _ in range(source.randrange(14)))
        + source.choice((b"\n", b"\r\n", b""))
        for _ in range(source.randrange(12))
    )


# --- the command


def main() -> None:
    """Run inputs through the readers, each reader in processes of its own."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--reader", choices=sorted(EXTENSIONS), action="append")
    parser.add_argument("--count", type=int, default=1000, help="inputs for each reader")
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--keep", type=Path, help="folder for inputs that are findings")
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    readers = arguments.reader or sorted(EXTENSIONS)
    keep = arguments.keep or Path(tempfile.mkdtemp(prefix="tpc-fuzz-"))
    keep.mkdir(parents=True, exist_ok=True)
    if arguments.child:
        _child(readers[0], range(arguments.first, arguments.first + arguments.count), keep)
        return
    failed = False
    for reader in readers:
        for first in range(arguments.first, arguments.first + arguments.count, 20_000):
            count = min(20_000, arguments.first + arguments.count - first)
            command = [sys.executable, "-m", "fuzz.readers", "--child", "--reader", reader]
            command += ["--first", str(first), "--count", str(count), "--keep", str(keep)]
            status = subprocess.run(command, check=False).returncode
            if status:
                failed = True
                what = f"status {status}" if status < 0 or status > 1 else "findings"
                print(f"{reader}: {what} among {first} to {first + count - 1}: {keep}", flush=True)
    raise SystemExit(failed)


def _child(reader: str, numbers: range, keep: Path) -> None:
    began = time.monotonic()
    tally = Tally()
    for start in range(numbers.start, numbers.stop, 200):
        # What hangs in C code, where no signal's handler runs, ends here with a traceback.
        faulthandler.dump_traceback_later(200 * SECONDS + _HANG_S, exit=True)
        part = run(reader, range(start, min(start + 200, numbers.stop)), keep)
        tally.read += part.read
        tally.refused += part.refused
        tally.events += part.events
        tally.findings += part.findings
        tally.reasons += part.reasons
    faulthandler.cancel_dump_traceback_later()
    for finding in tally.findings[:20]:
        print(finding, flush=True)
    print(
        f"{reader}: {tally.inputs:,} inputs from {numbers.start:,}, {tally.read:,} read"
        f" ({tally.events:,} events), {tally.refused:,} refused, {len(tally.findings)} findings,"
        f" {time.monotonic() - began:.0f} s, {_peak_mb():.0f} MB",
        flush=True,
    )
    raise SystemExit(bool(tally.findings))


if __name__ == "__main__":
    main()
