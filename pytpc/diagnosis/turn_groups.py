"""Which comparisons turn together, or in a fixed order: from when they turned, they are one.

Two comparisons belong together if nearly each turn of either has one of the other at the same
distance in time, and chance would not do that. The distance is the median of those from each turn
of the one to the nearest of the other. If turns came at any time, each turn of the first would meet
one of the second by chance with the probability

    p = min(1, 2 w n / T)

where w is how far a distance may be from the median, n the number of the second's turns and T the
length of the log. All n turns meet with a probability of at most the binomial tail P(X >= k). That
must be below ``CHANCE``, divided by the number of pairs that are compared (Bonferroni). For
distances other than zero, the median could have been anything up to ``ORDER_S``, which multiplies
the tail. The groups are the connected components.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import exp, lgamma, log
from weakref import WeakKeyDictionary

import numpy as np

from pytpc.base.columns import Floats, Int64s
from pytpc.diagnosis.ranking.result_streams import CASCADE_S, ResultStream, ResultStreams
from pytpc.diagnosis.ranking.summarised import with_summarised
from pytpc.diagnosis.results.turn_groups import GroupMember, TurnGroup
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

TOGETHER_S = 0.15
"""Turns this near to each other have no order: a loop at 10 Hz, or a message to another node, lies
between them."""

ORDER_S = CASCADE_S
"""Turns that follow each other later than this are not one's consequence of the other."""

SPREAD = 0.25
"""A distance may be from the median by this part of it, and by ``TOGETHER_S`` in any case."""

AGREED = 0.9
"""So large a part of the turns of either must have one of the other."""

LEAST = 2
"""Who turned once turned at the same time as everything that began then."""

MOST = 2000
"""Of who turned more often, the first so many turns are compared."""

LOOKED_AT, LOOKS_AGREED = 16, 0.6
"""A pair of which fewer of so many turns seem to agree is not looked at any further. One that
belongs together is overlooked in less than one case of 100,000."""

CHANCE = 0.01
"""How likely it may be that a log without any group seems to have one."""


@dataclass(frozen=True, eq=False)
class Turns:
    """When a comparison turned in a node: ``times`` float64[n], sorted, in s."""

    key: str
    node: str
    parameter: str
    times: Floats


def turn_groups_of(recording: Recording, static_info: StaticInfo) -> tuple[TurnGroup, ...]:
    """The groups of a recording, with the names of its static information."""
    tpcs = Tpcs.of(static_info)
    streams = ResultStreams.of(with_summarised(recording), tpcs)
    return groups_in(streams, tpcs, recording)


def groups_in(streams: ResultStreams, tpcs: Tpcs, recording: Recording) -> tuple[TurnGroup, ...]:
    """The groups of a recording's streams, which are kept; noise at a threshold is one turn."""
    known = _KEPT.get(streams)
    if known is None:
        turns = [
            Turns(
                tpcs.keys[one.code],
                one.node,
                tpcs.parameters[one.code],
                _reported(one, tpcs.keys[one.code], streams.begin_ns, recording),
            )
            for one in streams.streams
        ]
        known = _KEPT[streams] = turn_groups(turns, streams.seconds)
    return known


# The verdict and the report's table ask for the same ones.
_KEPT: WeakKeyDictionary[ResultStreams, tuple[TurnGroup, ...]] = WeakKeyDictionary()


def _reported(stream: ResultStream, key: str, begin_ns: int, recording: Recording) -> Floats:
    """The turns whose times were reported.

    Of others a summary tells, at its end. There a node ends all its summaries: what turned in one
    period would seem to have turned at one instant.
    """
    events = recording.events
    if not len(recording.summaries):
        return stream.changes
    times = (events.time_ns[events.rows_in(key, stream.node)] - begin_ns) / 1e9
    return stream.changes[np.isin(stream.changes, times)]


def turn_groups(every: Sequence[Turns], seconds: float) -> tuple[TurnGroup, ...]:
    """The groups of comparisons that turn as one, those that turned most often first.

    Args:
        every: the comparisons.
        seconds: how long they were watched.
    """
    turned = sorted(
        (one for one in every if one.times.size >= LEAST),
        key=lambda one: (one.times.size, one.parameter, one.key, one.node),
    )
    sizes = np.array([one.times.size for one in turned])
    # Those whose numbers of turns are near enough; they are sorted by these.
    ends = np.searchsorted(AGREED * sizes, sizes, side="right")
    limit = CHANCE / max(1, int((ends - np.arange(1, ends.size + 1)).sum()))
    parent = list(range(len(turned)))
    for a, b in _likely(turned, ends):
        if _root(parent, a) != _root(parent, b) and _belong(turned[a], turned[b], seconds, limit):
            parent[_root(parent, b)] = _root(parent, a)
    found: dict[int, list[Turns]] = {}
    for place, one in enumerate(turned):
        found.setdefault(_root(parent, place), []).append(one)
    groups = [_group(members) for members in found.values() if len(members) > 1]
    return tuple(sorted(groups, key=lambda one: (-one.turns, one.parameters)))


