"""Methods that look at no log: what was changed last, what was changed most, and chance."""

from __future__ import annotations

import hashlib
import random
from collections.abc import Sequence

from pytpc.changes import Change
from pytpc.parameters import same_parameter
from pytpc.scoring.tables import Tpcs
from pytpc.study.case import Case, Verdict


def recent_change(case: Case) -> Verdict:
    """The parameter that was changed last is the most suspicious, then the one before it."""
    return _newest_first(case.changes, case)


def largest_change(case: Case) -> Verdict:
    """By the part of its value by which each was changed, the largest first.

    The study's harmless changes are of 3 %, and a treatment has to change more to be seen: this
    says how much of a result with changes is the study's own making.
    """

    def part(change: Change) -> float:
        return abs(change.new - change.old) / max(abs(change.old), abs(change.new), 1e-300)

    return _newest_first(sorted(case.changes, key=part), case)


def _newest_first(changes: Sequence[Change], case: Case) -> Verdict:
    order: list[str] = []
    names = Tpcs.of(case.static_info).names
    for change in reversed(changes):
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
