"""Where each method puts the parameter that a treatment changed: ``results/positions.parquet``.

The position is the place in the order, from 1. Parameters that are tied have the mean of their
places and stand there with how many they are, so that nobody gains by making no difference; those
that a method does not name are tied behind all that it names. Where the mission has no mark there
is no position: that is a miss.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from pytpc.base.columns import write_table
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.static.parameters import same_parameter
from pytpc_evaluation.study.case import Method, Verdict
from pytpc_evaluation.study.data import ALL, LABELS, Labels, Mission

POSITIONS_FILE = Path("results") / "positions.parquet"

SCHEMA = pa.schema(
    [
        pa.field("system", pa.string()),
        pa.field("treatment", pa.string()),
        pa.field("type", pa.string()),
        pa.field("half", pa.string()),
        pa.field("seed", pa.int64()),
        pa.field("labels", pa.string()),
        pa.field("who", pa.string()),
        pa.field("method", pa.string()),
        pa.field("position", pa.float64()),
        pa.field("parameters", pa.int64()),
        pa.field("top", pa.string()),
        pa.field("confidence", pa.float64()),
        pa.field("marks", pa.int64()),
        pa.field("digest", pa.string()),
        pa.field("tied", pa.int64()),
        pa.field("round", pa.int64()),
        pa.field("none", pa.float64()),
    ]
)


@dataclass(frozen=True, slots=True)
class Judged:
    """A row: one verdict. ``position`` and ``confidence`` are None where there is none.

    ``digest`` is `verdict_digest`, empty where it is not known. ``tied`` is how many parameters
    share the position, itself among them; ``round`` is when the treatment was made. ``none`` is the
    probability that it is none of the parameters.
    """

    system: str
    treatment: str
    type: str
    half: str
    seed: int
    labels: str
    who: str
    method: str
    position: float | None
    parameters: int
    top: str
    confidence: float | None
    marks: int
    digest: str = ""
    tied: int = 1
    round: int = 1
    none: float | None = None


class MeanPlace(NamedTuple):
    """A place from 1, the mean of those of all that are ``tied`` there."""

    mean: float
    tied: int


def judge(
    mission: Mission,
    methods: Mapping[str, Method],
    labels: Sequence[Labels] = LABELS,
    users: Sequence[str] | None = None,
) -> Iterator[Judged]:
    """The verdicts of all methods on a mission: by the marks of all users, and by each one's.

    Args:
        mission: with its marks.
        methods: by their names.
        labels: which types the marks have.
        users: whose marks are taken alone, too; None for all that marked it.
    """
    alone = sorted({mark.observer for mark in mission.marks}) if users is None else users
    names = Tpcs.of(mission.static_info).names
    for label in labels:
        for who in (ALL, *alone):
            case = mission.case(label, who)
            marks = len(case.recording.marks)
            for name, method in methods.items():
                verdict = method(case) if marks else Verdict(())
                known = marks > 0 and not np.isnan(verdict.confidence)
                found = position(verdict, mission.parameter, names) if marks else None
                yield Judged(
                    mission.system,
                    mission.treatment,
                    mission.type,
                    mission.half,
                    mission.seed,
                    label,
                    who,
                    name,
                    None if found is None else found.mean,
                    len(names),
                    verdict.order[0] if verdict.order else "",
                    verdict.confidence if known else None,
                    marks,
                    tied=1 if found is None else found.tied,
                    round=mission.round,
                    none=verdict.none if marks and not np.isnan(verdict.none) else None,
                )


def position(verdict: Verdict, parameter: str | None, names: Sequence[str]) -> MeanPlace | None:
    """The place of a parameter among ``names``, None where none was changed.

    A name that several parameters of the source can have means the first of them in the order.
    """
    if parameter is None:
        return None
    places = [place(verdict, name, len(names)) for name in names if same_parameter(parameter, name)]
    return min(places, default=None)


def place(verdict: Verdict, name: str, parameters: int) -> MeanPlace:
    """The place of a name among so many parameters."""
    if name not in verdict.order:
        named = len(verdict.order)
        return MeanPlace((named + 1 + parameters) / 2, parameters - named)
    index = verdict.order.index(name)
    if not verdict.scores:
        return MeanPlace(index + 1.0, 1)
    tied = [n for n, score in enumerate(verdict.scores) if score == verdict.scores[index]]
    return MeanPlace(sum(tied) / len(tied) + 1.0, len(tied))


def save_positions(rows: Iterable[Judged], out: Path) -> None:
    """Write the table into the study's folder, atomically.

    Raises:
        TpcError: the file cannot be written.
    """
    path = out / POSITIONS_FILE
    path.parent.mkdir(parents=True, exist_ok=True)
    write_table(pa.Table.from_pylist([asdict(row) for row in rows], schema=SCHEMA), path)
