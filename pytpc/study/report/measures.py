"""Means with what chance would make of them: the bootstrap over treatments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

DRAWS = 2000
_SEED = 8
_TAILS = (2.5, 97.5)


@dataclass(frozen=True, slots=True)
class Interval:
    """A mean over ``n`` treatments, and the 95 % interval of it; None where there is none."""

    value: float | None
    low: float | None
    high: float | None
    n: int

    def shown(self) -> str:
        """In per cent: ``83 [67, 100]``, a dash where nothing is known."""
        if self.value is None or self.low is None or self.high is None:
            return "-"
        return f"{100 * self.value:.0f} [{100 * self.low:.0f}, {100 * self.high:.0f}]"


def interval(values: Sequence[float]) -> Interval:
    """The mean of one value for each treatment, with the percentiles of the bootstrap.

    Treatments are drawn with replacement ``DRAWS`` times, from a fixed seed (Efron 1979, the
    percentile interval). Seeds of a treatment are no draws of their own: they are alike.
    """
    if not values:
        return Interval(None, None, None, 0)
    numbers = np.asarray(values, dtype=np.float64)
    random = np.random.default_rng(_SEED)
    drawn = random.integers(0, numbers.size, (DRAWS, numbers.size))
    low, high = np.percentile(numbers[drawn].mean(axis=1), _TAILS)
    return Interval(float(numbers.mean()), float(low), float(high), numbers.size)
