"""The diagnosis that users get, alone and with what may be known beside the log."""

from __future__ import annotations

import random
from dataclasses import dataclass, replace

from pytpc.diagnosis.ranking.other_values import diagnose_beside
from pytpc.diagnosis.ranking.posterior import Posterior, diagnose_log
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import parameter_name
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.study.case import Case, Verdict

OTHER_DEFAULTS = 0.4
"""Of how many parameters ``tpc_other_defaults`` takes the default for another one."""


def tpc(case: Case) -> Verdict:
    """From the log, the marks and the static information, defaults in the code among it."""
    return verdict(diagnose_beside(case.recording, case.static_info))


def tpc_log(case: Case) -> Verdict:
    """The same without the defaults."""
    return verdict(diagnose_log(case.recording, case.static_info))


def tpc_where(case: Case) -> Verdict:
    """With what the observer says of where it was wrong."""
    return verdict(diagnose_beside(case.with_places, case.static_info))


def tpc_other_defaults(case: Case) -> Verdict:
    """As if the defaults in the code were not those of this robot for 40 % of its parameters.

    The robots' files have the values of the code, but for what was changed; other robots' files
    differ more. The other defaults are drawn for each mission: a switch is turned, a number is up
    to three times as much or as little.
    """
    return verdict(diagnose_beside(case.recording, _with_other_defaults(case)))


def _with_other_defaults(case: Case) -> StaticInfo:
    recording, static = case.recording, case.static_info
    dice = random.Random(f"{recording.start_ns} {recording.end_ns} {len(recording.events)}")
    factors = {
        name: 3.0 ** dice.uniform(-1.0, 1.0)
        for name in Tpcs.of(static).names
        if dice.random() < OTHER_DEFAULTS
    }

    def changed(found: Comparison) -> Comparison:
        factor, default = factors.get(parameter_name(found)), found.default
        if factor is None or default is None or isinstance(default, str):
            return found
        other = not default if isinstance(default, bool) else default * factor or 1.0
        return replace(found, default=other)

    units = [
        replace(unit, comparisons=tuple(map(changed, unit.comparisons))) for unit in static.units
    ]
    return replace(static, units=tuple(units))


@dataclass(frozen=True, slots=True)
class GoodRuns:
    """With so many good runs that have other settings than the mission and each other.

    ``where``: the marks say where it was wrong.
    """

    count: int
    where: bool = False

    def __call__(self, case: Case) -> Verdict:
        """Judge a mission."""
        recording = case.with_places if self.where else case.recording
        good = case.good[: self.count]
        return verdict(diagnose_beside(recording, case.static_info, references=good))


def tpc_reference(case: Case) -> Verdict:
    """With the thresholds of a good run, where there is one, and what they would have changed."""
    return verdict(diagnose_beside(case.recording, case.static_info, references=case.references))


def tpc_changes(case: Case) -> Verdict:
    """With the history of changes, where it is known, and what the old values would have changed.

    The order of the changes says nothing.
    """
    return verdict(diagnose_beside(case.recording, case.static_info, changes=case.changes))


def verdict(found: Posterior) -> Verdict:
    """The order, and the posterior of the first as the confidence; 0 where there is nobody."""
    order = found.order
    return Verdict(
        tuple(found.names[n] for n in order),
        float(found.posterior[order[0]]) if order else 0.0,
        tuple(float(found.scores[n]) for n in order),
        found.none,
    )
