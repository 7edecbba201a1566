"""Figures of merit of rankings and of their confidence, with bootstrap intervals.

A treatment is what was drawn from the population of faults, so it is the unit: the value of a
treatment is the mean over its missions, a figure the mean over treatments, and the bootstrap draws
treatments. Two seeds of one treatment are not two findings.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

DRAWS = 2000
SEED = 8
CONFIDENT = 0.5
"""From here on a method accuses: it holds its first suspect for likelier than all else together,
"none of them" included."""


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
    numbers = np.asarray(values, dtype=np.float64)
    known: dict[object, int] = {}
    codes = np.array([known.setdefault(unit, len(known)) for unit in units], np.int64)
    if not codes.size:
        return Estimate(np.nan, np.nan, np.nan, 0)
    means = np.bincount(codes, numbers) / np.bincount(codes)
    drawn = np.random.default_rng(seed).integers(means.size, size=(draws, means.size))
    low, high = np.quantile(means[drawn].mean(axis=1), [0.025, 0.975])
    return Estimate(float(means.mean()), float(low), float(high), means.size)


class Bin(NamedTuple):
    """A row of a reliability table: confidences in [low, high), and how often they were right."""

    low: float
    high: float
    verdicts: int
    confidence: float
    right: float


def reliability(confidence: npt.ArrayLike, right: npt.ArrayLike, bins: int = 5) -> list[Bin]:
    """How often the first suspect was right, by confidence, in bins of equal width.

    Args:
        confidence: float64[n] in [0, 1].
        right: float64[n], whether the first suspect was to blame, a share where several are tied;
            of clean runs and of faults in the source never.
        bins: how many; the last one has its end. Empty ones are left out.
    """
    given, hits = np.asarray(confidence, np.float64), np.asarray(right, np.float64)
    # linspace has an edge a little above 0.6.
    edges = np.arange(bins + 1) / bins
    place = np.clip(np.digitize(given, edges) - 1, 0, bins - 1)
    return [
        Bin(
            float(edges[n]),
            float(edges[n + 1]),
            int(np.count_nonzero(place == n)),
            float(given[place == n].mean()),
            float(hits[place == n].mean()),
        )
        for n in range(bins)
        if np.any(place == n)
    ]
