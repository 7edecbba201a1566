"""Methods that look at no mark: what was changed last or most, what turns most, and chance.

Chance is exact: those that are drawn from are tied, and the judge counts the expected place.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pytpc.diagnosis.ranking.known_good import of_good_run, other_thresholds
from pytpc.diagnosis.ranking.replayed_outcomes import is_other
from pytpc.diagnosis.ranking.result_streams import ResultStreams
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.recording.parameter_change import Change
from pytpc.static.parameters import same_parameter
from pytpc_evaluation.study.case import Case, Verdict


def recent_change(case: Case) -> Verdict:
    """The parameter that was changed last is the most suspicious, then the one before it."""
    return _newest_first(case.changes, case)


def largest_change(case: Case) -> Verdict:
    """By the part of its value by which each was changed, the largest first.

    A treatment has to change enough to be seen: this says how much of a result with changes is the
    study's own making.
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


def turned_decisions(case: Case) -> Verdict:
    """By how many recorded results the value of the good run would have turned, the most first.

    Of the parameters that differ from it; all others, and all without a good run, are tied.
    """
    if case.reference is None:
        return Verdict(())
    tpcs, events = Tpcs.of(case.static_info), case.recording.events
    others = of_good_run(tpcs, events, case.reference.events)
    found: dict[str, int] = {}
    for stream in ResultStreams.of(events, tpcs).streams:
        key, name = tpcs.keys[stream.code], tpcs.names[stream.column]
        if key in others:
            relation = case.static_info.thresholds[key].relation
            other = other_thresholds(stream.thresh, others[key])
            turned = int(np.count_nonzero(is_other(relation, stream, other)))
            found[name] = found.get(name, 0) + turned
    order = sorted(found, key=lambda name: (-found[name], name))
    return Verdict(tuple(order), scores=tuple(float(found[name]) for name in order))


def differs_at_random(case: Case) -> Verdict:
    """Those that differ from the good run are tied before all others, and chance decides."""
    order = turned_decisions(case).order
    return Verdict(order, scores=(0.0,) * len(order))


def by_chance(_: Case) -> Verdict:
    """All are tied."""
    return Verdict(())
