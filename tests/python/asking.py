"""Asks for a suggestion about a small mission that is written out in rows."""

from __future__ import annotations

import operator

from mission_samples import comparison, events, ns

from pytpc.diagnosis.suggestion.suggest import suggest

OPERATORS = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}


def ask(rows, kind, relation=">", at=100.0, **changes):
    """The suggestion at ``at``; rows are (s, cmp, thresh) and results follow from the relation."""
    window = changes.pop("window_s", 12.0)
    unit = changes.pop("unit", None)
    found = comparison(0, "limit", relation, **changes)
    compare = (lambda cmp, _: cmp != 0) if relation == "flag" else OPERATORS[relation]
    table = events([(t, 0, compare(cmp, thresh), cmp, thresh) for t, cmp, thresh in rows])
    return suggest(table, found, ns(at), kind, window_s=window, unit=unit)
