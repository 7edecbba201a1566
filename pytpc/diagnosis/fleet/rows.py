"""The digests of many missions as numpy columns: one row per mission and comparison.

A comparison is the same in all missions if its key, its node and its parameter's name are, after
the robot's own namespace is taken off both names. The number of an instance does not count: only of
several with one name in a mission, the first is the first.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from pytpc.base.columns import Bools, Floats, Int32s, Int64s, frozen, words_and_codes
from pytpc.base.errors import InputError
from pytpc.diagnosis.results.fleet import FleetPlace
from pytpc.static.parameters import base_key

BAD, GOOD = "bad", "good"
"""The verdicts that count; a mission with another one is neither."""

_WORDS = ("mission", "robot", "day", "verdict", "key", "node", "parameter", "file", "relation")
_MORE_WORDS = ("kind", "unit")
_WHOLE = ("start_ns", "lineno", "turns", "thresholds")
_NUMBERS = ("seconds", "true_share", "thresh_last", "value_low", "value_high")
_MAYBE = ("least", "median")
_TRUTHS = ("result_first", "result_last")
COLUMNS = (*_WORDS, *_MORE_WORDS, *_WHOLE, *_NUMBERS, *_MAYBE, *_TRUTHS)
"""The columns that a table of digests must have; others are ignored."""

_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9_/]")


class Series(NamedTuple):
    """A comparison of the fleet, as the last mission that has it says.

    ``key`` is that of the source; ``place`` is ``file:line``; ``number`` is 0, or counts instances
    of one name.
    """

    key: str
    node: str
    parameter: str
    number: int
    place: str
    relation: str
    kind: str
    unit: str

    @property
    def where(self) -> FleetPlace:
        """What answers call it."""
        return FleetPlace(self.parameter, self.node, self.place, self.key)

    @property
    def named(self) -> tuple[str, str, str]:
        """By what a query names it: key, parameter, place."""
        return self.key, self.parameter, self.place


@dataclass(frozen=True, eq=False)
class Rows:
    """n rows of m missions, s comparisons and p parameters.

    Make one with ``of``. Missions are in the order of their time, words and comparisons sorted. The
    arrays are read-only.

    Attributes:
        missions: the name of each mission; two robots may each have one of a name.
        robots: the words of ``robot``.
        days: the words of ``day``, ``YYYY-MM-DD``.
        parameters: without the robots' namespaces.
        series: the comparisons.
        robot: int32[m], codes into ``robots``.
        day: int32[m], codes into ``days``.
        start_ns: int64[m].
        bad: bool[m]; ``good`` bool[m]; a mission may be neither.
        of_series: int32[s], the parameter of each comparison.
        mission: int32[n]; ``which`` int32[n], the comparison.
        turns: int64[n].
        seconds: float64[n], for how long it was evaluated.
        true_share: float64[n], of these seconds.
        was_true, was_false: bool[n], whether its result ever was.
        thresh: float64[n], the threshold, which may be infinite; nan where it had several, or none.
        value_low, value_high: float64[n], the range of the compared values.
        least, median: float64[n], of the margins, in the unit of the comparison; nan without one.
    """

    missions: tuple[str, ...]
    robots: tuple[str, ...]
    days: tuple[str, ...]
    parameters: tuple[str, ...]
    series: tuple[Series, ...]
    robot: Int32s
    day: Int32s
    start_ns: Int64s
    bad: Bools
    good: Bools
    of_series: Int32s
    mission: Int32s
    which: Int32s
    turns: Int64s
    seconds: Floats
    true_share: Floats
    was_true: Bools
    was_false: Bools
    thresh: Floats
    value_low: Floats
    value_high: Floats
    least: Floats
    median: Floats

    @classmethod
    def of(cls, table: pa.Table) -> Rows:
        """Read a table with the columns ``COLUMNS``, in any order of rows.

        Args:
            table: digests, with ``mission``, ``robot``, ``day``, ``start_ns`` and ``verdict``
                joined to each row; words as text or as dictionaries.

        Raises:
            InputError: a column is missing, of another type, or has missing values; a mission has
                two days, times or verdicts; or a comparison is twice in one.
        """
        return _rows(table)

    def __len__(self) -> int:
        return self.mission.size

    @cached_property
    def places(self) -> dict[tuple[str, str], int]:
        """The number of each mission, by robot and name."""
        names = zip(self.robot.tolist(), self.missions, strict=True)
        return {(self.robots[robot], name): place for place, (robot, name) in enumerate(names)}

    @property
    def parameter(self) -> Int32s:
        """int32[n]: the parameter of each row."""
        return self.of_series[self.which]

    @property
    def turn_rate(self) -> Floats:
        """float64[n]: turns per minute in which it was evaluated; 0 where that took no time."""
        with np.errstate(divide="ignore", invalid="ignore"):
            rate = 60.0 * self.turns / self.seconds
        return np.where(self.seconds > 0, rate, 0.0)

    @property
    def signed_median(self) -> Floats:
        """float64[n]: the median margin, negative where the result was mostly false."""
        return np.where(self.true_share >= 0.5, self.median, -self.median)


def without_robot(name: str, robot: str) -> str:
    """A name of ROS without the namespace that is the robot's name.

    >>> without_robot("/r2/nav/limit", "r2"), without_robot("/robot_1/x", "robot-1")
    ('/nav/limit', '/x')
    >>> without_robot("/r22/nav", "r2"), without_robot("/r2", "r2"), without_robot("~limit", "r2")
    ('/r22/nav', '/r2', '~limit')
    """
    own = f"/{_NOT_IN_NAMES.sub('_', robot).strip('/')}/"
    return name[len(own) - 1 :] if name.startswith(own) and len(name) > len(own) > 2 else name


def words_of(table: pa.Table, name: str) -> tuple[list[str], Int32s]:
    """The words and codes of a column of text.

    Raises:
        InputError: the column is missing, is no text or has missing values.
    """
    column = _column(table, name)
    if not pa.types.is_dictionary(column.type):
        kind = column.type
        if not (pa.types.is_string(kind) or pa.types.is_large_string(kind)):
            # Readers of partitioned data make dates and numbers of what looks like them.
            column = column.cast(pa.string())
        column = column.dictionary_encode()
    words, codes = words_and_codes(column)
    return [str(word) for word in words], codes.astype(np.int32)


def numbers_of(table: pa.Table, name: str, *, maybe: bool = False) -> Floats:
    """A column as float64[n]; with ``maybe`` nan where nothing is said.

    Raises:
        InputError: the column is missing, has no numbers, or has missing values.
    """
    column = _column(table, name, maybe)
    try:
        return np.asarray(column.cast(pa.float64()).to_numpy(), np.float64)
    except pa.ArrowException as error:
        raise InputError(f"column {name} is {column.type}, not numbers") from error


def _column(table: pa.Table, name: str, maybe: bool = False) -> pa.ChunkedArray:
    if name not in table.column_names:
        raise InputError(f"the digests of missions have no column {name}")
    column = table.column(name)
    if column.null_count and not maybe:
        raise InputError(f"column {name} has {column.null_count:,} missing values")
    return column


def _whole(table: pa.Table, name: str) -> Int64s:
    column = _column(table, name)
    if not pa.types.is_integer(column.type):
        raise InputError(f"column {name} is {column.type}, not whole numbers")
    return np.asarray(column.to_numpy(), np.int64)


def _truths(table: pa.Table, name: str) -> Bools:
    column = _column(table, name)
    if not pa.types.is_boolean(column.type):
        raise InputError(f"column {name} is {column.type}, not true and false")
    return np.asarray(column.to_numpy(), np.bool_)


def pairs(first: Int32s, second: Int32s) -> tuple[Int64s, Int64s, Int64s]:
    """The different pairs of codes, sorted, as two columns, and for each row the pair's number."""
    width = int(second.max(initial=0)) + 1
    both, places = np.unique(first.astype(np.int64) * width + second, return_inverse=True)
    return both // width, both % width, places


