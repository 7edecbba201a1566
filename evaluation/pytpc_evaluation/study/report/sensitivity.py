"""The study's missions, marked by people whom the ranking was not tuned to.

The study's observers draw their delays and numbers of marks from tables 6.14 and 6.15 of the
thesis, and the ranking takes its constants from the same tables. Here the missions are marked by
people who are faster, slower, alone and so on, and ranked by those marks. So they are by marks of
one of the study's own observers that come late, are few, or say more
(`pytpc_evaluation.study.other_marks`). The verdicts stand in ``results/sensitivity.parquet``. Its
rows are those of ``results/positions.parquet``, with the crowd as ``who``, or with what is
different about the marks; then there is a row for each observer.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pyarrow as pa

from pytpc.base.columns import write_table
from pytpc.base.errors import InputError
from pytpc_evaluation.demo.demo_examples import SHARED_PACKAGE
from pytpc_evaluation.study.case import Method
from pytpc_evaluation.study.data import Labels, Mission, user_marks
from pytpc_evaluation.study.dataset import CAUSES_FILE, DONE_FILE, SIGHTS_FILE, load_done
from pytpc_evaluation.study.digest import people_digest
from pytpc_evaluation.study.judge import SCHEMA, Judged, judge
from pytpc_evaluation.study.methods import METHODS
from pytpc_evaluation.study.other_marks import VARIANTS, other_marks
from pytpc_evaluation.study.people import look_on
from pytpc_evaluation.study.report.judging import Ranking
from pytpc_evaluation.study.verdict_digest import contents, digest_of, mission_digest

SENSITIVITY_FILE = Path("results") / "sensitivity.parquet"
PROGRAM = SHARED_PACKAGE.parent / "other_people" / "crowds.py"
CROWDS = ("thesis", "fast", "slow", "spread", "two-marks", "alone", "coin")
"""The files that the program writes; the first is of the mission's own people."""
_METHODS = ("tpc", "tpc+reference", "thesis")
ALONE_METHODS = ("tpc", "tpc+2-runs")
"""The methods that judge one observer's marks."""
_LABELS: tuple[Labels, ...] = ("typed", "confused")


def by_others() -> Ranking:
    """``results/sensitivity.parquet``: some methods, by the marks of other people."""
    methods = {name: METHODS[name] for name in dict.fromkeys((*_METHODS, *ALONE_METHODS))}
    return Ranking(SENSITIVITY_FILE, methods, inputs_digest, judge_by_others, save_sensitivity)


def inputs_digest(out: Path, mission: Path, half: str) -> str:
    """Of what the methods read of a mission, and of what the crowds' marks are made from.

    Raises:
        InputError: a file cannot be read.
    """
    done = load_done(mission)
    looked = [people_digest(), contents(PROGRAM), None if done is None else done.people]
    seen = [contents(mission / CAUSES_FILE), contents(mission / SIGHTS_FILE)]
    return digest_of([mission_digest(out, mission, half), *seen, *looked])


def judge_by_others(
    mission: Mission, folder: Path, methods: Mapping[str, Method]
) -> Iterator[Judged]:
    """The verdicts of the methods by the marks of each crowd, and by other marks of one observer.

    Args:
        mission: as it was read.
        folder: the mission's; nothing is written there.
        methods: by their names.

    Raises:
        InputError: the mission is not whole.
        RunError: the program fails.
    """
    of_crowd = {name: one for name, one in methods.items() if name in _METHODS}
    with TemporaryDirectory(prefix="tpc-people-") as marks:
        words = ["--causes", str(folder / CAUSES_FILE), "--sights", str(folder / SIGHTS_FILE)]
        words += ["--seed", str(_seed(folder)), "--folder", marks]
        look_on(PROGRAM, os.environ, words)
        for crowd in CROWDS:
            marked = replace(mission, marks=user_marks(Path(marks) / f"{crowd}.parquet"))
            for row in judge(marked, of_crowd, _LABELS, users=()):
                yield replace(row, who=crowd)
    alone = {name: one for name, one in methods.items() if name in ALONE_METHODS}
    for variant in VARIANTS:
        for marked in other_marks(mission, variant):
            for row in judge(marked, alone, ("confused",), users=()):
                yield replace(row, who=variant)


def save_sensitivity(rows: Iterable[Judged], out: Path) -> None:
    """Write the table into the study's folder, atomically.

    Raises:
        TpcError: the file cannot be written.
    """
    path = out / SENSITIVITY_FILE
    path.parent.mkdir(parents=True, exist_ok=True)
    write_table(pa.Table.from_pylist([asdict(row) for row in rows], schema=SCHEMA), path)


def _seed(mission: Path) -> int:
    """Of those who looked on in the mission."""
    done = load_done(mission)
    if done is None:
        raise InputError("does not say who looked on", mission / DONE_FILE)
    return done.people
