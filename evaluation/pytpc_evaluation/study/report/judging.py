"""Lets the methods rank what they have not ranked yet, in several processes."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from dataclasses import dataclass, field, replace
from multiprocessing import active_children, get_context, parent_process
from pathlib import Path
from threading import Thread

from pytpc.base.errors import RunError, TpcError
from pytpc.base.signals import signals_end
from pytpc_evaluation.study.case import Method
from pytpc_evaluation.study.data import ALL, LABELS, Mission, load_mission, places, seed_of
from pytpc_evaluation.study.judge import POSITIONS_FILE, Judged, judge, save_positions
from pytpc_evaluation.study.methods import METHODS
from pytpc_evaluation.study.plan import Half
from pytpc_evaluation.study.report.folder import Progress
from pytpc_evaluation.study.report.judged import HELD_BACK, save_judging
from pytpc_evaluation.study.report.positions import read_positions
from pytpc_evaluation.study.resume import alone_with_results
from pytpc_evaluation.study.verdict_digest import method_digest, mission_digest, verdict_digest

_FEW = 3
"""Fewer missions are ranked before another process has begun."""

_Place = tuple[str, str, int]


@dataclass(frozen=True)
class Ranking:
    """A table of verdicts, and how it is made. It is sent to the processes that rank.

    ``file`` is below the study's folder. ``inputs`` is the digest of all that is read of a mission
    (study's folder, mission's, half). ``judge`` gives the verdicts of methods on a mission that was
    read from a folder. ``save`` writes the table into the study's folder.
    """

    file: Path
    methods: Mapping[str, Method]
    inputs: Callable[[Path, Path, str], str]
    judge: Callable[[Mission, Path, Mapping[str, Method]], Iterable[Judged]]
    save: Callable[[Iterable[Judged], Path], None]

    def is_complete(self, folder: Path, halves: Sequence[Half]) -> bool:
        """Whether ``complete`` would have nothing to do.

        Raises:
            InputError: a mission or the table cannot be read.
        """
        return _Plan.of(self, folder, halves, again=False).is_done

    def complete(
        self,
        folder: Path,
        halves: Sequence[Half],
        on_progress: Progress | None = None,
        *,
        again: bool = False,
        jobs: int = 1,
    ) -> None:
        """Complete a table by the verdicts on ``halves`` that it does not have.

        A method ranks a mission again where it, or anything that it is given, has changed. What was
        ranked when this is interrupted is kept. The table is the same for any number of jobs. Each
        time missions were judged that are held back, ``results/judged.json`` gets another row.

        Args:
            folder: the study's.
            halves: nothing is read of other missions; what stands about them stays.
            on_progress: called with (missions ranked, missions to rank).
            again: rank all of ``halves``.
            jobs: how many processes rank.

        Raises:
            InputError: a mission or the table cannot be read; all others are ranked.
            RunError: another command is at work on the results, or a process died.
            TpcError: the table cannot be written.
        """
        if _Plan.of(self, folder, halves, again=again).is_done:
            return
        errors: list[TpcError] = []
        with alone_with_results(folder), signals_end():
            # Another one may have been at work until now.
            plan = _Plan.of(self, folder, halves, again=again)
            try:
                with closing(_ranked(plan.tasks, jobs)) as results:
                    for done, (task, found) in enumerate(results, start=1):
                        if isinstance(found, TpcError):
                            errors.append(found)
                        else:
                            plan.take_in(task, found)
                        if on_progress is not None:
                            on_progress(done, len(plan.tasks))
            finally:
                self.save(plan.rows(), folder)
                plan.save_judging(folder)
        if errors:
            raise min(errors, key=str)


@dataclass(frozen=True)
class _Task:
    """A mission, and the digest of each method that is to rank it."""

    ranking: Ranking
    out: Path
    mission: Path
    half: Half
    digests: Mapping[str, str]


def by_own_marks() -> Ranking:
    """``results/positions.parquet``: all methods, by the marks of the study's own observers."""
    return Ranking(POSITIONS_FILE, METHODS, mission_digest, _judge_own_marks, save_positions)


def _judge_own_marks(
    mission: Mission, _folder: Path, methods: Mapping[str, Method]
) -> Iterable[Judged]:
    return judge(mission, methods)


