"""Figures of merit of rankings and of their confidence, with bootstrap intervals.

A treatment is what was drawn from the population of faults, so it is the unit: the value of a
treatment is the mean over its missions, a figure the mean over treatments, and the bootstrap draws
treatments. Two seeds of one treatment are not two findings.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

DRAWS = 2000
SEED = 8
CONFIDENT = 0.5
"""From here on a method accuses: it holds its first suspect for likelier than all else together,
"none of them" included."""


class Row(Protocol):
    """What is asked of a row of the table of positions."""

    @property
    def system(self) -> str:
        """The robot."""
        ...

    @property
    def treatment(self) -> str:
        """What was done to it."""
        ...

    @property
    def position(self) -> float | None:
        """The place of the changed parameter, None where there is no mark."""
        ...

    @property
    def tied(self) -> int:
        """How many share that place, itself included."""
        ...

    @property
    def parameters(self) -> int:
        """How many parameters there are."""
        ...

    @property
    def confidence(self) -> float | None:
        """That of the method, None where it has none."""
        ...


class Estimate(NamedTuple):
    """A figure with its interval, and of how many treatments it is."""

    value: float
    low: float
    high: float
    treatments: int


@dataclass(frozen=True)
class Merit:
    """How well a method ranks: shares of top 1 and top 3, mean position, and mean rank.

    The rank is 1 - (position - 1) / n, 1 for the most suspicious (SPEC 7). A mission without a mark
    is a miss, and counts as the middle of all places.
    """

    top1: Estimate
    top3: Estimate
    position: Estimate
    rank: Estimate


def merit(rows: Iterable[Row]) -> Merit:
    """The figures of one method, from the rows of missions with a changed parameter."""
    found = list(rows)
    places = [(row.parameters + 1) / 2 if row.position is None else row.position for row in found]
    shares = [
        [0.0 if row.position is None else top_share(row.position, row.tied, k) for row in found]
        for k in (1, 3)
    ]
    where = np.array(places, np.float64)
    ranks = [1.0 - (place - 1.0) / row.parameters for row, place in zip(found, places, strict=True)]
    units = [(row.system, row.treatment) for row in found]
    return Merit(
        estimate(shares[0], units),
        estimate(shares[1], units),
        estimate(where, units),
        estimate(np.array(ranks), units),
    )


def top_share(position: float, tied: int, k: int) -> float:
    """The probability of a place among the first ``k`` if those that are tied were drawn.

    Args:
        position: from 1, the mean of the places that are shared.
        tied: how many share them; 1 or more.
        k: how many are looked at.
    """
    first = position - (tied - 1) / 2
    return min(1.0, max(0.0, (k + 1 - first) / tied))


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
        right: bool[n], whether the first suspect was to blame; of clean runs and of faults in the
            source never.
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


def brier(confidence: npt.ArrayLike, right: npt.ArrayLike) -> float:
    """The mean of (confidence - right)^2: 0 is perfect, 0.25 is always one half (Brier 1950)."""
    given, hits = np.asarray(confidence, np.float64), np.asarray(right, np.float64)
    return float(np.mean((given - hits) ** 2)) if given.size else np.nan


def accusations(rows: Iterable[Row], limit: float = CONFIDENT) -> Estimate:
    """The share of missions with a confident accusation; one without a mark has none."""
    found = list(rows)
    accused = [row.confidence is not None and row.confidence >= limit for row in found]
    return estimate(accused, [(row.system, row.treatment) for row in found])
