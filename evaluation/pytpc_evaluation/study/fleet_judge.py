"""Judges the fleet's ranking, and others, by flown fleets in which the wrong parameter is known.

A fleet's ranking sees all missions of a question at once. A ranking of single missions sees each
bad mission alone; it counts with the share of the bad missions in which it is right.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from hashlib import sha256
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from pytpc.api.wired_robot import with_wiring
from pytpc.base.columns import read_table, write_table
from pytpc.base.errors import TpcError
from pytpc.base.paths import MERGED_FILE
from pytpc.base.signals import signals_end
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.thinned import thinned
from pytpc.recording.graph_file import GRAPH_FILE
from pytpc.recording.mission import EVENTS_FILE, MARKS_FILE, SUMMARIES_FILE, load_recording
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import ORIGINS_FILE, PARAMS_FILE
from pytpc_evaluation.study.case import Case, Verdict
from pytpc_evaluation.study.fleet_questions import FleetQuestion
from pytpc_evaluation.study.judge import position
from pytpc_evaluation.study.methods import METHODS
from pytpc_evaluation.study.metrics import within
from pytpc_evaluation.study.verdict_digest import contents, digest_of, method_digest

RankOf = Callable[[FleetQuestion, Path], Mapping[str, Verdict]]
"""Ranks the parameters of a question's missions, in a folder of fleets: a verdict by each method.

