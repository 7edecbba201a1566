"""The suspects at each mark of a mission: parameters, most suspicious first.

``rank_marks`` is the entrance. TPCs with a constant threshold are left out. A parameter has its
name in the source; if that is not a constant, its place is its name.

How far the observer's type is believed (``Types``):

- ``believe``: the score of the mark's type orders the parameters.
- ``ignore``: a parameter's rank is the better one of its two ranks.
- ``doubt``: the better one, too, but the rank by the other type is multiplied by ``DOUBT``: the
  probability that the observer meant the other type, by table 6.13 of the thesis, if both types
  were as likely before. 2 of the 17 marks on the type I treatment were of type I, and 26 of the 51
  on the type II treatment. So after a mark of type I, type II has
  26/51 / (26/51 + 2/17) = 26/32, and after one of type II, type I has
  15/17 / (15/17 + 25/51) = 45/70. The first suspect by the given type stays first; the first by the
  other type comes below it, higher if a confusion is likelier. A weight of 0 is ``believe``, a
  weight of 1 is ``ignore``.

Equal better ranks are ordered by the other rank. A mark without a type is ranked by both. These are
baselines (docs/reference/scores.md#when-the-type-may-be-wrong).
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from pytpc.diagnosis.question import PLAIN, WINDOW_S, Question
from pytpc.diagnosis.results.suspects import MarkRanking, Suspect
from pytpc.diagnosis.scores.evaluations import Evaluations, LoggedEvaluations
from pytpc.diagnosis.scores.score_tables import Tables, Tpcs, parameter_tables, tpc_scores
from pytpc.diagnosis.scores.scores import NONE, combined
from pytpc.diagnosis.scores.summary_scores import LogTables
from pytpc.recording.faults import CLOCKS_APART_NS
from pytpc.recording.marks import Mark, MarkType
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

DOUBT: dict[MarkType, float] = {"I": 26 / 32, "II": 45 / 70}
"""How probable the other type is after a mark of this one."""

FEWEST = 2
"""The fewest parameters that must have been evaluated up to the mark for a ranking."""


def rank_marks(
    recording: Recording, static_info: StaticInfo, question: Question = PLAIN
) -> list[MarkRanking]:
    """Rank the parameters at every mark.

    Args:
        recording: the mission. Keys that the static information does not know are left out;
            ``unknown_keys`` counts them.
        static_info: what the analysis found. All its TPCs and parameters count in n of the rank,
            even those that were never evaluated.
        question: its ``types`` and ``window_s``.

    Returns:
        One ranking for each mark, in the order of ``recording.marks``.
    """
    tpcs = Tpcs.of(static_info)
    events = recording.events.with_keys(tpcs.keys)
    marks_ns = np.array([mark.time_ns for mark in recording.marks], dtype=np.int64)
    reports = LogTables(events, recording.summaries)
    scores = tpc_scores(tpcs, reports, marks_ns, question.window_s)
    ranker = Ranker(static_info, tpcs, LoggedEvaluations(events, recording.summaries), question)
    tables = parameter_tables(tpcs, scores)
    return [ranker.ranking(mark, tables, row) for row, mark in enumerate(recording.marks)]


class _Ordered(NamedTuple):
    """A parameter in the order: its column, and what it is ordered by."""

    column: int
    type: MarkType
    rank: float
    order: tuple[float, ...]


@dataclass(frozen=True)
class Ranker:
    """Makes rankings out of tables of scores."""

    static_info: StaticInfo
    tpcs: Tpcs
    evidence: Evaluations
    question: Question = PLAIN

    def ranking(self, mark: Mark, tables: Tables, row: int) -> MarkRanking:
        """The ranking at ``mark``, whose scores are in ``row`` of the tables."""
        places = self._places(mark, tables, row)
        alike = Counter(place.order for place in places)
        suspects: list[Suspect] = []
        for number, place in enumerate(places, start=1):
            same = number > 1 and place.order == places[number - 2].order
            position = suspects[-1].position if same else number
            tied = alike[place.order] > 1
            suspect = self._suspect(mark, tables, row, place)
            suspects.append(replace(suspect, position=position, tied=tied))
        reason = self._reason(mark, suspects)
        return MarkRanking(mark, tuple(suspects), len(self.tpcs.names), not reason, reason)

    def _places(self, mark: Mark, tables: Tables, row: int) -> list[_Ordered]:
        """The parameters with a score, in order; ties by distance and name."""
        given = None if self.question.types == "ignore" else mark.type
        kind: MarkType = given or "I"
        other: MarkType = "II" if kind == "I" else "I"
        own = tables.of(kind)
        ranks, others = own.ranks[row], tables.of(other).ranks[row]
        if given is not None and self.question.types == "believe":
            scores = own.scores[row]
            places = [
                _Ordered(n, kind, float(ranks[n]), (float(scores[n]),))
                for n in np.flatnonzero(scores != NONE).tolist()
            ]
            distance = own.distance[row]
        else:
            weight = 1.0 if given is None else DOUBT[kind]
            better = combined(ranks, others, weight)
            both = ranks + weight * others
            places = [
                _Ordered(
                    n,
                    kind if ranks[n] >= weight * others[n] else other,
                    float(better[n]),
                    (-float(better[n]), -float(both[n])),
                )
                for n in np.flatnonzero(better > 0).tolist()
            ]
            distance = np.minimum(tables.first.distance[row], tables.second.distance[row])
        # The columns are in the order of the names.
        return sorted(places, key=lambda place: (place.order, distance[place.column], place.column))

    def _suspect(self, mark: Mark, tables: Tables, row: int, place: _Ordered) -> Suspect:
        """The suspect at a place of the order; its position is set later."""
        table, column = tables.of(place.type), place.column
        key = self.tpcs.keys[int(table.best[row, column])]
        parameter = table.names[column]
        seen = self.evidence.first_ns
        return Suspect(
            position=1,
            parameter=parameter,
            key=key,
            comparison=self.static_info.comparisons[key],
            type=place.type,
            score=float(table.scores[row, column]),
            rank=place.rank,
            keys=tuple(one for one in self.tpcs.keys_of[parameter] if one in seen),
            last=self.evidence.last(key, mark.time_ns),
            rank1=float(tables.first.ranks[row, column]),
            rank2=float(tables.second.ranks[row, column]),
        )

    def _reason(self, mark: Mark, suspects: list[Suspect]) -> str:
        """Why the evidence is not enough; empty if it is."""
        first = self.evidence.first_ns
        if not self.tpcs.keys:
            return "the static information has no comparison with a parameter"
        beyond = outside(mark, self.evidence, self.question.window_s)
        if beyond:
            return beyond
        evaluated = {
            name
            for key, name in zip(self.tpcs.keys, self.tpcs.parameters, strict=True)
            if key in first and first[key] <= mark.time_ns
        }
        if not suspects:
            return self._why_nobody(mark)
        if len(evaluated) < FEWEST:
            return f"only {suspects[0].parameter} had been compared up to the mark"
        if len(suspects) > 1 and suspects[-1].position == 1:
            return f"all {len(suspects)} parameters with a score have the same one"
        return ""

    def _why_nobody(self, mark: Mark) -> str:
        change = "no result had changed up to the mark"
        window = f"{self.question.window_s:g} s"
        near = f"nothing that ever had two different values was compared in the {window}"
        if self.question.types != "believe" or mark.type is None:
            return f"{change}, and {near} before it"
        return change if mark.type == "I" else f"{near} before the mark"


def outside(mark: Mark, evidence: Evaluations, window_s: float = WINDOW_S) -> str:
    """What is wrong with the time of a mark; empty if nothing is."""
    first = evidence.first_ns
    if not first:
        return "no comparison was reported"
    last = evidence.reported_ns(mark.time_ns)
    away = min(first.values()) - mark.time_ns if last is None else mark.time_ns - last
    if away > CLOCKS_APART_NS:
        return "the mark is on another clock than the reports"
    if last is None:
        return f"the mark is {_seconds(away)} before the first report"
    if away > window_s * 1e9:
        return f"the last report up to the mark is {_seconds(away)} before it"
    return ""


def _seconds(time_ns: int) -> str:
    seconds = time_ns / 1e9
    return f"{seconds:,.0f} s" if seconds >= 1000 else f"{seconds:.3g} s"
