"""What a robot's observer consists of: what is seen, how it comes about, what is wrong with it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic

from simulated_world.rules import Rules, SightT


@dataclass(frozen=True)
class Channel(Generic[SightT]):
    """One topic: its type as "package/Message", and what a message on it lets one see.

    ``take`` returns a sight where the message completes one, else None.
    """

    message_type: str
    take: Callable[[Any], SightT | None]


class Eyes(Generic[SightT]):
    """How messages become sights; the same for a running robot and for a bag."""

    def channels(self) -> Mapping[str, Channel[SightT]]:
        """The topics of what a person can see or hear.

        Of messages of one time the first topic's is taken first, so that what completes a sight
        stands last.
        """
        raise NotImplementedError


@dataclass(frozen=True)
class Observer(Generic[SightT]):
    """The observer of one robot. ``rules`` and ``eyes`` make new ones for a mission."""

    sight: type[SightT]
    rules: Callable[[], Rules[SightT]]
    eyes: Callable[[], Eyes[SightT]]
