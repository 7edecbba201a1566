"""Figures of merit of rankings and of their confidence, with bootstrap intervals.

A treatment is what was drawn from the population of faults, so it is the unit: the value of a
treatment is the mean over its missions, a figure the mean over treatments, and the bootstrap draws
treatments. Two seeds of one treatment are not two findings. Where all treatments are 0, or all are
1, the bootstrap has nothing to draw, and the interval is that of Clopper and Pearson (1934).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import bdtri, betaincinv

from pytpc.diagnosis.results.suspects import SURE

DRAWS = 2000
BINS = 5
"""Of confidence, for its calibration."""
SPARSE = 5
"""A bin with verdicts about fewer treatments says little."""
SEED = 8
CONFIDENT = SURE
"""From here on a method accuses."""
_TAIL = 0.025
"""What an interval of 95 % leaves out at each end."""


class Estimate(NamedTuple):
    """A figure with its interval, and of how many treatments it is."""

    value: float
    low: float
    high: float
    treatments: int


def within(k: int, place: float, tied: int) -> float:
    """The probability that a parameter is among the first ``k`` if ties are broken by chance.

    So the shares of a method that makes no difference are those of chance, k / n.

    Args:
        k: how many are looked at.
        place: the parameter's, from 1: the mean of the places that it shares.
        tied: how many parameters share them, itself among them.
    """
    before = place - (tied + 1) / 2
    return min(max(k - before, 0.0), tied) / tied


def estimate(
    values: npt.ArrayLike, units: Sequence[object], draws: int = DRAWS, seed: int = SEED
) -> Estimate:
    """The mean over units of the mean of their values, with the bootstrap's 95 % interval.

    Args:
        values: float64[n].
        units: whose each value is; n of them.
        draws: of the bootstrap, each of as many units as there are, with replacement.
        seed: of the draws.

    Returns:
        All nan where there is no value.
    """
    means = _means(values, units)
    if not means.size:
        return Estimate(np.nan, np.nan, np.nan, 0)
    drawn = np.random.default_rng(seed).integers(means.size, size=(draws, means.size))
    low, high = np.quantile(means[drawn].mean(axis=1), [_TAIL, 1 - _TAIL])
    return Estimate(float(means.mean()), float(low), float(high), means.size)


def share(values: npt.ArrayLike, units: Sequence[object]) -> Estimate:
    """As ``estimate``, of values in [0, 1]: where all are 0 or all are 1 the interval has a width.

    Args:
        values: float64[n].
        units: whose each value is; n of them.
    """
    found = estimate(values, units)
    if found.treatments and found.value in (0.0, 1.0):
        # At its ends the interval has a closed form.
        end = _TAIL ** (1 / found.treatments)
        low, high = (end, 1.0) if found.value else (0.0, 1.0 - end)
        return found._replace(low=low, high=high)
    return found


def exact_share(values: npt.ArrayLike, units: Sequence[object]) -> Estimate:
    """The mean over units of values in [0, 1], with Clopper and Pearson's 95 % interval.

    A unit whose values differ counts with its mean; the interval is that of so many of all units,
    also between whole numbers. It is wide enough near 0 and 1, where the bootstrap's is not.

    Args:
        values: float64[n].
        units: whose each value is; n of them.

    Returns:
        All nan where there is no value.
    """
    means = _means(values, units)
    if not means.size:
        return Estimate(np.nan, np.nan, np.nan, 0)
    count, of = float(means.sum()), means.size
    low = float(betaincinv(count, of - count + 1, _TAIL)) if count > 0 else 0.0
    high = float(betaincinv(count + 1, of - count, 1 - _TAIL)) if count < of else 1.0
    return Estimate(count / of, low, high, of)


def upper_limit(count: int, of: int) -> float:
    """The largest share that ``count`` of ``of`` leave possible (Clopper and Pearson, 95 %).

    With it as few as ``count`` are seen in 2.5 % of all cases.

    Args:
        count: how many were seen, at most ``of``.
        of: how many could be; at least one.
    """
    return 1.0 if count == of else float(bdtri(count, of, _TAIL))


class Bin(NamedTuple):
    """A row of a reliability table: confidences in [low, high), and how often they were right.

    ``treatments`` is of how many its ``verdicts`` are.
    """

    low: float
    high: float
    verdicts: int
    treatments: int
    confidence: float
    right: float

    @property
    def is_sparse(self) -> bool:
        """Whether its share depends on single treatments."""
        return self.treatments < SPARSE


def reliability(
    confidence: npt.ArrayLike, right: npt.ArrayLike, units: Sequence[object]
) -> list[Bin]:
    """How often the first suspect was right, by confidence, in ``BINS`` of equal width.

    Args:
        confidence: float64[n] in [0, 1].
        right: float64[n], whether the first suspect was to blame, a share where several are tied;
            of clean missions and of faults in the source never.
        units: the treatment of each.

    Returns:
        Those with verdicts; the last one has its end.
    """
    given, hits = np.asarray(confidence, np.float64), np.asarray(right, np.float64)
    place = _bins(given)
    codes = _codes(units)
    return [
        Bin(
            n / BINS,
            (n + 1) / BINS,
            int(np.count_nonzero(place == n)),
            np.unique(codes[place == n]).size,
            float(given[place == n].mean()),
            float(hits[place == n].mean()),
        )
        for n in range(BINS)
        if np.any(place == n)
    ]


def calibration_error(
    confidence: npt.ArrayLike, right: npt.ArrayLike, units: Sequence[object]
) -> Estimate:
    """The expected calibration error (Naeini et al. 2015), with the bootstrap's 95 % interval.

    It is the mean over verdicts of the gap between mean confidence and share of right ones in their
    bin of ``BINS``. The bootstrap draws treatments, with all of their verdicts. Of few verdicts the
    error is above 0 even where confidence is right, and that of a draw is above that of all.

    Args:
        confidence: float64[n], as in ``reliability``.
        right: float64[n].
        units: the treatment of each.

    Returns:
        All nan where there is no verdict.
    """
    given, hits = np.asarray(confidence, np.float64), np.asarray(right, np.float64)
    codes = _codes(units)
    if not codes.size:
        return Estimate(np.nan, np.nan, np.nan, 0)
    count = int(codes.max()) + 1
    # float64[treatment, bin]: their verdicts' sum of the gap, of which a bin's is the sum.
    gaps = np.zeros((count, BINS))
    np.add.at(gaps, (codes, _bins(given)), given - hits)
    verdicts = np.bincount(codes, minlength=count)
    drawn = np.random.default_rng(SEED).integers(count, size=(DRAWS, count))
    errors = np.abs(gaps[drawn].sum(axis=1)).sum(axis=1) / verdicts[drawn].sum(axis=1)
    low, high = np.quantile(errors, [_TAIL, 1 - _TAIL])
    value = np.abs(gaps.sum(axis=0)).sum() / verdicts.sum()
    return Estimate(float(value), float(low), float(high), count)


def _bins(confidence: npt.NDArray[np.float64]) -> npt.NDArray[np.intp]:
    # linspace has an edge a little above 0.6.
    edges = np.arange(BINS + 1) / BINS
    return np.clip(np.digitize(confidence, edges) - 1, 0, BINS - 1)


def _means(values: npt.ArrayLike, units: Sequence[object]) -> npt.NDArray[np.float64]:
    """float64[units]: the mean of the values of each unit, in the order of their first."""
    codes = _codes(units)
    sums = np.bincount(codes, np.asarray(values, dtype=np.float64))
    return np.asarray(sums / np.bincount(codes))


def _codes(units: Sequence[object]) -> npt.NDArray[np.int64]:
    """int64[n]: the same number for the same unit, from 0 in the order of their first."""
    known: dict[object, int] = {}
    return np.array([known.setdefault(unit, len(known)) for unit in units], np.int64)
