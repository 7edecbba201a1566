"""Importance of a predicate over runs of which some failed (Liblit et al., 2005).

Scalable Statistical Bug Isolation: with F and S the failing and passing runs in which a predicate
was true, F_obs and S_obs those in which it was observed, and NumF all failing runs,

    Increase = F / (F + S) - F_obs / (F_obs + S_obs)
    Importance = 2 / (1 / Increase + log(NumF) / log(F))

and 0 where Increase is not positive or the formula has no value. Where only one run failed both
logarithms are 0; a predicate that was true in it has all of the recall there is, 1.
"""

from __future__ import annotations

import numpy as np

from pytpc.base.columns import Bools, Floats, Int64s


def importances(
    failing: Int64s, passing: Int64s, failing_seen: Int64s, passing_seen: Int64s, every: int
) -> Floats:
    """float64[n]: the Importance of n predicates.

    Args:
        failing: int64[n], the failing runs in which each was true.
        passing: int64[n], the passing runs in which it was.
        failing_seen: int64[n], the failing runs in which it was observed.
        passing_seen: int64[n], the passing ones.
        every: how many runs failed.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        increase = failing / (failing + passing) - failing_seen / (failing_seen + passing_seen)
        recall = np.ones(failing.size) if every == 1 else np.log(failing) / np.log(every)
        found = 2.0 / (1.0 / increase + 1.0 / recall)
    holds = (failing > 0) & (increase > 0) & (recall > 0)
    return np.where(holds, found, 0.0)


def importance_of(true: Bools, observed: Bools, failed: Bools) -> float:
    """Importance of one predicate, from what it was in each run (bool[runs] each)."""
    f, s, f_obs, s_obs = (
        np.array([np.count_nonzero(part)], np.int64)
        for part in (true & failed, true & ~failed, observed & failed, observed & ~failed)
    )
    return float(importances(f, s, f_obs, s_obs, int(np.count_nonzero(failed)))[0])
