"""In how many bad and good missions a parameter had which value, and what that says in words."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Bools, Int32s, Int64s
from pytpc.base.wording import listed, many
from pytpc.diagnosis.fleet.rows import Rows
from pytpc.diagnosis.fleet.settings import Settings
from pytpc.diagnosis.results.fleet import ValueInMissions

MOST_VALUES = 8
"""So many values of a parameter are listed."""
MOSTLY = 4
"""A value is mostly wrong if it has so many bad missions for each good one."""
_NAMED = 3


class Verdicts(NamedTuple):
    """Of each mission: its robot, whether it is bad and good; and the robots' words."""

    robot: Int32s
    bad: Bools
    good: Bools
    robots: tuple[str, ...]

    @classmethod
    def of(cls, rows: Rows) -> Verdicts:
        """Those of the missions of ``rows``."""
        return cls(rows.robot, rows.bad, rows.good, rows.robots)


class Held(NamedTuple):
    """The values of a parameter, see `FleetSuspect`; ``reasons`` in words."""

    values: tuple[ValueInMissions, ...]
    more: int
    differs: float | None
    robots: tuple[str, ...]
    reasons: tuple[str, ...]


def gone_wrong_with(settings: Settings, verdicts: Verdicts, parameter: int) -> Int64s:
    """int64[f]: the bad missions with a value with which their robot mostly went wrong.

    At least four of five: a mission that goes wrong unseen counts as good. A robot that went right
    with no other value says nothing of it by itself; there the missions of the whole fleet count.
    """
    own = settings.entries(parameter)
    mission, value = settings.mission[own].astype(np.int64), settings.value[own].astype(np.int64)
    robot = verdicts.robot[mission].astype(np.int64)
    is_bad, is_good = verdicts.bad[mission], verdicts.good[mission]
    pair = value * len(verdicts.robots) + robot

    def counts(codes: Int64s) -> tuple[Int64s, Int64s]:
        """Of each entry the bad and the good missions with its code."""
        bad, good = (np.bincount(codes, rows)[codes].astype(np.int64) for rows in (is_bad, is_good))
        return bad, good

    (bad, good), (_, right), fleet = counts(pair), counts(robot), counts(value)
    alone = right == good
    bad, good = np.where(alone, fleet, (bad, good))
    return np.asarray(mission[is_bad & (bad >= MOSTLY * good)])


def values_in(settings: Settings, verdicts: Verdicts, parameter: int) -> Held:
    """Count the values of one parameter in the judged missions."""
    own = settings.entries(parameter)
    mission, code = settings.mission[own], settings.value[own]
    judged = verdicts.bad[mission] | verdicts.good[mission]
    mission = mission[judged]
    codes, value = np.unique(code[judged], return_inverse=True)
    robot, bad = verdicts.robot[mission], verdicts.bad[mission]
    good = ~bad
    robots = len(verdicts.robots)
    pair = value * robots + robot
    flown = np.bincount(pair[good], minlength=codes.size * robots) > 0
    fresh = bad & ~flown[pair]
    counts = [np.bincount(value[rows], minlength=codes.size) for rows in (bad, good, fresh)]
    order = np.lexsort((codes, -counts[1], -counts[0], -counts[2])).tolist()
    shown = []
    for one in order[:MOST_VALUES]:
        setting = settings.setting(parameter, int(codes[one]))
        in_bad, in_good, anew = (int(count[one]) for count in counts)
        own_robots = _names(verdicts, robot[value == one])
        shown.append(
            ValueInMissions(setting.text, setting.number, in_bad, in_good, anew, own_robots)
        )
    listed_values = tuple(shown)
    known = int(bad.sum())
    nowhere = int(counts[0][counts[1] == 0].sum())
    return Held(
        listed_values,
        max(0, codes.size - MOST_VALUES),
        nowhere / int(verdicts.bad.sum()) if known else None,
        _names(verdicts, robot[fresh]),
        _reasons(
            listed_values,
            int(fresh.sum()),
            (known, int(verdicts.bad.sum())),
            has_good=bool(good.any()),
        ),
    )


def _names(verdicts: Verdicts, robot: Int32s | Int64s) -> tuple[str, ...]:
    return tuple(verdicts.robots[one] for one in np.unique(robot).tolist())


def _reasons(
    values: tuple[ValueInMissions, ...], fresh: int, bad: tuple[int, int], *, has_good: bool
) -> tuple[str, ...]:
    known, every = bad
    if not known:
        return ("its value is known in no bad mission",)
    if not has_good:
        return ("its value is known in no good mission",)
    if not fresh:
        texts = listed([one.text for one in values if one.bad], _NAMED)
        return (f"each robot flew well with what it had in bad missions: {texts}",)
    texts = listed([one.text for one in values if one.fresh], _NAMED)
    of = many(every, "bad mission")
    have = "has" if fresh == 1 else "have"
    return (f"{fresh:,} of {of} {have} a value that no good mission of the robot has: {texts}",)
