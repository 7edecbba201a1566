"""The MCAP file that a recording of ROS 2 is: read back by rosbags."""

from __future__ import annotations

from pathlib import Path

import pytest
from ros2_bags import STORE
from rosbags.rosbag2.storage_mcap import McapReader

from pytpc.base.errors import InputError, RunError
from pytpc.ingest.reading import read
from pytpc.ros.ros2.mcap_file import McapFile
from pytpc.ros.source import Source

TEXT = "std_msgs/msg/String"
STRING = Source("/threshold_information", "", TEXT, "", "string data\n")
TIME = Source("/mark_action", "", "builtin_interfaces/msg/Time", "", "int32 sec\nuint32 nanosec\n")
# 8 bytes of magic, and 9 + 4 + 4 + 4 + 5 of a record with two texts.
HEADER = 34
KEY = "00000001-0000-5000-8000-000000000000"
BATCH = (
    "#seq:{seq},count:1,dropped:0,pid:7,steady:1.0,node:/robot1/guard\n"
    "{t}.5,%s,1,cmp:2,thresh:1,res:1"
)


def text(data: str) -> bytes:
    return bytes(STORE.serialize_cdr(STORE.types[TEXT](data=data), TEXT))


def written(path: Path, count: int = 3) -> McapFile:
    file = McapFile(path)
    for number in range(count):
        file.write(
            STRING, (10 + number) * 10**9, text((BATCH % KEY).format(seq=number, t=10 + number))
        )
    kind = TIME.type
    mark = STORE.types[kind](sec=11, nanosec=5)
    file.write(TIME, 11 * 10**9, bytes(STORE.serialize_cdr(mark, kind)))
    return file


def test_what_was_written_is_read(tmp_path: Path) -> None:
    path = tmp_path / "mission.mcap"
    file = written(path)
    assert not path.exists()
    file.close()
    assert sorted(one.name for one in tmp_path.iterdir()) == ["mission.mcap"]
    recording = read(path)
    assert recording.events.time_ns.tolist() == [10_500_000_000, 11_500_000_000, 12_500_000_000]
    assert recording.events.nodes == ("/robot1/guard",)
    assert [(mark.type, mark.time_ns) for mark in recording.marks] == [("I", 11_000_000_005)]
    assert dict(file.messages) == {"/threshold_information": 3, "/mark_action": 1}
    reader = McapReader(path)
    reader.open()
    try:
        assert {one.topic: one.msgcount for one in reader.connections} == dict(file.messages)
    finally:
        reader.close()


def test_a_number_that_is_missing_is_a_loss_of_the_node_that_the_batch_names(
    tmp_path: Path,
) -> None:
    file = written(tmp_path / "a.mcap", 2)
    # After 0 and 1 comes 4: 2 and 3 are lost.
    file.write(STRING, 20 * 10**9, text((BATCH % KEY).format(seq=4, t=20)))
    file.close()
    assert read(tmp_path / "a.mcap").lost == {"/robot1/guard": 2}


def events_of_a_cut(path: Path) -> int | str:
    """The number of events that are read, or the error."""
    try:
        recording = read(path)
    except InputError as error:
        return str(error)
    assert any("has no end" in note for note in recording.notes)
    return len(recording.events)


def grown(folder: Path) -> bytes:
    """The bytes of a file that is not closed: the mark has closed a chunk of 3 reports."""
    file = written(folder / "a.mcap")
    data = (folder / "a.mcap.active").read_bytes()
    file.close()
    (folder / "a.mcap").unlink()
    return data


def test_a_file_that_is_cut_off_has_its_whole_records(tmp_path: Path) -> None:
    data = grown(tmp_path)
    # The index of the chunk follows it: 2 records of 9 + 6 bytes, and 16 for each message.
    index = 2 * 15 + 4 * 16
    path = tmp_path / "mission.mcap.active"
    found = []
    sizes = (8, HEADER - 1, HEADER, len(data) - index - 1, len(data) - index, len(data))
    for size in sizes:
        path.write_bytes(data[:size])
        found.append(events_of_a_cut(path))
    assert all("it ends at its beginning" in str(one) for one in found[:2])
    assert found[2:] == [0, 0, 3, 3]


def test_a_folder_with_a_file_that_is_cut_off_is_a_mission(tmp_path: Path) -> None:
    (tmp_path / "mission.mcap.active").write_bytes(grown(tmp_path))
    assert events_of_a_cut(tmp_path) == 3


def test_messages_need_not_be_in_order(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap.active"
    data = grown(tmp_path)
    path.write_bytes(data + data[HEADER:])
    # The first 3 reports come again behind the mark.
    assert events_of_a_cut(path) == 6


def test_a_chunk_that_was_not_written_ends_the_file(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap.active"
    data = grown(tmp_path)
    # A file system may keep the length of what it had no time to write.
    path.write_bytes(data + data[HEADER:120] + bytes(len(data) - 120))
    assert events_of_a_cut(path) == 3


def test_on_a_full_disk_the_file_has_the_whole_chunks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "mission.mcap"
    # The mark closes a chunk of 3 messages and itself.
    file = written(path)
    put = McapFile._put

    def full(self: McapFile, data: bytes) -> None:
        monkeypatch.setattr(McapFile, "_put", put)
        self._stream.write(data[:10])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(McapFile, "_put", full)
    file.write(STRING, 20 * 10**9, text((BATCH % KEY).format(seq=3, t=20)))
    with pytest.raises(RunError, match="all but the last 1 messages"):
        file.close()
    assert len(read(path).events) == 3
    assert dict(file.messages) == {"/threshold_information": 3, "/mark_action": 1}


def test_there_is_room_for_the_index_of_a_long_recording(tmp_path: Path) -> None:
    file = McapFile(tmp_path / "a.mcap")
    kind = TIME.type
    mark = bytes(STORE.serialize_cdr(STORE.types[kind](sec=11, nanosec=5), kind))
    for _ in range(4000):
        file.write(TIME, 11 * 10**9, mark)
    # Each mark closes a chunk, and its entry has 9 + 16 + 16 + 4 + 10 + 8 + 4 + 16 bytes.
    room = (tmp_path / ".a.mcap.reserve").stat().st_size
    file.close()
    assert room > 4000 * 83
