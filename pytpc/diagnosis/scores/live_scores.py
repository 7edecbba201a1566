"""The scores of the thesis while a mission runs: the same numbers as offline, at every instant.

What is kept are the evaluations of the window and of some seconds more, of each comparison in each
node (a stream); what is older is counted: flops, the last of them, and the extremes of the values.
So memory is bounded by the window, whatever the length of the mission. The scores are worked out by
the very functions of `pytpc.diagnosis.scores.scores` and `pytpc.diagnosis.scores.summary_scores`,
from what is kept and what was counted (`pytpc.diagnosis.scores.scores.Before`).

LogTables may come in any order between nodes: every stream has its own newest time. Within a stream
one may come up to ``LATE_S`` after a newer one, and is put where it belongs. What is older still
than all that is kept cannot be put anywhere any more: it is left out, and counted in ``late``. A
clock that was put back (a simulation that began again) makes everything late: begin with a new
object then.

The cost of a report does not depend on how many there were, that of scores on what the window has.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from pytpc.diagnosis.question import PLAIN, WINDOW_S, Question
from pytpc.diagnosis.ranking.mark_ranking import Ranker
from pytpc.diagnosis.results.suspects import Evaluation, MarkRanking
from pytpc.diagnosis.scores.live_streams import AGAIN, EventStream, Rows, SummaryStream, end_of
from pytpc.diagnosis.scores.score_tables import Tpcs, TpcScores, parameter_tables, tpc_scores
from pytpc.diagnosis.scores.scores import NEVER, Before, not_negative
from pytpc.diagnosis.scores.summary_scores import LogTables
from pytpc.recording.events import Events, Floats
from pytpc.recording.marks import Mark
from pytpc.recording.summaries import Summaries, Summary
from pytpc.static.static_info import StaticInfo

LATE_S = 10.0
"""How much later than a newer one of its stream a report may come; how far back a mark may lie."""

# Longer than a summary and a report of it may be apart, see ``covered``.
_SUMMARY_SLACK_NS = 1_000_000_000
_MOST_UNKNOWN = 1000


class TooOldError(ValueError):
    """Scores were asked for at a time whose window was forgotten in part."""


class LiveScores:
    """Both scores of every comparison, from reports as they come.

    ``late`` counts the reports that came too late to count. ``unknown`` has the reports of keys
    that are not among ``keys``, of the first thousand of these.
    """

    def __init__(
        self,
        keys: Sequence[str],
        distance: npt.ArrayLike,
        window_s: float = WINDOW_S,
        *,
        late_s: float = LATE_S,
    ) -> None:
        """Start with none.

        Args:
            keys: the n comparisons.
            distance: float64[n], theirs.
            window_s: the window of type II in seconds.
            late_s: how much later than a newer one a report may come.

        Raises:
            ValueError: ``distance`` is not one number for each key, a key is there twice, or a time
                is negative.
        """
        not_negative(window_s=window_s, late_s=late_s)
        distances = np.asarray(distance, dtype=np.float64)
        if distances.shape != (len(keys),):
            raise ValueError("one distance for each key is needed")
        if len(set(keys)) != len(keys):
            raise ValueError("a key is there twice")
        self.tpcs = Tpcs(tuple(keys), distances, tuple(keys))
        self.window_s = window_s
        self.late = 0
        self.unknown: Counter[str] = Counter()
        self.first_ns: dict[str, int] = {}
        self.last_ns = NEVER
        self._codes = {key: code for code, key in enumerate(keys)}
        self._window_ns = round(window_s * 1e9)
        self._keep_ns = self._window_ns + round(late_s * 1e9)
        self._again_ns = round(self._keep_ns * AGAIN)
        self._number = 0
        # By key and node.
        self._streams: dict[str, dict[str, EventStream]] = {key: {} for key in keys}
        self._summaries: dict[str, dict[str, SummaryStream]] = {key: {} for key in keys}

    # One argument for each column of an event: this is called thousands of times a second.
    def add(  # noqa: PLR0913, PLR0917
        self,
        time_ns: int,
        key: str,
        node: str,
        result: bool,
        cmp: float,
        thresh: float,
        res: bool,
    ) -> None:
        """Take in a report."""
        streams = self._streams.get(key)
        if streams is None:
            self._count_unknown(key)
            return
        stream = streams.get(node)
        if stream is None:
            stream = streams[node] = EventStream()
            stream.look_ns = time_ns + self._keep_ns + self._again_ns
        self._number += 1
        times = stream.times
        if times and time_ns < times[-1]:
            if not stream.insert((time_ns, self._number, result, cmp, thresh, res)):
                self.late += 1
                return
        else:
            times.append(time_ns)
            stream.numbers.append(self._number)
            stream.results.append(result)
            stream.cmps.append(cmp)
            stream.threshs.append(thresh)
            stream.ress.append(res)
            if time_ns > stream.look_ns:
                stream.look_ns = time_ns + self._again_ns
                stream.forget(time_ns - self._keep_ns)
        self._saw(key, time_ns, time_ns)

    def add_summary(self, summary: Summary) -> None:
        """Take in a summary (policy ``edges``)."""
        if summary.key not in self._summaries:
            self._count_unknown(summary.key)
            return
        stream = self._summaries[summary.key].setdefault(summary.node, SummaryStream())
        stream.add(summary, self._keep_ns + _SUMMARY_SLACK_NS)
        self._saw(summary.key, min(summary.begin_ns, summary.end_ns), end_of(summary))

    def scores_at(self, mark_ns: int) -> tuple[Floats, Floats]:
        """Both scores at one time, of all that was added and is not later.

        Returns:
            float64[n] each: what ``type1`` and ``type2`` (``type2_of_summaries`` for keys with
            summaries) give for the table of all that was added.

        Raises:
            TooOldError: more than ``late_s`` of a stream has come after that time, so that its
                window is not kept any more.
        """
        before = Before.nothing(len(self.tpcs.keys))
        events = self._events(mark_ns, before)
        summaries = self._kept_summaries(mark_ns, before)
        reports = LogTables(events, summaries, before)
        scores = tpc_scores(self.tpcs, reports, mark_ns, self.window_s)
        return scores.first[0], scores.second[0]

    def last(self, key: str, mark_ns: int) -> Evaluation:
        """The last evaluation of a key up to a time, of those that are kept.

        Raises:
            KeyError: nothing was reported of it.
        """
        found = []
        for node, stream in self._streams[key].items():
            place = max(0, bisect_right(stream.times, mark_ns) - 1)
            found.append((stream.times[place], stream.numbers[place], stream, place, node))
        rows = [row for row in found if row[0] <= mark_ns]
        evaluations = [_evaluation(*(max(rows) if rows else min(found))[2:])] if found else []
        ended = [one for stream in self._summaries[key].values() for one in stream.kept]
        evaluations += [_last_of(one) for one in sorted(ended, key=lambda one: one.end_ns)]
        if not evaluations:
            raise KeyError(key)
        before = [one for one in evaluations if one.time_ns <= mark_ns]
        return max(before) if before else min(evaluations)

    def reported_ns(self, mark_ns: int) -> int | None:
        """When anything was evaluated last up to a time, None where nothing was that is known."""
        times: list[int] = []
        for streams in self._streams.values():
            for stream in streams.values():
                place = bisect_right(stream.times, mark_ns)
                times += stream.times[place - 1 : place] if place else []
        for summaries in self._summaries.values():
            for kept in summaries.values():
                begun = (one for one in kept.kept if one.begin_ns <= mark_ns)
                times += [min(mark_ns, one.end_ns) for one in begun]
        return max(times, default=None)

    def _saw(self, key: str, first_ns: int, last_ns: int) -> None:
        if first_ns < self.first_ns.get(key, 2**63):
            self.first_ns[key] = first_ns
        self.last_ns = max(self.last_ns, last_ns)

    def _count_unknown(self, key: str) -> None:
        if key in self.unknown or len(self.unknown) < _MOST_UNKNOWN:
            self.unknown[key] += 1

    def _events(self, mark_ns: int, before: Before) -> Events:
        """What is kept, but for streams that began after the mark; the rest goes to ``before``."""
        parts: list[Rows] = []
        words: list[tuple[int, str]] = []
        every = [(key, *item) for key, found in self._streams.items() for item in found.items()]
        for key, node, stream in every:
            code, counted = self._codes[key], stream.counted
            rows = stream.rows()
            if counted.count:
                if counted.first_ns > mark_ns:
                    continue
                self._check_kept(int(rows.time_ns[0]), mark_ns, key)
                stands = bool(np.isfinite(rows.cmp[0]) and np.isfinite(rows.thresh[0]))
                before.flops[code] += counted.flops
                before.last_flop_ns[code] = max(before.last_flop_ns[code], counted.last_flop_ns)
                before.finite[code] += counted.finite - stands
                before.highest[code] = max(before.highest[code], counted.highest)
                before.lowest[code] = min(before.lowest[code], counted.lowest)
            parts.append(rows)
            words.append((code, node))
        return _table(parts, words, self.tpcs.keys)

    def _kept_summaries(self, mark_ns: int, before: Before) -> Summaries:
        kept: list[Summary] = []
        every = [(key, stream) for key, of in self._summaries.items() for stream in of.values()]
        for key, stream in every:
            if stream.forgotten_ns > NEVER:
                if stream.first_ns > mark_ns + _SUMMARY_SLACK_NS:
                    continue
                self._check_kept(stream.forgotten_ns + _SUMMARY_SLACK_NS, mark_ns, key)
                code = self._codes[key]
                before.highest[code] = max(before.highest[code], stream.highest)
                before.lowest[code] = min(before.lowest[code], stream.lowest)
            kept += stream.kept
        return Summaries.of_rows(kept)

    def _check_kept(self, forgotten_ns: int, mark_ns: int, key: str) -> None:
        if forgotten_ns >= mark_ns - self._window_ns:
            raise TooOldError(f"the window before this time is forgotten in part (of {key})")


def _table(parts: list[Rows], words: list[tuple[int, str]], keys: Sequence[str]) -> Events:
    """Events in the order in which they were added; ``words`` of each part."""
    if not parts:
        return Events.empty(keys)
    nodes = sorted({node for _, node in words})
    sizes = [part.time_ns.size for part in parts]
    rows = Rows(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
    order = np.lexsort((rows.number, rows.time_ns))
    places = {node: place for place, node in enumerate(nodes)}
    return Events.of(
        time_ns=rows.time_ns[order],
        key=np.repeat([code for code, _ in words], sizes)[order],
        result=rows.result[order],
        cmp=rows.cmp[order],
        thresh=rows.thresh[order],
        res=rows.res[order],
        node=np.repeat([places[node] for _, node in words], sizes)[order],
        keys=keys,
        nodes=nodes,
    )


def _evaluation(stream: EventStream, place: int, node: str) -> Evaluation:
    return Evaluation(
        stream.times[place],
        bool(stream.results[place]),
        stream.cmps[place],
        stream.threshs[place],
        bool(stream.ress[place]),
        node,
    )


def _last_of(one: Summary) -> Evaluation:
    return Evaluation(one.end_ns, one.result, one.cmp, one.thresh, one.res, one.node)


class LiveRanking:
    """The suspects at any instant of a mission that runs.

    ``scores`` takes the reports in (`LiveScores.add`, `LiveScores.add_summary`); reports of keys
    that are not comparisons with parameters are counted in its ``unknown``.
    """

    def __init__(self, static_info: StaticInfo, question: Question = PLAIN) -> None:
        """Start without a report.

        Args:
            static_info: what the analysis found.
            question: its ``types`` and ``window_s``, as for `rank_marks`.
        """
        self._tpcs = Tpcs.of(static_info)
        self.scores = LiveScores(self._tpcs.keys, self._tpcs.distance, question.window_s)
        self._ranker = Ranker(static_info, self._tpcs, self.scores, question)

    def ranking_at(self, mark: Mark) -> MarkRanking:
        """What `rank_marks` gives for a mark in a recording of all that was added so far.

        Where the mark is older than what is kept, there is not enough evidence any more.
        """
        return self.rankings_at(mark.time_ns, [mark])[0]

    def rankings_at(self, mark_ns: int, marks: Sequence[Mark]) -> list[MarkRanking]:
        """The same for several marks of one time, whose scores are worked out once."""
        try:
            first, second = self.scores.scores_at(mark_ns)
        except TooOldError:
            reason = f"the mark is more than {LATE_S:g} s older than the newest reports"
            return [MarkRanking(one, (), len(self._tpcs.names), False, reason) for one in marks]
        tables = parameter_tables(self._tpcs, TpcScores(first[np.newaxis], second[np.newaxis]))
        return [self._ranker.ranking(mark, tables, 0) for mark in marks]
