"""Several causes in one fleet: each explains some of the bad missions.

A cause explains the bad missions with a value with which the robot mostly went wrong. The likeliest
suspect is taken, the missions that it explains are left out, the rest is judged again, and so on
(as Liblit et al. 2005 eliminate predicates). Then each of them is judged once more by the bad
missions that none of the others explains; those that are sure then are the causes. A cause that no
comparison reports is none, as elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Bools, Floats, Int64s
from pytpc.diagnosis.fleet.settings import Settings
from pytpc.diagnosis.fleet.values_in_missions import Verdicts, gone_wrong_with
from pytpc.diagnosis.results.fleet import FleetCause
from pytpc.diagnosis.results.suspects import SURE

MOST = 8
"""So many causes are looked for: each takes two judgements."""
LIKELY = 0.1
"""A suspect that is less likely explains nothing."""

Judge = Callable[[Bools], Floats]
"""float64[p]: the probabilities of the compared parameters, where only these missions are bad."""


class _Explained(NamedTuple):
    parameter: int
    missions: Int64s


def causes_in(
    settings: Settings, verdicts: Verdicts, compared: int, judge: Judge
) -> tuple[FleetCause, ...]:
    """The causes, the one that explains most missions first.

    Args:
        settings: the values of all parameters.
        verdicts: of the missions.
        compared: how many of the parameters a comparison reports; these come first.
        judge: asked for the probabilities by some of the bad missions.
    """
    left = verdicts.bad.copy()
    found: list[_Explained] = []
    while len(found) < MOST and left.any():
        probability = judge(left)[:compared].copy()
        probability[[one.parameter for one in found]] = 0.0
        best = int(np.argmax(probability)) if compared else -1
        if best < 0 or probability[best] < LIKELY:
            break
        wrong = gone_wrong_with(settings, verdicts, best)
        missions = wrong[left[wrong]]
        if not missions.size:
            break
        found.append(_Explained(best, missions))
        left[missions] = False
    causes = [_cause(one, found, settings, verdicts, judge) for one in found]
    sure = [one for one in causes if one.probability >= SURE]
    return tuple(sorted(sure, key=lambda one: (-one.bad, one.parameter)))


def _cause(
    one: _Explained,
    found: list[_Explained],
    settings: Settings,
    verdicts: Verdicts,
    judge: Judge,
) -> FleetCause:
    """A cause, judged without the missions that the others explain."""
    bad = verdicts.bad.copy()
    for other in found:
        if other is not one:
            bad[other.missions] = False
    robots = np.unique(verdicts.robot[one.missions]).tolist()
    return FleetCause(
        settings.parameters[one.parameter],
        float(judge(bad)[one.parameter]),
        one.missions.size,
        tuple(verdicts.robots[robot] for robot in robots),
    )
