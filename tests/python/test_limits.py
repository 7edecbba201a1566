"""Small files that would take minutes or gigabytes: one line, in little memory.

Memory is the peak of a process of its own, from ``wait4``. A small one starts it: at its start a
process has the peak of the one that it comes from, and that of the tests may be large.
"""

from __future__ import annotations

import bz2
import json
import os
import sqlite3
import struct
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import lz4.frame
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from launch_samples import needs_roslaunch

from pytpc.base.errors import InputError
from pytpc.ingest import unpacking
from pytpc.ingest.unpacking import Unpacker, UnpackingError
from pytpc.recording.events import Events
from pytpc.recording.mission import load_recording
from pytpc.values.yaml_tree import read_yaml

EXAMPLE = Path(__file__).parents[2] / "examples/recorded_mission"
STATIC = ("--static", str(EXAMPLE / "static.json"))
MOST_KB = 1 << 20


MEASURE = """
import os, subprocess, sys
process = subprocess.Popen([sys.executable, "-m", "pytpc", *sys.argv[1:]])
_, status, used = os.wait4(process.pid, 0)
print(used.ru_maxrss)
sys.exit(os.waitstatus_to_exitcode(status))
"""


def run(folder: Path, words: Sequence[str]) -> tuple[int, str]:
    """Run pytpc; it may need no more than 1 GB."""
    done = subprocess.run(
        [sys.executable, "-c", MEASURE, *words],
        cwd=folder,
        env={**os.environ, "XDG_STATE_HOME": str(folder / "state")},
        capture_output=True,
        text=True,
        check=False,
    )
    said = done.stderr
    assert int(done.stdout.splitlines()[-1]) < MOST_KB, words
    lines = [line for line in said.splitlines() if line.startswith(("pytpc: error", "Traceback"))]
    assert len(lines) <= 1, said
    return done.returncode, lines[0] if lines else ""


# --- recordings


def field(name: str, value: bytes) -> bytes:
    whole = name.encode() + b"=" + value
    return struct.pack("<I", len(whole)) + whole


def record(fields: Sequence[tuple[str, bytes]], data: bytes) -> bytes:
    head = b"".join(field(*one) for one in fields)
    return struct.pack("<I", len(head)) + head + struct.pack("<I", len(data)) + data


def u32(number: int) -> bytes:
    return struct.pack("<I", number)


def bag_of(compression: bytes, size: int, packed: bytes, chunks: int = 1) -> bytes:
    """A ROS 1 bag of chunks that say that they unpack to ``size`` bytes."""

    def head(index: int) -> bytes:
        numbers = [("index_pos", struct.pack("<Q", index)), ("conn_count", u32(1))]
        return record([("op", b"\3"), *numbers, ("chunk_count", u32(chunks))], b" " * 4027)

    chunk = record([("op", b"\5"), ("compression", compression), ("size", u32(size))], packed)
    first = 13 + len(head(0))
    known = [("topic", b"/rosout"), ("type", b"rosgraph_msgs/Log"), ("md5sum", b"x" * 32)]
    connection = record(
        [("op", b"\7"), ("conn", u32(0)), ("topic", b"/rosout")],
        b"".join(field(*one) for one in [*known, ("message_definition", b"d")]),
    )
    infos = b"".join(
        record(
            [
                *[("op", b"\6"), ("ver", u32(1))],
                ("chunk_pos", struct.pack("<Q", first + number * len(chunk))),
                *[("start_time", bytes(8)), ("end_time", bytes(8)), ("count", u32(1))],
            ],
            u32(0) + u32(1),
        )
        for number in range(chunks)
    )
    index = first + chunks * len(chunk)
    return b"#ROSBAG V2.0\n" + head(index) + chunk * chunks + connection + infos


def zeros_bz2(folder: Path) -> str:
    packed = bz2.compress(bytes(1 << 28), 9)
    assert len(packed) < 5000
    (folder / "a.bag").write_bytes(bag_of(b"bz2", 1 << 28, packed))
    return "a.bag"


def empty_records(folder: Path) -> str:
    """30 MB of zeros are millions of records without a header."""
    packed = bz2.compress(bytes(30 << 20), 9)
    (folder / "a.bag").write_bytes(bag_of(b"bz2", 30 << 20, packed))
    return "a.bag"


def zeros_lz4(folder: Path) -> str:
    size = (1 << 29) + 1
    packed = lz4.frame.compress(bytes(size))
    (folder / "a.bag").write_bytes(bag_of(b"lz4", size, packed))
    return "a.bag"


