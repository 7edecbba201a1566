"""Declarations that dynamic_reconfigure's servers published, in a ROS 1 bag.

A server says on NODE/parameter_descriptions (latched) which parameters there are and their ranges.
The layout is that of dynamic_reconfigure/ConfigDescription: little endian; a string and a list
begin with their length as uint32. rosbags would refuse a message for one byte that is not UTF-8.
"""

from __future__ import annotations

import ast
import struct
from pathlib import Path
from typing import Any

from pytpc.ingest.bag_chunks import BrokenBagError, messages, read_index
from pytpc.ingest.magic import BAG_MAGIC
from pytpc.recording.declaration import Declared, RawValues, make_declared

_TYPE = "dynamic_reconfigure/msg/ConfigDescription"
_TOPIC = "/parameter_descriptions"


def read_declared_bag(path: Path) -> tuple[list[Declared], list[str]]:
    """The last description of each server in a bag, and a line for each that could not be read.

    Names are the full ones (``/node/gate``). A file that is no bag declares nothing.

    Raises:
        OSError: the bag cannot be read.
    """
    last: dict[str, bytes] = {}
    try:
        with path.open("rb") as stream:
            if stream.read(len(BAG_MAGIC)) != BAG_MAGIC:
                return [], []
            index = read_index(stream)
            topics = {
                number: one.topic
                for number, one in index.connections.items()
                if one.msgtype == _TYPE and one.topic.endswith(_TOPIC)
            }
            for chunk in messages(stream, index, topics.keys()) if topics else ():
                for row, number in enumerate(chunk.connection.tolist()):
                    last[topics[number]] = bytes(chunk.data[chunk.begin[row] : chunk.end[row]])
    except BrokenBagError as error:
        return [], [f"{path}: descriptions of parameters: {error}"]
    found: list[Declared] = []
    skipped = []
    for topic, raw in sorted(last.items()):
        try:
            found += decode_description(raw, topic)
        except (struct.error, ValueError, IndexError):
            skipped.append(f"{path}: the message on {topic} is not a ConfigDescription")
    return found, skipped


def decode_description(raw: bytes, topic: str) -> list[Declared]:
    """The declarations in a serialised ConfigDescription.

    Raises:
        ValueError, IndexError, struct.error: it is not such a message.
    """
    reader = _DescriptionReader(raw)
    parameters = []
    for _ in range(reader.number("<I")):
        reader.group()
        parameters += [reader.parameter() for _ in range(reader.number("<I"))]
        reader.skip("<ii")
    highs, lows, defaults = reader.config(), reader.config(), reader.config()
    node = topic.removesuffix(_TOPIC)
    found = []
    for name, type_, description, edit_method in parameters:
        if type_ not in {"bool", "int", "double", "str"}:
            raise ValueError(type_)
        found.append(
            make_declared(
                f"{node}/{name}",
                type_,
                RawValues(lows.get(name), highs.get(name), defaults.get(name), description),
                constants=_constants(edit_method),
                place=f"topic {topic}",
            )
        )
    return found


def _constants(edit_method: str) -> object:
    """The list of an enumeration, written as a Python literal."""
    if not edit_method:
        return None
    try:
        known: object = ast.literal_eval(edit_method)
    except (ValueError, SyntaxError, RecursionError, MemoryError):
        return None
    return known.get("enum") if isinstance(known, dict) else None


class _DescriptionReader:
    """Reads the bytes of a message in order."""

    def __init__(self, raw: bytes) -> None:
        self._raw = raw
        self._at = 0

    def group(self) -> None:
        """Skip the name and type of a group."""
        self.text()
        self.text()

    def skip(self, form: str) -> tuple[Any, ...]:
        values = struct.unpack_from(form, self._raw, self._at)
        self._at += struct.calcsize(form)
        return values

    def number(self, form: str) -> int:
        value: int = self.skip(form)[0]
        return value

    def text(self) -> str:
        length = self.number("<I")
        end = self._at + length
        if end > len(self._raw):
            raise IndexError(end)
        text = self._raw[self._at : end].decode("utf-8", "replace")
        self._at = end
        return text

    def parameter(self) -> tuple[str, str, str, str]:
        name, type_ = self.text(), self.text()
        self.skip("<I")
        return name, type_, self.text(), self.text()

    def config(self) -> dict[str, object]:
        values: dict[str, object] = {}
        for _ in range(self.number("<I")):
            name = self.text()
            values[name] = bool(self.number("<B"))
        for _ in range(self.number("<I")):
            name = self.text()
            values[name] = self.number("<i")
        for _ in range(self.number("<I")):
            name = self.text()
            values[name] = self.text()
        for _ in range(self.number("<I")):
            name = self.text()
            values[name] = self.skip("<d")[0]
        for _ in range(self.number("<I")):
            self.text()
            self.skip("<Bii")
        return values
