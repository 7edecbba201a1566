"""The scores of the thesis while a mission runs: the same numbers as offline, at every instant.

Each comparison in each node is a stream. It keeps the evaluations of the window and of some seconds
before it. Older ones are only counted: the flops, the last flop, and the extremes of the values. So
the window bounds the memory, not the length of the mission. The functions of
`pytpc.diagnosis.scores.scores` and `pytpc.diagnosis.scores.summary_scores` compute the scores from
what is kept and what was counted (`pytpc.diagnosis.scores.scores.Before`).

Reports of different nodes may arrive in any order. Within a stream a report may be up to ``LATE_S``
older than the newest one, and is put where it belongs. One that is older than all that is kept is
left out and counted in ``late``. After the clock was set back (a simulation started again)
everything would be late: start with a new object.

The cost of a report does not depend on how many there were; that of scores depends on the window.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from pytpc.diagnosis.question import PLAIN, WINDOW_S, Question
from pytpc.diagnosis.ranking.mark_ranking import Ranker
from pytpc.diagnosis.results.suspects import Evaluation, MarkRanking
from pytpc.diagnosis.scores.live_streams import AGAIN, EventStream, Rows, SummaryStream
from pytpc.diagnosis.scores.score_tables import Tpcs, TpcScores, parameter_tables, tpc_scores
from pytpc.diagnosis.scores.scores import NEVER, Before, not_negative
from pytpc.diagnosis.scores.summary_scores import LogTables
from pytpc.recording.events import Events, Floats
from pytpc.recording.marks import Mark
from pytpc.recording.summaries import Summaries, Summary
from pytpc.static.static_info import StaticInfo

LATE_S = 10.0
"""How much older than the newest of its stream a report may be; how far back a mark may be."""

# Longer than a summary and a report of it may be apart, see ``covered``.
_SUMMARY_SLACK_NS = 1_000_000_000


class TooOldError(ValueError):
    """A part of the window before this time is forgotten."""


class LiveScores:
    """Both scores of every comparison, from reports as they come.

    ``late`` counts the reports that came too late to count. Reports of other keys are left out.
    """

    def __init__(
        self,
        keys: Sequence[str],
        distance: npt.ArrayLike,
        window_s: float = WINDOW_S,
        *,
        late_s: float = LATE_S,
    ) -> None:
        """Start without a report.

        Args:
            keys: the n comparisons.
            distance: float64[n], theirs.
            window_s: the window of type II in seconds.
            late_s: how much older than the newest one a report may be.

        Raises:
            ValueError: ``distance`` is not one number for each key, a key stands twice, or a time
                is negative.
        """
        not_negative(window_s=window_s, late_s=late_s)
        distances = np.asarray(distance, dtype=np.float64)
        if distances.shape != (len(keys),):
            raise ValueError("one distance for each key is needed")
        if len(set(keys)) != len(keys):
            raise ValueError("a key is there twice")
        self.window_s = window_s
        self.late = 0
        self.first_ns: dict[str, int] = {}
        self._window_ns = round(window_s * 1e9)
        self._keep_ns = self._window_ns + round(late_s * 1e9)
        self._again_ns = round(self._keep_ns * AGAIN)
        self._number = 0
        # By key and node.
        self._streams: dict[str, dict[str, EventStream]] = {}
        self._summaries: dict[str, dict[str, SummaryStream]] = {}
        self.learn(keys, distances)

    def learn(self, keys: Sequence[str], distances: Floats) -> None:
        """Make these the comparisons; known ones keep their reports."""
        self.tpcs = Tpcs(tuple(keys), distances, tuple(keys))
        self._codes = {key: code for code, key in enumerate(keys)}
        self._streams = {key: self._streams.get(key, {}) for key in keys}
        self._summaries = {key: self._summaries.get(key, {}) for key in keys}

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
        self._saw(key, time_ns)

    def add_summary(self, summary: Summary) -> None:
        """Take in a summary (policy ``edges``)."""
        if summary.key not in self._summaries:
            return
        stream = self._summaries[summary.key].setdefault(summary.node, SummaryStream())
        stream.add(summary, self._keep_ns + _SUMMARY_SLACK_NS)
        self._saw(summary.key, min(summary.begin_ns, summary.end_ns))

    def scores_at(self, mark_ns: int) -> tuple[Floats, Floats]:
        """Both scores at one time, from the reports up to then.

        Returns:
            float64[n] each: what ``type1`` and ``type2`` (``type2_of_summaries`` for keys with
            summaries) give for the table of all that was added.

        Raises:
            TooOldError: a stream has reports more than ``late_s`` after that time, so its window is
                no longer kept.
        """
        before = Before.nothing(len(self.tpcs.keys))
        events = self._events(mark_ns, before)
        summaries = self._kept_summaries(mark_ns, before)
        reports = LogTables(events, summaries, before)
        scores = tpc_scores(self.tpcs, reports, mark_ns, self.window_s)
        return scores.first[0], scores.second[0]

    def last(self, key: str, mark_ns: int) -> Evaluation:
        """The last kept evaluation of a key up to a time.

        Raises:
            KeyError: it was never reported.
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
        """When the last kept evaluation up to a time was; None if there is none."""
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

    def _saw(self, key: str, first_ns: int) -> None:
        if first_ns < self.first_ns.get(key, 2**63):
            self.first_ns[key] = first_ns

    def _events(self, mark_ns: int, before: Before) -> Events:
        """What is kept of streams that began by the mark; what was counted goes to ``before``."""
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
    """The suspects at any instant of a running mission.

    ``scores`` takes the reports in (`LiveScores.add`, `LiveScores.add_summary`); reports of keys
    that are not comparisons with parameters are left out.
    """

    def __init__(self, static_info: StaticInfo, question: Question = PLAIN) -> None:
        """Start without a report.

        Args:
            static_info: what the analysis found.
            question: its ``types`` and ``window_s``, as for `rank_marks`.
        """
        self._question = question
        self._tpcs = Tpcs.of(static_info)
        self.scores = LiveScores(self._tpcs.keys, self._tpcs.distance, question.window_s)
        self._ranker = Ranker(static_info, self._tpcs, self.scores, question)

    def learn(self, static_info: StaticInfo) -> None:
        """Go on with more or renamed comparisons; known ones keep their reports."""
        self._tpcs = Tpcs.of(static_info)
        self.scores.learn(self._tpcs.keys, self._tpcs.distance)
        self._ranker = Ranker(static_info, self._tpcs, self.scores, self._question)

    def ranking_at(self, mark: Mark) -> MarkRanking:
        """What `rank_marks` would give for a mark in a recording of all reports so far.

        For a mark older than what is kept, the ranking says that there is not enough evidence.
        """
        return self.rankings_at(mark.time_ns, [mark])[0]

    def rankings_at(self, mark_ns: int, marks: Sequence[Mark]) -> list[MarkRanking]:
        """The same for several marks of one time; their scores are computed once."""
        try:
            first, second = self.scores.scores_at(mark_ns)
        except TooOldError:
            reason = f"the mark is more than {LATE_S:g} s older than the newest reports"
            return [MarkRanking(one, (), len(self._tpcs.names), False, reason) for one in marks]
        tables = parameter_tables(self._tpcs, TpcScores(first[np.newaxis], second[np.newaxis]))
        return [self._ranker.ranking(mark, tables, 0) for mark in marks]
