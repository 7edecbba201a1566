"""Evaluates the logged comparisons of one parameter again with another value of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from pytpc.base.columns import Bools, Floats, Int64s
from pytpc.base.errors import InputError
from pytpc.base.wording import Number
from pytpc.diagnosis.thresholds.inverse import kept_as
from pytpc.diagnosis.thresholds.threshold_sets import outcomes
from pytpc.diagnosis.thresholds.units import NoUnitError, is_text, read_type, tree_of
from pytpc.recording.events import Events
from pytpc.recording.summaries import Summaries
from pytpc.static.arithmetic import Tree, evaluate
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import meant_by, parameter_name
from pytpc.static.static_info import StaticInfo

_ALL = slice(None)
_SLACK_NS = 100_000_000


@dataclass(frozen=True)
class Track:
    """The evaluations of one TPC, in the order of time.

    ``time_ns`` int64[n], ``cmp`` and ``thresh`` float64[n], ``result``, ``res`` bool[n], ``node``
    int64[n] are as in the events. ``flops`` int64[f, 2] are the places of each flop's evaluation
    and of the one before it; ``flop_ns`` int64[f] are their times. ``kept`` are the summaries of
    the TPC; ``own`` bool[n] is False for evaluations that a summary counts.
    """

    comparison: Comparison
    tree: Tree
    time_ns: Int64s
    cmp: Floats
    thresh: Floats
    result: Bools
    res: Bools
    node: Int64s
    flops: Int64s
    flop_ns: Int64s
    kept: Summaries
    own: Bools

    def threshold(self, value: Number) -> float:
        """The threshold that a value of the parameter gives."""
        return evaluate(self.tree, float(value))

    def turned(self, threshold: float, rows: slice | Int64s = _ALL) -> Bools:
        """bool[rows]: whether the outcome would differ with ``threshold``."""
        relation = self.comparison.relation
        if relation == "flag":
            return np.asarray(self._flag(rows, threshold) != self.res[rows], dtype=np.bool_)
        cmp, thresh = self.cmp[rows], self.thresh[rows]
        before = outcomes(relation, cmp, thresh)
        return np.asarray(before != outcomes(relation, cmp, threshold), dtype=np.bool_)

    def ways(self, threshold: float) -> tuple[int, int]:
        """How many different outcomes the log has, and how many with ``threshold``."""
        relation, kept = self.comparison.relation, self.kept
        before = self.res if relation == "flag" else outcomes(relation, self.cmp, self.thresh)
        after = before ^ self.turned(threshold)
        if relation == "flag":
            ends = [kept.low != 0, kept.high != 0]
            then = [np.full(len(kept), threshold != 0)]
        else:
            diffs = (kept.diff_min, kept.diff_max)
            ends = [outcomes(relation, diff, 0.0) for diff in diffs]
            then = [outcomes(relation, kept.thresh + diff, threshold) for diff in diffs]
        return (
            np.unique(np.concatenate([before, *ends])).size,
            np.unique(np.concatenate([after, *then])).size,
        )

    def _flag(self, rows: slice | Int64s, threshold: float) -> Bools:
        """Outcomes of a flag; for a switch, those of the log at this value."""
        res = self.res[rows]
        if bool(np.all(self.res == (self.thresh != 0))):
            return np.full(res.shape, threshold != 0)
        same = self.thresh == threshold
        if not np.any(same):
            return res
        return np.full(res.shape, bool(self.res[same][-1]))

    def turned_kept(self, rows: Bools, threshold: float) -> tuple[int, int]:
        """How many evaluations of the summaries ``rows`` would turn: at least, and at most.

        If the evaluations of a summary go both ways, only the extremes are known.
        """
        kept = self.kept.take(rows & (self.kept.count > self.kept.odd))
        if not len(kept):
            return 0, 0
        size = kept.count - kept.odd
        relation = self.comparison.relation
        if relation == "flag":
            return self._kept_flags(kept, threshold != 0)
        if relation in {"==", "!="}:
            return 0, int(size.sum())
        ends = [kept.thresh + kept.diff_min, kept.thresh + kept.diff_max]
        before = [outcomes(relation, diff, 0.0) for diff in (kept.diff_min, kept.diff_max)]
        after = [outcomes(relation, end, threshold) for end in ends]
        all_before, all_after = before[0] == before[1], after[0] == after[1]
        sure = all_before & all_after
        turned = before[0] != after[0]
        whole = np.where(sure & turned, size, 0)
        # At least one extreme turns if only one of the two is mixed.
        some = np.where(sure, 0, np.where(all_before | all_after, 1, 0))
        most = np.where(sure, whole, np.where(all_before | all_after, size - 1, size))
        return int((whole + some).sum()), int(most.sum())

    def _kept_flags(self, kept: Summaries, value: bool) -> tuple[int, int]:
        """The same for a flag, whose extremes are two of its values; nothing is known of a switch.

        Values between a negative and a positive one may be 0.
        """
        every = self.kept
        if np.any(every.res != (every.thresh != 0)) or np.any(self.res != (self.thresh != 0)):
            return 0, 0
        size = kept.count - kept.odd
        low, high = (kept.low != 0) != value, (kept.high != 0) != value
        alike = (kept.low == kept.high) | (kept.low > 0) | (kept.high < 0)
        least = np.where(alike, low * size, low.astype(np.int64) + high)
        most = np.where(alike, least, size - ~low - ~high)
        return int(least.sum()), int(most.sum())

    def flop_before(self, mark_ns: int) -> Int64s | None:
        """int64[2]: the places of the last flop up to a mark; None if there is none."""
        count = int(np.searchsorted(self.flop_ns, mark_ns, side="right"))
        return self.flops[count - 1] if count else None

    def rows_between(self, begin_ns: int, end_ns: int) -> slice:
        """The evaluations of a closed span."""
        first = int(np.searchsorted(self.time_ns, begin_ns, side="left"))
        return slice(first, int(np.searchsorted(self.time_ns, end_ns, side="right")))


def tracks_of(
    events: Events, summaries: Summaries, static_info: StaticInfo, parameter: str
) -> tuple[str, list[Track], list[str]]:
    """The evaluations of all TPCs of a parameter.

    Returns:
        The parameter's name in the source, the tracks of its TPCs in the log, and for each TPC that
        cannot be replayed the reason.

    Raises:
        InputError: there is no such parameter, or several.
    """
    name = _name_of(static_info, parameter)
    tracks, without = [], []
    for key, found in sorted(static_info.thresholds.items()):
        if parameter_name(found) != name:
            continue
        place = f"{found.file}:{found.lineno}"
        unit = static_info.unit_of(key)
        if is_text(found, unit):
            without.append(f"{place} compares text")
            continue
        try:
            tree = kept_as(tree_of(found), read_type(found, unit))
        except NoUnitError as why:
            without.append(f"{place}: {why}")
            continue
        track = _TrackStore.of(events).track(events, summaries, found, tree)
        if track.time_ns.size or len(track.kept):
            tracks.append(track)
    return name, tracks, without


def _name_of(static_info: StaticInfo, parameter: str) -> str:
    names = sorted({parameter_name(found) for found in static_info.thresholds.values()})
    if parameter in names:
        return parameter
    same = meant_by(parameter, names)
    if len(same) == 1:
        return same[0]
    if same:
        raise InputError(f"{parameter} may be any of {', '.join(same)}")
    raise InputError(f"no comparison with a parameter {parameter} is known")


class _TrackStore:
    """The tracks of one table, so that many questions about a parameter make them once.

    They repeat the table's columns, so only those of small tables are kept.
    """

    def __init__(self) -> None:
        self._known: dict[str, tuple[Summaries, Track]] = {}
        self._rows = 0

    @classmethod
    def of(cls, events: Events) -> _TrackStore:
        """The one of this table, as long as the table exists."""
        return _STORES.setdefault(events, cls())

    def track(self, events: Events, summaries: Summaries, found: Comparison, tree: Tree) -> Track:
        """The track of a comparison."""
        known = self._known.get(found.key)
        if known is not None and known[0] is summaries and known[1].comparison is found:
            return known[1]
        made = _track(events, summaries, found, tree)
        self._rows += made.time_ns.size
        if self._rows <= _MOST_KEPT:
            self._known[found.key] = summaries, made
        return made


_STORES: WeakKeyDictionary[Events, _TrackStore] = WeakKeyDictionary()
_MOST_KEPT = 4_000_000


def _track(events: Events, summaries: Summaries, found: Comparison, tree: Tree) -> Track:
    rows = events.rows_of(found.key)
    time_ns, node = events.time_ns[rows], events.node[rows].astype(np.int64)
    result = events.result[rows]
    flops = _flops(result, node)
    kept = summaries.take(summaries.rows_of(found.key))
    return Track(
        found,
        tree,
        time_ns,
        events.cmp[rows],
        events.thresh[rows],
        result,
        events.res[rows],
        node,
        flops,
        time_ns[flops[:, 1]],
        kept,
        _not_in(kept, time_ns, node, events.nodes),
    )


def _flops(result: Bools, node: Int64s) -> Int64s:
    """int64[f, 2]: each flop's evaluation, behind the one before it in the same node."""
    if not node.size or not np.ptp(node):
        after = np.flatnonzero(result[1:] != result[:-1]) + 1
        return np.stack([after - 1, after], axis=1).astype(np.int64)
    order = np.argsort(node, kind="stable")
    before, after = order[:-1], order[1:]
    is_flop = (node[before] == node[after]) & (result[before] != result[after])
    pairs = np.stack([before[is_flop], after[is_flop]], axis=1).astype(np.int64)
    return pairs[np.argsort(pairs[:, 1], kind="stable")]


def _not_in(kept: Summaries, time_ns: Int64s, node: Int64s, nodes: Sequence[str]) -> Bools:
    """bool[n]: evaluations that no summary of their node counts."""
    own = np.ones(time_ns.size, dtype=np.bool_)
    begins = np.searchsorted(time_ns, kept.begin_ns - _SLACK_NS, side="left")
    ends = np.searchsorted(time_ns, kept.end_ns + _SLACK_NS, side="right")
    for code, name in enumerate(nodes):
        if name not in kept.nodes:
            continue
        # How many spans of this node hold each evaluation.
        theirs = (kept.node == kept.nodes.index(name)) & (begins < ends)
        steps = np.bincount(begins[theirs], minlength=time_ns.size + 1)
        steps = steps - np.bincount(ends[theirs], minlength=time_ns.size + 1)
        own &= (np.cumsum(steps)[:-1] == 0) | (node != code)
    return own