def each_pair(first: Int32s, second: Int32s, of: Callable[[int, int], int]) -> Int32s:
    """int32[n]: the number of each pair of codes; it is asked once for each different pair."""
    one, other, places = pairs(first, second)
    found = [of(*both) for both in zip(one.tolist(), other.tolist(), strict=True)]
    return np.array(found, np.int32)[places]


def _without_robots(
    words: list[str], codes: Int32s, robots: tuple[list[str], Int32s]
) -> tuple[list[str], Int32s]:
    """The words without the namespace of the robot whose row it is, sorted, and the codes."""
    names: dict[str, int] = {}
    found = each_pair(
        codes,
        robots[1],
        lambda w, r: names.setdefault(without_robot(words[w], robots[0][r]), len(names)),
    )
    return _sorted(list(names), found)


def _sorted(
    words: list[str], codes: npt.NDArray[Any], new: Callable[[str], str] = str
) -> tuple[list[str], Int32s]:
    """The different ones of the words that ``new`` makes, sorted, and the codes among them."""
    made = [new(word) for word in words]
    among = sorted(set(made))
    places = {word: place for place, word in enumerate(among)}
    table = np.array([places[word] for word in made] or [0], np.int32)
    return among, table[codes]


def _rows(table: pa.Table) -> Rows:
    words = {name: words_of(table, name) for name in (*_WORDS, *_MORE_WORDS)}
    robots, robot = _sorted(*words["robot"])
    days, day = _sorted(*words["day"])
    verdicts, verdict = words["verdict"]
    is_bad = np.array([word == BAD for word in verdicts] or [False], np.bool_)[verdict]
    is_good = np.array([word == GOOD for word in verdicts] or [False], np.bool_)[verdict]
    start_ns = _whole(table, "start_ns")
    names, name = _sorted(*words["mission"])
    mission, first = _missions(name, robot, start_ns)
    _check_missions((mission, first), day=day, start_ns=start_ns, verdict=verdict)

    own = robots, robot
    nodes, node = _without_robots(*words["node"], own)
    parameters, parameter = _without_robots(*words["parameter"], own)
    keys, base = _sorted(*words["key"], base_key)
    own_names = [_sorted(*words[name]) for name in ("key", "node", "parameter")]
    order, which, starts = _series(mission, (base, node, parameter), own_names)
    lineno = _whole(table, "lineno")
    said = {name: words[name] for name in ("file", "relation", *_MORE_WORDS)}
    # Rows are sorted by comparison, then by mission: the last one is that of the newest mission.
    lasts = order[np.append(starts[1:], order.size) - 1] if order.size else starts
    numbers = _numbers_in_series(base, node, parameter, lasts)
    series = tuple(
        Series(
            keys[base[row]],
            nodes[node[row]],
            parameters[parameter[row]],
            number,
            f"{_word(said['file'], row)}:{lineno[row]}",
            *(_word(said[name], row) for name in ("relation", *_MORE_WORDS)),
        )
        for row, number in zip(lasts.tolist(), numbers, strict=True)
    )
    values = {name: numbers_of(table, name)[order] for name in _NUMBERS}
    values |= {name: numbers_of(table, name, maybe=True)[order] for name in _MAYBE}
    thresh, finite = values.pop("thresh_last"), _whole(table, "thresholds")[order]
    constant = np.where(np.isfinite(thresh), finite == 1, finite == 0)
    turns = _whole(table, "turns")[order]
    share = values["true_share"]
    begins, ends = (_truths(table, name)[order] for name in _TRUTHS)
    return Rows(
        missions=tuple(names[code] for code in name[first].tolist()),
        robots=tuple(robots),
        days=tuple(days),
        parameters=tuple(parameters),
        series=series,
        robot=frozen(robot[first]),
        day=frozen(day[first]),
        start_ns=frozen(start_ns[first]),
        bad=frozen(is_bad[first]),
        good=frozen(is_good[first]),
        of_series=frozen(parameter[lasts]),
        mission=frozen(mission[order]),
        which=frozen(which),
        turns=frozen(turns),
        was_true=frozen(begins | ends | (share > 0) | (turns > 0)),
        was_false=frozen(~begins | ~ends | (share < 1) | (turns > 0)),
        thresh=frozen(np.where(constant, thresh, np.nan)),
        **{name: frozen(column) for name, column in values.items()},
    )


