"""What the made-up robot's values do over a mission: smooth, seeded processes.

All of them are made at ``KNOTS_HZ`` at once, and are linear in between. An event that is decided
moves a value of another loop a moment later, as what a robot does changes what it sees; so
comparisons turn together that have no parameter in common.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.signal import lfilter

from pytpc_evaluation.fleet.robot_model import DECISIONS, LARGE, SMALL, Kind

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

KNOTS_HZ = 10.0
_WANDER_S = 1.5
_FOLLOW_S = 0.5
_PUSH = 0.8
_SLOT_S = 7.0
_FEWEST_SLOTS = 3
_QUIET = 0.04


@dataclass(frozen=True)
class Processes:
    """The values of all decisions, and those that second places compare, in steps.

    Attributes:
        z, second: float64[n, decisions], at ``KNOTS_HZ``.
    """

    z: Floats
    second: Floats

    @property
    def times(self) -> Floats:
        """float64[n]: seconds since the beginning."""
        return np.arange(len(self.z)) / KNOTS_HZ


def make_processes(
    rng: np.random.Generator, seconds: float, levels: Floats, offsets: Floats
) -> Processes:
    """The values of a mission.

    Args:
        rng: where chance comes from.
        seconds: how long it takes.
        levels: float64[decisions]: the thresholds that the robot has, in steps.
        offsets: float64[decisions]: added to each value, in steps.
    """
    count = int(np.ceil(seconds * KNOTS_HZ)) + 2
    width = len(DECISIONS)
    z = _smooth(rng, count, width)
    small = 0.08 * _smooth(rng, count, width)
    noise = lfilter([0.5], [1.0, -0.5], rng.standard_normal((count, width)), axis=0)
    for number, one in enumerate(DECISIONS):
        if one.kind is Kind.STEADY:
            z[:, number] *= 0.5
        elif one.kind is Kind.RAMP:
            z[:, number] = np.linspace(-2.0, 2.0, count) + 0.02 * z[:, number]
        elif one.kind is Kind.EVENT:
            z[:, number] = _QUIET * noise[:, number] + _bumps(rng, count)
    z += offsets
    events = [n for n, one in enumerate(DECISIONS) if one.kind is Kind.EVENT]
    pushed = [n for n, one in enumerate(DECISIONS) if one.kind is Kind.WANDER]
    keep = float(np.exp(-1.0 / (_FOLLOW_S * KNOTS_HZ)))
    decided = (z[:, events] > levels[events]).astype(np.float64)
    follows = lfilter([1.0 - keep], [1.0, -keep], decided, axis=0)
    for number, event in enumerate(events):
        # One of another loop: the list goes on behind the event's own.
        others = [n for n in pushed if DECISIONS[n].loop != DECISIONS[event].loop]
        z[:, others[number % len(others)]] += _PUSH * follows[:, number]
    return Processes(z, z + small)


def _smooth(rng: np.random.Generator, count: int, width: int) -> Floats:
    """Random and smooth, with a standard deviation of 1: white noise through two low passes."""
    keep = float(np.exp(-1.0 / (_WANDER_S * KNOTS_HZ)))
    before = round(8 * _WANDER_S * KNOTS_HZ)
    white = rng.standard_normal((count + before, width))
    found = lfilter([1.0], [1.0, -2.0 * keep, keep * keep], white, axis=0)[before:]
    # The variance of this filter's output.
    square = keep * keep
    made: Floats = found / np.sqrt((1.0 + square) / (1.0 - square) ** 3)
    return made


def _bumps(rng: np.random.Generator, count: int) -> Floats:
    """Small and large bumps, at least one of each, at random places."""
    seconds = count / KNOTS_HZ
    slots = max(_FEWEST_SLOTS, int(seconds / _SLOT_S))
    slot = seconds / slots
    kinds = rng.choice(3, slots, p=[0.4, 0.3, 0.3])
    kinds[rng.choice(slots, 2, replace=False)] = (1, 2)
    at = np.arange(count) / KNOTS_HZ
    made = np.zeros(count)
    for number, kind in enumerate(kinds.tolist()):
        low, high = LARGE if kind == 2 else SMALL
        height, width = rng.uniform(low, high), slot * rng.uniform(0.3, 0.45)
        middle = slot * (number + rng.uniform(0.3, 0.7))
        if kind:
            inside = np.abs(at - middle) < width / 2
            made[inside] = height * np.cos(np.pi * (at[inside] - middle) / width) ** 2
    return made
