"""What other nodes did after a comparison turned, where messages lead from it to theirs.

A comparison that decides what its node publishes may turn comparisons of the nodes that get the
messages. Such a turn that follows within ``CASCADE_S`` for each topic on the way is an effect of
the first one, and counts once. Without links between the comparisons nothing is known, and nothing
counts.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pytpc.base.columns import Floats
from pytpc.diagnosis.ranking.result_streams import (
    CASCADE_S,
    DECISIVE,
    ResultStream,
    ResultStreams,
)
from pytpc.diagnosis.results.suspects import Followed
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.static.message_paths import MessagePath, MessagePaths, NodeComparison, leaves, path_text
from pytpc.static.static_info import StaticInfo
from pytpc.static.wiring import Wiring

_SHOWN = 3
"""So many paths are evidence for a suspect; more say the same."""


@dataclass(frozen=True, slots=True)
class Reached:
    """When a comparison turned that messages reach from another one, and how long they may take.

    ``turns`` float64[turns], sorted, in seconds since the log began.
    """

    turns: Floats
    within_s: float


@dataclass(frozen=True)
class OtherNodes:
    """The streams of a log, and the paths of messages between their comparisons."""

    streams: ResultStreams
    tpcs: Tpcs
    paths: MessagePaths

    @classmethod
    def of(
        cls, streams: ResultStreams, tpcs: Tpcs, static_info: StaticInfo, wiring: Wiring | None
    ) -> OtherNodes | None:
        """None where nothing is known of messages between nodes."""
        known = any(found.received for found in static_info.thresholds.values())
        if wiring is None or not known:
            return None
        return cls(streams, tpcs, MessagePaths(static_info, wiring))

    @cached_property
    def _streams(self) -> dict[NodeComparison, list[ResultStream]]:
        """By the name without a process: two processes of one program have the same."""
        found: dict[NodeComparison, list[ResultStream]] = defaultdict(list)
        for stream in self.streams.streams:
            found[self._end(stream)].append(stream)
        return dict(found)

    def _end(self, stream: ResultStream) -> NodeComparison:
        return NodeComparison(self.tpcs.keys[stream.code], stream.node.partition(" ")[0])

    def _turning(self, end: NodeComparison) -> list[Floats]:
        """The turns of a comparison in each process, without those that change all the time."""
        turns = (stream.changes for stream in self._streams.get(end, ()))
        return [each for each in turns if 0 < each.size <= DECISIVE]

    @cached_property
    def reached(self) -> list[tuple[Reached, ...]]:
        """For each stream, those that messages reach from it.

        What changes all the time is no effect of anything.
        """
        return [tuple(self._reached(stream)) for stream in self.streams.streams]

    def _reached(self, stream: ResultStream) -> list[Reached]:
        return [
            Reached(turns, CASCADE_S * len(path.links))
            for path in self.paths.from_comparison(self._end(stream))
            for turns in self._turning(path.end)
        ]

    def followed(self, key: str, node: str, until_s: float) -> tuple[Followed, ...]:
        """The paths from a comparison on which others turned after its last turn up to a time.

        Args:
            key: of the comparison.
            node: that evaluated it, with its process where reports name one.
            until_s: the time, in seconds since the log began.
        """
        start = NodeComparison(key, node.partition(" ")[0])
        own = [stream.changes for stream in self._streams.get(start, ()) if stream.node == node]
        if not own:
            return ()
        times = {
            path: when
            for path in self.paths.from_comparison(start)
            if (when := self._chain(path, own[0], until_s)) is not None
        }
        return tuple(
            Followed(path_text(self.paths.static, path), *times[path])
            for path in leaves(list(times))[:_SHOWN]
        )

    def _chain(
        self, path: MessagePath, turns: Floats, until_s: float
    ) -> tuple[float, float] | None:
        """The last turn that the comparisons of a path followed in their order up to a time; and
        how long after it the last of them turned first."""
        later = [
            np.unique(np.concatenate([np.zeros(0), *self._turning(link.to)])) for link in path.links
        ]
        for turn in reversed(turns[turns <= until_s].tolist()):
            here = np.array([turn])
            for others in later:
                here = _following(others[others <= until_s], here)
            if here.size:
                return turn, float(here[0]) - turn
        return None


def _following(turns: Floats, times: Floats) -> Floats:
    """The turns that follow any of the times closely enough to be its effect; all are sorted."""
    before = np.concatenate([[-np.inf], times])[np.searchsorted(times, turns, side="right")]
    return np.asarray(turns[turns - before <= CASCADE_S])


def effects(turns: Floats, reached: Sequence[Reached]) -> Floats:
    """Whether comparisons of other nodes turned after each turn (1), less whether some did before.

    However many of them turned, the message is one effect: a node decides many things by it.

    Args:
        turns: float64[turns], of one comparison.
        reached: what messages reach from it.
    """
    after, before = np.zeros(turns.size), np.zeros(turns.size)
    for other in reached:
        after = np.maximum(after, _any(other.turns, turns, turns + other.within_s))
        before = np.maximum(before, _any(other.turns, turns - other.within_s, turns))
    return np.asarray(after - before)


def _any(times: Floats, begins: Floats, ends: Floats) -> Floats:
    first = np.searchsorted(times, begins, side="left")
    return (np.searchsorted(times, ends, side="left") > first).astype(np.float64)
