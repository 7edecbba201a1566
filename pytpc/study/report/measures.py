"""Means with what chance would make of them, and how well confidence is calibrated."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

DRAWS = 2000
SEED = 8
CONFIDENT = 0.5


class Estimate(NamedTuple):
    """A figure with its interval, and of how many treatments it is."""

    value: float
    low: float
    high: float
    treatments: int


class Bin(NamedTuple):
    """A row of a reliability table: confidences in [low, high), and how often they were right."""

    low: float
    high: float
    verdicts: int
    confidence: float
    right: float


def estimate(values: npt.ArrayLike, units: Sequence[object]) -> Estimate:
    """The mean over units of the mean of their values, with the bootstrap's 95 % interval.

    All nan where there is no value.
    """
    numbers = np.asarray(values, dtype=np.float64)
    known: dict[object, int] = {}
    codes = np.array([known.setdefault(unit, len(known)) for unit in units], np.int64)
    if not codes.size:
        return Estimate(np.nan, np.nan, np.nan, 0)
    means = np.bincount(codes, numbers) / np.bincount(codes)
    drawn = np.random.default_rng(SEED).integers(means.size, size=(DRAWS, means.size))
    low, high = np.quantile(means[drawn].mean(axis=1), [0.025, 0.975])
    return Estimate(float(means.mean()), float(low), float(high), means.size)


def reliability(confidence: npt.ArrayLike, right: npt.ArrayLike, bins: int = 5) -> list[Bin]:
    """How often the first suspect was right, by confidence, in bins of equal width.

    Empty ones are left out.
    """
    given, hits = np.asarray(confidence, np.float64), np.asarray(right, np.float64)
    edges = np.linspace(0.0, 1.0, bins + 1)
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
