"""Writes .mcap and .db3 files with real messages of ROS 2."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mission_samples import SECOND, ns
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
LOG = "rcl_interfaces/msg/Log"


def ros2_time(seconds: float) -> Any:
    """A builtin_interfaces/Time."""
    stamp = ns(seconds)
    return STORE.types["builtin_interfaces/msg/Time"](sec=stamp // SECOND, nanosec=stamp % SECOND)


def _log(seconds: float, node: str, text: str) -> Any:
    return STORE.types[LOG](
        stamp=ros2_time(seconds),
        level=20,
        name=node,
        msg=text,
        file="node.cpp",
        function="step",
        line=7,
    )


def log_bytes(seconds: float, node: str, text: str) -> bytes:
    """A message of /rosout."""
    return bytes(STORE.serialize_cdr(_log(seconds, node, text), LOG))


class Ros2Bag:
    """A folder with one storage file; ``file`` is that."""

    def __init__(self, folder: Path, kind: str) -> None:
        plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
        self.writer = Writer(folder, version=9, storage_plugin=plugin)
        self.file = folder / f"{folder.name}.{kind}"
        self.connections: dict[tuple[str, str], Any] = {}

    def __enter__(self) -> Ros2Bag:
        self.writer.open()
        return self

    def __exit__(self, *error: object) -> None:
        self.writer.close()

    def _write(self, topic: str, kind: str, seconds: float, message: Any) -> None:
        place = (topic, kind)
        if place not in self.connections:
            self.connections[place] = self.writer.add_connection(topic, kind, typestore=STORE)
        raw = STORE.serialize_cdr(message, kind)
        self.writer.write(self.connections[place], ns(seconds), raw)

    def log(self, seconds: float, node: str, text: str, topic: str = "/rosout") -> None:
        self._write(topic, LOG, seconds, _log(seconds, node, text))

    def text(self, seconds: float, topic: str, text: str) -> None:
        message = STORE.types["std_msgs/msg/String"](data=text)
        self._write(topic, "std_msgs/msg/String", seconds, message)

    def mark(self, seconds: float, topic: str, marked: float) -> None:
        self._write(topic, "builtin_interfaces/msg/Time", seconds, ros2_time(marked))
