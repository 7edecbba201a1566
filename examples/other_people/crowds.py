#!/usr/bin/env python3
"""Other people at a mission than the thesis's, from what an observer wrote of it.

    crowds.py --causes causes.json --sights sights.parquet --seed 7 --folder DIR

It writes a file of marks for each crowd. It imports nothing of pytpc, as all who look on.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from statistics import NormalDist

from simulated_world.crowd import DELAY_SIGMA, USERS, CrowdMark, User, marks_of
from simulated_world.errors import ObserverError
from simulated_world.marks_file import save_marks
from simulated_world.rules import KIND_I, KIND_II, Cause, Look
from simulated_world.sights import load_sights

SPREAD_SIGMA = 0.6
_STEPS = 100


def times(factor: float) -> tuple[User, ...]:
    """People who are slower by a factor."""
    return _with_delays(lambda delays: [factor * delay for delay in delays])


def spread(sigma: float) -> tuple[User, ...]:
    """People whose delays vary by lognormal(0, sigma) in all."""
    # The crowd varies each delay by DELAY_SIGMA. The variances add up, so the rest is in the
    # delays that it chooses from: quantiles of a lognormal factor.
    rest = NormalDist(0.0, math.sqrt(sigma**2 - DELAY_SIGMA**2))
    factors = [math.exp(rest.inv_cdf((step + 0.5) / _STEPS)) for step in range(_STEPS)]
    return _with_delays(lambda delays: [f * delay for delay in delays for f in factors])


def _with_delays(change: Callable[[Sequence[float]], list[float]]) -> tuple[User, ...]:
    return tuple(
        replace(user, delays_s={kind: tuple(change(all_)) for kind, all_ in user.delays_s.items()})
        for user in USERS
    )


TWO_MARKS = tuple(replace(user, counts={KIND_I: (2, 2), KIND_II: (2, 2)}) for user in USERS)

CROWDS: Mapping[str, tuple[User, ...]] = {
    "thesis": USERS,
    "fast": times(0.5),
    "slow": times(2.0),
    "spread": spread(SPREAD_SIGMA),
    "two-marks": TWO_MARKS,
    "alone": USERS[1:2],
    "coin": USERS,
}


def crowd_marks(
    name: str, causes: Sequence[Cause], begin: float, end: float, seed: int
) -> list[CrowdMark]:
    """The marks of one crowd; the arguments are those of ``marks_of``."""
    marks = marks_of(causes, begin, end, seed, CROWDS[name])
    if name != "coin":
        return marks
    dice = random.Random(f"{seed} coin")
    return [replace(mark, said=dice.choice((KIND_I, KIND_II))) for mark in marks]


def load_causes(path: Path) -> list[Cause]:
    """What was wrong in the mission.

    Raises:
        ObserverError: the file is not of causes.
        OSError: it cannot be read.
    """
    try:
        causes = [Cause(**one) for one in json.loads(path.read_text(encoding="utf-8"))]
        if any(one.kind not in (KIND_I, KIND_II) or one.start > one.end for one in causes):
            raise ValueError("an unknown kind, or an end before the start")
    except (TypeError, ValueError) as error:
        raise ObserverError(f"{path}: not the causes of a mission: {error}") from error
    return causes


def main(arguments: Sequence[str]) -> int:
    """Write the files; the exit status is 1, with a line on stderr, where that cannot be."""
    parser = argparse.ArgumentParser(description="Other people's marks in a mission.")
    parser.add_argument("--causes", type=Path, required=True, help="what was wrong (JSON)")
    parser.add_argument("--sights", type=Path, required=True, help="what was seen (Parquet)")
    parser.add_argument("--seed", type=int, required=True, help="of all that is random")
    parser.add_argument("--folder", type=Path, required=True, help="where files of marks go")
    options = parser.parse_args(arguments)
    try:
        causes = load_causes(options.causes)
        sights = load_sights(options.sights, Look)
        for name in CROWDS:
            # Who saw nothing of the robot has nothing to mark.
            seen = (sights[0].time, sights[-1].time) if sights else None
            marks = crowd_marks(name, causes, *seen, options.seed) if seen else []
            save_marks(marks, options.folder / f"{name}.parquet")
    except OSError as error:
        return _failed(f"{error.filename}: {error.strerror}" if error.filename else str(error))
    except ObserverError as error:
        return _failed(str(error))
    return 0


def _failed(text: str) -> int:
    print(f"crowds.py: {' '.join(text.split())}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