A parameter that is not in a verdict's order counts as one that was not found.
"""
Progress = Callable[[int, int], None]

ALONE = ("tpc+2-runs", "tpc", "importance", "thesis")
"""The methods of the study that see one mission each."""
_GOOD_RUNS = 2
_RANKED = (EVENTS_FILE, SUMMARIES_FILE, MARKS_FILE, PARAMS_FILE, ORIGINS_FILE, GRAPH_FILE)
RESULTS_FILE = Path("results") / "fleet-verdicts.parquet"
ALONE_FILE = Path("results") / "fleet-alone.parquet"
_VERDICTS = pa.schema(
    [
        ("system", pa.string()),
        ("treatment", pa.string()),
        ("type", pa.string()),
        ("half", pa.string()),
        ("shape", pa.string()),
        ("draw", pa.int64()),
        ("method", pa.string()),
        ("first", pa.float64()),
        ("third", pa.float64()),
        ("top", pa.string()),
        ("confidence", pa.float64()),
        ("none", pa.float64()),
        ("bad", pa.int64()),
        ("good", pa.int64()),
        ("digest", pa.string()),
    ]
)
_ALONE = pa.schema(
    [
        ("folder", pa.string()),
        ("method", pa.string()),
        ("first", pa.float64()),
        ("third", pa.float64()),
        ("digest", pa.string()),
    ]
)


@dataclass(frozen=True, slots=True)
class FleetVerdict:
    """What a method said to a question.

    ``first`` and ``third`` are how surely the wrong parameter is the first, or among the first
    three, if ties are broken by chance; of a ranking of single missions the mean over the bad ones.
    ``confidence`` is the probability of ``top``, ``none`` that it is no parameter; both None where
    a method has none. ``bad`` and ``good`` count the missions.
    """

    system: str
    treatment: str
    type: str
    half: str
    shape: str
    draw: int
    method: str
    first: float
    third: float
    top: str
    confidence: float | None
    none: float | None
    bad: int
    good: int
    digest: str = ""


@dataclass(frozen=True, slots=True)
class AloneVerdict:
    """What a method said to one bad mission; see ``FleetVerdict``."""

    folder: str
    method: str
    first: float
    third: float
    digest: str


def judge_fleets(
    out: Path,
    asked: Sequence[FleetQuestion],
    rank_of: RankOf,
    on_progress: Progress | None = None,
    *,
    again: bool = False,
) -> list[FleetVerdict]:
    """Ask the fleet's ranking what it was not asked yet, and save its verdicts.

    What was ranked when this is interrupted is kept.

    Args:
        out: the folder of fleets.
        asked: the questions.
        rank_of: ranks.
        on_progress: called with (questions done, questions in all).
        again: ask all anew.

    Returns:
        The verdicts on these questions.

    Raises:
        TpcError: a mission or the table cannot be read or written, or cannot be ranked.
    """
    path = out / RESULTS_FILE
    by_question: dict[tuple[str, ...], list[FleetVerdict]] = {}
    for one in load_verdicts(out):
        by_question.setdefault(_place(one), []).append(one)
    code, digests = method_digest(rank_of), _Digests(out)
    found: list[FleetVerdict] = []
    for number, question in enumerate(asked, start=1):
        digest = digest_of([code, digests.of_question(question)])
        own = by_question.get(_place(question), [])
        if again or not own or any(one.digest != digest for one in own):
            verdicts = rank_of(question, out).items()
            own = [judged(question, name, one, digest) for name, one in verdicts]
            by_question[_place(question)] = own
            every = [asdict(one) for rows in by_question.values() for one in rows]
            _save(every, _VERDICTS, path)
        found += own
        if on_progress is not None:
            on_progress(number, len(asked))
    return found


def load_verdicts(out: Path) -> list[FleetVerdict]:
    """The verdicts that were saved; none where there is no table.

    Raises:
        InputError: the table cannot be read.
    """
    return [FleetVerdict(**row) for row in _rows(out / RESULTS_FILE, _VERDICTS)]


def judged(
    question: FleetQuestion, method: str, verdict: Verdict, digest: str = ""
) -> FleetVerdict:
    """How a verdict on a question did."""
    place = position(verdict, question.parameter, verdict.order)
    first, third = (0.0 if place is None else within(k, *place) for k in (1, 3))
    return FleetVerdict(
        *_of(question),
        method=method,
        first=first,
        third=third,
        top=verdict.order[0] if verdict.order else "",
        confidence=None if np.isnan(verdict.confidence) else verdict.confidence,
        none=None if np.isnan(verdict.none) else verdict.none,
        bad=len(question.bad),
        good=len(question.good),
        digest=digest,
    )


def alone_in_questions(
    asked: Iterable[FleetQuestion], alone: Iterable[AloneVerdict]
) -> Iterator[FleetVerdict]:
    """How the rankings of single missions did: by question and method the mean over bad missions.

    A question of which a bad mission was not ranked is left out.
    """
    by_mission: dict[str, dict[str, AloneVerdict]] = {}
    for one in alone:
        by_mission.setdefault(one.method, {})[one.folder] = one
    for question in asked:
        for method, verdicts in by_mission.items():
            own = [verdicts[folder] for folder in question.bad if folder in verdicts]
            if len(own) < len(question.bad):
                continue
            first, third = (
                float(np.mean([getattr(one, name) for one in own])) for name in ("first", "third")
            )
            counts = len(question.bad), len(question.good)
            yield FleetVerdict(*_of(question), method, first, third, "", None, None, *counts)


def judge_alone(
    out: Path,
    asked: Iterable[FleetQuestion],
    on_progress: Progress | None = None,
    *,
    jobs: int = 1,
) -> list[AloneVerdict]:
    """Rank each bad mission of the questions by itself, and save the verdicts.

    Methods that know good runs get two good missions of the question, drawn for each bad one.

    Args:
        out: the folder of fleets.
        asked: the questions.
        on_progress: called with (missions done, missions in all).
        jobs: how many processes rank.

    Raises:
        TpcError: a mission or the table cannot be read or written; all others are ranked.
    """
    path, digests = out / ALONE_FILE, _Digests(out)
    known = {(row["folder"], row["method"]): AloneVerdict(**row) for row in _rows(path, _ALONE)}
    code = {name: method_digest(METHODS[name]) for name in ALONE}
    tasks: dict[str, _Alone] = {}
    wanted: set[tuple[str, str]] = set()
    for question in asked:
        for folder in question.bad:
            if folder in tasks:
                continue
            good = _drawn_good(question, folder)
            own = digest_of([digests.of_build(question), *map(digests.of, (folder, *good))])
            need = {name: digest_of([own, code[name]]) for name in ALONE}
            wanted |= {(folder, name) for name in ALONE}
            for name, digest in list(need.items()):
                before = known.get((folder, name))
                if before is not None and before.digest == digest:
                    del need[name]
            tasks[folder] = _Alone(out, question, folder, good, need)
    todo = [task for task in tasks.values() if task.digests]
    errors: list[TpcError] = []
    try:
        for number, found in enumerate(_all_alone(todo, jobs), start=1):
            if isinstance(found, TpcError):
                errors.append(found)
            else:
                known |= {(one.folder, one.method): one for one in found}
            if on_progress is not None:
                on_progress(number, len(todo))
    finally:
        _save([asdict(known[key]) for key in sorted(known)], _ALONE, path)
    if errors:
        raise min(errors, key=str)
    return [known[key] for key in sorted(wanted)]


@dataclass(frozen=True)
class _Alone:
    """A bad mission that is ranked by itself, and the digests of the methods that are to do it."""

    out: Path
    question: FleetQuestion
    folder: str
    good: tuple[str, ...]
    digests: Mapping[str, str]


def _all_alone(tasks: Sequence[_Alone], jobs: int) -> Iterator[list[AloneVerdict] | TpcError]:
    if jobs == 1 or len(tasks) < jobs:
        yield from map(_ranked_alone, tasks)
        return
    with signals_end(), ProcessPoolExecutor(jobs, get_context("spawn")) as pool:
        try:
            for future in as_completed([pool.submit(_ranked_alone, task) for task in tasks]):
                yield future.result()
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _ranked_alone(task: _Alone) -> list[AloneVerdict] | TpcError:
    try:
        static = StaticInfo.load(static_file(task.out, task.question))
        mission = task.out / task.folder
        good = [replace(load_recording(task.out / one), marks=()) for one in task.good]
        case = Case(
            with_wiring(load_recording(mission), mission),
            static,
            good[0] if good else None,
            good=tuple(map(thinned, good)),
        )
        names = Tpcs.of(static).names
        found = []
        for name, digest in task.digests.items():
            place = position(METHODS[name](case), task.question.parameter, names)
            first, third = (0.0 if place is None else within(k, *place) for k in (1, 3))
            found.append(AloneVerdict(task.folder, name, first, third, digest))
    except TpcError as error:
        return error
    return found


def _drawn_good(question: FleetQuestion, folder: str) -> tuple[str, ...]:
    """The good runs beside a bad mission, drawn for it from those of a question."""
    drawn = sorted(question.good, key=lambda run: _hash(f"{folder} beside {run}"))
    return tuple(drawn[:_GOOD_RUNS])


def _hash(text: str) -> str:
    return sha256(text.encode()).hexdigest()


class _Digests:
    """Of what is ranked; each file is read once."""

    def __init__(self, out: Path) -> None:
        self._out = out
        self._known: dict[str, str] = {}

    def of(self, folder: str) -> str:
        """Of a mission's recording and marks."""
        if folder not in self._known:
            files = [self._out / folder / name for name in _RANKED]
            self._known[folder] = digest_of([*map(contents, files)])
        return self._known[folder]

    def of_build(self, question: FleetQuestion) -> str:
        """Of the static information of a question's robots."""
        path = static_file(self._out, question)
        if str(path) not in self._known:
            self._known[str(path)] = contents(path)
        return self._known[str(path)]

    def of_question(self, question: FleetQuestion) -> str:
        """Of its missions and its build."""
        missions = map(self.of, (*question.bad, *question.good))
        return digest_of([self.of_build(question), *missions])


def static_file(out: Path, question: FleetQuestion) -> Path:
    """The static information of a question's robots, in the folder of fleets."""
    return out / "systems" / question.system / MERGED_FILE


def _of(question: FleetQuestion) -> tuple[str, str, str, str, str, int]:
    return (
        question.system,
        question.treatment,
        question.type,
        question.half,
        question.shape,
        question.draw,
    )


def _place(one: FleetQuestion | FleetVerdict) -> tuple[str, ...]:
    counts = (one.bad, one.good)
    bad, good = (count if isinstance(count, int) else len(count) for count in counts)
    return (one.system, one.treatment, one.shape, str(one.draw), str(bad), str(good))


def _rows(path: Path, schema: pa.Schema) -> list[dict[str, Any]]:
    if not path.is_file():
        return []
    return read_table(path, "verdicts", lambda table: table.cast(schema).to_pylist())


def _save(rows: Sequence[dict[str, Any]], schema: pa.Schema, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    write_table(pa.Table.from_pylist(list(rows), schema=schema), path)
