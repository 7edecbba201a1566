"""runtime_log/Layout.h and the Python side have the same layout of the binary file."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from pytpc.ingest.binary_chunks import CHUNK, KEPT, RECORD, SLOT
from pytpc.python_runtime import log_layout, sinks

HEADER = (Path(__file__).parents[2] / "runtime_log/Layout.h").read_text()
SIZES = {"uint32_t": 4, "uint64_t": 8, "int64_t": 8, "double": 8, "char": 1}


def number_of(name: str) -> int:
    found = re.search(rf"constexpr uint32_t {name} =\s*(\d+)U?(?: << (\d+))?;", HEADER)
    assert found, name
    return int(found[1]) << int(found[2] or 0)


def enumerators(name: str) -> dict[str, int]:
    body = re.search(rf"enum {name} : uint32_t {{(.*?)}};", HEADER, re.DOTALL)[1]
    return {word: int(number) for word, number in re.findall(r"(\w+) = (\d+)", body)}


def places_of(name: str) -> dict[str, int]:
    """Name of each member -> its byte; "" -> the size. No padding: sizes are multiples of 4."""
    body = re.search(rf"struct {name} {{(.*?)\n}};", HEADER, re.DOTALL)[1]
    body = re.sub(r"union {\s*([^;]*;).*?};", r"\1", re.sub(r"//.*", "", body), flags=re.DOTALL)
    places, at = {}, 0
    for kind, members in re.findall(r"(\w+) ([^;]+);", body):
        for member in members.split(","):
            word, _, count = member.strip().rstrip("]").partition("[")
            size = SIZES[kind] if kind in SIZES else places_of(kind)[""]
            assert at % min(size, 8) == 0
            places[word] = at
            at += size * int(count or 1)
    return {**places, "": at}


def offsets(record: np.dtype) -> list[int]:
    return [record.fields[name][1] for name in record.names] + [record.itemsize]


@pytest.mark.parametrize(
    ("theirs", "ours"),
    [
        ("HeaderBytes", log_layout.HEADER_BYTES),
        ("RecordBytes", log_layout.RECORD_BYTES),
        ("ChunkBytes", log_layout.CHUNK_BYTES),
        ("ChunkHeaderBytes", log_layout.CHUNK_HEADER_BYTES),
        ("ResultBit", log_layout.RESULT_BIT),
        ("OutcomeBit", log_layout.OUTCOME_BIT),
        ("EdgeBit", log_layout.EDGE_BIT),
    ],
)
def test_the_numbers(theirs, ours):
    assert number_of(theirs) == ours


def test_the_kinds_of_records_and_chunks():
    assert enumerators("Kind") == {
        f"{name.title()}Record": getattr(log_layout, name)
        for name in ("REPORT", "SITE", "SYNC", "SIMULATED", "SUMMARY", "DROPPED", "POLICY", "NAME")
    }
    chunks = [log_layout.THREAD_CHUNK, log_layout.SYSTEM_CHUNK, log_layout.LIVE_CHUNK]
    assert enumerators("ChunkKind") == dict(zip(("Reports", "System", "Live"), chunks, strict=True))
    states = [log_layout.OPEN, log_layout.CLOSED, log_layout.STOPPED]
    assert enumerators("State") == dict(zip(("Open", "Closed", "Stopped"), states, strict=True))


def test_the_header():
    places = places_of("Header")
    assert (places["State"], places["NotRecorded"]) == (log_layout.STATE_AT, log_layout.LOST_AT)
    assert places["Node"] == log_layout.NODE_AT
    assert places["Host"] - places["Node"] == log_layout.NODE_BYTES
    assert places[""] == log_layout.HEADER.size


def test_the_records():
    places = list(places_of("Record").values())
    # The two numbers of a report are one member of the union.
    assert offsets(RECORD) == [*places[:-1], places[-2] + 8, places[-1]]
    summary = places_of("Summary")
    assert offsets(KEPT) == list(summary.values())
    # What a summary is, its first four bytes, is written last.
    assert summary["Site"] + sinks._SUMMARY.size == summary[""]
    assert summary["Count"] == sinks._COUNT_AT


def test_the_chunks():
    chunk = places_of("ChunkHeader")
    assert offsets(CHUNK) == list(chunk.values())[:-1]
    assert chunk[""] == log_layout.CHUNK_HEADER_BYTES
    slot = places_of("Slot")
    assert offsets(SLOT) == list(slot.values())
    assert (slot["Begun"], slot[""]) == (sinks._BEGUN_AT, log_layout.SLOT_BYTES)
