"""In which missions, and when, a comparison turned within a margin, at a place, at a value.

The digests say which missions can have such a turn: `find_missions`. The reports of one of them say
when it was: `turns_in`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pytpc.base.closest import did_you_mean
from pytpc.base.columns import Bools, Int64s
from pytpc.base.errors import InputError
from pytpc.base.wording import plain
from pytpc.diagnosis.fleet.rows import Rows, without_robot
from pytpc.diagnosis.results.fleet import FoundMission, FoundTurn
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.thresholds.margins import slope_of
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_values import ParameterValues
from pytpc.static.parameters import base_key, same_parameter
from pytpc.static.static_info import StaticInfo

_BITS = 24
_WITH_LINE = re.compile(r":[0-9]+\Z")


@dataclass(frozen=True, slots=True)
class TurnQuery:
    """What to look for; what is not given does not count.

    Attributes:
        place: ``file:line`` or ``file``; the end of a path is enough.
        parameter: a name as people give it, see `same_parameter`.
        key: of a comparison; with the number of an instance only that one in each mission.
        within: the largest margin, in the unit of the comparison's margins.
        low, high: the range of the compared value.
        had: names of parameters, and the values that they must have had at the turn.
    """

    place: str = ""
    parameter: str = ""
    key: str = ""
    within: float | None = None
    low: float = -np.inf
    high: float = np.inf
    had: tuple[tuple[str, object], ...] = ()

    def names(self, key: str, parameter: str, place: str) -> bool:
        """Whether it asks for a comparison, by its ``file:line``."""
        if self.key and not _is_key(key, self.key):
            return False
        if self.place and not _is_at(place, self.place):
            return False
        return not self.parameter or same_parameter(self.parameter, parameter)


def _is_key(key: str, asked: str) -> bool:
    """Whether a key is asked for; without a number it is all instances."""
    return asked in (key, base_key(key)) or (key == base_key(key) == base_key(asked))


def find_missions(rows: Rows, query: TurnQuery) -> tuple[FoundMission, ...]:
    """The missions that may have such a turn, by time.

    The values of parameters (``had``) are not looked at: they may differ in the course of a
    mission.

    Args:
        rows: the digests.
        query: what to look for.

    Raises:
        InputError: no comparison of the fleet is meant.
    """
    named = np.array([query.names(*one.named) for one in rows.series] or [False], np.bool_)
    if not named.any():
        asked = query.parameter or query.place or query.key
        known = {one.parameter if query.parameter else one.place for one in rows.series}
        hint = did_you_mean(asked, sorted(known))
        raise InputError(f"no comparison of the fleet is of {plain(asked)}{hint}")
    fits = np.flatnonzero(named[rows.which] & _fits(rows, query))
    fits = fits[np.lexsort((rows.which[fits], rows.mission[fits]))]
    mission = rows.mission[fits]
    starts = np.flatnonzero(np.append(True, mission[1:] != mission[:-1])) if fits.size else fits
    return tuple(_found(rows, own) for own in np.split(fits, starts[1:]) if own.size)


def _fits(rows: Rows, query: TurnQuery) -> Bools:
    fits = (rows.turns > 0) & ~(rows.value_low > query.high) & ~(rows.value_high < query.low)
    if query.within is not None:
        fits &= rows.least <= query.within
    return fits


def _found(rows: Rows, own: Int64s) -> FoundMission:
    mission = int(rows.mission[own[0]])
    least = rows.least[own]
    least = least[~np.isnan(least)]
    return FoundMission(
        mission=rows.missions[mission],
        robot=rows.robots[int(rows.robot[mission])],
        day=rows.days[int(rows.day[mission])],
        start_ns=int(rows.start_ns[mission]),
        is_bad=bool(rows.bad[mission]),
        where=tuple(rows.series[one].where for one in rows.which[own].tolist()),
        turns=int(rows.turns[own].sum()),
        least=float(least.min()) if least.size else None,
    )


def _is_at(place: str, asked: str) -> bool:
    """Whether ``src/nav.cpp:10`` is at ``nav.cpp``, ``nav.cpp:10`` or ``src/nav.cpp:10``."""
    own = place if _WITH_LINE.search(asked) else place.rpartition(":")[0]
    return f"/{own}".endswith(f"/{asked.lstrip('/')}")


def turns_in(
    recording: Recording,
    static_info: StaticInfo,
    query: TurnQuery,
    *,
    robot: str = "",
    values: ParameterValues | None = None,
) -> tuple[FoundTurn, ...]:
    """The turns of one mission that a query asks for, by time.

    The margin of a turn is the smaller one of the evaluations before and after it: the value was as
    near to the threshold as that. Where only turns were kept, it is that of the one after it. Turns
    that only a summary counts have no time, and are not found.

    Args:
        recording: the mission.
        static_info: what the analysis found, with the names of this mission.
        query: what to look for.
        robot: its own namespace is taken off the names of parameters and nodes.
        values: the parameters over time; None takes those of the recording.
    """
    tpcs = Tpcs.of(static_info)
    known = ParameterValues(recording.values) if values is None else values
    had = [(_meant(name, known.names(), robot), value) for name, value in query.had]
    found: list[FoundTurn] = []
    for code, key in enumerate(tpcs.keys):
        comparison = static_info.comparisons[key]
        place = f"{comparison.file}:{comparison.lineno}"
        parameter = without_robot(tpcs.parameters[code], robot)
        if query.names(key, parameter, place):
            slope = slope_of(comparison)
            scale = 1.0 if slope is None else abs(slope)
            is_flag = comparison.relation == "flag"
            turns = _turns(recording, (key, parameter, place), np.nan if is_flag else scale)
            found += [
                replace(one, node=without_robot(one.node, robot))
                for one in turns
                if _asked(one, query) and _had(one, had, known)
            ]
    return tuple(sorted(found, key=lambda one: (one.time_ns, one.key, one.node)))


def _turns(recording: Recording, named: tuple[str, str, str], scale: float) -> Iterator[FoundTurn]:
    """All turns of a comparison; a nan as ``scale`` is one without margins."""
    key, parameter, place = named
    events = recording.events
    rows = events.rows_of(key)
    rows = rows[events.flop[rows]]
    before = events.previous[rows]
    with np.errstate(invalid="ignore"):
        margins = [np.abs(events.cmp[at] - events.thresh[at]) / scale for at in (before, rows)]
    # Where summaries have the evaluations between, the row before is that of an earlier turn.
    margin = margins[1] if recording.summaries.rows_of(key).size else np.fmin(*margins)
    for row, off in zip(rows.tolist(), margin.tolist(), strict=True):
        yield FoundTurn(
            time_ns=int(events.time_ns[row]),
            key=key,
            node=events.nodes[events.node[row]],
            parameter=parameter,
            place=place,
            result=bool(events.result[row]),
            value=float(events.cmp[row]),
            threshold=float(events.thresh[row]),
            margin=off if np.isfinite(off) else None,
        )


def _asked(turn: FoundTurn, query: TurnQuery) -> bool:
    if query.within is not None and (turn.margin is None or turn.margin > query.within):
        return False
    is_limited = query.low > -np.inf or query.high < np.inf
    return not is_limited or query.low <= turn.value <= query.high


def _meant(given: str, names: Iterable[str], robot: str) -> list[str]:
    """The parameters that a person can mean, who may leave out the robot's namespace."""
    return [
        one
        for one in names
        if same_parameter(given, one) or same_parameter(given, without_robot(one, robot))
    ]


def _had(turn: FoundTurn, had: Sequence[tuple[list[str], object]], values: ParameterValues) -> bool:
    """Whether one of each of these parameters had the value then."""
    return all(
        any(_is_value(values.at(name, turn.time_ns), value) for name in meant)
        for meant, value in had
    )


def _is_value(one: object, asked: object) -> bool:
    """Whether they are one value; true and 1 are different.

    Numbers that a 32-bit float does not tell apart are the same, as in `Settings`: answers print
    them so.
    """
    if isinstance(one, bool) != isinstance(asked, bool):
        return False
    if isinstance(one, float | int) and isinstance(asked, float | int):
        try:
            return math.isclose(one, asked, rel_tol=2.0**-_BITS)
        except OverflowError:
            return one == asked
    return one == asked
