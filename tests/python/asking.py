"""Asks for a suggestion about a small mission that is written out in rows."""

from __future__ import annotations

import operator
from dataclasses import replace

from mission_samples import comparison, events, link_unit, ns

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.suggestion.smallest_change import At, smallest_change
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries
from pytpc.static.static_info import StaticInfo

OPERATORS = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}


def suggested(table, found, at, kind, *, unit=None, summaries=None, declared=None, window_s=12.0):
    """The suggestion for one comparison at ``at`` s; ``unit`` has the reads of its link unit."""
    unit = replace(unit or link_unit([]), comparisons=(found,))
    log = Recording("m", table, (), 0, ns(200), summaries=summaries or Summaries.empty())
    question = Question(window_s=window_s).about(declared)
    return smallest_change(log, StaticInfo.of([unit]), found, At(ns(at), kind), question)


def ask(rows, kind, relation=">", at=100.0, **changes):
    """The suggestion at ``at``; rows are (s, cmp, thresh) and results follow from the relation."""
    window = changes.pop("window_s", 12.0)
    unit = changes.pop("unit", None)
    found = comparison(0, "limit", relation, **changes)
    compare = (lambda cmp, _: cmp != 0) if relation == "flag" else OPERATORS[relation]
    table = events([(t, 0, compare(cmp, thresh), cmp, thresh) for t, cmp, thresh in rows])
    return suggested(table, found, at, kind, window_s=window, unit=unit)
