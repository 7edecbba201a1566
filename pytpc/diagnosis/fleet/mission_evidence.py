r"""What the diagnoses of the bad missions say together, as of one common cause.

Each bad mission has its own diagnosis beside good runs: a probability P of each of its n
parameters, and of "none of them". Before any evidence these are (1 - NONE) / n and NONE; R is P by
that. If a parameter is the common cause of the part x of the bad missions, the diagnoses are so
much likelier than if each mission had a cause of its own:

    the mean over x of  (product of (x R + 1 - x)  -  product of (1 - x)) / (1 - product of (1 - x))

A mission with another cause, or with marks that were slips, says nothing of the common one. So no
mission decides or vetoes anything alone, and several causes in one fleet are all found. At least
one mission has the common cause: of one bad mission the ratio is R, and the fleet says what its
diagnosis says. A mission that never compared the parameter says nothing of it.

"None of them" is one more suspect with its own R; or, the likelier the more missions there are,
each mission has another cause (``APART``), with the ratio 1.

The log over k missions is taken as that of k / (1 + (k - 1) r) independent ones (Kish 1965): their
errors are alike, as the same consequence of the error turns in each of them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from pytpc.base.columns import Floats, Int32s, Int64s
from pytpc.base.errors import InputError
from pytpc.diagnosis.fleet.rank_sum import summed
from pytpc.diagnosis.fleet.rows import Rows, each_pair, numbers_of, without_robot, words_of
from pytpc.diagnosis.fleet.value_evidence import EXPLAINED
from pytpc.diagnosis.ranking.known_good import UNCHANGED
from pytpc.static.parameters import ByParameter

NONE = 0.2
"""The probability, before any evidence, that no parameter is the cause: one treatment in five of
the study."""

ALIKE = 0.25
"""The correlation of the errors of two missions' diagnoses. However many they are, they count as at
most four: by reason, as a diagnosis that is wrong is mostly wrong about what follows the error."""

APART = 0.5
"""The part of "none of them" that is several causes, if there are many missions."""


class Diagnoses(NamedTuple):
    """``evidence`` float64[p] and that of ``none``, in log odds; see the module's docstring.

    So many ``missions`` have a diagnosis. ``position`` float64[p] is the mean position by another
    ranking, nan where none is given.
    """

    evidence: Floats
    none: float
    position: Floats
    missions: int


def joined(rows: Rows, names: tuple[str, ...], table: pa.Table | None) -> Diagnoses:
    """Join the diagnoses of the bad missions.

    Args:
        rows: the digests.
        names: the parameters; others in the table only count as suspects of their missions.
        table: a row for each suspect of a mission, with ``mission``, ``parameter``,
            ``log_probability`` and ``log_none``; if missions of several robots have one name,
            ``robot``; and, if it is known, ``position`` (from 1) by another ranking. None if there
            is none.

    Raises:
        InputError: a column is missing or of another type, or two robots have a mission of that
            name and the table does not say whose it is.
    """
    if table is None or not table.num_rows:
        return Diagnoses(np.zeros(len(names)), 0.0, np.full(len(names), np.nan), 0)
    mission = _missions(rows, table)
    column = _columns(rows, names, table, mission)
    found, none = numbers_of(table, "log_probability"), numbers_of(table, "log_none")
    counted = np.flatnonzero((mission >= 0) & ~np.isnan(found + none))
    counted = counted[rows.bad[mission[counted]]]
    mission, column = mission[counted], column[counted]
    found, none = found[counted], none[counted]
    suspects = np.bincount(mission, minlength=len(rows.missions))[mission]
    ratio = np.exp(np.minimum(found, 0.0)) * np.maximum(1, suspects) / (1.0 - NONE)
    own = column >= 0
    count = int(np.unique(mission).size)
    alike = 1.0 / (1.0 + max(0, count - 1) * ALIKE)
    first = np.unique(mission, return_index=True)[1]
    of_none = np.exp(np.minimum(none[first], 0.0)) / NONE
    nobody = float(alike * _common(np.zeros(count, np.int64), of_none, 1)[0])
    apart = APART * (1.0 - 1.0 / max(1, count))
    return Diagnoses(
        alike * _common(column[own], ratio[own], len(names)),
        math.log(apart + (1.0 - apart) * math.exp(nobody)),
        _positions(table, counted[own], column[own], len(names)),
        count,
    )


def _common(column: Int32s | Int64s, ratio: Floats, count: int) -> Floats:
    """float64[count]: the log of the ratio that the module's docstring gives; 0 without a row."""
    columns, own = np.unique(column, return_inverse=True)
    missions = np.bincount(own, minlength=columns.size)
    found = np.empty((EXPLAINED.size, columns.size))
    for place, part in enumerate(EXPLAINED.tolist()):
        both = summed(own, np.log(part * ratio + (1.0 - part)), columns.size)
        nothing = missions * math.log1p(-part)
        with np.errstate(divide="ignore"):
            some = np.log(-np.expm1(np.minimum(nothing - both, 0.0)))
        found[place] = both + some - np.log(-np.expm1(nothing))
    mean = np.logaddexp.reduce(found, axis=0) - math.log(EXPLAINED.size)
    every = np.zeros(count)
    every[columns] = np.logaddexp(mean, UNCHANGED)
    return every


def _missions(rows: Rows, table: pa.Table) -> Int32s:
    """The number of each row's mission; -1 for missions that are not there."""
    missions, mission = words_of(table, "mission")
    if "robot" in table.column_names:
        robots, robot = words_of(table, "robot")
        return each_pair(robot, mission, lambda r, m: rows.places.get((robots[r], missions[m]), -1))
    place: dict[str, int] = {}
    for number, name in enumerate(rows.missions):
        if place.setdefault(name, number) != number and name in missions:
            raise InputError(f"two robots have a mission {name}: the diagnoses need a column robot")
    return np.array([place.get(name, -1) for name in missions], np.int32)[mission]


def _columns(rows: Rows, names: tuple[str, ...], table: pa.Table, mission: Int32s) -> Int32s:
    """The column of each row's parameter; -1 for others."""
    words, word = words_of(table, "parameter")
    robot = rows.robot[np.maximum(mission, 0)]
    place = {name: column for column, name in enumerate(names)}
    by_name = ByParameter(range(len(names)), lambda column: names[column])

    def column_of(r: int, w: int) -> int:
        name = without_robot(words[w], rows.robots[r])
        if name in place:
            return place[name]
        # A diagnosis calls what no comparison reports by the name in the source.
        meant = by_name.meant(name)
        return meant[0] if len(meant) == 1 else -1

    return each_pair(robot, word, column_of)


def _positions(table: pa.Table, rows: Int64s, column: Int32s, count: int) -> Floats:
    if "position" not in table.column_names:
        return np.full(count, np.nan)
    position = numbers_of(table, "position", maybe=True)[rows]
    said = ~np.isnan(position)
    total = np.bincount(column[said], position[said], count)
    with np.errstate(invalid="ignore"):
        return np.asarray(total / np.bincount(column[said], minlength=count))
