"""How likely each parameter is to be the cause, or none of them, from all marks at once.

``diagnose_log`` is the entrance. It mixes witnesses, each of which gives every parameter, and "none
of them", a probability (docs/reference/scores.md#how-it-is-joined):

    P(p) = P(I) D(p) + P(II) ((1 - l) W(p) + l D(p))
    D = (acted + baseline of type I) / 2,    W = (waited + baseline of either type) / 2

P(I) and P(II) are how likely either type is from what the marks say (``type_odds``); l is the share
of latches in type II: a change that cannot be undone. *acted* and *waited* are conditional logits
(McFadden 1974) of the evidence of `pytpc.diagnosis.ranking.mark_evidence`, each parameter with the
mean of its comparisons' odds. The *baseline* is the order by the thesis's ranks, joined over the
marks: place k has a probability of 1/k to a power; it says nothing of "none of them". A parameter
that one witness puts first is high in the mixture; a product would need all witnesses to agree. A
few weights are fitted on the tuning half of the study (`pytpc_evaluation.study.fit`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Floats, Int64s
from pytpc.diagnosis.ranking.mark_evidence import SHARE, MarkEvidence, mark_evidence, marked
from pytpc.diagnosis.ranking.other_nodes import OtherNodes
from pytpc.diagnosis.ranking.result_streams import ResultStreams
from pytpc.diagnosis.ranking.summarised import with_summarised
from pytpc.diagnosis.scores.score_tables import Tpcs, parameter_tables, tpc_scores
from pytpc.diagnosis.scores.summary_scores import LogTables
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo


@dataclass(frozen=True, slots=True)
class Weights:
    """What the evidence counts.

    The defaults are fitted by `python -m pytpc_evaluation.study.fit` on the tuning half of the
    study: 24 treatments of types I and II, three faults and the clean missions of three robots, 702
    sets of marks. Their loss is 2.515, that of weights chosen by reason alone 2.662. With one robot
    left out, the loss on that robot is 2.978 (image_capture; by reason 2.923), 2.737 (navigation;
    2.878) and 2.128 (water_sampler; 2.185).
    """

    acted: float = 0.99
    waited: float = 0.98
    since: float = 0.29
    held: float = 0.98
    near: float = -1.05
    flat: float = -1.51
    ranked: float = 1.46
    latch: float = -1.34
    none: float = 1.39


WEIGHTS = Weights()

LIED = 0.5
"""The probability, before any mark, that these observers cannot tell the types apart (table
6.13)."""
SLIP = 0.05
"""How often an observer who can tell the types apart names the wrong one."""
SAID_I = 28 / 68
"""How often one who cannot says type I: the share of all marks in table 6.13."""

MARKS_I, MARKS_II = 17 / 8, 51 / 8
"""Marks per user in a trial of either type, by table 6.15, including users who set none."""
LATER = 0.5
"""The weight of a mark against the observer's mark before it: later marks are often about another
error that follows from the first."""
REPEAT = 0.5
"""The weight of the number of marks: those of one observer are not independent."""

_DIGITS = 9
"""Mean ranks that differ by rounding only are tied."""


class Decisive(NamedTuple):
    """The comparison that decides a parameter's score, its node, and P(I) if it is to blame."""

    key: str
    node: str
    type1: float


@dataclass(frozen=True)
class Posterior:
    """The parameters and how suspicious they are.

    ``names`` as `Tpcs.names`; ``scores`` float64[p], the greater the more suspicious, -inf where
    the parameter was never compared; ``posterior`` float64[p]; ``none`` the probability that it is
    none of them; ``type1`` that the error is of type I, from the marks alone. ``decisive`` has an
    entry for each parameter, None where it was never compared.
    """

    names: tuple[str, ...]
    scores: Floats
    posterior: Floats
    none: float
    type1: float
    decisive: tuple[Decisive | None, ...]

    @property
    def order(self) -> list[int]:
        """The columns of compared parameters, the most suspicious first; ties by name."""
        known = np.flatnonzero(np.isfinite(self.scores))
        return [int(n) for n in known[np.argsort(-self.scores[known], kind="stable")]]


