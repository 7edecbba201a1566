"""A made-up fleet with known truth: its robots, their settings and missions, and what is wrong.

Everything follows from `WorldSettings`: the plan of a mission from its number alone, so missions
may be made in any order and by several processes. What is true of the fleet:

- ``CULPRITS`` parameters are wrong in the bad missions, one in each, with the same wrong value;
- each robot has values of its own for a third of its parameters;
- the margin of one parameter becomes smaller every day on all robots, that of another on one;
- one robot differs from its sisters, in values and in what it sees, without harm;
- the clock of one robot is off; the first missions of one are of an older build;
- half of all missions have a harmless difference (a decoy), and some marks are false alarms.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from functools import cached_property
from typing import Literal

import numpy as np

from pytpc.recording.marks import Mark, MarkType
from pytpc_evaluation.fleet.processes import (
    KNOTS_HZ,
    Bools,
    Floats,
    Processes,
    make_processes,
)
from pytpc_evaluation.fleet.robot_model import (
    DECISIONS,
    EARLY,
    LATE,
    LOOPS,
    Kind,
    nominal_rate,
)

CULPRITS = 3
_SHARES = (0.5, 0.3, 0.2)
_OWN_SHARE = 1 / 3
_OWN = {Kind.EVENT: 0.15, Kind.WANDER: 0.3, Kind.STEADY: 0.8, Kind.RAMP: 0.3}
"""By how many steps the value of a robot's own may differ from the usual one."""
_WHOLE_DRIFT = 3.2
_FAR = {Kind.WANDER: 2.8, Kind.STEADY: 9.0}
_SEEN_ELSEWHERE = 0.9
_CLOCK_OFF = timedelta(days=-41, hours=-3)
_FIRST_DAY = datetime(2026, 3, 2, 6, tzinfo=timezone.utc)
_OF_A_DAY = timedelta(hours=14)
_USUAL_IN_A_DAY = 21
_OBSERVERS = ("anna", "ben")
_SEEN, _SEEN_TWICE, _ABSENT = 0.4, 0.25, 0.1
_ALARM_BAD, _ALARM_GOOD = 0.2, 0.06
_DELAY_S = (0.5, 3.0)
_SHORTEST_S = 0.4
_TYPED = (0.7, 0.1, 0.2)
_RIGHT, _OTHER = 0, 1

Origin = Literal["config", "robot", "release", "runtime"]
"""Who set a value: the package, the robot's own file, a release, or somebody by hand. What is wrong
comes with a release."""


@dataclass(frozen=True)
class WorldSettings:
    """What a world is made from.

    Attributes:
        seed: where chance comes from.
        robots: how many.
        days: over how many days the missions are spread.
        missions: how many, of all robots.
        reports: about how many a mission has; it takes as long as it needs for them.
        bad: the share of bad missions.
        namespaces: whether the nodes of each robot are in a namespace with its name.
    """

    seed: int = 1
    robots: int = 6
    days: int = 10
    missions: int = 60
    reports: int = 200_000
    bad: float = 0.3
    namespaces: bool = True

    @property
    def seconds(self) -> float:
        """How long a mission takes."""
        return self.reports / nominal_rate()


@dataclass(frozen=True)
class SetTo:
    """The value of a parameter in a mission, and who set it."""

    value: float | bool
    by: Origin


@dataclass(frozen=True)
class WrongValue:
    """A parameter that is wrong in bad missions: ``value`` makes its comparison turn too often (I)
    or never (II). ``robots`` are those on which it may be."""

    decision: int
    type: MarkType
    value: float
    robots: tuple[int, ...]


@dataclass(frozen=True)
class Drift:
    """The margin of a decision becomes smaller by ``steps`` every day on these robots."""

    decision: int
    steps: float
    robots: tuple[int, ...]