def many_chunks(folder: Path) -> str:
    """No chunk is too large, all of them are: 20 of 30 MB, each with one message of that size."""
    head = b"".join([field("op", b"\2"), field("conn", u32(0)), field("time", bytes(8))])
    length = (30 << 20) - len(head) - 8
    message = u32(len(head)) + head + u32(length) + bytes(length)
    packed = bz2.compress(message, 9)
    (folder / "a.bag").write_bytes(bag_of(b"bz2", 30 << 20, packed, 20))
    return "a.bag"


def large_blob(folder: Path) -> str:
    connection = sqlite3.connect(folder / "a.db3")
    connection.executescript(
        "create table topics(id integer primary key, name text, type text,"
        " serialization_format text, offered_qos_profiles text);"
        "create table messages(id integer primary key, topic_id integer, timestamp integer,"
        " data blob);"
        "insert into topics values(1, '/rosout', 'rcl_interfaces/msg/Log', 'cdr', '');"
        "insert into messages values(1, 1, 1, zeroblob(100000000));"
    )
    connection.close()
    return "a.db3"


def events_of(folder: Path, table: pa.Table, rows: int) -> str:
    """A converted recording with this table."""
    document = json.loads((EXAMPLE / "marks.json").read_text())
    (folder / "m").mkdir()
    (folder / "m/marks.json").write_text(json.dumps({**document, "events": rows, "summaries": 0}))
    pq.write_table(table, folder / "m/events.parquet", compression="zstd")
    return "m"


def table_of(keys: pa.Array, codes: Sequence[int], **columns: object) -> pa.Table:
    rows = len(codes)
    found: dict[str, object] = {
        "key": pa.DictionaryArray.from_arrays(pa.array(codes, pa.int32()), keys, safe=False),
        "node": pa.DictionaryArray.from_arrays(pa.array([0] * rows, pa.int32()), ["/n"]),
        **columns,
    }
    arrays = [
        found[one.name]
        if one.name in found
        else pa.array(np.zeros(rows, one.type.to_pandas_dtype()), one.type)
        for one in Events.schema
    ]
    return pa.Table.from_arrays(arrays, schema=Events.schema)


def many_rows(folder: Path) -> str:
    """Five million rows in a hundred kilobytes."""
    rows = 5_000_000
    table = table_of(pa.array(["0123456789ab"]), np.zeros(rows, np.int32))  # type: ignore[arg-type]
    return events_of(folder, table, rows)


def long_word(folder: Path) -> str:
    return events_of(folder, table_of(pa.array(["x" * (40 << 20)]), [0]), 1)


def many_words(folder: Path) -> str:
    words = [f"{number:064x}" for number in range(1 << 20)]
    return events_of(folder, table_of(pa.array(words), range(1 << 20)), 1 << 20)  # type: ignore[arg-type]


def endless(folder: Path) -> str:
    (folder / "a.bag").symlink_to("/dev/zero")
    return "a.bag"


def pipe(folder: Path) -> str:
    os.mkfifo(folder / "a.bag")
    return "a.bag"


def circle(folder: Path) -> str:
    (folder / "a.bag").symlink_to("a.bag")
    return "a.bag"


def deep_marks(folder: Path) -> str:
    name = events_of(folder, table_of(pa.array(["k"]), [0]), 1)
    (folder / "m/marks.json").write_text("[" * 200_000)
    return name


def many_values(folder: Path) -> str:
    name = events_of(folder, table_of(pa.array(["k"]), [0]), 1)
    (folder / "m/marks.json").write_text("[" + "[]," * 5_000_000 + "[]]")
    return name


RECORDINGS: dict[Callable[[Path], str], str] = {
    zeros_bz2: " bytes that unpack to 268,435,456, more than 2000 times as much",
    zeros_lz4: "a.bag: damaged: a chunk of 536,870,913 bytes; at most 536,870,912 are read",
    empty_records: "a.bag: damaged: a chunk of too many records, or one without a kind",
    many_chunks: "more than 2000 times as much",
    large_blob: "a.db3: truncated or damaged (100,106,240 bytes): string or blob too big",
    many_rows: "m/events.parquet: not a file of events: 5,000,000 rows in ",
    long_word: "m/events.parquet: not a file of events: column key has 41,943,0",
    many_words: "m/events.parquet: not a file of events: column key has ",
    endless: "a.bag: is a device, not a file",
    pipe: "a.bag: is a named pipe, not a file",
    circle: "a.bag: is a symbolic link that leads to itself",
    deep_marks: "m/marks.json: not JSON that can be read: maximum recursion depth exceeded",
    many_values: "m/marks.json: has more than 4,194,304 values",
}
COMMANDS = {
    "rank": STATIC,
    "report": (*STATIC, "-o", "page.html"),
    "marks": (),
    "convert": ("-o", "converted"),
}


