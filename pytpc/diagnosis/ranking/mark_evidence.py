"""What the marks say about each stream: the evidence for either type of error.

Type I: the robot did something that it should not. If a change of the comparison's result caused
it, the first mark of each observer followed that change after a reaction time:

    acted = log( sum over its turns t of u(t) fit(t) / (sum of u(t) + c) ) - log( mean of fit )
    fit(t) = product over the first marks m of (e + (1 - e) T p(m - t))

p is the density of reactions and T the length of the log: T p compares with marks at any time. e is
the share of marks that have another cause. Dividing by the sum of u(t) punishes a comparison that
changes often: most of its changes were not marked. The mean of fit over all times is subtracted,
because the marks of several observers come together for any cause. u(t) is how well the turn t fits
as a cause by itself: the first of a cascade causes the others, and changes what the robot does.

Type II: the robot does not do what it should. In the wait before the marks the comparison is
evaluated with one result; elsewhere it is not evaluated, has the other result, or its value is
farther from the threshold:

    waited = log( (held + s) / (elsewhere + s) )
    since = sum over the first marks m of log(e + (1 - e) T q(m - b(m)))

held is the share of the wait in which it had that result; elsewhere is the share of the rest of the
log in which it had it with a value as near as in the wait. b(m) is when that began before the mark,
q the density of an observer's patience: nobody waits for something that has been so for long.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Bools, Floats, Int64s
from pytpc.diagnosis.ranking.other_nodes import Reached, effects
from pytpc.diagnosis.ranking.result_streams import CASCADE_S, ResultStream, ResultStreams
from pytpc.recording.marks import Mark

REACTION_LOG = 1.946
"""Mean of the logarithms of table 6.14's seven delays of type I: a median of 7 s."""

REACTION_SIGMA = 1.17
"""Their standard deviation. (The tails of ``reaction`` are heavier: seven numbers are few.)"""

LATE = ((15.0, 0.15), (30.0, 0.075))
"""Shares of marks that come so much later (in s): somebody looked elsewhere, or was not sure. In
the study's tuning half, the log alone has the wrong parameter among the first three in 79 and 75 %
if all marks come 15 or 30 s late (without these shares in 73 and 67 %); marks in time lose
nothing."""

PATIENCE_LOG, PATIENCE_SIGMA = 2.01, 0.74
"""The same of the six delays of type II there: a median of 7.5 s."""

STRAY = 0.1
"""The share of marks that have another cause than the fault: observers also mark odd things that
the robot does after an error, and they marked clean missions of the thesis (table 6.15)."""

WAIT_S = 8.0
"""How long before a mark of type II counts as the wait: table 6.14's delays are 1.7 to 12.4 s with
a mean of 8.8, so most of a window of this length lies in the wait."""

SHARE = 0.05
"""Added to shares, so that a result that never was elsewhere is not infinite evidence."""

NEAR_QUANTILE = 0.75
"""The share of the wait whose values count as near."""

SLACK = 0.05
"""A value may be farther from the threshold by this part of the range and still be as near: a
battery sinks, and was never as low before."""

GRID = 1000
"""How many times are tried for a cause at any time."""

BRIEF_S = 2.0
"""An interruption this short does not end a wait: values at a threshold are noisy."""

START = 0.05
"""Weight of the start of a comparison's evaluation, against a change: much starts after any
cause."""

ONCE, ONCE_S = 0.4, 0.3
"""Weight of a start that ends within this time: it may have passed at once, and be the cause."""

LATER = 0.4
"""Weight of a change that follows another one within ``CASCADE_S``."""

EFFECT_S = 1.2
"""What the robot starts or stops within this time after a change may be its effect. So may turns
in other nodes that its messages reach (`other_nodes`)."""

IDLE = 0.3
"""Weight of a change after which the robot goes on as before; very many effects add 1."""

HALF = 2.0
"""The number of effects that adds a half."""

OTHERS = 0.3
"""Added to the sum of the turns' weights: turns without any effect are unlikely causes."""


TOLD = 0.9
"""How far an observer is believed who says when the error began; else it is an ordinary mark."""

LEAD_S, LAG_S = 3.0, 0.5
"""A cause may come that much (the mean of an exponential) before the span in which somebody saw the
error begin, or after it, as they are not exact. In the study's tuning half, with marks 30 s late, a
span of 10 s that holds the begin in nine of ten cases lifts the log alone from 32 to 69 % in the
first place, and two good runs from 60 to 85 %; marks in time gain 0 to 10."""