@dataclass(frozen=True)
class MissionPlan:
    """A mission: whose, when, with which values; ``wrong`` is the wrong one of them, if any.

    ``values`` are those of all parameters by `parameter_of`. ``start_ns`` is on the robot's clock,
    ``true_ns`` on one that is right.
    """

    number: int
    robot: int
    day: int
    name: str
    start_ns: int
    true_ns: int
    older: bool
    values: dict[str, SetTo]
    wrong: WrongValue | None
    decoy: str | None


@dataclass(frozen=True)
class FlownMission:
    """What happened in a mission.

    Attributes:
        processes: the values of its decisions.
        thresholds: float64[decisions]: those that were compared.
        errors: from when to when (s) a decision was wrong.
        marks: what observers said of it.
        causes: for each mark the number of the error that it is about; None: a false alarm.
    """

    plan: MissionPlan
    processes: Processes
    thresholds: Floats
    errors: tuple[tuple[float, float], ...] = ()
    marks: tuple[Mark, ...] = ()
    causes: tuple[int | None, ...] = ()


def parameter_of(decision: int) -> str:
    """The full name of a decision's parameter, without the namespace of a robot."""
    one = DECISIONS[decision]
    return f"/{one.parameter}" if one.shared else f"/{LOOPS[one.loop].node}/{one.parameter}"