def diagnose_log(
    recording: Recording, static_info: StaticInfo, *, weights: Weights = WEIGHTS
) -> Posterior:
    """Judge all parameters by all marks of a mission together.

    Args:
        recording: the mission with its marks, of any types or none.
        static_info: what the analysis found.
        weights: what the evidence counts.
    """
    tpcs = Tpcs.of(static_info)
    streams = ResultStreams.of(with_summarised(recording), tpcs)
    marks = recording.marks
    if not marks or not streams.streams:
        nobody = np.full(len(tpcs.names), -np.inf)
        nothing = (None,) * len(tpcs.names)
        return Posterior(tpcs.names, nobody, np.zeros(len(tpcs.names)), 1.0, 0.5, nothing)
    times = np.array([mark.time_ns for mark in marks], np.int64)
    observed = marked(marks, streams)
    others = OtherNodes.of(streams, tpcs, static_info, recording.wiring)
    found = mark_evidence(streams, observed, None if others is None else others.reached)
    places = np.array([stream.column for stream in streams.streams])
    said = Said(places, ranked(recording, tpcs, times), np.array([type_odds(marks)]))
    mixed = mixture(found, said, weights)
    with np.errstate(divide="ignore"):
        scores, none = np.log(mixed.shares[0, :-1]), math.log(mixed.shares[0, -1])
    posterior, rest = softmax(scores, none)
    by = _decisive(streams, tpcs, mixed)
    type1 = 1.0 / (1.0 + math.exp(float(said.odds[0])))
    return Posterior(tpcs.names, scores, posterior, rest, type1, by)


def _decisive(streams: ResultStreams, tpcs: Tpcs, mixed: Mixture) -> tuple[Decisive | None, ...]:
    """For each parameter the best stream by the parameter's likelier type."""
    best: list[Decisive | None] = [None] * len(tpcs.names)
    for turned in (False, True):
        scores = mixed.acted if turned else mixed.waited
        for n in reversed(np.argsort(-scores, kind="stable").tolist()):
            stream = streams.streams[n]
            if (mixed.turned[0, stream.column] > 1 / 2) == turned:
                type1 = float(mixed.type1[0, stream.column])
                best[stream.column] = Decisive(tpcs.keys[stream.code], stream.node, type1)
    return tuple(best)


def ranked(recording: Recording, tpcs: Tpcs, times_ns: Int64s) -> Floats:
    """float64[2, 1, p]: where the baseline's ranks put each parameter, as -log(place).

    The first by the rank of type I, the second by the better of both ranks; the mean over the
    marks. Tied parameters have the mean of their places; -inf for what was never compared.
    """
    events = recording.events.with_keys(tpcs.keys)
    tables = parameter_tables(
        tpcs, tpc_scores(tpcs, LogTables(events, recording.summaries), times_ns)
    )
    every = with_summarised(recording).with_keys(tpcs.keys)
    compared = {tpcs.parameters[code] for code in np.unique(every.key).tolist()}
    known = np.array([name in compared for name in tpcs.names], np.bool_)
    found = np.full((2, 1, known.size), -np.inf)
    for row, ranks in enumerate((tables.first.ranks, tables.combined)):
        mean = np.round(ranks.mean(axis=0)[known], _DIGITS)
        ascending = np.sort(-mean)
        before = np.searchsorted(ascending, -mean, side="left")
        upto = np.searchsorted(ascending, -mean, side="right")
        found[row, 0, known] = -np.log((before + upto + 1) / 2)
    return found


def type_odds(marks: Sequence[Mark]) -> float:
    """log P(II) / P(I) of an error, from what was said at the marks and how often they came.

    Either the observers can tell the types apart, except for slips, or what they say means nothing.
    If all of them agree, the first is likelier. The plain numbers of table 6.13 would make a mark
    of type I evidence for type II; other people are not assumed to do that.
    """
    users: dict[str, int] = {}
    said = {"I": 0.0, "II": 0.0}
    for mark in sorted(marks, key=Mark.order):
        before = users.get(mark.observer, 0)
        users[mark.observer] = before + 1
        if mark.type is not None:
            said[mark.type] += LATER**before
    ones, twos = said["I"], said["II"]
    vague = ones * math.log(SAID_I) + twos * math.log(1 - SAID_I) + math.log(LIED)
    likely = []
    for right, wrong in ((ones, twos), (twos, ones)):
        clear = right * math.log(1 - SLIP) + wrong * math.log(SLIP) + math.log(1 - LIED)
        likely.append(float(np.logaddexp(clear, vague)))
    repeated = sum(_geometric(n, MARKS_II) - _geometric(n, MARKS_I) for n in users.values())
    return likely[1] - likely[0] + REPEAT * repeated