@pytest.mark.parametrize("make", RECORDINGS, ids=lambda make: make.__name__)
def test_recordings(tmp_path: Path, make: Callable[[Path], str]) -> None:
    """One command for each: all commands read by the same function."""
    name = make(tmp_path)
    command = list(COMMANDS)[list(RECORDINGS).index(make) % len(COMMANDS)]
    status, line = run(tmp_path, [command, name, *COMMANDS[command]])
    assert (status, RECORDINGS[make] in line) == (1, True), (command, line)


def test_chunks_within_the_limits() -> None:
    """A hundred bytes may become 32 MB; all chunks together may become 256 MB."""
    data = os.urandom(1000) + bytes(10_000)
    for name, packed in (
        ("bz2", bz2.compress(data)),
        ("lz4", lz4.frame.compress(data)),
        ("none", data),
    ):
        assert Unpacker().unpack(packed, name, len(data)) == data
        with pytest.raises(UnpackingError, match=f"a chunk of {len(data)} bytes, not "):
            Unpacker().unpack(data if name == "none" else packed, name, len(data) - 1)
    unpacker = Unpacker()
    zeros = bz2.compress(bytes(1 << 25))
    for _ in range(8):
        unpacker.unpack(zeros, "bz2", 1 << 25)
    with pytest.raises(UnpackingError, match="more than 2000 times"):
        unpacker.unpack(zeros, "bz2", 1 << 25)


def test_a_chunk_in_a_chunk(tmp_path: Path) -> None:
    """The index names the same bytes again and again, each time from another place."""
    inner = record([("op", b"\5"), ("compression", b"none"), ("size", u32(0))], b"")
    whole = bag_of(b"none", len(inner), inner, 2)
    second = whole.rindex(b"chunk_pos=") + 10
    place = whole.index(inner)
    path = tmp_path / "a.bag"
    path.write_bytes(whole[:second] + struct.pack("<Q", place) + whole[second + 8 :])
    status, line = run(tmp_path, ["convert", "a.bag", "-o", "out"])
    assert status == 1
    assert "begins within the one before it" in line


def test_a_message_that_is_too_large(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(unpacking, "_ANY_CHUNK", 0)
    with pytest.raises(UnpackingError, match="10 bytes that unpack to 20,001"):
        Unpacker().unpack(bytes(10), "lz4", 20_001)


# --- Parquet of strangers


@pytest.mark.parametrize(
    ("keys", "codes", "said"),
    [
        (["a"], [7], "out of bounds"),
        (["a"], [-1], "out of bounds"),
        ([None], [0], "a key or node without a name"),
        (["a", None], [0], "a key or node without a name"),
        (["a", "a"], [0, 1], "a key or node is named twice"),
    ],
)
def test_a_broken_dictionary(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, keys: list[str], codes: list[int], said: str
) -> None:
    """The file is read as a table that no writer makes."""
    name = events_of(tmp_path, table_of(pa.array(["a"]), [0] * len(codes)), len(codes))
    table = table_of(pa.array(keys, pa.string()), codes)
    monkeypatch.setattr("pytpc.base.columns.pq.ParquetFile.read", lambda _: table)
    with pytest.raises(InputError, match=said) as found:
        load_recording(tmp_path / name)
    assert "\n" not in str(found.value)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"marks": [{"time_ns": 2**63, "type": "I"}]}, "a mark at 9.22e+18 ns"),
        ({"marks": [{"time_ns": -(2**70), "type": "I"}]}, "a mark at -1.18e+21 ns"),
        ({"start_ns": 2**63}, "a time beyond 64 bits"),
        ({"malformed": 1, "malformed_first": [{"topic": 1}]}, "missing 3 required"),
        ({"malformed": 3, "malformed_first": []}, ""),
        ({"start_ns": -5, "end_ns": -1}, ""),
    ],
)
def test_marks_of_strangers(tmp_path: Path, change: dict[str, object], said: str) -> None:
    name = events_of(tmp_path, table_of(pa.array(["0123456789ab"]), [0]), 1)
    path = tmp_path / name / "marks.json"
    document = {**json.loads(path.read_text()), **change}
    for mark in document["marks"]:
        mark.setdefault("observer", "")
        mark.setdefault("note", "")
    path.write_text(json.dumps(document))
    status, line = run(tmp_path, ["convert", name, "-o", "out"])
    assert status == (1 if said else 0), line
    assert said in line


