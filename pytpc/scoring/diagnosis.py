"""Who is to blame: a posterior over the parameters, and over none of them, from all marks at once.

``diagnose`` is the entrance. For each parameter p

    score(p) = log( P(I) exp(a . x_I(p)) + P(II) exp(b . x_II(p)) )

with the evidence x of `pytpc.scoring.diagnosis_evidence` of its best comparison; P is how likely
either type is from what the marks say (``type_odds``), a part of type II being latches: a change
that cannot be undone. The baseline's ranks are a witness in both (``ranked``): that by type I for
type I, the better of both for type II. The posterior
is that of a conditional logit (McFadden 1974): exp(score(p)) over the sum of all, "none of them"
being one alternative with a constant score. So a few weights, fitted on the tuning half of the
study (`pytpc.study.fit`), make one order of both types, and a probability beside it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pytpc.columns import Floats, Int64s
from pytpc.ingest.recording import Recording
from pytpc.marks import Mark
from pytpc.scoring.diagnosis_evidence import SHARE, Evidence, Witness, evidence, marked
from pytpc.scoring.diagnosis_streams import Streams
from pytpc.scoring.tables import Tpcs, parameter_tables, tpc_scores
from pytpc.static_info import StaticInfo


@dataclass(frozen=True, slots=True)
class Weights:
    """What the evidence counts."""

    acted: float = 0.8
    ranked1: float = 0.3
    waited: float = 0.8
    since: float = 0.4
    held: float = 1.0
    near: float = -0.7
    flat: float = -1.5
    ranked: float = 0.3
    type2: float = 0.0
    latch: float = -1.5
    none: float = 1.0


REASONED = Weights()
"""The weights by reason alone: where the fit begins, and what it stays near."""

WEIGHTS = Weights(
    acted=0.89,
    ranked1=0.24,
    waited=0.77,
    since=0.14,
    held=0.95,
    near=-0.82,
    flat=-1.5,
    ranked=1.18,
    type2=-0.24,
    latch=-1.24,
    none=0.82,
)
"""Fitted by `python -m pytpc.study.fit` on the whole tuning half of the study: 24 treatments of
types I and II, three faults and the clean missions of three robots, 699 sets of marks. Their loss
is 2.449 (2.911 with ``REASONED``). With one robot left out it is on that robot 3.137
(image_capture; reasoned 3.268), 2.741 (navigation; 3.118), 2.065 (water_sampler; 2.348)."""

LIED = 0.5
"""Before any mark is seen: that these observers cannot tell the types apart (table 6.13)."""
SLIP = 0.05
"""An observer who can tell them apart says the wrong one this often."""
SAID_I = 28 / 68
"""Who cannot says type I this often, whatever it is: the share of all marks in table 6.13."""

MARKS_I, MARKS_II = 17 / 8, 51 / 8
"""Marks of a user in a trial of either type, by table 6.15."""
LATER = 0.5
"""What is said at each mark of an observer counts so much of what was said at the one before: what
comes later is often of another error, that follows from the first."""
REPEAT = 0.5
"""How much the number of marks counts: those of one observer are not independent."""


class Decisive(NamedTuple):
    """The comparison that a parameter has its score by: whose it is, and P(I) if it is to blame."""

    key: str
    node: str
    type1: float


@dataclass(frozen=True)
class Diagnosis:
    """The parameters and what speaks against them.

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
        """The columns of those that were compared, the most suspicious first; ties by name."""
        known = np.flatnonzero(np.isfinite(self.scores))
        return [int(n) for n in known[np.argsort(-self.scores[known], kind="stable")]]


def diagnose(
    recording: Recording,
    static_info: StaticInfo,
    *,
    prior: Floats | None = None,
    weights: Weights = WEIGHTS,
) -> Diagnosis:
    """Judge all parameters by all marks of a mission together.

    Args:
        recording: the mission with its marks, of any types or none.
        static_info: what the analysis found.
        prior: float64[p], added to the scores: what is known of the parameters otherwise.
        weights: what the evidence counts.

    Raises:
        ValueError: ``prior`` does not have one number for each parameter.
    """
    tpcs = Tpcs.of(static_info)
    extra = np.zeros(len(tpcs.names)) if prior is None else np.asarray(prior, np.float64)
    if extra.shape != (len(tpcs.names),):
        raise ValueError("one prior for each parameter is needed")
    streams = Streams.of(recording.events, tpcs)
    marks = recording.marks
    if not marks or not streams.streams:
        nobody = np.full(len(tpcs.names), -np.inf)
        nothing = (None,) * len(tpcs.names)
        return Diagnosis(tpcs.names, nobody, np.zeros(len(tpcs.names)), 1.0, 0.5, nothing)
    times = np.array([mark.time_ns for mark in marks], np.int64)
    observed = marked(times, tuple(mark.observer for mark in marks), streams)
    found = evidence(streams, observed, ranked(recording, tpcs, times))
    columns = np.array([stream.column for stream in streams.streams])
    odds = type_odds(marks)
    scores = parameter_scores(found, columns, len(tpcs.names), odds, weights) + extra
    posterior, none = softmax(scores, weights.none)
    by = _decisive(streams, tpcs, *stream_scores(found, odds, weights))
    return Diagnosis(tpcs.names, scores, posterior, none, 1.0 / (1.0 + math.exp(odds)), by)


