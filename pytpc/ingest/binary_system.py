"""The contents of a binary file besides reports: sites, clocks, summaries, dropped reports."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from pytpc.base.columns import Bools, Int32s
from pytpc.ingest.binary_chunks import KEPT, RECORD, SLOT
from pytpc.ingest.binary_clock import Clock
from pytpc.ingest.gathering import SUMMARY_ROW, Gathering
from pytpc.ingest.rosout_line import Malformed, Named, as_text, parse_name
from pytpc.ingest.spool import Rows
from pytpc.python_runtime import log_layout as layout
from pytpc.recording.mission import Dropped

_MOST_SITES = 1 << 22
_LONGEST_KEY = 1 << 12
_LARGEST_COUNT = 2**62
_HEAD = 16
_NOT_PRINTED = re.compile(r"[\x00-\x1f\x7f]")
_REASONS = {number: name for name, number in layout.REASONS.items()}
_AS_THEY_ARE = ("cmp", "thresh", "diff_min", "diff_max", "low", "high")
_COUNTS = ("count", "flops", "far", "odd")

Chunk = npt.NDArray[np.uint8]
Skip = Callable[[str], None]


@dataclass
class SystemRecords:
    """The contents of the system's chunks except summaries; times are of the steady clock."""

    keys: dict[int, str] = field(default_factory=dict)
    syncs: list[tuple[int, int]] = field(default_factory=list)
    drops: list[tuple[int, int, int, int]] = field(default_factory=list)
    names: list[Named] = field(default_factory=list)
    torn: int = 0

    def key_codes(self, gathering: Gathering) -> Int32s:
        """int32[largest site + 2]: the code of each site's key, -1 where there is none."""
        codes = np.full(max(self.keys, default=0) + 2, -1, np.int32)
        for site, key in self.keys.items():
            codes[site] = gathering.keys.code(key)
        return codes

    def dropped(self, node: str) -> Iterator[Dropped]:
        """One record for each kind of dropped reports."""
        for site, reason, count, flops in self.drops:
            why = _REASONS.get(reason, "unknown")
            yield Dropped(self.keys.get(site, ""), node, count, min(flops, count), why)


