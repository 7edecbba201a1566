"""Writes .mcap and .db3 files with real messages of ROS 2."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mission_samples import SECOND, ns
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)


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

    @staticmethod
    def time(seconds: float) -> Any:
        stamp = ns(seconds)
        return STORE.types["builtin_interfaces/msg/Time"](
            sec=stamp // SECOND, nanosec=stamp % SECOND
        )

    def log(self, seconds: float, node: str, text: str, topic: str = "/rosout") -> None:
        message = STORE.types["rcl_interfaces/msg/Log"](
            stamp=self.time(seconds),
            level=20,
            name=node,
            msg=text,
            file="node.cpp",
            function="step",
            line=7,
        )
        self._write(topic, "rcl_interfaces/msg/Log", seconds, message)

    def text(self, seconds: float, topic: str, text: str) -> None:
        message = STORE.types["std_msgs/msg/String"](data=text)
        self._write(topic, "std_msgs/msg/String", seconds, message)

    def mark(self, seconds: float, topic: str, marked: float) -> None:
        self._write(topic, "builtin_interfaces/msg/Time", seconds, self.time(marked))