class Marked(NamedTuple):
    """The marks in seconds from the begin of the log: all, and the first of each observer.

    An observer's later marks say that the error lasts, and nothing more of when it began.
    ``waits`` float64[marks] is when the wait before each mark begins; ``begins`` float64[firsts, 2]
    from when to when the error of a first mark began, as the observer says; nan where nobody does.
    """

    times: Floats
    firsts: Floats
    waits: Floats
    begins: Floats

    def fits(self, causes: Floats, mean: float, sigma: float) -> Floats:
        """How well each first mark fits to causes at these times: its density, per second.

        Args:
            causes: float64[..., firsts] or float64[n, 1], in s.
            mean: of the logarithm of the time from a cause to a mark.
            sigma: its standard deviation.
        """
        density = reaction(self.firsts - causes, mean, sigma)
        told = ~np.isnan(self.begins[:, 0])
        if told.any():
            low, high = self.begins.T
            away = np.where(causes < low, (low - causes) / LEAD_S, (causes - high) / LAG_S)
            near = np.exp(-np.maximum(away, 0.0)) / (high - low + LEAD_S + LAG_S)
            density = np.where(told, TOLD * near + (1.0 - TOLD) * density, density)
        return density


@dataclass(frozen=True)
class MarkEvidence:
    """float64[streams] each.

    ``acted``, ``waited`` and ``since`` see above; ``held`` the share of the wait with one result;
    ``near`` the logarithm of the mean distance from the threshold in the wait as a part of the
    stream's range; ``flat`` 1 for a stream with one value only, like a flag.
    """

    acted: Floats
    waited: Floats
    since: Floats
    held: Floats
    near: Floats
    flat: Floats


def marked(marks: Sequence[Mark], streams: ResultStreams) -> Marked:
    """The marks, at least one, on the clock of the streams."""
    times = np.array([(mark.time_ns - streams.begin_ns) / 1e9 for mark in marks])
    ago = np.array([mark.began or (np.nan, np.nan) for mark in marks])
    begins = times[:, None] - ago
    middle = begins.mean(axis=1)
    waits = np.where(np.isnan(middle), times - WAIT_S, middle)
    firsts: dict[str, int] = {}
    for place in np.argsort(times, kind="stable").tolist():
        firsts.setdefault(marks[place].observer, place)
    own = [*firsts.values()]
    return Marked(times, times[own], waits, begins[own])


def mark_evidence(
    streams: ResultStreams,
    marks: Marked,
    reached: Sequence[Sequence[Reached]] | None = None,
) -> MarkEvidence:
    """The evidence of all streams; there is at least one mark.

    Args:
        streams: of the log.
        marks: of the mission.
        reached: for each stream, those of other nodes that its messages reach; None: not known.
    """
    wait = Wait.before(marks, streams.seconds)
    chance = any_time(streams.seconds, marks)
    others = reached or [()] * len(streams.streams)
    rows = [
        (_acted(s, streams, marks, known) - chance, *_waited(s, wait, marks))
        for s, known in zip(streams.streams, others, strict=True)
    ]
    return MarkEvidence(*np.array(rows, np.float64).reshape(len(rows), len(fields(MarkEvidence))).T)


def reaction(delays: Floats, mean: float = REACTION_LOG, sigma: float = REACTION_SIGMA) -> Floats:
    """The density of reactions, per second, late ones among them; 0 for marks before the change."""
    in_time = 1.0 - sum(share for _, share in LATE)
    density = in_time * _in_time(delays, mean, sigma)
    for seconds, share in LATE:
        density += share * _in_time(delays - seconds, mean, sigma)
    return np.asarray(density)


def _in_time(delays: Floats, mean: float, sigma: float) -> Floats:
    """The density where the logarithms follow Student's t with 4 degrees of freedom.

    That is 3/8 (1 + z^2/4)^(-5/2).
    """
    density = np.zeros(delays.shape)
    after = delays > 0
    seconds = np.maximum(delays[after], 1e-3)
    z = (np.log(seconds) - mean) / sigma
    density[after] = 0.375 * (1.0 + z * z / 4.0) ** -2.5 / (sigma * seconds)
    return density


def _acted(
    stream: ResultStream, streams: ResultStreams, marks: Marked, reached: Sequence[Reached]
) -> float:
    last = float(marks.firsts.max(initial=0.0))
    turns = np.concatenate([stream.changes, stream.starts])
    once = stream.stops - stream.starts <= ONCE_S
    prior = np.concatenate([np.ones(stream.changes.size), np.where(once, ONCE, START)])
    turns, prior = turns[turns <= last], prior[turns <= last]
    if not turns.size:
        return float(np.log(STRAY)) * marks.firsts.size
    first = _between(streams.decisions, turns - CASCADE_S, turns) == 0
    follows = _between(streams.shifts, turns, turns + EFFECT_S) - _between(
        streams.shifts, turns - EFFECT_S, turns
    )
    follows = np.maximum(0, follows + effects(turns, reached))
    prior = prior * np.where(first, 1.0, LATER) * (IDLE + follows / (follows + HALF))
    return caused(turns, prior, streams.seconds, marks)


def caused(turns: Floats, weights: Floats, seconds: float, marks: Marked) -> float:
    """How well one of these turns explains the first marks: ``acted`` before chance is subtracted.

    Args:
        turns: float64[turns], at least one; their times.
        weights: float64[turns], u(t) of the formula.
        seconds: the length of the log.
        marks: those to explain.
    """
    fits = _fits(turns, seconds, marks)
    top = fits.max()
    total = np.sum(weights * np.exp(fits - top)) / (OTHERS + weights.sum())
    return float(top + np.log(total))


