"""Marks: the times at which an observer says that the robot does wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

MarkType = Literal["I", "II"]
"""``I``: the robot did something that it should not have; ``II``: it should do something and does
not (SPEC 1)."""

MARK_TYPES: tuple[MarkType, ...] = get_args(MarkType)
_TOPICS: dict[str, MarkType] = {"mark_action": "I", "mark_no_action": "II"}


@dataclass(frozen=True, slots=True)
class Mark:
    """One mark.

    ``time_ns`` is the marked time, ``type`` is None where the observer only says "wrong", and
    ``observer`` is the namespace of the topic (``marks0``), empty where there is none.
    """

    time_ns: int
    type: MarkType | None
    observer: str = ""

    def order(self) -> tuple[int, str, str]:
        """Sorting marks by this is deterministic."""
        return (self.time_ns, self.observer, self.type or "")


def topic_of_marks(topic: str) -> tuple[MarkType, str] | None:
    """Type and observer of the marks on ``topic``, or None where it carries none.

    ``/mark_action`` -> ``("I", "")``, ``/marks0/mark_no_action`` -> ``("II", "marks0")``.
    """
    observer, _, last = topic.rpartition("/")
    kind = _TOPICS.get(last)
    return None if kind is None else (kind, observer.strip("/"))