def _likely(turned: Sequence[Turns], ends: Int64s) -> Iterator[tuple[int, int]]:
    """The pairs of each with those up to its end of which a few turns say that they may belong.

    To look at all turns of a million pairs would take minutes.
    """
    if not turned:
        return
    times = [one.times[:MOST] for one in turned]
    sizes = np.array([one.size for one in times])
    begins = np.cumsum(sizes) - sizes
    # The times of one after those of the other, each with a space of its own.
    low, high = min(float(one[0]) for one in times), max(float(one[-1]) for one in times)
    space = high - low + 1.0
    row = np.concatenate([one - low + n * space for n, one in enumerate(times)])
    for a, one in enumerate(times[:-1]):
        others = np.arange(a + 1, ends[a])
        some = one[np.linspace(0, one.size - 1, min(one.size, LOOKED_AT)).astype(np.int64)]
        first, last = begins[others, None], (begins + sizes)[others, None] - 1
        at = some - low + others[:, None] * space
        after = np.clip(np.searchsorted(row, at), first + 1, last)
        before, behind = row[after - 1] - at, row[after] - at
        gaps = np.where(-before <= behind, before, behind)
        medians = np.median(gaps, axis=1)
        widths = 2.0 * np.maximum(TOGETHER_S, SPREAD * np.abs(medians))
        met = (np.abs(gaps - medians[:, None]) <= widths[:, None]).mean(axis=1) >= LOOKS_AGREED
        met &= np.abs(medians) <= 2.0 * ORDER_S
        yield from ((a, int(b)) for b in others[met])


def _root(parent: list[int], place: int) -> int:
    while parent[place] != place:
        parent[place] = place = parent[parent[place]]
    return place


def _belong(first: Turns, second: Turns, seconds: float, limit: float) -> bool:
    a, b = first.times[:MOST], second.times[:MOST]
    median, joined = _joined(a, b)
    most = max(a.size, b.size)
    if abs(median) > ORDER_S or joined < AGREED * most:
        return False
    width = width_of(median)
    free = 1.0 if abs(median) <= TOGETHER_S else ORDER_S / width
    # Two that turn nearly all the time always meet.
    hit = min(1.0, 2.0 * width * second.times.size / max(seconds, width))
    return free * _tail(joined, a.size, hit) <= limit


def _joined(a: Floats, b: Floats) -> tuple[float, int]:
    """The median distance from turns of ``a`` to the nearest of ``b``, and how many have it.

    Each turn of ``b`` counts once.
    """
    nearest = _nearest(a, b)
    median = float(np.median(b[nearest] - a))
    met = _nearest(a + median, b)
    near = np.abs(b[met] - a - median) <= width_of(median)
    return median, int(np.unique(met[near]).size)


def _nearest(times: Floats, among: Floats) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """intp[times]: the place of the nearest among the sorted others."""
    after = np.clip(np.searchsorted(among, times), 1, among.size - 1)
    before = after - 1
    return np.where(times - among[before] <= among[after] - times, before, after)


def width_of(median: float) -> float:
    """How far a distance may be from its median, in s."""
    return max(TOGETHER_S, SPREAD * abs(median))


def _tail(least: int, of: int, chance: float) -> float:
    """P(X >= least) of a binomial distribution; logarithms keep large numbers in range."""
    if chance >= 1.0:
        return 1.0
    if chance <= 0.0:
        return 0.0
    up, down = log(chance), log(1.0 - chance)
    terms = (
        exp(min(0.0, _log_comb(of, k) + k * up + (of - k) * down)) for k in range(least, of + 1)
    )
    return min(1.0, sum(terms))


def _log_comb(of: int, k: int) -> float:
    return lgamma(of + 1) - lgamma(k + 1) - lgamma(of - k + 1)


def _group(members: Sequence[Turns]) -> TurnGroup:
    """The members in the order in which they turn, seen from one of them."""
    seen_from = members[0].times[:MOST]
    ordered = sorted(
        ((_joined(seen_from, one.times[:MOST]), one) for one in members),
        key=lambda each: (each[0][0], each[1].parameter, each[1].key, each[1].node),
    )
    return _in_order(
        GroupMember(one.key, one.node, one.parameter, after, one.times.size, joined)
        for (after, joined), one in ordered
    )


def part_of(group: TurnGroup, members: Collection[tuple[str, str]]) -> TurnGroup:
    """The same with these (key, node) only, at least two of its members."""
    return _in_order(one for one in group.members if (one.key, one.node) in members)


def _in_order(members: Iterable[GroupMember]) -> TurnGroup:
    """The group of sorted members, of which the first one turns at 0."""
    every = list(members)
    made = tuple(replace(one, after_s=one.after_s - every[0].after_s) for one in every)
    gaps = [later.after_s - earlier.after_s for earlier, later in pairwise(made)]
    return TurnGroup("in order" if max(gaps) > TOGETHER_S else "together", made)
