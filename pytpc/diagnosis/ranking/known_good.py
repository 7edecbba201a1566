"""Which values are known to be good: of good runs, from before a change, and defaults in the code.

Each source gives a prior, the log odds of each parameter to be the cause, and the other thresholds
of those that differ, which are replayed (`pytpc.diagnosis.ranking.replayed_outcomes`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, TypeAlias

import numpy as np

from pytpc.base.columns import Floats
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.thresholds.inverse import kept_as
from pytpc.diagnosis.thresholds.units import NoUnitError, added_by, is_text, read_type, tree_of
from pytpc.recording.events import Events
from pytpc.recording.parameter_change import Change
from pytpc.static.arithmetic import Tree, evaluate
from pytpc.static.parameters import ByParameter
from pytpc.static.static_info import StaticInfo

UNCHANGED = -12.0
"""The log odds of a parameter that kept the value with which the robot went right. Not less, as the
record may be wrong, and the robot may be at another place. The size of a change does not count:
what is a large change differs from one parameter to the next."""

BETWEEN = -3.0
"""The same of one whose value lies between those of two good runs: what the robot did with either
is known, and a threshold acts in one direction. Not so for equality and flags."""

DEFAULT = -3.0
"""The same of one that has the default of its code. Not as little as ``UNCHANGED``, because a
default may not fit to this robot."""

SET_ANEW = 1.0
"""The same of one that was set anew while the mission ran: hardly any are, and a robot that went
right before goes wrong after it. By reason, the study has none."""

MOST_SETTINGS = 4
"""A threshold that changes so often in a node, or that gets a value again which it had before, is
worked out, or several objects have one of their own: it was not set."""

_ORDERED = frozenset({"<", "<=", ">", ">="})
_CLOSE = 1e-6
"""A default that the code computes, or keeps in a float, is the threshold up to this part."""


class Moved(NamedTuple):
    """The other threshold of a comparison whose threshold is worked out: so much greater."""

    by: float


class Instead(NamedTuple):
    """For thresholds now the other ones, as pairs; other objects and nodes may have other ones."""

    pairs: tuple[tuple[float, float], ...]


Other: TypeAlias = "float | Moved | Instead"
"""The other threshold of a comparison."""


def other_thresholds(thresholds: Floats, other: Other) -> Floats:
    """float64[n]: the other thresholds at the evaluations with these; nan where it is not known."""
    if isinstance(other, Moved):
        return thresholds + other.by
    if isinstance(other, Instead):
        found = np.full(thresholds.size, np.nan)
        for now, then in other.pairs:
            found[np.isclose(thresholds, now, rtol=_CLOSE, atol=0.0)] = then
        return found
    return np.full(thresholds.size, other)


class KnownGood(NamedTuple):
    """``prior`` float64[p] are the log odds of each parameter; nan where nothing is known of it.

    ``others`` is the other threshold of each comparison whose parameter differs, by key; ``same``
    are the keys of those whose threshold is known to be as it was.
    """

    prior: Floats
    others: Mapping[str, Other]
    same: frozenset[str] = frozenset()


def before_changes(static_info: StaticInfo, changes: Iterable[Change]) -> dict[str, Other]:
    """The threshold that each comparison, by its key, has with the old values.

    Comparisons of text, and those with an unknown way from parameter to threshold, are left out.

    Args:
        static_info: what the analysis found.
        changes: the newest last. Of a parameter that was changed several times, the first value is
            the old one, and the last value the one that it has now.
    """
    joined: dict[str, Change] = {}
    for change in changes:
        first = joined.get(change.parameter, change)
        joined[change.parameter] = replace(change, old=first.old)
    found: dict[str, Other] = {}
    named = [(key, one) for key, one in static_info.thresholds.items() if one.source is not None]
    every = ByParameter(named, lambda item: item[1].source or "")
    for change in joined.values():
        for key, comparison in every.meant(change.parameter):
            now, then = (_threshold(static_info, key, v) for v in (change.new, change.old))
            if not math.isnan(then):
                # Nodes with values of their own may run the same code.
                before = found.get(key)
                pairs = before.pairs if isinstance(before, Instead) else ()
                found[key] = then if math.isnan(now) else Instead((*pairs, (now, then)))
                continue
            factor = added_by(comparison)
            if factor is not None and math.isfinite(change.old - change.new):
                found[key] = Moved(factor * (change.old - change.new))
    return found


def _tree(static_info: StaticInfo, key: str) -> Tree | None:
    """The way from the parameter to the threshold that is logged; None if there is no such one.

    A text logs no threshold, and of some others more than the parameter decides.
    """
    comparison, unit = static_info.comparisons[key], static_info.unit_of(key)
    if is_text(comparison, unit):
        return None
    try:
        return kept_as(tree_of(comparison), read_type(comparison, unit))
    except NoUnitError:
        return None


def _threshold(static_info: StaticInfo, key: str, value: float) -> float:
    """That of a comparison with this value of its parameter; nan if the way there is not known."""
    tree = None if math.isnan(value) else _tree(static_info, key)
    return math.nan if tree is None else evaluate(tree, value)


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


def of_references(
    static_info: StaticInfo, tpcs: Tpcs, events: Events, references: Sequence[Events]
) -> KnownGood:
    """What the thresholds of good runs say; those of texts are not logged.

    A parameter kept its value if one of the runs had it. Otherwise the other threshold is the
    nearest one of a good run. Nothing is known of a parameter that changed during a run, or was not
    compared in the mission and in a good run.
    """
    prior: dict[str, float] = {}
    others: dict[str, Other] = {}
    same: set[str] = set()
    for code, now, known in _known_elsewhere(static_info, tpcs, events, references):
        key, name = tpcs.keys[code], tpcs.parameters[code]
        ordered = static_info.comparisons[key].relation in _ORDERED
        least = BETWEEN if ordered and min(known) < now < max(known) else 0.0
        kept = min(least, *(of_change(then, now) for then in known))
        prior[name] = max(prior.get(name, UNCHANGED), kept)
        if kept == UNCHANGED:
            same.add(key)
        else:
            others[key] = _nearest(now, known)
    return KnownGood(_by_name(tpcs, prior), others, frozenset(same))


def of_others(
    static_info: StaticInfo, tpcs: Tpcs, events: Events, runs: Sequence[Events]
) -> KnownGood:
    """What the thresholds of runs say of which nobody knows that they went right.

    No parameter is less likely for that. The other threshold is the nearest one of those that
    differ.
    """
    others: dict[str, Other] = {}
    same: set[str] = set()
    for code, now, known in _known_elsewhere(static_info, tpcs, events, runs):
        if differing := [then for then in known if then != now]:
            others[tpcs.keys[code]] = _nearest(now, differing)
        else:
            same.add(tpcs.keys[code])
    return KnownGood(np.zeros(len(tpcs.names)), others, frozenset(same))


def _known_elsewhere(
    static_info: StaticInfo, tpcs: Tpcs, events: Events, runs: Sequence[Events]
) -> Iterator[tuple[int, float, list[float]]]:
    """Each comparison with one threshold here, that, and those of the runs; not of texts."""
    here = thresholds_of(events, tpcs)
    there = [thresholds_of(one, tpcs) for one in runs]
    for code, key in enumerate(tpcs.keys):
        now = float(here[code])
        known = [float(one[code]) for one in there if not math.isnan(one[code])]
        if math.isnan(now) or not known:
            continue
        if not is_text(static_info.comparisons[key], static_info.unit_of(key)):
            yield code, now, known


def _nearest(now: float, known: Sequence[float]) -> float:
    return min(known, key=lambda then: (abs(then - now), then))


def of_defaults(static_info: StaticInfo, tpcs: Tpcs, events: Events) -> KnownGood:
    """What the defaults in the code say: of ROS 1's ``param``, of ROS 2's declarations."""
    here = thresholds_of(events, tpcs)
    prior: dict[str, float] = {}
    others: dict[str, Other] = {}
    same: set[str] = set()
    for code, (key, name) in enumerate(zip(tpcs.keys, tpcs.parameters, strict=True)):
        now, default = float(here[code]), static_info.comparisons[key].default
        if math.isnan(now) or default is None or isinstance(default, str):
            continue
        try:
            then = _threshold(static_info, key, float(default))
        except OverflowError:
            continue
        if math.isnan(then):
            continue
        kept = math.isclose(then, now, rel_tol=_CLOSE)
        prior[name] = max(prior.get(name, DEFAULT), DEFAULT if kept else 0.0)
        if kept:
            same.add(key)
        else:
            others[key] = then
    return KnownGood(_by_name(tpcs, prior), others, frozenset(same))


def of_settings(static_info: StaticInfo, tpcs: Tpcs, events: Events) -> KnownGood:
    """What was set anew while the mission ran; the other threshold is the first one."""
    own = events.with_keys(tpcs.keys)
    prior: dict[str, float] = {}
    others: dict[str, Other] = {}
    for code in np.flatnonzero(np.isnan(thresholds_of(events, tpcs))).tolist():
        if _tree(static_info, tpcs.keys[code]) is None:
            continue
        rows = own.by_key.rows(code)
        for node in np.unique(own.node[rows]).tolist():
            values = own.thresh[rows[own.node[rows] == node]]
            switched = np.count_nonzero(values[1:] != values[:-1])
            returns = switched >= np.unique(values).size
            if np.isfinite(values).all() and 0 < switched < MOST_SETTINGS and not returns:
                prior[tpcs.parameters[code]] = SET_ANEW
                others[tpcs.keys[code]] = float(values[0])
    return KnownGood(_by_name(tpcs, prior), others)


def _by_name(tpcs: Tpcs, prior: Mapping[str, float]) -> Floats:
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