def _decisive(
    streams: Streams, tpcs: Tpcs, scores: Floats, type1: Floats
) -> tuple[Decisive | None, ...]:
    """The best stream of each parameter, the first of equal ones."""
    best: list[Decisive | None] = [None] * len(tpcs.names)
    for n in reversed(np.argsort(-scores, kind="stable").tolist()):
        stream = streams.streams[n]
        best[stream.column] = Decisive(tpcs.keys[stream.code], stream.node, float(type1[n]))
    return tuple(best)


def ranked(recording: Recording, tpcs: Tpcs, times_ns: Int64s) -> Witness:
    """How high the baseline's two scores put each parameter, as a logarithm.

    With k(p) parameters before it by a rank of SPEC 7, in the mean over the marks, it is
    -log(2 + k(p)). Behind all that were ever compared stands who has no score.
    """
    events = recording.events.with_keys(tpcs.keys)
    tables = parameter_tables(tpcs, tpc_scores(tpcs, events, recording.summaries, times_ns))
    compared = len({tpcs.parameters[code] for code in np.unique(events.key).tolist()})

    def height(ranks: Floats) -> Floats:
        before = np.minimum((1.0 - ranks) * len(tpcs.names), compared).mean(axis=0)
        return np.asarray(-np.log(2.0 + before))

    return Witness(height(tables.first.ranks), height(tables.combined))


def type_odds(marks: Sequence[Mark]) -> float:
    """log P(II) / P(I) of an error, from what was said at the marks and how often they came.

    The observers either can tell the types apart, but for slips, or what they say means nothing.
    That all of them agree speaks for the first. Both numbers of table 6.13 taken as they are would
    make a mark of type I evidence for type II; that is not believed of other people.
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


def parameter_scores(
    found: Evidence, columns: Int64s, parameters: int, odds: float | Floats, weights: Weights
) -> Floats:
    """The score of each parameter: that of its best stream.

    Args:
        found: the evidence of the streams.
        columns: int64[streams], whose each is.
        parameters: how many there are.
        odds: of the types, see ``type_odds``; of all or of each stream.
        weights: what the evidence counts.
    """
    best = np.full(parameters, -np.inf)
    np.maximum.at(best, columns, stream_scores(found, odds, weights)[0])
    return best


def stream_scores(found: Evidence, odds: float | Floats, weights: Weights) -> tuple[Floats, Floats]:
    """float64[streams] each: the score, and the part of it that is an error of type I.

    A latch is of type II: what is not done any more since.
    """
    first = weights.acted * found.acted + weights.ranked1 * found.ranked1
    second = (
        weights.type2
        + weights.waited * found.waited
        + weights.since * found.since
        + weights.held * np.log(found.held + SHARE)
        + weights.near * found.near
        + weights.flat * found.flat
        + weights.ranked * found.ranked
    )
    # In logarithms: of type II that are latches, of type II that are not, of type I.
    latched, held = -np.logaddexp(0.0, -weights.latch), -np.logaddexp(0.0, weights.latch)
    other, one = -np.logaddexp(0.0, -np.asarray(odds)), -np.logaddexp(0.0, odds)
    score = np.logaddexp(first + np.logaddexp(one, other + latched), second + other + held)
    return score, np.exp(first + one - score)


def softmax(scores: Floats, none: float) -> tuple[Floats, float]:
    """The posterior of each, and of none of them."""
    top = max(float(scores.max(initial=-np.inf)), none)
    parts = np.exp(scores - top)
    rest = math.exp(none - top)
    total = float(parts.sum()) + rest
    return parts / total, rest / total


def _geometric(count: int, mean: float) -> float:
    """log P(count) of a geometric distribution from 1 with that mean."""
    return (count - 1) * math.log(1 - 1 / mean) - math.log(mean)
