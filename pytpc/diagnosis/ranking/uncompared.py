"""Suspects that no comparison reports: gains, frames, poses, and what the mission never asked.

The log has nothing to say about such a parameter. It is a suspect because its value differs from
those of good runs, with what the log would say of a parameter that fits to the marks neither well
nor badly. Among them, and what was compared while a node was set up only, the larger difference is
the likelier cause.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from pytpc.diagnosis.ranking.known_good import SET_ANEW
from pytpc.diagnosis.ranking.mark_evidence import Marked, any_time, caused, marked
from pytpc.diagnosis.ranking.other_values import ALONE, REPLAYED, nobody
from pytpc.diagnosis.ranking.posterior import Posterior
from pytpc.diagnosis.ranking.replayed_outcomes import ACQUITTED, UNKNOWN_CHARGE
from pytpc.diagnosis.ranking.result_streams import ResultStreams
from pytpc.diagnosis.results.differences import Difference, RunDifferences
from pytpc.diagnosis.results.suspects import Suspected, Uncompared
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_values import ParameterValues

READ_BY_NOBODY = -3.0
"""The log odds of all parameters together that no analysed node reads: one that was not analysed
may, and a robot may have thousands of them. Not of one whose name is like one that a node reads and
nobody set: a misspelt name leaves a default."""

SIZE = 0.5
"""What a difference of a factor e counts between parameters of which the log says nothing: one that
is ten times as large is three times as likely as one that is the same. By reason: what shows is
seldom a small change. In the study, harmless changes are as large as others."""

LARGEST = math.log(10.0)
"""A larger difference, or one of the sign, counts as one of a factor of ten."""

OTHER_WAY = math.log(3.0)
"""A flag, a text or a list that differs counts as a factor of three."""


def with_uncompared(
    found: Posterior,
    recording: Recording,
    streams: ResultStreams,
    differences: RunDifferences | None,
) -> tuple[float, tuple[Uncompared, ...]]:
    """Judge what differs from good runs, and no comparison reports, beside the compared parameters.

    Args:
        found: the judgement of the compared parameters.
        recording: with its marks, at least one.
        streams: of the recording.
        differences: what differs from good runs; None if there is none.

    Returns:
        The share that is left to the compared parameters and to "none of them", and the others by
        name, without their positions.
    """
    silent = [] if differences is None else [one for one in differences.found if one.is_silent]
    if not silent:
        return 1.0, ()
    order = found.order
    level = found.scores[order[0]] - math.log(found.posterior[order[0]]) if order else 0.0
    plain = REPLAYED * UNKNOWN_CHARGE - ALONE * math.log(max(len(order), 1))
    base = level if order else nobody(differences) - math.log(found.none)
    values, marks = ParameterValues(recording.values), marked(recording.marks, streams)
    unread = sum(_is_unread(one) for one in silent)
    odds = []
    for one in silent:
        score = plain + _set_anew(values.history(one.parameter), marks, streams)
        if _is_unread(one):
            score += READ_BY_NOBODY - math.log(unread)
        odds.append(math.exp(score - base))
    left = 1.0 / (1.0 + sum(odds))
    named = [Uncompared(1, False, left * each, one) for one, each in zip(silent, odds, strict=True)]
    return left, tuple(sorted(named, key=lambda one: one.parameter))


def by_size(
    suspects: Sequence[Suspected], differences: RunDifferences | None, unheard: Collection[str]
) -> list[Suspected]:
    """The suspects, those of which the log says nothing sharing their part by how much they differ.

    What a parameter did is better evidence than how far its value is from a good one; but of these
    nobody knows what they did.

    Args:
        suspects: of all kinds.
        differences: what differs from good runs; None if there is none.
        unheard: the names of those that were compared while their node was set up only.
    """
    sizes = {} if differences is None else {one.name: _size(one) for one in differences.found}
    shares = {
        one.parameter: one.probability * math.exp(SIZE * sizes[one.parameter])
        for one in suspects
        if one.parameter in sizes and (one.parameter in unheard or _is_read(one))
    }
    together = sum(one.probability for one in suspects if one.parameter in shares)
    total = sum(shares.values())
    return [
        replace(one, probability=together * shares[one.parameter] / total)
        if one.parameter in shares
        else one
        for one in suspects
    ]


def _is_read(one: Suspected) -> bool:
    return isinstance(one, Uncompared) and not _is_unread(one.difference)


def _size(one: Difference) -> float:
    return OTHER_WAY if one.apart is None else min(one.apart, LARGEST)


def _is_unread(one: Difference) -> bool:
    return one.state is None and not one.alike


def _set_anew(
    history: Sequence[tuple[int, object]], marks: Marked, streams: ResultStreams
) -> float:
    """What speaks against a parameter that was set anew while the mission ran: it is then a turn.

    0 for one that was not, or if its values over time were not recorded.
    """
    turns = (np.array([time_ns for time_ns, _ in history[1:]]) - streams.begin_ns) / 1e9
    turns = turns[(turns >= 0.0) & (turns <= marks.firsts.max())]
    if not turns.size:
        return 0.0
    fits = caused(turns, np.ones(turns.size), streams.seconds, marks)
    charge = max(ACQUITTED, fits - any_time(streams.seconds, marks))
    return SET_ANEW + REPLAYED * (charge - UNKNOWN_CHARGE)