def read_system(chunk: Chunk, place: int, system: SystemRecords, skip: Skip) -> None:
    """Read a chunk of system records, except the summaries, into ``system``.

    Args:
        chunk: uint8[n]: its bytes, in whole records; n is 65536 but where the file ends.
        place: its first byte in the file, for messages.
        system: what is known so far.
        skip: is told what is wrong with a record that is left out, with its byte.
    """
    data = chunk.tobytes()
    if len(data) <= layout.CHUNK_HEADER_BYTES:
        return
    records = np.frombuffer(data, RECORD, -1, layout.CHUNK_HEADER_BYTES)
    end = layout.CHUNK_HEADER_BYTES
    for kind, begin, end in _records(data, place, skip):  # noqa: B007
        record = records[(begin - layout.CHUNK_HEADER_BYTES) // layout.RECORD_BYTES]
        site = int(record["site"])
        if kind == layout.SITE:
            length = int(record["steady"]) & 0xFFFFFFFF
            text = data[begin + _HEAD : begin + _HEAD + length]
            wrong = _site(system, site, text)
            if wrong is not None:
                skip(f"{wrong} at byte {place + begin}")
        elif kind == layout.NAME:
            length = int(record["steady"]) & 0xFFFFFFFF
            found = parse_name(as_text(data[begin + _HEAD : begin + _HEAD + length]))
            if isinstance(found, Malformed):
                skip(f"{found.what} at byte {place + begin}")
            else:
                system.names.append(found)
        elif kind == layout.SYNC:
            real = int.from_bytes(data[begin + 16 : begin + 24], "little", signed=True)
            system.syncs.append((int(record["steady"]), real))
        elif kind == layout.DROPPED:
            count, flops = np.frombuffer(data, "<u8", 2, begin + 16).tolist()
            if count >= _LARGEST_COUNT:
                skip(f"a count of {count} dropped reports at byte {place + begin}")
            else:
                system.drops.append((site, int(record["what"]) >> 16 & 0xFF, count, flops))
        elif kind not in {layout.SUMMARY, layout.POLICY}:
            skip(f"a record of the unknown kind {kind} at byte {place + begin}")
    system.torn += any(data[end : end + layout.RECORD_BYTES])


def written_summaries(chunk: Chunk) -> Rows:
    """The summaries of a chunk of system records, as ``KEPT``."""
    data = chunk.tobytes()
    runs = [
        np.frombuffer(data, KEPT, (end - begin) // KEPT.itemsize, begin)
        for kind, begin, end in _records(data, 0, lambda _: None)
        if kind == layout.SUMMARY
    ]
    return np.concatenate([np.empty(0, KEPT), *runs])


def open_summaries(chunk: Chunk) -> tuple[Rows, int]:
    """The periods of a live chunk, as ``KEPT``, and how many of them are half counted."""
    count = max(0, (chunk.size - layout.CHUNK_HEADER_BYTES) // layout.SLOT_BYTES)
    data = chunk.tobytes().ljust(layout.CHUNK_HEADER_BYTES, b"\0")
    slots = np.frombuffer(data, SLOT, count, layout.CHUNK_HEADER_BYTES)
    used = slots[slots["kept"]["count"] != 0]
    return used["kept"].copy(), int(np.count_nonzero(used["begun"] != used["kept"]["count"]))


def summary_rows(kept: Rows, key_of_site: Int32s, clock: Clock, last_ns: int, skip: Skip) -> Rows:
    """Rows of ``SUMMARY_ROW``, but for node and channel, for the summaries ``kept``.

    Args:
        kept: of type ``KEPT``.
        key_of_site: int32[n]: the code of each site's key, -1 where there is none.
        clock: gives the times of summaries that have no ROS time of their own.
        last_ns: the end of periods that are open.
        skip: is told what is wrong with a summary that is left out.
    """
    kept = kept[_sound(kept, key_of_site.size, skip)]
    keys = key_of_site[kept["site"]]
    for site in kept["site"][keys < 0].tolist():
        skip(f"a summary of the unknown site {site}")
    kept, keys = kept[keys >= 0], keys[keys >= 0]
    rows = np.zeros(kept.size, SUMMARY_ROW)
    for name in (*_AS_THEY_ARE, *_COUNTS):
        rows[name] = kept[name]
    begin, end = kept["begin_ros"], kept["end_ros"]
    rows["begin_ns"] = np.where(begin != 0, begin, clock.real(kept["begin_steady"]))
    real_end = np.where(kept["end_steady"] != 0, clock.real(kept["end_steady"]), last_ns)
    rows["end_ns"] = np.maximum(rows["begin_ns"], np.where(end != 0, end, real_end))
    finite = (kept["count"] - kept["odd"]).astype(np.float64)
    finite[finite == 0] = np.nan
    with np.errstate(all="ignore"):
        rows["diff_mean"] = kept["diff_sum"] / finite
        rows["abs_mean"] = kept["abs_sum"] / finite
    for name in ("diff_min", "diff_max", "low", "high"):
        rows[name][np.isnan(finite)] = np.nan
    rows["key"] = keys
    rows["result"] = (kept["what"] & 0x100) != 0
    rows["res"] = (kept["what"] & 0x200) != 0
    return rows


def _sound(kept: Rows, sites: int, skip: Skip) -> Bools:
    """Whether the counts of each summary are consistent and its site is valid."""
    count = kept["count"]
    parts = np.maximum(np.maximum(kept["odd"], kept["far"]), kept["flops"])
    sound: Bools = (count > 0) & (count < _LARGEST_COUNT) & (parts <= count)
    for _ in range(int(np.count_nonzero(~sound))):
        skip("a summary whose counts contradict one another")
    for site in kept["site"][sound & (kept["site"] >= sites)].tolist():
        skip(f"a summary of the unknown site {site}")
    return sound & (kept["site"] < sites)


def _records(data: bytes, place: int, skip: Skip) -> Iterator[tuple[int, int, int]]:
    """Kind, first byte in the chunk, and the byte behind it of each record, until one is empty.

    Summaries that follow one another are given as one: under ``edges`` nearly all records are.
    """
    begin = layout.CHUNK_HEADER_BYTES
    while begin < len(data) and any(data[begin : begin + 4]):
        kind = data[begin]
        length = layout.RECORD_BYTES
        if kind in {layout.SITE, layout.NAME}:
            key_length = int.from_bytes(data[begin + 8 : begin + 12], "little")
            length *= 1 + max(0, -(-(key_length - _HEAD) // layout.RECORD_BYTES))
            if key_length > _LONGEST_KEY:
                skip(f"a text of {key_length} bytes at byte {place + begin}")
                return
        elif kind == layout.SUMMARY:
            length = KEPT.itemsize
        if begin + length > len(data):
            skip(f"a record is cut off at byte {place + begin}")
            return
        if kind == layout.SUMMARY:
            kinds = np.frombuffer(data, np.uint8, -1, begin)[:: KEPT.itemsize]
            other = np.flatnonzero(kinds != layout.SUMMARY)
            # The last one may be cut off.
            count = int(other[0]) if other.size else (len(data) - begin) // length
            length *= min(count, (len(data) - begin) // length)
        yield kind, begin, begin + length
        begin += length


def _site(system: SystemRecords, number: int, text: bytes) -> str | None:
    """Read the name of a site; return what is wrong with it, if anything."""
    try:
        key = text.decode("utf-8")
    except UnicodeDecodeError:
        return f"the key of site {number} is not UTF-8"
    if not key or _NOT_PRINTED.search(key):
        return f"the key of site {number} has no or odd characters"
    if not 0 < number < _MOST_SITES:
        return f"a site has the number {number}"
    key = key.lower()
    if system.keys.setdefault(number, key) != key:
        return f"site {number} has a second key"
    return None