def _fits(turns: Floats, seconds: float, marks: Marked) -> Floats:
    """How well each turn explains the first marks, as logarithms."""
    times = max(seconds, 1.0) * marks.fits(turns[:, None], REACTION_LOG, REACTION_SIGMA)
    return np.asarray(np.log(STRAY + (1 - STRAY) * times).sum(axis=1))


def any_time(seconds: float, marks: Marked) -> float:
    """The same for a cause at any time up to the last mark."""
    last = float(np.clip(marks.firsts.max(initial=0.0), 0.0, seconds))
    fits = _fits(np.linspace(0.0, last, GRID), seconds, marks)
    top = fits.max()
    return float(top + np.log(np.mean(np.exp(fits - top))))


class _Waited(NamedTuple):
    """The evidence for type II; the defaults are for a stream that is not in the wait."""

    waited: float
    since: float
    held: float = 0.0
    near: float = 0.0
    flat: float = 0.0


class Wait(NamedTuple):
    """Sorted, disjoint spans that count as waits; ``begins`` and ``ends`` float64[spans]."""

    begins: Floats
    ends: Floats
    seconds: float

    @classmethod
    def before(cls, marks: Marked, seconds: float) -> Wait:
        """The ``WAIT_S`` before each mark, or after the error began, if the observer says when."""
        order = np.argsort(marks.waits, kind="stable")
        begins = marks.waits[order]
        ends = np.maximum.accumulate(np.minimum(begins + WAIT_S, marks.times[order]))
        new = np.concatenate([[True], begins[1:] > ends[:-1]])
        joined = np.flatnonzero(new)
        return cls(begins[joined], ends[np.append(joined[1:], begins.size) - 1], seconds)

    def holds(self, times: Floats) -> Bools:
        """Whether each time is in one of them."""
        place = np.searchsorted(self.begins, times, side="right") - 1
        return np.asarray((place >= 0) & (times <= self.ends[np.maximum(place, 0)]))

    @property
    def length(self) -> float:
        """The length of all spans together in s, at least 1."""
        ends = np.minimum(self.ends, self.seconds)
        return max(float(np.sum(np.maximum(ends - np.maximum(self.begins, 0.0), 0.0))), 1.0)


def _waited(stream: ResultStream, wait: Wait, marks: Marked) -> _Waited:
    inside = wait.holds(stream.times)
    if not inside.any():
        nothing = float(np.log(STRAY)) * marks.firsts.size
        return _Waited(float(np.log(SHARE / (SHARE + 1.0))), nothing)
    weight, margin = stream.weight, stream.margin
    held = [float(weight[inside & (stream.res == way)].sum()) for way in (False, True)]
    way = bool(held[1] > held[0]) if sum(held) else bool(stream.res[inside][-1])
    one = inside & (stream.res == way)
    known = margin[one][np.isfinite(margin[one])]
    flat = stream.spread == 0.0 or not known.size
    if flat:
        limit, near = np.inf, 0.0
    else:
        limit = float(np.quantile(known, NEAR_QUANTILE)) + SLACK * stream.spread
        near = float(np.log(known.mean() / stream.spread + 0.01))
    alike = (stream.res == way) & ~(margin > limit)
    share = min(1.0, held[way] / wait.length)
    rest = max(wait.seconds - wait.length, 1.0)
    elsewhere = min(1.0, float(weight[alike & ~inside].sum()) / rest)
    return _Waited(
        waited=float(np.log((share + SHARE) / (elsewhere + SHARE))),
        since=_since(stream.times[alike], wait.seconds, marks),
        held=share,
        near=near,
        flat=float(flat),
    )


def _since(times: Floats, seconds: float, marks: Marked) -> float:
    """How well the first marks fit to when the wait before each of them began.

    ``times`` are those at which the stream was as in the wait. A pause of up to ``BRIEF_S`` does
    not end it, and a mark may come that much after its end.
    """
    firsts = marks.firsts
    begins = np.flatnonzero(np.diff(times, prepend=-np.inf) > BRIEF_S)
    last = np.searchsorted(times, firsts, side="right") - 1
    begun = times[begins[np.maximum(np.searchsorted(begins, last, side="right") - 1, 0)]]
    fits = max(seconds, 1.0) * marks.fits(begun, PATIENCE_LOG, PATIENCE_SIGMA)
    fits[(last < 0) | (firsts - times[last] > BRIEF_S)] = 0.0
    return float(np.log(STRAY + (1 - STRAY) * fits).sum())


def _between(times: Floats, begins: Floats, ends: Floats) -> Int64s:
    """int64[spans]: how many of the sorted times lie in [begin, end)."""
    first = np.searchsorted(times, begins, side="left")
    return np.searchsorted(times, ends, side="left") - first