class Said(NamedTuple):
    """What is known besides the evidence, for s sets of marks with up to p parameters each.

    ``places`` int64[streams], whose each is: places in the flat table [s, p]. ``ranked``
    float64[2, s, p], see there; ``odds`` float64[s], see ``type_odds``.
    """

    places: Int64s
    ranked: Floats
    odds: Floats


class Mixture(NamedTuple):
    """``shares`` float64[s, p + 1]: the probabilities, the last that of none of them.

    ``acted`` and ``waited`` float64[streams] are the scores of the streams. Of each parameter, if
    it is to blame, float64[s, p]: ``type1`` is the probability of type I, ``turned`` that of type I
    or a latch.
    """

    shares: Floats
    acted: Floats
    waited: Floats
    type1: Floats
    turned: Floats


def mixture(found: MarkEvidence, said: Said, weights: Weights) -> Mixture:
    """What all witnesses say together, see the module's docstring."""
    acted = weights.acted * found.acted
    waited = (
        weights.waited * found.waited
        + weights.since * found.since
        + weights.held * np.log(found.held + SHARE)
        + weights.near * found.near
        + weights.flat * found.flat
    )
    shape = said.ranked.shape[1:]
    own = [_logit(_mean(scores, said.places, shape), weights.none) for scores in (acted, waited)]
    orders = [_logit(weights.ranked * one, -math.inf) for one in said.ranked]
    did, waits = (_half(a, b) for a, b in zip(own, orders, strict=True))
    second = 1.0 / (1.0 + np.exp(-said.odds))[:, None]
    latch = 1.0 / (1.0 + math.exp(-weights.latch))
    shares = (1.0 - second) * did + second * ((1.0 - latch) * waits + latch * did)
    some = np.maximum(shares, 1e-300)
    type1 = (1.0 - second) * did / some
    turned = type1 + second * latch * did / some
    return Mixture(shares, acted, waited, type1[:, :-1], turned[:, :-1])


def _half(own: Floats, order: Floats) -> Floats:
    """Both in equal parts. The order does not say whether it is any parameter at all."""
    none = own[:, -1:]
    return np.column_stack([(own[:, :-1] + (1.0 - none) * order[:, :-1]) / 2, none])


def _mean(scores: Floats, places: Int64s, shape: tuple[int, ...]) -> Floats:
    """float64[s, p]: the score of each parameter; -inf without a stream.

    Any of its streams may be the one, each as likely before: the mean of their odds. With the best
    one alone, who is compared at twenty places would be likelier than who is at one.
    """
    best = np.full(math.prod(shape), -np.inf)
    np.maximum.at(best, places, scores)
    odds, count = np.zeros(best.size), np.bincount(places, minlength=best.size)
    np.add.at(odds, places, np.exp(scores - best[places]))
    known = count > 0
    best[known] += np.log(odds[known] / count[known])
    return best.reshape(shape)


def _logit(scores: Floats, none: float) -> Floats:
    """float64[s, p + 1]: the softmax of the scores, with ``none`` as the last one."""
    table = np.column_stack([scores, np.full(scores.shape[0], none)])
    mass = np.exp(table - table.max(axis=1, keepdims=True))
    return np.asarray(mass / mass.sum(axis=1, keepdims=True))


def softmax(scores: Floats, none: float) -> tuple[Floats, float]:
    """The probability of each, and of none of them."""
    top = max(float(scores.max(initial=-np.inf)), none)
    parts = np.exp(scores - top)
    rest = math.exp(none - top)
    total = float(parts.sum()) + rest
    return parts / total, rest / total


def _geometric(count: int, mean: float) -> float:
    """log P(count) of a geometric distribution from 1 with that mean."""
    return (count - 1) * math.log(1 - 1 / mean) - math.log(mean)
