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


def test_a_file_that_is_cut_off_is_an_error_of_one_line(tmp_path: Path) -> None:
    path = tmp_path / "cut.mcap"
    written(path).close()
    path.write_bytes(path.read_bytes()[:-40])
    with pytest.raises(InputError, match="truncated or damaged") as caught:
        read(path)
    assert "\n" not in str(caught.value)


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