class World:
    """A fleet of robots. See the module."""

    def __init__(self, settings: WorldSettings) -> None:
        """Draws what is true of the fleet."""
        self.settings = settings
        rng = np.random.default_rng([settings.seed, 0])
        robots = range(settings.robots)
        every = tuple(robots)
        events = [n for n, one in enumerate(DECISIONS) if one.kind is Kind.EVENT]
        calm = [n for n, one in enumerate(DECISIONS) if one.kind in _FAR and not one.shared]
        steady = [n for n in calm if DECISIONS[n].kind is Kind.STEADY]
        special = [int(n) for n in rng.permutation(settings.robots)]
        picked = [special[n % settings.robots] for n in range(4)]
        self.outlier, self.clock_off, self.older, self.worn = picked
        self.culprits = tuple(
            self._wrong(int(n), rank, every, rng)
            for rank, n in enumerate(rng.choice(events, CULPRITS, replace=False))
        )
        per_day = _WHOLE_DRIFT / max(1, settings.days - 1)
        everywhere, on_one = (int(n) for n in rng.choice(steady, 2, replace=False))
        self.drifts = (Drift(everywhere, per_day, every), Drift(on_one, per_day, (self.worn,)))
        free = [n for n in calm if n not in (everywhere, on_one)]
        self.far = tuple(sorted(int(n) for n in rng.choice(free, 3, replace=False)))
        """Decisions whose values are far from the usual ones on the outlier."""
        wander = [n for n in free if DECISIONS[n].kind is Kind.WANDER and n not in self.far]
        self.elsewhere = int(rng.choice(wander))
        """The decision whose value the outlier sees elsewhere."""

    @staticmethod
    def _wrong(
        decision: int, rank: int, every: tuple[int, ...], rng: np.random.Generator
    ) -> WrongValue:
        # The second one is wrong on a part of the robots only.
        some = tuple(sorted(rng.choice(every, max(1, len(every) // 2), replace=False).tolist()))
        early = bool(rng.random() < 0.5) if rank > 1 else rank == 0
        value = DECISIONS[decision].value_at(EARLY if early else LATE)
        return WrongValue(decision, "I" if early else "II", value, some if rank == 1 else every)

    def robot_name(self, robot: int) -> str:
        """What a robot is called."""
        return f"r{robot + 1:0{len(str(self.settings.robots))}d}"

    def full_name(self, plan: MissionPlan, name: str) -> str:
        """The name of a node or parameter on a robot's graph."""
        return f"/{self.robot_name(plan.robot)}{name}" if self.settings.namespaces else name

    @cached_property
    def own_values(self) -> tuple[dict[str, float], ...]:
        """For each robot, the values that are not the usual ones."""
        return tuple(self._own(robot) for robot in range(self.settings.robots))

    def right_value(self, robot: int, decision: int) -> float:
        """The value of a decision's parameter on a robot where nothing is wrong."""
        one = DECISIONS[decision]
        return self.own_values[robot].get(parameter_of(decision), one.value_at(one.level))

    def _own(self, robot: int) -> dict[str, float]:
        rng = np.random.default_rng([self.settings.seed, 1, robot])
        found: dict[str, float] = {}
        for number, one in enumerate(DECISIONS):
            is_own, shift = rng.random() < _OWN_SHARE, rng.uniform(-1.0, 1.0)
            level = one.level + shift * _OWN.get(one.kind, 0.0)
            if robot == self.outlier and number in self.far:
                level = _FAR[one.kind]
            elif not is_own or one.kind is Kind.FLAG or one.shared:
                continue
            found[parameter_of(number)] = one.value_at(level)
        return found

    def plan(self, number: int) -> MissionPlan:
        """The mission with a number, from 0."""
        settings = self.settings
        robot, turn = number % settings.robots, number // settings.robots
        turns = -(-settings.missions // settings.robots)
        steps = max(turns, settings.days)
        day = turn * settings.days // steps
        number_of_day = turn - -(-day * steps // settings.days)
        between = _OF_A_DAY / max(_USUAL_IN_A_DAY, -(-steps // settings.days))
        rng = np.random.default_rng([settings.seed, 2, number])
        first_of_day = _FIRST_DAY + timedelta(days=day)
        began = first_of_day + (number_of_day + int(rng.integers(600)) / 2400) * between
        name = f"{self.robot_name(robot)}-{first_of_day:%Y-%m-%d}-{number_of_day + 1}"
        wrong = self._drawn_wrong(robot, rng) if rng.random() < settings.bad else None
        values = self._values(robot)
        decoy = self._decoy(values, wrong, rng)
        if wrong is not None:
            values[parameter_of(wrong.decision)] = SetTo(wrong.value, "release")
        true_ns = round(began.timestamp()) * 10**9 + int(rng.integers(10**9))
        off = _CLOCK_OFF if robot == self.clock_off else timedelta()
        start_ns = true_ns + round(off.total_seconds()) * 10**9
        older = robot == self.older and day == 0
        return MissionPlan(number, robot, day, name, start_ns, true_ns, older, values, wrong, decoy)

    def _drawn_wrong(self, robot: int, rng: np.random.Generator) -> WrongValue:
        may = [robot in one.robots for one in self.culprits]
        shares = np.array(_SHARES) * may
        return self.culprits[int(rng.choice(CULPRITS, p=shares / shares.sum()))]

    def _values(self, robot: int) -> dict[str, SetTo]:
        found = {
            parameter_of(number): SetTo(
                True if one.kind is Kind.FLAG else one.value_at(one.level), "config"
            )
            for number, one in enumerate(DECISIONS)
        }
        own = self.own_values[robot]
        return found | {name: SetTo(value, "robot") for name, value in own.items()}

    def _decoy(
        self, values: dict[str, SetTo], wrong: WrongValue | None, rng: np.random.Generator
    ) -> str | None:
        """Change a value a little in every second mission; the name of its parameter."""
        if rng.random() < 0.5:
            return None
        # A value far from the usual one stays: it is known as such.
        may = [
            number
            for number, one in enumerate(DECISIONS)
            if one.kind in _OWN
            and not one.shared
            and number not in self.far
            and (wrong is None or number != wrong.decision)
        ]
        number = int(rng.choice(may))
        one = DECISIONS[number]
        shift = rng.uniform(0.5, 1.0) * rng.choice((-1.0, 1.0)) * _OWN[one.kind]
        values[parameter_of(number)] = SetTo(one.value_at(one.level + shift), "runtime")
        return parameter_of(number)

    def fly(self, plan: MissionPlan) -> FlownMission:
        """What happens in a mission."""
        rng = np.random.default_rng([self.settings.seed, 3, plan.number])
        given = [plan.values[parameter_of(number)].value for number in range(len(DECISIONS))]
        levels = np.array([o.level_of(float(v)) for o, v in zip(DECISIONS, given, strict=True)])
        scales = np.array([one.scale for one in DECISIONS])
        processes = make_processes(rng, self.settings.seconds, levels, self._offsets(plan))
        flown = FlownMission(plan, processes, np.array(given, np.float64) * scales)
        return self._observed(flown, levels, rng)

    def _offsets(self, plan: MissionPlan) -> Floats:
        found = np.zeros(len(DECISIONS))
        for drift in self.drifts:
            if plan.robot in drift.robots:
                found[drift.decision] += drift.steps * plan.day
        if plan.robot == self.outlier:
            found[self.elsewhere] += _SEEN_ELSEWHERE
        return found

    def _observed(
        self, flown: FlownMission, levels: Floats, rng: np.random.Generator
    ) -> FlownMission:
        """The mission with its errors, and with the marks of those who saw them."""
        plan, seconds = flown.plan, self.settings.seconds
        errors: tuple[tuple[float, float], ...] = ()
        if plan.wrong is not None:
            number = plan.wrong.decision
            right = DECISIONS[number].level_of(self.right_value(plan.robot, number))
            z = flown.processes.z[:, number]
            errors = _spans((z > levels[number]) != (z > right), seconds)
        seen = [(n, who) for n, _ in enumerate(errors) for who in self._seen_by(rng)]
        if errors and rng.random() < _ABSENT:
            seen = []
        elif errors and not seen:
            seen = [(0, _OBSERVERS[0])]
        said: list[tuple[Mark, int | None]] = []
        for number, who in seen:
            at = min(errors[number][0] + rng.uniform(*_DELAY_S), seconds - 0.01)
            assert plan.wrong is not None
            said.append((_mark(plan, at, plan.wrong.type, who, rng), number))
        if rng.random() < (_ALARM_GOOD if plan.wrong is None else _ALARM_BAD):
            at = rng.uniform(0.2, 0.98) * seconds
            type_: MarkType = "I" if rng.random() < 0.5 else "II"
            said.append((_mark(plan, at, type_, _OBSERVERS[1], rng), None))
        said.sort(key=lambda one: one[0].order())
        marks, causes = tuple(m for m, _ in said), tuple(c for _, c in said)
        return FlownMission(plan, flown.processes, flown.thresholds, errors, marks, causes)

    @staticmethod
    def _seen_by(rng: np.random.Generator) -> list[str]:
        if rng.random() >= _SEEN:
            return []
        return list(_OBSERVERS if rng.random() < _SEEN_TWICE else _OBSERVERS[:1])


def _spans(wrong: Bools, seconds: float) -> tuple[tuple[float, float], ...]:
    """From when to when (s) it was wrong, for a time that can be seen."""
    edges = np.flatnonzero(np.diff(np.r_[False, wrong, False])).reshape(-1, 2)
    # To the last knot that is wrong: up to there all values in between are, too.
    spans = ((edges - [0, 1]) / KNOTS_HZ).tolist()
    return tuple(
        (begin, min(end, seconds))
        for begin, end in spans
        if min(end, seconds) - begin >= _SHORTEST_S
    )


def _mark(
    plan: MissionPlan, at: float, right: MarkType, who: str, rng: np.random.Generator
) -> Mark:
    """A mark; its type is not always right, and may be missing."""
    said = int(rng.choice(3, p=_TYPED))
    other: MarkType = "II" if right == "I" else "I"
    type_ = right if said == _RIGHT else other if said == _OTHER else None
    return Mark(plan.start_ns + round(at * 1e9), type_, who)
