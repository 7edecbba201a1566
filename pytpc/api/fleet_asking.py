"""Questions to a fleet's data set: its digests are read by tasks, and judged here."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

import pyarrow as pa

from pytpc.api.dask_engine import DIED, Engine
from pytpc.api.fleet_judging import judged, notes_on, spread
from pytpc.api.fleet_missions import (
    EVERY,
    FleetMission,
    Selection,
    Unread,
    build_of,
    missions,
    once_each,
    opened,
)
from pytpc.api.learning import learn
from pytpc.api.missions import with_names_of
from pytpc.base.errors import InputError
from pytpc.diagnosis.fleet.drifting import fleet_drift
from pytpc.diagnosis.fleet.finding import TurnQuery, find_missions, turns_in
from pytpc.diagnosis.fleet.outliers import fleet_outliers
from pytpc.diagnosis.fleet.ranking import rank_fleet
from pytpc.diagnosis.fleet.rows import COLUMNS, Rows
from pytpc.diagnosis.fleet.settings import Settings
from pytpc.diagnosis.results.fleet import (
    FleetDrifts,
    FleetOutliers,
    FleetRanking,
    FoundMission,
    FoundTurn,
)
from pytpc.fleet.data_set import Fleet, Place
from pytpc.fleet.store import shown_url
from pytpc.fleet.tables import COMPARISONS, VALUES, WORD
from pytpc.recording.parameter_values import ParameterValues, SetValue
from pytpc.recording.profile import LearnedRun
from pytpc.static.other_builds import keys_in, renamed

Progress = Callable[[int, int], None]
Answer_co = TypeVar("Answer_co", covariant=True)

_OF_MISSION = ("mission", "robot", "day", "verdict")
_TOGETHER = 32
"""So many missions are read by one task: each has two small files."""
_DIGEST = tuple(name for name in COLUMNS if name in COMPARISONS.names)
_VALUE = ("name", "time_ns", "value", "number")


def _schema(own: pa.Schema, names: Sequence[str], of_mission: Sequence[str]) -> pa.Schema:
    fields = [pa.field(name, WORD) for name in of_mission]
    return pa.schema([*fields, *(own.field(name) for name in names)])


_ROWS = _schema(COMPARISONS, _DIGEST, _OF_MISSION).append(pa.field("start_ns", pa.int64()))
_VALUES = _schema(VALUES, _VALUE, _OF_MISSION[:2])


@dataclass(frozen=True, slots=True)
class Digests:
    """The digests of missions, with the keys of one build; and what cannot be read.

    ``values`` are those of parameters, without rows if they were not asked for.
    """

    rows: pa.Table
    values: pa.Table
    unread: tuple[Unread, ...] = ()


class _Part(NamedTuple):
    fleet: Fleet
    missions: tuple[FleetMission, ...]
    build: str
    with_values: bool


class Asked(NamedTuple):
    """The missions that a question is about, and the build whose keys count."""

    missions: tuple[FleetMission, ...]
    build: str
    digests: Digests

    @property
    def rows(self) -> Rows:
        """The digests as columns."""
        return Rows.of(self.digests.rows)


def newest_build(found: Sequence[FleetMission]) -> str:
    """The build of the last mission.

    Raises:
        InputError: there is no mission.
    """
    if not found:
        raise InputError("no missions: add some with `pytpc fleet add`, or select others")
    return max(found, key=lambda one: (one.place.day, one.start_ns, one.place)).build


def ask(
    fleet: Fleet,
    engine: Engine,
    selection: Selection,
    *,
    with_values: bool = False,
    on_progress: Progress | None = None,
) -> Asked:
    """Read the digests of missions.

    Args:
        fleet: the data set.
        engine: reads them, some missions at once.
        selection: which missions.
        with_values: also the values of parameters.
        on_progress: called with (done, in all).

    Raises:
        InputError: no such data set or robot, or no mission.
        TpcError: the store does not answer.
    """
    known = missions(fleet, engine, selection)
    build = newest_build(known.found)
    found, again = once_each(known.found)
    parts = [
        _Part(fleet, found[at : at + _TOGETHER], build, with_values)
        for at in range(0, len(found), _TOGETHER)
    ]
    read = engine.joined(_read, parts, _joined, on_progress)
    unread = (*known.unread, *again, *read.unread)
    return Asked(found, build, Digests(read.rows, read.values, unread))


def _read(part: _Part) -> Digests:
    """The task of a few missions."""
    made = [_digest(part, one) for one in part.missions]
    return _joined(made)


def _digest(part: _Part, mission: FleetMission) -> Digests:
    fleet, place = part.fleet, mission.place
    words = {**place._asdict(), "verdict": mission.verdict}
    try:
        rows = fleet.read(place, "comparisons", _DIGEST)
        values = fleet.read(place, "values", _VALUE) if part.with_values else None
        names = (
            {}
            if mission.build == part.build
            else _names(fleet.url, fleet.patience_s, part.build, mission.build)
        )
    except InputError as error:
        return Digests(_ROWS.empty_table(), _VALUES.empty_table(), (Unread(place, error.message),))
    if mission.reports and not len(rows):
        why = Unread(place, "its comparisons are missing: add it again")
        return Digests(_ROWS.empty_table(), _VALUES.empty_table(), (why,))
    if names:
        keys = rows["key"].to_pylist()
        new = [renamed(key, names) for key in keys]
        rows = rows.set_column(rows.column_names.index("key"), "key", pa.array(new).cast(WORD))
    start = pa.array([mission.start_ns] * len(rows), pa.int64())
    joined = _with_words(rows, words, _OF_MISSION).append_column("start_ns", start)
    table = (
        _VALUES.empty_table()
        if values is None
        else _with_words(values, words, ("mission", "robot"))
    )
    return Digests(joined.select(_ROWS.names).cast(_ROWS), table.cast(_VALUES))


def _with_words(table: pa.Table, words: dict[str, str], names: Sequence[str]) -> pa.Table:
    for place, name in enumerate(names):
        codes = pa.array([0] * len(table), pa.int32())
        column = pa.DictionaryArray.from_arrays(codes, pa.array([words[name]]))
        table = table.add_column(place, pa.field(name, WORD), column)
    return table


@lru_cache(maxsize=64)
def _names(url: str, patience_s: float, here: str, there: str) -> dict[str, str]:
    """The keys in one build by those of another one."""
    fleet = Fleet(url, patience_s)
    return dict(keys_in(build_of(fleet, here), build_of(fleet, there)))


def _joined(parts: list[Digests]) -> Digests:
    return Digests(
        _in_one_chunk([_ROWS.empty_table(), *(part.rows for part in parts)]),
        _in_one_chunk([_VALUES.empty_table(), *(part.values for part in parts)]),
        tuple(one for part in parts for one in part.unread),
    )


def _in_one_chunk(tables: Sequence[pa.Table]) -> pa.Table:
    """One table; on the way to another process each chunk has all words with it."""
    return pa.concat_tables(tables).unify_dictionaries().combine_chunks()


@dataclass(frozen=True)
class Answered(Generic[Answer_co]):
    """The answer to a question, and the missions that could not be read for it."""

    answer: Answer_co
    unread: tuple[Unread, ...]


def rank(
    fleet: Fleet,
    engine: Engine,
    selection: Selection = EVERY,
    on_progress: Progress | None = None,
) -> Answered[FleetRanking]:
    """Which parameter makes the bad missions of a fleet go wrong.

    Args:
        fleet: the data set.
        engine: where the tasks run.
        selection: which missions.
        on_progress: called with (done, in all), for reading and for judging.

    Raises:
        InputError: there is no bad mission, no such data set, or no such robot.
        TpcError: the store does not answer.
    """
    asked = ask(fleet, engine, selection, with_values=True, on_progress=on_progress)
    found = judged(fleet, engine, asked.missions, asked.build, on_progress)
    rows = asked.rows
    unread = (*asked.digests.unread, *found.unread)
    notes = notes_on(asked.missions, rows, unread)
    ranking = rank_fleet(rows, values=asked.digests.values, diagnoses=found.rows)
    ranking = replace(ranking, notes=(*ranking.notes, *notes))
    return Answered(ranking, unread)


def drift(
    fleet: Fleet,
    engine: Engine,
    selection: Selection = EVERY,
    on_progress: Progress | None = None,
) -> Answered[FleetDrifts]:
    """Which thresholds creep towards turning, and when they will turn; see ``rank``."""
    asked = ask(fleet, engine, selection, on_progress=on_progress)
    return Answered(fleet_drift(asked.rows), asked.digests.unread)


def outliers(
    fleet: Fleet,
    engine: Engine,
    selection: Selection = EVERY,
    on_progress: Progress | None = None,
) -> Answered[FleetOutliers]:
    """Which robots have settings, or decide, as none of their sisters; see ``rank``."""
    asked = ask(fleet, engine, selection, with_values=True, on_progress=on_progress)
    rows = asked.rows
    settings = Settings.of(rows, asked.digests.values)
    return Answered(fleet_outliers(rows, settings), asked.digests.unread)


def learn_good(
    fleet: Fleet,
    found: Sequence[FleetMission],
    profile: Path,
    most: int,
    on_progress: Progress | None = None,
) -> list[LearnedRun]:
    """Put good missions into a profile: of each robot about as many, evenly over its time.

    Args:
        fleet: the data set.
        found: the missions, of which the good ones count.
        profile: its folder; it is made.
        most: how many missions at most.
        on_progress: called with (done, in all).

    Raises:
        InputError: there is no good mission, or one is broken, or ``profile`` is something else.
        TpcError: the profile cannot be written, or the store does not answer.
    """
    chosen = spread([one for one in found if not one.is_bad], most)
    if not chosen:
        raise InputError("no good missions: add some, or select others", shown_url(fleet.url))
    learned = []
    for number, one in enumerate(chosen, start=1):
        with opened(fleet, one.place) as run:
            assert run.source is not None, "it was written to a folder"
            learned.append(learn(run.recording, run.source, profile))
        if on_progress is not None:
            on_progress(number, len(chosen))
    return learned


class _Search(NamedTuple):
    fleet: Fleet
    place: Place
    build: str
    query: TurnQuery


_KEY = re.compile(r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}(#\d+)?")
_PLACE = re.compile(r".*:\d+|.*\.(?:py|c|cc|cpp|cxx|h|hh|hpp|hxx|ipp|tpp)")


def turn_query(
    where: str,
    *,
    within: float | None = None,
    low: float = -math.inf,
    high: float = math.inf,
    had: tuple[tuple[str, object], ...] = (),
) -> TurnQuery:
    """What ``find`` looks for.

    Args:
        where: a parameter, a key, a file, or ``file:line``.
        within: the largest margin.
        low: the smallest compared value.
        high: the largest one.
        had: parameters and the values that they must have had then.
    """
    named: dict[str, Any] = {"within": within, "low": low, "high": high, "had": had}
    if _KEY.fullmatch(where):
        return TurnQuery(key=where, **named)
    if _PLACE.fullmatch(where):
        return TurnQuery(place=where, **named)
    return TurnQuery(parameter=where, **named)


Found = list[tuple[FoundMission, tuple[FoundTurn, ...]]]
"""Missions with their turns, by time."""


def find(
    query: TurnQuery,
    fleet: Fleet,
    engine: Engine,
    selection: Selection = EVERY,
    on_progress: Progress | None = None,
) -> Answered[Found]:
    """In which missions, and when, a comparison turned.

    Args:
        query: what is looked for.
        fleet: the data set.
        engine: where the tasks run, one for each mission whose digest fits.
        selection: which missions.
        on_progress: called with (done, in all).

    Raises:
        InputError: as ``rank``, or no comparison is meant.
        TpcError: the store does not answer.
    """
    asked = ask(fleet, engine, selection, on_progress=on_progress)
    likely = find_missions(asked.rows, query)
    jobs = [
        _Search(fleet, Place(one.robot, one.day, one.mission), asked.build, query) for one in likely
    ]
    turns = engine.map(_turns, jobs, on_progress, lambda job: ((), (Unread(job.place, DIED),)))
    unread = [one for _, why in turns for one in why]
    found = [(one, own) for one, (own, _) in zip(likely, turns, strict=True) if own]
    return Answered(found, (*asked.digests.unread, *unread))


def _turns(job: _Search) -> tuple[tuple[FoundTurn, ...], tuple[Unread, ...]]:
    """The task of one mission."""
    try:
        static = build_of(job.fleet, job.build)
        with opened(job.fleet, job.place) as mission:
            run = mission.in_build(static)
            named = with_names_of(run.recording, static, run.source)
            at_first = run.values.values or {}
            values = ParameterValues(
                [
                    *(SetValue(-(2**63), name, value) for name, value in at_first.items()),
                    *run.recording.values,
                ]
            )
            robot = job.place.robot
            return turns_in(run.recording, named, job.query, robot=robot, values=values), ()
    except InputError as error:
        return (), (Unread(job.place, error.message),)