def test_a_note_of_three_megabytes(tmp_path: Path) -> None:
    name = events_of(tmp_path, table_of(pa.array(["0123456789ab"]), [0]), 1)
    path = tmp_path / name / "marks.json"
    document = json.loads(path.read_text())
    document["marks"][0]["note"] = "n" * 3_000_000
    path.write_text(json.dumps(document))
    (mark, *_) = load_recording(tmp_path / name).marks
    assert mark.note == "n" * 9_997 + "..."


# --- values


def laughs(form: str, name: str) -> str:
    """Ten levels of ten aliases each: ten billion values in a kilobyte."""
    below = {"list": "[x]", "map": "{k: 1}", "merge": "{k: 1}"}[form]
    lines = [f"a0: &a0 {below}"]
    for level in range(1, 11):
        names = [f"*a{level - 1}"] * 10
        text = {
            "list": f"[{', '.join(names)}]",
            "map": "{" + ", ".join(f"k{n}: {one}" for n, one in enumerate(names)) + "}",
            "merge": f"{{<<: [{', '.join(names)}]}}",
        }[form]
        lines.append(f"a{level}: &a{level} {text}")
    return "\n".join([*lines, f"{name}: 1"])


@pytest.mark.parametrize("form", ["list", "map", "merge"])
def test_aliases_that_multiply(tmp_path: Path, form: str) -> None:
    text = laughs(form, "limit")
    assert len(text) < 1500
    (tmp_path / "p.yaml").write_text(text)
    status, line = run(tmp_path, ["apply", "p.yaml", "limit", "2"])
    assert status == 1
    assert "more than 1,000,000 values, with aliases" in line


def test_aliases_of_a_robot() -> None:
    """A map of 100 values in 500 places is usual; that is 500 * 201 + ... values."""
    pairs = ", ".join(f"k{number}: {number}" for number in range(100))
    users = "\n".join(f"u{number}: {{<<: *base, own: 1}}" for number in range(500))
    (document,) = read_yaml(f"base: &base {{{pairs}}}\n{users}\n")
    assert len(document.pairs) == 501


@needs_roslaunch
def test_aliases_in_a_launch_file(tmp_path: Path) -> None:
    inner = laughs("map", "limit").replace("&", "&amp;")
    (tmp_path / "a.launch").write_text(f"<launch><rosparam>\n{inner}\n</rosparam></launch>")
    status, line = run(tmp_path, ["origin", "a.launch"])
    assert status == 1
    assert "YAML with more than 1,000,000 values" in line


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[" * 100_000, "p.yaml: not YAML: line 1: more than 200 levels"),
        ("limit: " + "9" * 1_000_000, "p.yaml:1: a number of 1,000,000 characters"),
        ("limit: " + ":".join(["59"] * 20_000), "p.yaml:1: a number of 59,999 characters"),
    ],
)
def test_yaml_of_strangers(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "p.yaml").write_text(text)
    assert run(tmp_path, ["apply", "p.yaml", "limit", "1"]) == (1, f"pytpc: error: {said}")


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (os.mkfifo, "is a named pipe, not a file"),
        (lambda path: path.symlink_to("/dev/zero"), "is a device, not a file"),
        (lambda path: path.mkdir(), "is a folder, not a file"),
        (lambda path: path.symlink_to(path.name), "is a symbolic link that leads to itself"),
    ],
    ids=["pipe", "device", "folder", "circle"],
)
def test_files_that_are_none(tmp_path: Path, make: Callable[[Path], None], said: str) -> None:
    make(tmp_path / "p.yaml")
    status, line = run(tmp_path, ["apply", "p.yaml", "limit", "1"])
    assert (status, line.endswith(said)) == (1, True), line


@pytest.mark.parametrize("text", ["[" * 200_000, '{"schema": ' + "9" * 100_000 + "}"])
def test_json_of_strangers(tmp_path: Path, text: str) -> None:
    for name in ("origins.json", "static.json"):
        (tmp_path / name).write_text(text)
    for words in (
        ["origin", "."],
        ["apply", ".", "/a", "1"],
        ["show", "a", "--static", "static.json"],
        ["list", "static.json"],
        ["rank", str(EXAMPLE), "--static", "static.json"],
    ):
        status, line = run(tmp_path, words)
        assert status in {1, 2}
        assert "Traceback" not in line
