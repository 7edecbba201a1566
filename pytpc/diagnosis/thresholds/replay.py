"""Evaluates the logged comparisons of one parameter again with other values of it.

The evaluations of each comparison are split by their outcome in the log. The number of each half
that a threshold would turn is how many compared values lie on one side of it: a binary search in
sorted values for several thresholds, or one pass over them for a single one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pytpc.base.columns import Bools, Floats, Int64s
from pytpc.base.errors import InputError
from pytpc.diagnosis.thresholds.inverse import kept_as
from pytpc.diagnosis.thresholds.threshold_sets import outcomes
from pytpc.diagnosis.thresholds.units import NoUnitError, is_text, read_type, tree_of
from pytpc.recording.events import Events
from pytpc.recording.summaries import Summaries
from pytpc.static.arithmetic import Tree, evaluate
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import parameter_name, same_parameter
from pytpc.static.static_info import StaticInfo

_FEW = 3
_SLACK_NS = 100_000_000


@dataclass(frozen=True)
class Track:
    """The evaluations of one TPC, in the order of time.

    ``time_ns`` int64[n], ``cmp`` and ``thresh`` float64[n], ``result``, ``res`` bool[n], ``node``
    int64[n] are as in the events; ``flops`` int64[f, 2] are places in these, of the evaluation
    before and that of each flop, which is at ``flop_ns`` int64[f]. ``kept`` are the summaries of
    the TPC; ``own`` bool[n] is False for what is counted in one of them.
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

    def thresholds(self, values: Floats) -> Floats:
        """float64[v]: the thresholds that values of the parameter give."""
        return np.array([evaluate(self.tree, float(value)) for value in values])

    def other(self, rows: slice | Int64s | Bools, threshold: float) -> Bools:
        """bool[rows]: whether the outcome would be another with ``threshold``."""
        cmp, thresh = self.cmp[rows], self.thresh[rows]
        if self.comparison.relation == "flag":
            return np.asarray(self._flag(rows, threshold) != self.res[rows], dtype=np.bool_)
        relation = self.comparison.relation
        before = outcomes(relation, cmp, thresh)
        return np.asarray(before != outcomes(relation, cmp, threshold), dtype=np.bool_)

    def _flag(self, rows: slice | Int64s | Bools, threshold: float) -> Bools:
        """Outcomes of a flag; of a switch those of the log where it had this value."""
        res = self.res[rows]
        if bool(np.all(self.res == (self.thresh != 0))):
            return np.full(res.shape, threshold != 0)
        same = self.thresh == threshold
        if not np.any(same):
            return res
        return np.full(res.shape, bool(self.res[same][-1]))

    def turned(self, rows: slice | Int64s | Bools, thresholds: Floats) -> Int64s:
        """int64[v]: how many of ``rows`` would have another outcome, for each threshold."""
        if thresholds.size <= _FEW or self.comparison.relation == "flag":
            return np.array(
                [np.count_nonzero(self.other(rows, one)) for one in thresholds.tolist()]
            )
        relation = self.comparison.relation
        cmp = self.cmp[rows]
        went = outcomes(relation, cmp, self.thresh[rows])
        finite = ~np.isnan(cmp)
        true, false = np.sort(cmp[went & finite]), np.sort(cmp[~went & finite])
        return (true.size - _holding(true, relation, thresholds)) + _holding(
            false, relation, thresholds
        )

    def turned_kept(self, rows: Bools, threshold: float) -> tuple[int, int]:
        """How many evaluations of the summaries ``rows`` would turn: for certain, and at most.

        Of one whose evaluations went both ways, before or then, only the ends are known.
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
        # One end at least turns where only one of the two is mixed.
        some = np.where(sure, 0, np.where(all_before | all_after, 1, 0))
        most = np.where(sure, whole, np.where(all_before | all_after, size - 1, size))
        return int((whole + some).sum()), int(most.sum())

    def _kept_flags(self, kept: Summaries, value: bool) -> tuple[int, int]:
        """The same of a flag, whose extremes are two of its values; of a switch nothing is known.

        What lies between a negative and a positive value may be 0.
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

    def turned_near(self, near: Bools, thresholds: Floats) -> tuple[Int64s, Int64s]:
        """int64[v] each: how many of ``near``, and of all, would turn; without those summed up."""
        if thresholds.size > _FEW and self.comparison.relation != "flag":
            return self.turned(self.own & near, thresholds), self.turned(self.own, thresholds)
        counts = []
        for threshold in thresholds.tolist():
            turned = self.other(slice(None), threshold) & self.own
            counts.append((np.count_nonzero(turned & near), np.count_nonzero(turned)))
        both = np.array(counts, dtype=np.int64).reshape(-1, 2)
        return both[:, 0], both[:, 1]

    def flop_before(self, mark_ns: int) -> Int64s | None:
        """int64[2]: the places of the last flop up to a mark; None where there is none."""
        count = int(np.searchsorted(self.flop_ns, mark_ns, side="right"))
        return self.flops[count - 1] if count else None

    def rows_between(self, begin_ns: int, end_ns: int) -> slice:
        """The evaluations of a closed span."""
        first = int(np.searchsorted(self.time_ns, begin_ns, side="left"))
        return slice(first, int(np.searchsorted(self.time_ns, end_ns, side="right")))


