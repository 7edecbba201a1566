"""Counts messages that were lost on the way, by the numbers that their senders give them."""

from __future__ import annotations

import struct
from collections import Counter

from pytpc.ingest.rosout_line import Batch, parse_batch

_LOG_HEAD = struct.Struct("<IIII")
_LENGTH = struct.Struct("<I")


class LossCounter:
    """Finds gaps in the numbers that each node gives to its messages on /rosout."""

    def __init__(self) -> None:
        """Nothing was seen yet."""
        self._last: dict[str, int] = {}
        self._spared: set[str] = set()
        self.lost: Counter[str] = Counter()
        self.missed_before: Counter[str] = Counter()

    def see(self, data: bytes, sender: str = "", *, latched: bool = False) -> bytes:
        """Take in one serialized rosgraph_msgs/Log; return its text.

        Who sends numbers: ``rosbag play`` does so anew, in one row for all nodes. Where no
        ``sender`` is known it is the node. One that is ``latched``, as rospy's, sends its last text
        anew to each new subscriber, as rosout is one, by a number of its own: no loss, once.

        Raises:
            ValueError: the bytes are shorter than such a message.
        """
        try:
            sequence, _seconds, _nanoseconds, frame = _LOG_HEAD.unpack_from(data)
            at = _LOG_HEAD.size + frame + 1
            name, at = _text(data, at)
            text, _ = _text(data, at)
        except struct.error as error:
            raise ValueError(f"no rosgraph_msgs/Log: {error}") from error
        node = sender or name.decode("utf-8", "replace")
        last = self._last.get(node)
        if last is None:
            # roscpp counts from 0 and rospy from 1, so that 1 may be the first one.
            if sequence > 1:
                self.missed_before[node] = sequence - 1
        elif sequence == last + 2 and latched and node not in self._spared:
            self._spared.add(node)
        elif sequence > last + 1:
            self.lost[node] += sequence - last - 1
        self._last[node] = sequence
        return text


def _text(data: bytes, at: int) -> tuple[bytes, int]:
    (length,) = _LENGTH.unpack_from(data, at)
    start = at + _LENGTH.size
    if start + length > len(data):
        raise struct.error("the text goes past the end")
    return data[start : start + length], start + length


class BatchCounter:
    """The same for numbered messages on /threshold_information (docs/reference/formats.md)."""

    def __init__(self, counter: LossCounter) -> None:
        """Losses are added to those of ``counter``."""
        self._counter = counter
        self._next: dict[tuple[str, int], int] = {}

    def see(self, node: str, data: bytes) -> int:
        """Take in one serialized std_msgs/String; return how many reports it has.

        Raises:
            ValueError: the bytes are shorter than such a message.
        """
        try:
            text, _ = _text(data, 0)
        except struct.error as error:
            raise ValueError(f"no std_msgs/String: {error}") from error
        if not text.startswith(b"#"):
            return 1
        batch = parse_batch(text.partition(b"\n")[0].decode("utf-8", "replace"))
        if not isinstance(batch, Batch):
            return 0
        process = (node, batch.pid)
        expected = self._next.get(process)
        if expected is None and batch.seq:
            self._counter.missed_before[node] += batch.seq
        elif expected is not None and batch.seq > expected:
            self._counter.lost[node] += batch.seq - expected
        self._next[process] = max(expected or 0, batch.seq + batch.count)
        return batch.count
