"""Which values are known to be good: of good runs, and from before changes.

Each source gives a prior, the log odds of each parameter to be the cause, and the other thresholds
of those that differ, which are replayed (`pytpc.diagnosis.ranking.replayed_outcomes`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from pytpc.base.columns import Floats
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.thresholds.inverse import kept_as
from pytpc.diagnosis.thresholds.units import NoUnitError, is_text, read_type, tree_of
from pytpc.recording.events import Events
from pytpc.recording.parameter_change import Change
from pytpc.static.arithmetic import evaluate
from pytpc.static.parameters import ByParameter
from pytpc.static.static_info import StaticInfo

UNCHANGED = -12.0
"""The log odds of a parameter that kept the value with which the robot went right. Not less, as the
record may be wrong, and the robot may be at another place. The size of a change does not count:
what is a large change differs from one parameter to the next."""


def before_changes(
    static_info: StaticInfo, changes: Iterable[tuple[str, float]]
) -> dict[str, float]:
    """The threshold that each comparison, by its key, has with the old values of (parameter, old).

    Comparisons of text, and those with an unknown way from parameter to threshold, are left out.
    """
    found = {}
    named = [(key, one) for key, one in static_info.thresholds.items() if one.source is not None]
    every = ByParameter(named, lambda item: item[1].source or "")
    for parameter, old in changes:
        for key, comparison in every.meant(parameter):
            unit = static_info.unit_of(key)
            if is_text(comparison, unit):
                continue
            try:
                tree = kept_as(tree_of(comparison), read_type(comparison, unit))
            except NoUnitError:
                continue
            threshold = evaluate(tree, old)
            if not math.isnan(threshold):
                found[key] = threshold
    return found


def of_good_run(tpcs: Tpcs, events: Events, reference: Events) -> dict[str, float]:
    """The thresholds in a good run that differ, by the key of the comparison."""
    here, there = thresholds_of(events, tpcs), thresholds_of(reference, tpcs)
    differs = (here != there) & ~np.isnan(here) & ~np.isnan(there)
    return {tpcs.keys[code]: float(there[code]) for code in np.flatnonzero(differs)}


def of_changes(names: Sequence[str], changes: Iterable[Change]) -> Floats:
    """float64[p], the log odds of each name, by which of them were changed."""
    prior = np.full(len(names), UNCHANGED)
    columns = ByParameter(range(len(names)), lambda column: names[column])
    for change in changes:
        for column in columns.meant(change.parameter):
            prior[column] = max(prior[column], of_change(change.old, change.new))
    return prior


def of_references(tpcs: Tpcs, events: Events, references: Sequence[Events]) -> Floats:
    """float64[p], the log odds of each parameter, by the thresholds of good runs.

    A parameter kept its value if one of the runs had it. Nothing is known of one that changed
    during a run, or was not compared in the mission and in a good run: nan. Without other knowledge
    it gets half of ``UNCHANGED``.
    """
    here = thresholds_of(events, tpcs)
    prior: dict[str, float] = {}
    there = [thresholds_of(one, tpcs) for one in references]
    for code, name in enumerate(tpcs.parameters):
        known = [float(one[code]) for one in there if not np.isnan(one[code])]
        if np.isnan(here[code]) or not known:
            continue
        kept = min(of_change(then, float(here[code])) for then in known)
        prior[name] = max(prior.get(name, UNCHANGED), kept)
    return np.array([prior.get(name, np.nan) for name in tpcs.names])


def of_change(old: float, new: float) -> float:
    """The log odds of a parameter that was ``old`` and is ``new``."""
    return UNCHANGED if old == new else 0.0


def thresholds_of(events: Events, tpcs: Tpcs) -> Floats:
    """float64[n]: the threshold of each comparison; nan if it had none or several."""
    own = events.with_keys(tpcs.keys)
    found = np.full(len(tpcs.keys), np.nan)
    for code in range(len(tpcs.keys)):
        values = own.thresh[own.by_key.rows(code)]
        if values.size and np.isfinite(values[0]) and bool(np.all(values == values[0])):
            found[code] = values[0]
    return found
