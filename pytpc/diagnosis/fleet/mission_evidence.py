r"""What the diagnoses of the bad missions say together, as of one common cause.

Each bad mission has its own diagnosis beside good runs: a probability of each of its n parameters
and of "none of them". The evidence of a mission for a parameter is how much its odds against "none"
rose over those before any evidence, which are (1 - NONE) / n against NONE:

    log( ((1 - s) P(p) + s (1 - NONE) / n) / ((1 - s) P(none) + s NONE) )
      - log( (1 - NONE) / n / NONE )

With probability s (``OTHER``) the mission has another cause than the others, or its marks were
slips; then its diagnosis says nothing of the common cause. So no mission vetoes a parameter, and
none is sure alone. "None of them" has the evidence 0 by this, and is joined as one more suspect.

The sum over the k missions is taken as that of k / (1 + (k - 1) r) independent ones (Kish 1965):
their errors are alike, as the same consequence of the error turns in each of them. A mission that
never compared the parameter says nothing of it, and counts 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pyarrow as pa

from pytpc.base.columns import Floats, Int32s, Int64s
from pytpc.base.errors import InputError
from pytpc.diagnosis.fleet.rank_sum import summed
from pytpc.diagnosis.fleet.rows import Rows, each_pair, numbers_of, without_robot, words_of
from pytpc.diagnosis.fleet.value_evidence import OTHER
from pytpc.static.parameters import ByParameter

NONE = 0.2
"""The probability, before any evidence, that no parameter is the cause: one treatment in five of
the study."""

ALIKE = 0.25
"""The correlation of the errors of two missions' diagnoses. However many they are, they count as at
most four: by reason, as a diagnosis that is wrong is mostly wrong about what follows the error."""


class Diagnoses(NamedTuple):
    """``evidence`` float64[p], see the module's docstring; so many ``missions`` have a diagnosis.

    ``position`` float64[p] is the mean position by another ranking, nan where none is given.
    """

    evidence: Floats
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
        return Diagnoses(np.zeros(len(names)), np.full(len(names), np.nan), 0)
    mission = _missions(rows, table)
    column = _columns(rows, names, table, mission)
    found, none = numbers_of(table, "log_probability"), numbers_of(table, "log_none")
    counted = np.flatnonzero((mission >= 0) & ~np.isnan(found + none))
    counted = counted[rows.bad[mission[counted]]]
    mission, column = mission[counted], column[counted]
    found, none = found[counted], none[counted]
    suspects = np.bincount(mission, minlength=len(rows.missions))[mission]
    before = (1.0 - NONE) / np.maximum(1, suspects)
    evidence = np.log((1.0 - OTHER) * np.exp(np.minimum(found, 0.0)) + OTHER * before)
    evidence -= np.log((1.0 - OTHER) * np.exp(np.minimum(none, 0.0)) + OTHER * NONE)
    evidence -= np.log(before / NONE)
    own = column >= 0
    count = int(np.unique(mission).size)
    weight = 1.0 / (1.0 + max(0, count - 1) * ALIKE)
    total = weight * summed(column[own], evidence[own], len(names))
    return Diagnoses(total, _positions(table, counted[own], column[own], len(names)), count)


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
