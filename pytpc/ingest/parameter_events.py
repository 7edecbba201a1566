"""Decodes rcl_interfaces/ParameterEvent: what a node's parameters are set to."""

from __future__ import annotations

import struct
from typing import NamedTuple

from pytpc.ingest.ros2 import HEAD

TOPIC = "/parameter_events"
TYPE = "rcl_interfaces/msg/ParameterEvent"

Value = bool | int | float | str | list[bool] | list[int] | list[float] | list[str]


class ParameterEvent(NamedTuple):
    """Values that a node's parameters got, by the names that the node knows; None: deleted."""

    stamp_ns: int
    node: str
    values: dict[str, Value | None]

    @property
    def is_of_tpc(self) -> bool:
        """Whether the node is one of TPC: a hidden one with settings, or that of a command."""
        return self.node.rpartition("/")[2].startswith("_tpc")


class _Reader:
    """Reads CDR from front to back."""

    def __init__(self, raw: bytes) -> None:
        self._raw = raw
        self._at = HEAD
        self._order = "<" if raw[1] & 1 else ">"

    def number(self, form: str) -> int | float:
        size = struct.calcsize(form)
        self._at += -(self._at - HEAD) % size
        (value,) = struct.unpack_from(self._order + form, self._raw, self._at)
        self._at += size
        return value  # type: ignore[no-any-return]

    def count(self) -> int:
        found = int(self.number("I"))
        if found > len(self._raw):
            raise struct.error
        return found

    def text(self) -> str:
        length = self.count()
        begin, self._at = self._at, self._at + length
        if self._at > len(self._raw):
            raise struct.error
        return self._raw[begin : begin + max(0, length - 1)].decode("utf-8", "replace")

    def numbers(self, form: str) -> list[int | float]:
        return [self.number(form) for _ in range(self.count())]

    def texts(self) -> list[str]:
        return [self.text() for _ in range(self.count())]

    def value(self) -> Value | None:
        """An rcl_interfaces/ParameterValue; it has a field for each type."""
        kind = int(self.number("B"))
        fields: list[Value] = [bool(self.number("B")), int(self.number("q"))]
        fields += [float(self.number("d")), self.text()]
        fields.append([int(byte) for byte in self.numbers("B")])
        fields.append([bool(one) for one in self.numbers("B")])
        fields.append([int(one) for one in self.numbers("q")])
        fields.append([float(one) for one in self.numbers("d")])
        fields.append(self.texts())
        return fields[kind - 1] if 1 <= kind <= len(fields) else None


def decode_parameter_event(raw: bytes) -> ParameterEvent:
    """Read an event.

    Raises:
        ValueError: the bytes end too early.
    """
    try:
        reader = _Reader(raw)
        seconds, nanoseconds = int(reader.number("i")), int(reader.number("I"))
        node = reader.text()
        values: dict[str, Value | None] = {}
        for is_deleted in (False, False, True):
            for _ in range(reader.count()):
                name = reader.text()
                value = reader.value()
                values[name] = None if is_deleted else value
    except (struct.error, IndexError) as error:
        raise ValueError(f"a parameter event of {len(raw)} bytes ends too early") from error
    return ParameterEvent(seconds * 10**9 + nanoseconds, node, values)
