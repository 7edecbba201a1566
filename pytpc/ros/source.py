"""Where messages of a graph come from."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Source:
    """Where messages come from: one publisher of one topic, with what it says of their type.

    ``latched``: it sends its last message to each new subscriber.
    """

    topic: str
    node: str
    type: str
    md5sum: str
    definition: str
    latched: bool = False