@dataclass
class _Plan:
    """What has been ranked, by mission, and what is to be ranked; ``gone`` rows are of no use.

    ``judged`` are the tasks that are done whose missions are held back.
    """

    ranked: dict[_Place, list[Judged]]
    tasks: list[_Task]
    gone: int
    judged: list[_Task] = field(default_factory=list)

    @classmethod
    def of(cls, ranking: Ranking, folder: Path, halves: Sequence[Half], *, again: bool) -> _Plan:
        """By the table and the missions in the study's folder."""
        path = folder / ranking.file
        known: list[Judged] = list(read_positions(path)) if path.exists() else []
        ranked: dict[_Place, list[Judged]] = {}
        for row in known:
            ranked.setdefault((row.system, row.treatment, row.seed), []).append(row)
        tasks = []
        for mission, half in places(folder, halves):
            own = [row for row in ranked.get(_place(mission), []) if row.method in ranking.methods]
            ranked[_place(mission)] = own
            task = _task(ranking, folder, mission, half, [] if again else own)
            if task.digests:
                tasks.append(task)
        return cls(ranked, tasks, len(known) - sum(map(len, ranked.values())))

    @property
    def is_done(self) -> bool:
        """Whether the table is as it should be."""
        return not self.tasks and not self.gone

    def take_in(self, task: _Task, found: Sequence[Judged]) -> None:
        """Put the new verdicts of a task in the place of its methods' old ones."""
        place = _place(task.mission)
        old = [row for row in self.ranked[place] if row.method not in task.digests]
        self.ranked[place] = [*old, *found]
        if task.half == HELD_BACK:
            self.judged.append(task)

    def save_judging(self, folder: Path) -> None:
        """Have it known that missions which are held back were judged, if any were."""
        if self.judged:
            methods = {name for task in self.judged for name in task.digests}
            made_by = [(name, method_digest(METHODS[name])) for name in methods]
            save_judging(folder, made_by, len(self.judged))

    def rows(self) -> list[Judged]:
        """The whole table, sorted."""
        return [
            row for place in sorted(self.ranked) for row in sorted(self.ranked[place], key=_order)
        ]


def _task(
    ranking: Ranking, folder: Path, mission: Path, half: Half, rows: Sequence[Judged]
) -> _Task:
    """What is not among the rows about a mission."""
    inputs = ranking.inputs(folder, mission, half)
    known = ranking.methods.items()
    wanted = {name: verdict_digest(inputs, method_digest(of)) for name, of in known}
    there = {row.method for row in rows if row.digest == wanted[row.method]}
    missing = {name: digest for name, digest in wanted.items() if name not in there}
    return _Task(ranking, folder, mission, half, missing)


def _ranked(tasks: Sequence[_Task], jobs: int) -> Generator[tuple[_Task, list[Judged] | TpcError]]:
    """The rows of each task, or why there are none; in any order."""
    if jobs == 1 or len(tasks) < _FEW:
        yield from ((task, _rank(task)) for task in tasks)
        return
    with ProcessPoolExecutor(
        min(jobs, len(tasks)), mp_context=get_context("spawn"), initializer=_end_with_parent
    ) as pool:
        try:
            running = {pool.submit(_rank, task): task for task in tasks}
            for future in as_completed(running):
                yield running[future], future.result()
        except BrokenProcessPool as error:
            raise RunError("a process that ranks has died; is there memory for so many?") from error
        except BaseException:
            # The pool would wait for all that they have begun.
            for process in active_children():
                process.terminate()
            raise


def _rank(task: _Task) -> list[Judged] | TpcError:
    methods = {name: task.ranking.methods[name] for name in task.digests}
    try:
        mission = load_mission(task.out, task.mission, task.half)
        rows = list(task.ranking.judge(mission, task.mission, methods))
    except TpcError as error:
        return error
    return [replace(row, digest=task.digests[row.method]) for row in rows]


def _end_with_parent() -> None:
    """An interrupt ends this process, and so does the end of the one that hands out tasks."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    Thread(target=_wait_for_parent, daemon=True).start()


def _wait_for_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _place(mission: Path) -> _Place:
    return (mission.parent.parent.name, mission.parent.name, seed_of(mission))


def _order(row: Judged) -> tuple[object, ...]:
    """All users before single ones, and methods as in ``METHODS``."""
    methods, labels = list(METHODS), [*LABELS]
    method = methods.index(row.method) if row.method in methods else len(methods)
    label = labels.index(row.labels) if row.labels in labels else len(labels)
    return (label, row.who != ALL, row.who, method, row.method)