def _holding(cmps: Floats, relation: str, thresholds: Floats) -> Int64s:
    """int64[v]: for how many of the sorted ``cmps`` the relation holds, for each threshold."""
    below = np.searchsorted(cmps, thresholds, side="left")
    up_to = np.searchsorted(cmps, thresholds, side="right")
    counts = {
        "<": below,
        "<=": up_to,
        ">": cmps.size - up_to,
        ">=": cmps.size - below,
        "==": up_to - below,
        "!=": cmps.size - (up_to - below),
    }[relation]
    none = np.isnan(thresholds)
    return np.where(none, cmps.size if relation == "!=" else 0, counts)


def tracks_of(
    events: Events, summaries: Summaries, static_info: StaticInfo, parameter: str
) -> tuple[str, list[Track], list[str]]:
    """The evaluations of all TPCs of a parameter.

    Returns:
        The parameter's name in the source, the tracks of its TPCs that the log has and that can be
        replayed, and for each that cannot why.

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
        track = _track(events, summaries, found, tree)
        if track.time_ns.size or len(track.kept):
            tracks.append(track)
    return name, tracks, without


def _name_of(static_info: StaticInfo, parameter: str) -> str:
    names = sorted({parameter_name(found) for found in static_info.thresholds.values()})
    if parameter in names:
        return parameter
    same = [name for name in names if same_parameter(parameter, name)]
    if len(same) == 1:
        return same[0]
    if same:
        raise InputError(f"{parameter} may be any of {', '.join(same)}")
    raise InputError(f"no comparison with a parameter {parameter} is known")


def _track(events: Events, summaries: Summaries, found: Comparison, tree: Tree) -> Track:
    code = events.keys.index(found.key) if found.key in events.keys else -1
    # The index of all keys is worth its sorting only where it is there already.
    if code >= 0 and "by_key" in vars(events):
        rows = events.by_key.rows(code)
    else:
        rows = np.flatnonzero(events.key == code)
    time_ns, node = events.time_ns[rows], events.node[rows].astype(np.int64)
    result = events.result[rows]
    flops = _flops(result, node)
    kept_code = summaries.keys.index(found.key) if found.key in summaries.keys else -1
    kept = summaries.take(summaries.key == kept_code)
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
    """int64[f, 2]: the evaluation before in the same node, and that of each flop, by the latter."""
    if not node.size or not np.ptp(node):
        after = np.flatnonzero(result[1:] != result[:-1]) + 1
        return np.stack([after - 1, after], axis=1).astype(np.int64)
    order = np.argsort(node, kind="stable")
    before, after = order[:-1], order[1:]
    is_flop = (node[before] == node[after]) & (result[before] != result[after])
    pairs = np.stack([before[is_flop], after[is_flop]], axis=1).astype(np.int64)
    return pairs[np.argsort(pairs[:, 1], kind="stable")]


def _not_in(kept: Summaries, time_ns: Int64s, node: Int64s, nodes: Sequence[str]) -> Bools:
    """bool[n]: evaluations that no summary of their node has counted."""
    own = np.ones(time_ns.size, dtype=np.bool_)
    for row in range(len(kept)):
        name = kept.nodes[kept.node[row]]
        inside = (time_ns >= kept.begin_ns[row] - _SLACK_NS) & (
            time_ns <= kept.end_ns[row] + _SLACK_NS
        )
        codes = [code for code, other in enumerate(nodes) if other == name]
        own &= ~(inside & np.isin(node, codes))
    return own
