"""The frames between the agent and pytpc.

A frame is two lengths (uint32, little-endian), a head in JSON, and raw bytes. The bytes of a
message are its source's time (int64, ns, 0 where unknown) and the message.
"""

import collections
import json
import os
import struct
import threading
from typing import Any

LENGTHS = struct.Struct("<II")
TIME = struct.Struct("<q")
# What waits at most for a reader that is stopped, so that the robot keeps its memory.
MOST_BYTES = 256 << 20


class Writer(threading.Thread):
    """Writes frames by a thread of its own, so that the subscriptions never wait for the reader."""

    def __init__(self, descriptor: Any) -> None:
        super().__init__(daemon=True)
        self._descriptor = descriptor
        self._parts: Any = collections.deque()
        self._has_parts = threading.Event()
        self._closed = False
        # Each is changed by one thread alone.
        self._taken_bytes = 0
        self._written_bytes = 0
        self.start()

    def has_room(self) -> Any:
        """Whether there is room for a message: the reader is not too far behind."""
        return self._taken_bytes - self._written_bytes < MOST_BYTES

    def put(self, head: Any, body: Any = b"") -> None:
        """Send a frame; ``head`` is a dictionary, or its JSON as bytes."""
        if not isinstance(head, bytes):
            head = json.dumps(head).encode()
        frame = LENGTHS.pack(len(head), len(body)) + head + body
        self._taken_bytes += len(frame)
        self._parts.append(frame)
        self._has_parts.set()

    def run(self) -> None:
        """Write until ``close``."""
        while not (self._closed and not self._parts):
            self._has_parts.wait(1.0)
            self._has_parts.clear()
            parts = []
            while self._parts:
                parts.append(self._parts.popleft())
            data = memoryview(b"".join(parts))
            size = len(data)
            try:
                while data:
                    data = data[os.write(self._descriptor, data) :]
            except OSError:
                # Nobody reads any more.
                os._exit(0)
            self._written_bytes += size

    def close(self) -> None:
        """Write what is left."""
        self._closed = True
        self._has_parts.set()
        self.join(10.0)


def read_frame(stream: Any) -> Any:
    """The next head and body; None at the end."""
    lengths = stream.read(LENGTHS.size)
    if len(lengths) < LENGTHS.size:
        return None
    head_size, body_size = LENGTHS.unpack(lengths)
    head, body = stream.read(head_size), stream.read(body_size)
    if len(head) < head_size or len(body) < body_size:
        return None
    return json.loads(head), body
