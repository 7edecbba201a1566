"""A full disk: one line, and what was written before can still be read."""

from __future__ import annotations

import errno
import struct
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from mission_samples import ns
from rosbags.highlevel import AnyReader

from pytpc.base.errors import RunError
from pytpc.cli.main import main
from pytpc.ros import kept_file
from pytpc.ros.ros1.bag_file import BagFile
from pytpc.ros.ros2.mcap_file import McapFile
from pytpc.ros.source import Source

EXAMPLE = str(Path(__file__).parents[2] / "examples/recorded_mission")
STATIC = ("--static", f"{EXAMPLE}/static.json")
CHAT = Source("/chat", "/n", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n")


def chat(text: str) -> bytes:
    return struct.pack("<I", len(text)) + text.encode()


def texts_in(path: Path) -> list[str]:
    with AnyReader([path]) as reader:
        return [
            reader.deserialize(data, connection.msgtype).data
            for connection, _, data in reader.messages()
        ]


class FullDisk:
    """Stands in the way of a stream: behind ``room`` bytes, all writing fails."""

    def __init__(self, stream, room: int) -> None:
        self._stream = stream
        self._room = room

    def write(self, data: bytes) -> int:
        if len(data) > self._room:
            # As the kernel does it: the beginning is written.
            self._stream.write(data[: self._room])
            self._room = 0
            raise OSError(errno.ENOSPC, "No space left on device")
        self._room -= len(data)
        return int(self._stream.write(data))

    def __getattr__(self, name: str):
        return getattr(self._stream, name)


@pytest.mark.parametrize("room", [0, 10, 60, 110, 200])
def test_the_bag_of_a_full_disk_is_closed(tmp_path: Path, monkeypatch, room: int) -> None:
    """Wherever it breaks off within the third chunk, the first two can be read."""
    monkeypatch.setattr(kept_file, "KEEP_S", -1.0)
    path = tmp_path / "a.bag"
    bag = BagFile(path)
    for text in ("one", "two"):
        bag.write(CHAT, ns(1.5), chat(text))
    bag._writer.bio = FullDisk(bag._writer.bio, room)
    with pytest.raises(RunError) as found:
        for text in ("three", "four"):
            bag.write(CHAT, ns(2.5), chat(text))
    assert str(found.value) == (
        f"{path}: the recording ended: No space left on device; the bag is closed and has all but"
        f" the last 1 messages; make room before you record again"
    )
    whole = ["one", "two", "three"] if room == 200 else ["one", "two"]
    assert texts_in(path) == whole
    assert bag.messages == {"/chat": len(whole)}
    assert [one.name for one in tmp_path.iterdir()] == ["a.bag"]
    # Whoever goes on gets the same line again.
    with pytest.raises(RunError, match="the bag is closed"):
        bag.write(CHAT, ns(3.5), chat("late"))
    with pytest.raises(RunError, match="the bag is closed"):
        bag.close()
    assert texts_in(path) == whole


@pytest.mark.parametrize("kind", [BagFile, McapFile])
def test_without_room_for_the_index_nothing_begins(tmp_path: Path, monkeypatch, kind) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(kept_file.os, "posix_fallocate", full)
    with pytest.raises(OSError, match="No space left"):
        kind(tmp_path / "a")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "words",
    [
        ("--help",),
        ("rank", "--help"),
        ("rank", EXAMPLE, *STATIC),
        ("rank", EXAMPLE, *STATIC, "--json"),
        ("suggest", EXAMPLE, *STATIC, "--json"),
        ("marks", EXAMPLE, "--json"),
        ("watch", "--once", EXAMPLE, *STATIC, "--json"),
        ("list", f"{EXAMPLE}/static.json", "--json"),
    ],
    ids=" ".join,
)
def test_output_that_nobody_can_write(words: tuple[str, ...]) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "pytpc", *words],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            timeout=120,
        )
    lines = [line for line in done.stderr.splitlines() if "warning" not in line]
    assert lines == ["pytpc: error: the output cannot be written: No space left on device"]
    assert done.returncode == 1


@pytest.fixture
def full_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """No file can be put onto the disk."""

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("pytpc.base.atomic.os.fsync", full)


@pytest.mark.usefixtures("full_disk")
@pytest.mark.parametrize(
    ("words", "left"),
    [
        (("convert", EXAMPLE, "-o", "out"), []),
        (("report", EXAMPLE, *STATIC, "-o", "out/page.html"), []),
        (("marks", "own.csv", "--add", "0", "II"), ["own.csv"]),
        (("apply", "p.yaml", "limit", "0.25"), ["p.yaml"]),
    ],
    ids=lambda one: one[0] if one else "",
)
def test_files_that_nobody_can_write(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], left: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    texts = {"own.csv": "time_ns,type,observer,note\n1,I,,\n", "p.yaml": "limit: 0.5\n"}
    for name in left:
        Path(name).write_text(texts[name])
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 1
    (line,) = [line for line in done.stderr.splitlines() if "error" in line]
    assert "No space left on device" in line
    for name in left:
        assert Path(name).read_text() == texts[name]
    files = [path for path in tmp_path.rglob("*") if path.is_file() and path.name != ".lock"]
    assert files == [tmp_path / name for name in left]
