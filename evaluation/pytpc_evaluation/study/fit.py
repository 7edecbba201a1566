"""Fits the weights of `pytpc.diagnosis.ranking.posterior` on the tuning half of a study.

    python -m pytpc_evaluation.study.fit out/study

What is made greatest is the mean log posterior of what is to blame: the changed parameter, or none
of them on clean missions and those with a fault in the source. Each treatment counts the same, and
a normal prior holds each weight near the one that was chosen by reason (``REASONED``), for there
are few treatments. The fits with one system left out show how far it goes beyond what it has seen.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, astuple, dataclass, fields
from pathlib import Path

import numpy as np

from pytpc.base.columns import Bools, Floats, Int64s
from pytpc.base.errors import TpcError
from pytpc.diagnosis.ranking.mark_evidence import MarkEvidence, mark_evidence, marked
from pytpc.diagnosis.ranking.posterior import Said, Weights, mixture, ranked, type_odds
from pytpc.diagnosis.ranking.result_streams import ResultStreams
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.static.parameters import same_parameter
from pytpc_evaluation.study.data import ALL, LABELS, Mission, missions

REASONED = Weights(
    acted=0.8,
    waited=0.8,
    since=0.4,
    held=1.0,
    near=-0.7,
    flat=-1.5,
    ranked=1.0,
    latch=-1.5,
    none=1.0,
)
"""The weights by reason alone: where the fit begins, and what it stays near."""


ALONE = 0.3
"""What the marks of single users count beside those of all together, which the study judges by."""

WIDTH = 0.5
"""The standard deviation of the prior of a weight about the reasoned one."""

STEPS = 150


@dataclass(frozen=True, eq=False)
class Sample:
    """One set of marks on one mission: the evidence, and whose fault it was.

    ``columns`` int64[streams] is the parameter of each; ``ranked`` as in `Said`, of one set of
    marks; ``right`` are the columns of the parameter that is to blame, empty for none.
    """

    system: str
    treatment: str
    found: MarkEvidence
    columns: Int64s
    ranked: Floats
    odds: float
    right: tuple[int, ...]
    weight: float

    @property
    def parameters(self) -> int:
        """How many there are."""
        return int(self.ranked.shape[2])

    @property
    def unit(self) -> tuple[str, str]:
        """The treatment."""
        return (self.system, self.treatment)


@dataclass(frozen=True, eq=False)
class Batch:
    """All samples in one table: the streams of all, one after the other.

    ``right`` bool[samples, width + 1] is who is to blame, where the last column is "none";
    ``share`` float64[samples] sums to 1.
    """

    found: MarkEvidence
    said: Said
    right: Bools
    share: Floats

    @classmethod
    def of(cls, parts: Sequence[Sample]) -> Batch:
        """Put them together; each treatment has the same share."""
        width = max(sample.parameters for sample in parts)
        sums: dict[tuple[str, str], float] = {}
        for sample in parts:
            sums[sample.unit] = sums.get(sample.unit, 0.0) + sample.weight
        right = np.zeros((len(parts), width + 1), np.bool_)
        baseline = np.full((2, len(parts), width), -np.inf)
        for row, sample in enumerate(parts):
            right[row, list(sample.right) or [width]] = True
            baseline[:, row, : sample.parameters] = sample.ranked[:, 0]
        columns = [
            np.concatenate([getattr(sample.found, field.name) for sample in parts])
            for field in fields(MarkEvidence)
        ]
        return cls(
            MarkEvidence(*columns),
            Said(
                np.concatenate([sample.columns + row * width for row, sample in enumerate(parts)]),
                baseline,
                np.array([sample.odds for sample in parts]),
            ),
            right,
            np.array([sample.weight / sums[sample.unit] / len(sums) for sample in parts]),
        )

    def loss(self, weights: Weights) -> float:
        """The mean of minus the log posterior of what is to blame."""
        share = (mixture(self.found, self.said, weights).shares * self.right).sum(axis=1)
        return -float(np.sum(self.share * np.log(np.maximum(share, 1e-9))))


def samples(mission: Mission) -> list[Sample]:
    """Those of a mission: the marks of all users, and of each alone, with all labels."""
    tpcs = Tpcs.of(mission.static_info)
    streams = ResultStreams.of(mission.recording.events, tpcs)
    columns = np.array([stream.column for stream in streams.streams], np.int64)
    right = tuple(
        column
        for column, name in enumerate(tpcs.names)
        if mission.parameter is not None and same_parameter(mission.parameter, name)
    )
    users = sorted({mark.observer for mark in mission.marks})
    made = []
    for who in (ALL, *users):
        own = [mark for mark in mission.marks if who in {ALL, mark.observer}]
        times = np.array([mark.time_ns for mark in own], np.int64)
        observed = marked([mark.mark("untyped") for mark in own], streams)
        found = mark_evidence(streams, observed)
        baseline = ranked(mission.recording, tpcs, times)
        share = (1.0 if who == ALL else ALONE / len(users)) / len(LABELS)
        made += [
            Sample(
                mission.system,
                mission.treatment,
                found,
                columns,
                baseline,
                type_odds([mark.mark(labels) for mark in own]),
                right,
                share,
            )
            for labels in LABELS
        ]
    return made


def fit(
    found: Sequence[Sample], on_progress: Callable[[int, float], None] | None = None
) -> Weights:
    """The weights with the least loss, by resilient propagation (Riedmiller, Braun 1993).

    It needs the signs of the slopes only, so that the corners of a loss of best streams do not
    matter.

    Args:
        found: the samples.
        on_progress: called with the number of the step and the loss after it.
    """
    batch, treatments = Batch.of(found), len({sample.unit for sample in found})
    start = np.array(astuple(REASONED))

    def target(values: Floats) -> float:
        away = float(np.sum((values - start) ** 2)) / (2 * WIDTH**2)
        return batch.loss(Weights(*values.tolist())) + away / treatments

    at, step = start.copy(), np.full(start.size, 0.1)
    before = np.zeros(start.size)
    best, least = at.copy(), target(at)
    for number in range(STEPS):
        slope = np.array([_slope(target, at, n) for n in range(at.size)])
        step = np.clip(step * np.where(slope * before < 0, 0.5, 1.2), 1e-3, 0.3)
        at = at - np.sign(slope) * step
        before = slope
        now = target(at)
        if now < least:
            best, least = at.copy(), now
        if on_progress is not None:
            on_progress(number + 1, now)
        if float(step.max()) <= 2e-3:
            break
    return Weights(*best.round(2).tolist())


def _slope(target: Callable[[Floats], float], at: Floats, place: int) -> float:
    side = np.zeros(at.size)
    side[place] = 0.01
    return target(at + side) - target(at - side)


def main(out: Path) -> Iterable[str]:
    """What was fitted, in lines."""
    found = [sample for mission in missions(out) if mission.marks for sample in samples(mission)]
    names = ", ".join(field.name for field in fields(Weights))
    yield f"{len(found)} sets of marks on the tuning half; weights {names}"
    yield f"reasoned: loss {Batch.of(found).loss(REASONED):.3f}"
    for system in sorted({sample.system for sample in found}):
        rest = [sample for sample in found if sample.system != system]
        own = [sample for sample in found if sample.system == system]
        if rest:
            weights = fit(rest)
            yield (
                f"without {system}: loss on it {Batch.of(own).loss(weights):.3f},"
                f" reasoned {Batch.of(own).loss(REASONED):.3f}: {astuple(weights)}"
            )
    weights = fit(found)
    yield f"all: loss {Batch.of(found).loss(weights):.3f}: {asdict(weights)}"


if __name__ == "__main__":
    try:
        for line in main(Path(sys.argv[1])):
            print(line, flush=True)
    except TpcError as error:
        raise SystemExit(f"fit: error: {error}") from None
