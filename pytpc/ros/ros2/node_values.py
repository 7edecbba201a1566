"""The values that the nodes of a graph tell when they are asked, for a recording."""

from __future__ import annotations

import queue
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from pytpc.base.errors import RunError
from pytpc.ros.ros2.agent_process import Head, Take

# Whose parameters change all the time is believed after so many answers.
_MOST_ANSWERS = 5


class Asks(Protocol):
    """Asks a node for its values; `pytpc.ros.ros2.agent_process.Agent` does."""

    def values_later(self, node: str, take: Take) -> None:
        """See there."""


@dataclass(slots=True)
class _Asked:
    """A node that has not answered: since when, and whether its parameters were set since."""

    since: float = field(default_factory=time.monotonic)
    is_outdated: bool = False


class NodeValues:
    """Asks each node once for its parameters; a slow one answers when it can.

    An answer that crosses an event on /parameter_events may be older than that: it is asked for
    again.
    """

    def __init__(self, agent: Asks) -> None:
        """``agent`` is that of the recording."""
        self._agent = agent
        self._seen: set[str] = set()
        self._answers: queue.SimpleQueue[tuple[str, Head, bytes]] = queue.SimpleQueue()
        self._asked: dict[str, _Asked] = {}
        self._outdated: Counter[str] = Counter()

    def are_asked_for(self, patience_s: float) -> bool:
        """Whether a node has not answered that was asked within the last seconds."""
        since = time.monotonic() - patience_s
        return any(asked.since > since for asked in self._asked.values())

    def see(self, nodes: Sequence[str]) -> None:
        """Ask those that are new; one that comes again is another process."""
        for name in nodes:
            if name not in self._seen and not name.rpartition("/")[2].startswith("_"):
                self._outdated.pop(name, None)
                self._ask(name)
        self._seen = set(nodes)

    def see_event(self, node: str) -> None:
        """A node's parameters were set."""
        if node in self._asked:
            self._asked[node].is_outdated = True

    def told(self) -> Iterator[bytes]:
        """The answers that have come, each a serialized rcl_interfaces/ParameterEvent."""
        while not self._answers.empty():
            node, head, event = self._answers.get()
            asked = self._asked.pop(node, None)
            if asked is None or not head or "error" in head:
                continue
            self._outdated[node] += asked.is_outdated
            if asked.is_outdated and self._outdated[node] < _MOST_ANSWERS:
                self._ask(node)
            else:
                yield event

    def _ask(self, node: str) -> None:
        self._asked[node] = _Asked()
        try:
            self._agent.values_later(node, lambda *answer: self._answers.put((node, *answer)))
        except RunError:
            # The recording ends.
            del self._asked[node]
