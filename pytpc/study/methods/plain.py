"""Two methods that look at no log: what was changed last, and chance."""

from __future__ import annotations

import hashlib
import random

from pytpc.parameters import same_parameter
from pytpc.scoring.tables import Tpcs
from pytpc.study.case import Case, Verdict


def recent_change(case: Case) -> Verdict:
    """The parameter that was changed last is the most suspicious, then the one before it."""
    order: list[str] = []
    names = Tpcs.of(case.static_info).names
    for change in reversed(case.changes):
        order += [
            name for name in names if name not in order and same_parameter(change.parameter, name)
        ]
    return Verdict(tuple(order))


def by_chance(case: Case) -> Verdict:
    """Any order, drawn anew for each mission and set of marks; the same for the same."""
    marks = [(mark.time_ns, mark.observer, mark.type) for mark in case.recording.marks]
    drawn = hashlib.sha256(repr((case.recording.name, case.recording.end_ns, marks)).encode())
    order = list(Tpcs.of(case.static_info).names)
    random.Random(drawn.digest()).shuffle(order)
    return Verdict(tuple(order))
