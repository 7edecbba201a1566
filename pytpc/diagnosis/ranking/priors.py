"""What is known of the parameters beside the log: which of them have changed.

A parameter that kept the value with which the robot went right is unlikely to be the cause. The
size of a change does not count: what is a large change differs from one parameter to the next (in
the study, whose harmless changes are as large as the others, ``largest-change`` is no better than
chance).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from pytpc.base.columns import Floats
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.recording.events import Events
from pytpc.recording.parameter_change import Change
from pytpc.static.parameters import same_parameter

UNCHANGED = -12.0
"""The log odds of a parameter that is as it was; not less, as what is on record may be wrong, and
the robot may be elsewhere than where that value was right."""


def of_changes(names: Sequence[str], changes: Iterable[Change]) -> Floats:
    """float64[p], the log prior of each name; 0 where nothing is known to be changed."""
    found = list(changes)
    if not found:
        return np.zeros(len(names))
    prior = np.full(len(names), UNCHANGED)
    for change in found:
        for column, name in enumerate(names):
            if same_parameter(change.parameter, name):
                prior[column] = max(prior[column], of_change(change.old, change.new))
    return prior


def of_reference(tpcs: Tpcs, events: Events, reference: Events) -> Floats:
    """float64[p], the log prior of each parameter, from the thresholds of a good run.

    A parameter none of whose comparisons was evaluated in both, or that changed while the robot
    ran, is between: nothing is known of it.
    """
    here, there = thresholds_of(events, tpcs), thresholds_of(reference, tpcs)
    prior: dict[str, float] = {}
    for now, then, name in zip(here, there, tpcs.parameters, strict=True):
        if np.isnan(now) or np.isnan(then):
            continue
        prior[name] = max(prior.get(name, UNCHANGED), of_change(then, now))
    known = np.array([prior.get(name, np.nan) for name in tpcs.names])
    return np.where(np.isnan(known), UNCHANGED / 2, known)


def of_change(old: float, new: float) -> float:
    """The log odds of a parameter that was ``old`` and is ``new``."""
    return UNCHANGED if old == new else 0.0


def thresholds_of(events: Events, tpcs: Tpcs) -> Floats:
    """float64[n]: the threshold of each comparison, nan where it has none or several."""
    own = events.with_keys(tpcs.keys)
    found = np.full(len(tpcs.keys), np.nan)
    for code in range(len(tpcs.keys)):
        values = own.thresh[own.by_key.rows(code)]
        if values.size and np.isfinite(values[0]) and bool(np.all(values == values[0])):
            found[code] = values[0]
    return found
