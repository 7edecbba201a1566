"""The log as streams: the evaluations of one comparison in one node, and when its result changed.

All times are seconds since the log began, float64. Nothing here depends on a mark, so it is
computed once for each recording.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from pytpc.base.columns import Bools, Floats, Int64s
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.recording.events import Events

PAUSE_S = 2.0
"""A comparison that was not evaluated for longer than this, and for three of its usual intervals,
has paused: the robot was doing something else."""

BURST_S = 0.5
"""Changes of one result within this time of each other count as one: noise at a threshold. The
first of them counts."""

DECISIVE = 20
"""A comparison whose result changed more often than this is not part of cascades."""

LARGEST = 1e290
"""A value beyond this counts as infinite, so that sums stay within a double."""

SET_UP_S = 10.0
"""What a node asks only so soon after its first report, it asked while it was set up."""

CASCADE_S = 1.5
"""A change within this time of another one may be its consequence: nodes wait for messages, and a
mission runs at a few Hz."""


@dataclass(frozen=True, eq=False)
class ResultStream:
    """n evaluations of one comparison in one node.

    ``times`` float64[n], sorted; ``weight`` float64[n], the seconds for which each was the last
    word; ``res`` bool[n]; ``margin`` float64[n], |cmp - thresh|, nan where it is not finite;
    ``spread`` is the range of all its finite values, of cmp and of thresh. ``code`` is the
    comparison's place in `Tpcs.keys`, ``column`` its parameter's in `Tpcs.names`.
    ``changes`` are when its result changed, noise taken together; ``starts`` and ``stops`` when it
    began to be evaluated after a pause, and was before one (those of the log included). ``node``
    is the one that evaluates.
    """

    code: int
    column: int
    times: Floats
    weight: Floats
    res: Bools
    cmp: Floats
    thresh: Floats
    margin: Floats
    spread: float
    changes: Floats
    starts: Floats
    stops: Floats
    node: str


@dataclass(frozen=True, eq=False)
class ResultStreams:
    """All streams of a recording. ``seconds`` is how long the log is."""

    streams: tuple[ResultStream, ...]
    begin_ns: int
    seconds: float

    @classmethod
    def of(cls, events: Events, tpcs: Tpcs) -> ResultStreams:
        """The streams of a table; cached as long as the table exists."""
        asked = (tpcs.keys, tpcs.parameters)
        known = _KEPT.get(events)
        if known is not None and known[0] == asked:
            return known[1]
        made = cls._of(events.with_keys(tpcs.keys), tpcs)
        _KEPT[events] = (asked, made)
        return made

    @classmethod
    def _of(cls, events: Events, tpcs: Tpcs) -> ResultStreams:
        if not len(events):
            return cls((), 0, 0.0)
        begin = int(events.time_ns[0])
        seconds = (int(events.time_ns[-1]) - begin) / 1e9
        place = {name: column for column, name in enumerate(tpcs.names)}
        order = np.lexsort((events.node, events.key))
        ends = np.flatnonzero(
            np.diff(events.key[order], append=-1) | np.diff(events.node[order], append=-1)
        )
        streams = []
        for rows in np.split(order, ends[:-1] + 1):
            code = int(events.key[rows[0]])
            column = place[tpcs.parameters[code]]
            streams.append(_stream(events, rows, begin, (code, column)))
        return cls(tuple(streams), begin, seconds)

    @cached_property
    def shifts(self) -> Floats:
        """When a comparison started or paused: the robot did something else.

        float64[shifts], sorted; without the begin and end of the log.
        """
        times = [s.starts for s in self.streams] + [s.stops for s in self.streams]
        found = np.sort(np.concatenate([np.zeros(0), *times]))
        edge = PAUSE_S
        return found[(found > edge) & (found < self.seconds - edge)]

    def only_at_set_up(self, before_s: float) -> frozenset[int]:
        """The columns of parameters that were compared only while their nodes were set up.

        Args:
            before_s: no set-up lasts longer, in seconds since the log began.
        """
        begins: dict[str, float] = {}
        for stream in self.streams:
            first = float(stream.times[0])
            begins[stream.node] = min(first, begins.get(stream.node, first))
        later = {
            stream.column
            for stream in self.streams
            if stream.times[-1] > min(begins[stream.node] + SET_UP_S, before_s)
        }
        return frozenset({stream.column for stream in self.streams} - later)

    @cached_property
    def decisions(self) -> Floats:
        """When the result of a rarely changing comparison changed; float64[changes], sorted."""
        times = [s.changes for s in self.streams if s.changes.size <= DECISIVE]
        return np.sort(np.concatenate([np.zeros(0), *times]))


_Asked = tuple[tuple[str, ...], tuple[str, ...]]
# With the keys and the parameters, whose order gives the columns.
_KEPT: WeakKeyDictionary[Events, tuple[_Asked, ResultStreams]] = WeakKeyDictionary()


def _stream(events: Events, rows: Int64s, begin_ns: int, places: tuple[int, int]) -> ResultStream:
    times = (events.time_ns[rows] - begin_ns) / 1e9
    cmp, thresh, res = events.cmp[rows], events.thresh[rows], events.res[rows]
    gaps = np.diff(times)
    pause = max(PAUSE_S, 3.0 * float(np.median(gaps))) if gaps.size else PAUSE_S
    usual = float(np.median(gaps)) if gaps.size else 0.0
    weight = np.append(np.minimum(gaps, pause), min(usual, pause))
    finite = (np.abs(cmp) < LARGEST) & (np.abs(thresh) < LARGEST)
    with np.errstate(invalid="ignore", over="ignore"):
        margin = np.where(finite, np.abs(cmp - thresh), np.nan)
        values = np.concatenate([cmp[finite], thresh[finite]])
        spread = float(values.max() - values.min()) if values.size else 0.0
    changed = np.flatnonzero(res[1:] != res[:-1]) + 1
    paused = np.flatnonzero(gaps > pause)
    return ResultStream(
        code=places[0],
        column=places[1],
        times=times,
        weight=weight,
        res=res,
        cmp=cmp,
        thresh=thresh,
        margin=margin,
        spread=spread,
        changes=_first_of_bursts(times[changed]),
        starts=times[np.concatenate([[0], paused + 1])],
        stops=times[np.concatenate([paused, [times.size - 1]])],
        node=events.nodes[events.node[rows[0]]],
    )


def _first_of_bursts(times: Floats) -> Floats:
    """The times that come more than ``BURST_S`` after the one before."""
    return times[np.diff(times, prepend=-np.inf) > BURST_S]
