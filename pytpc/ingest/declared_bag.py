"""Declarations that dynamic_reconfigure's servers published, in a ROS 1 bag.

A server says on NODE/parameter_descriptions (latched) which parameters there are and their ranges.
"""

from __future__ import annotations

import ast
import struct
from pathlib import Path
from typing import Any

from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.base import TypesysError

from pytpc.ingest.bag_chunks import MAGIC, BrokenBagError, messages, read_index
from pytpc.recording.declaration import Declared, RawValues, make_declared

_UNREADABLE = (TypesysError, SerdeError, struct.error, AssertionError, LookupError, AttributeError)
_TYPE = "dynamic_reconfigure/msg/ConfigDescription"
_TOPIC = "/parameter_descriptions"


def read_declared_bag(path: Path) -> tuple[list[Declared], list[str]]:
    """The last description of each server in a bag, and a line for each that could not be read.

    Names are the full ones (``/node/gate``). A file that is no bag declares nothing.

    Raises:
        OSError: the bag cannot be read.
    """
    last: dict[str, tuple[bytes, str]] = {}
    try:
        with path.open("rb") as stream:
            if stream.read(len(MAGIC)) != MAGIC:
                return [], []
            index = read_index(stream)
            servers = {
                number: one
                for number, one in index.connections.items()
                if one.msgtype == _TYPE and one.topic.endswith(_TOPIC)
            }
            for chunk in messages(stream, index, servers.keys()) if servers else ():
                for row, number in enumerate(chunk.connection.tolist()):
                    server = servers[number]
                    raw = chunk.data[chunk.begin[row] : chunk.end[row]]
                    last[server.topic] = raw, server.definition
    except BrokenBagError as error:
        return [], [f"{path}: descriptions of parameters: {error}"]
    found: list[Declared] = []
    skipped = []
    for topic, (raw, definition) in sorted(last.items()):
        try:
            found += decode_description(raw, topic, definition)
        except ValueError:
            skipped.append(f"{path}: the message on {topic} is not a ConfigDescription")
    return found, skipped


def decode_description(raw: bytes, topic: str, definition: str) -> list[Declared]:
    """The declarations in a serialised ConfigDescription.

    Raises:
        ValueError: it is not such a message, or ``definition`` is not its definition.
    """
    store = get_typestore(Stores.EMPTY)
    try:
        store.register(get_types_from_msg(definition, _TYPE))
        said: Any = store.deserialize_ros1(raw, _TYPE)
        lows, highs, defaults = (
            {one.name: one.value for one in (*of.bools, *of.ints, *of.strs, *of.doubles)}
            for of in (said.min, said.max, said.dflt)
        )
        parameters = [one for group in said.groups for one in group.parameters]
    except _UNREADABLE as error:
        raise ValueError(f"not a ConfigDescription: {error}") from error
    node = topic.removesuffix(_TOPIC)
    found = []
    for one in parameters:
        if one.type not in {"bool", "int", "double", "str"}:
            raise ValueError(one.type)
        found.append(
            make_declared(
                f"{node}/{one.name}",
                one.type,
                RawValues(
                    lows.get(one.name), highs.get(one.name), defaults.get(one.name), one.description
                ),
                constants=_constants(one.edit_method),
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