def _word(words: tuple[list[str], Int32s], row: int) -> str:
    return words[0][int(words[1][row])]


def _missions(name: Int32s, robot: Int32s, start_ns: Int64s) -> tuple[Int32s, Int64s]:
    """The number of the mission of each row, and of each mission a row, in the order of time."""
    width = int(robot.max(initial=0)) + 1
    _, first, places = np.unique(
        name.astype(np.int64) * width + robot, return_index=True, return_inverse=True
    )
    order = np.lexsort((name[first], robot[first], start_ns[first]))
    rank = np.empty(order.size, np.int32)
    rank[order] = np.arange(order.size, dtype=np.int32)
    return rank[places], first[order]


def _check_missions(missions: tuple[Int32s, Int64s], **columns: npt.NDArray[Any]) -> None:
    mission, first = missions
    for name, column in columns.items():
        if bool(np.any(column != column[first][mission])):
            raise InputError(f"a mission has rows with more than one {name}")


def _series(
    mission: Int32s,
    codes: tuple[Int32s, Int32s, Int32s],
    own_names: list[tuple[list[str], Int32s]],
) -> tuple[Int64s, Int32s, Int64s]:
    """The order of the rows by comparison and mission, their comparison, and where each begins.

    By their own names (key, node and parameter) rows of one comparison are told apart: instances,
    and nodes that have one name only without the robot's namespace.
    """
    base, node, parameter = codes
    instance = np.zeros(mission.size, np.int64)
    for names, code in own_names:
        instance = np.unique(instance * max(1, len(names)) + code, return_inverse=True)[1]
    order = np.lexsort((instance, mission, node, base, parameter))
    name = np.column_stack([parameter[order], base[order], node[order]])
    new = np.ones(order.size, np.bool_)
    new[1:] = np.any(name[1:] != name[:-1], axis=1)
    own = mission[order]
    alone = new.copy()
    alone[1:] |= own[1:] != own[:-1]
    starts = np.flatnonzero(alone)
    number = np.arange(order.size) - starts[np.cumsum(alone) - 1] if order.size else starts
    again = ~alone
    again[1:] &= instance[order][1:] == instance[order][:-1]
    if bool(again[1:].any()):
        raise InputError("a mission has two rows of one comparison")
    if int(number.max(initial=0)):
        kept = np.lexsort((own, number, np.cumsum(new)))
        order, number = order[kept], number[kept]
        name = name[kept]
        new[1:] = np.any(name[1:] != name[:-1], axis=1) | (number[1:] != number[:-1])
    return order, (np.cumsum(new) - 1).astype(np.int32), np.flatnonzero(new)


def _numbers_in_series(base: Int32s, node: Int32s, parameter: Int32s, lasts: Int64s) -> list[int]:
    """How many comparisons of the same name come before each."""
    found: list[int] = []
    names = list(
        zip(base[lasts].tolist(), node[lasts].tolist(), parameter[lasts].tolist(), strict=True)
    )
    for place, name in enumerate(names):
        found.append(found[-1] + 1 if place and names[place - 1] == name else 0)
    return found
