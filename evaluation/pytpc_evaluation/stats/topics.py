"""What was recorded besides the reports: the other topics of a bag, message by message."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from rosbags.highlevel import AnyReader
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from pytpc.base.errors import InputError, TpcError

_STEP = 512
"""So many messages between two calls of ``on_progress``."""


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic of a bag: its type as ``package/msg/Name``, and how many messages it has.

    ``plain_fields`` are the type's own fields that are one number, text or truth value each.
    """

    name: str
    type: str
    messages: int
    plain_fields: frozenset[str]


class Message(NamedTuple):
    """A message: when it was recorded, and its fields as attributes."""

    topic: str
    time_ns: int
    content: Any


class BagTopics:
    """The topics of an open bag, sorted by name."""

    def __init__(self, reader: AnyReader) -> None:
        """Of what ``open_topics`` opened."""
        self._reader = reader
        counts: dict[tuple[str, str], int] = {}
        for one in reader.connections:
            place = one.topic, one.msgtype
            counts[place] = counts.get(place, 0) + one.msgcount
        self.topics = [
            Topic(name, kind, count, self._plain_fields(kind))
            for (name, kind), count in sorted(counts.items())
        ]

    def messages(
        self, names: Collection[str], on_progress: Callable[[int, int], None] | None = None
    ) -> Iterator[Message]:
        """The messages of some topics, in the order of their recording.

        Args:
            names: of topics.
            on_progress: called with (messages read, messages in all).
        """
        wanted = [one for one in self._reader.connections if one.topic in names]
        total = sum(one.msgcount for one in wanted)
        found = self._reader.messages(wanted) if wanted else ()
        for number, (connection, time_ns, raw) in enumerate(found, start=1):
            content = self._reader.deserialize(raw, connection.msgtype)
            yield Message(connection.topic, time_ns, content)
            if on_progress is not None and number % _STEP == 0:
                on_progress(number, total)

    def _plain_fields(self, kind: str) -> frozenset[str]:
        _, fields = self._reader.typestore.fielddefs.get(kind, ((), ()))
        return frozenset(name for name, found in fields if found[0] is Nodetype.BASE)


@contextmanager
def open_topics(bag: Path, what: str) -> Iterator[BagTopics]:
    """The topics of a bag while it is open; ``what`` is read from them, for the message.

    Args:
        bag: a ROS 1 bag, or a folder of rosbag2.
        what: as in "WHAT cannot be read".

    Raises:
        InputError: the bag cannot be read; also a TpcError of the block itself, with the bag's
            path; one line.
    """
    try:
        with AnyReader([bag], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            yield BagTopics(reader)
    except TpcError as error:
        raise InputError(error.message, bag) from error
    except Exception as error:  # rosbags raises whatever its parsers do
        said = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{what} cannot be read: {said}", bag) from error
