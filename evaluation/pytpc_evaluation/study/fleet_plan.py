"""The study's flights as fleets: three robots of each system, good missions and bad ones.

The robots of a system have other settings than their sisters, harmless ones that stay for all of
their missions. Each mission has more harmless settings of its own, as the study's missions have.
Everything is drawn by SHA-256, so that it is the same everywhere and whatever was flown before.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from itertools import zip_longest
from pathlib import Path

from pytpc.recording.parameter_change import Change
from pytpc.values.recording import read_parameters
from pytpc_evaluation.demo.demo_examples import EXAMPLES, Example
from pytpc_evaluation.study.changes import harmless_changes
from pytpc_evaluation.study.plan import CLEAN, Flight, Setting, halves, values_on
from pytpc_evaluation.treatment import OVERLAY_FILE, Treatment

ROBOTS = ("robot-1", "robot-2", "robot-3")
OWN = 6
"""So many settings of a robot are its own."""
BESIDE = 4
"""So many more are drawn for each mission."""
GOOD = 60
"""Good missions of a system, an equal number of each robot: all its treatments share them."""
FIRST_GOOD = 21
BAD = 10
"""Bad missions of a treatment, the robots by turns."""
ALONE = 6
"""More of them on the robot that has four, so that ten are on one robot."""
_SHARES = (0.5, 0.75, 1.0)
"""How much of the way a harmless setting goes from the old value to the one that was tried."""


@dataclass(frozen=True)
class FleetFlight(Flight):
    """A mission of a fleet.

    ``number`` is that of the mission among all of the system, and ``own`` are the settings of its
    robot, which ``changes`` come on top of. ``is_extra``: it is beyond the ten of its treatment.
    ``file`` is what the robot's own file says.
    """

    robot: str = ROBOTS[0]
    number: int = 0
    own: tuple[Change, ...] = ()
    is_extra: bool = False
    file: Mapping[str, object] = field(default_factory=dict, repr=False, compare=False)

    @property
    def name(self) -> str:
        """``water_sampler/robot-2/mission-0017``: it does not say what was done to the robot."""
        return f"{self.example.name}/{self.robot}/mission-{self.number:04}"

    @property
    def label(self) -> str:
        """Its folder below the fleet's; truth is in it."""
        return f"flown/{self.name}"

    @property
    def overlay(self) -> Path:
        """That of a clean mission: all that is set is in one file, the treatment's parameter too.

        So neither a file's name nor the place of a value says which of them is wrong.
        """
        return self.example.folder / "treatments" / CLEAN / OVERLAY_FILE

    @property
    def people(self) -> int:
        """The seed of those who look on: others in each mission."""
        return int(sha256(f"fleet/{self.name}".encode()).hexdigest()[:8], 16)

    @property
    def is_bad(self) -> bool:
        """Whether the robot has a wrong parameter."""
        return self.treatment.name != CLEAN

    def settings(self) -> dict[str, float | int | bool]:
        """All that is set beside the robot's file, the treatment's parameter among it.

        Raises:
            InputError: the robot has no such parameter.
        """
        changes = [Setting(one.parameter, one.node, one.new) for one in (*self.own, *self.changes)]
        treatment = self.treatment
        if treatment.parameter is not None and treatment.new is not None:
            changes.append(Setting(treatment.parameter, treatment.node or "", treatment.new))
        return values_on(self.file, changes)


def fleet_flights(example: Example, treatments: Collection[str] = ()) -> list[FleetFlight]:
    """The missions of a system, in the order in which they are flown.

    First come 21 good missions and the bad ones of a first treatment, then those of two more
    treatments, each after more of the good ones; then the other treatments; then what is beyond the
    ten of each. Wherever it stops, there are good missions of all robots, and whole treatments.

    Args:
        example: the robot.
        treatments: the bad missions of these alone; of all where empty.

    Raises:
        InputError: a treatment, or the list of harmless changes, cannot be read.
    """
    among = harmless_changes(example)
    own = {robot: robot_settings(example.name, robot, among) for robot in ROBOTS}
    half = halves(example.name, example.all_treatments())
    file = read_parameters(example.parameters)
    clean = example.treatment(CLEAN)

    def mission(number: int, robot: str, treatment: Treatment, *, is_extra: bool) -> FleetFlight:
        name = f"{example.name}/{robot}/{number}"
        return FleetFlight(
            kind="mission",
            example=example,
            treatment=treatment,
            seed=_seed(example, number),
            half=None if treatment is clean else half[treatment.name, 1],
            changes=mission_settings(name, treatment, own[robot], among),
            robot=robot,
            number=number,
            own=own[robot],
            is_extra=is_extra,
            file=file,
        )

    good = [
        mission(number, ROBOTS[(number - 1) % len(ROBOTS)], clean, is_extra=False)
        for number in range(1, GOOD + 1)
    ]
    bad: list[list[FleetFlight]] = []
    extra: list[list[FleetFlight]] = []
    # A treatment has the same numbers whatever else there is to fly.
    for place, treatment in enumerate(ordered_treatments(example)):
        if treatments and treatment.name not in treatments:
            continue
        first = GOOD + place * (BAD + ALONE)
        alone = ROBOTS[_number(f"fleet/{example.name}/{treatment.name}") % len(ROBOTS)]
        flights = []
        for turn in range(BAD + ALONE):
            # The robot that is alone later has one more of the first ten.
            by_turns = ROBOTS[(ROBOTS.index(alone) + turn) % len(ROBOTS)]
            robot = by_turns if turn < BAD else alone
            flights.append(mission(first + turn + 1, robot, treatment, is_extra=turn >= BAD))
        bad.append(flights[:BAD])
        extra.append(flights[BAD:])
    parts = (good[:FIRST_GOOD], good[FIRST_GOOD : 2 * FIRST_GOOD], good[2 * FIRST_GOOD :])
    order: list[FleetFlight] = []
    for some_good, some_bad in zip_longest(parts, bad, fillvalue=()):
        order += [*some_good, *some_bad]
    return order + [flight for flights in extra for flight in flights]


def all_fleet_flights(
    examples: Sequence[Example] = EXAMPLES, treatments: Collection[str] = ()
) -> list[FleetFlight]:
    """Those of all systems, one of each by turns.

    Raises:
        InputError: see ``fleet_flights``.
    """
    every = [fleet_flights(example, treatments) for example in examples]
    return [flight for turn in zip_longest(*every) for flight in turn if flight is not None]


def ordered_treatments(example: Example) -> list[Treatment]:
    """The treatments that change a parameter, tuning and held-back ones and both types by turns.

    Raises:
        InputError: a treatment cannot be read.
    """
    every = [one for one in example.all_treatments() if one.parameter is not None]
    half = halves(example.name, example.all_treatments())
    groups = []
    for kind, part in (
        ("type1", "tuning"),
        ("type2", "held-back"),
        ("type2", "tuning"),
        ("type1", "held-back"),
    ):
        group = [one for one in every if one.type == kind and half[one.name, 1] == part]
        groups.append(sorted(group, key=lambda one: _hash(f"fleet/{example.name}/{one.name}")))
    return [one for turn in zip_longest(*groups) for one in turn if one is not None]


def robot_settings(
    system: str, robot: str, among: Mapping[Change, Collection[str]]
) -> tuple[Change, ...]:
    """The settings that are a robot's own, in an order that is drawn.

    None of them was seen to hide an error, since they stay under every treatment.

    Args:
        system: whose robot it is.
        robot: its name.
        among: see ``harmless_changes``.
    """
    drawn = f"fleet/{system}/{robot}"
    return _drawn(drawn, [one for one, not_with in among.items() if not not_with], OWN)


def mission_settings(
    mission: str,
    treatment: Treatment,
    own: Sequence[Change],
    among: Mapping[Change, Collection[str]],
) -> tuple[Change, ...]:
    """The harmless settings of a mission alone.

    Args:
        mission: its name.
        treatment: its parameter is none of them.
        own: the settings of the robot; none is set again.
        among: see ``harmless_changes``.
    """
    taken = {(one.node, one.parameter) for one in own}
    changed = (treatment.parameter or "").lstrip("~/")
    others = [
        one
        for one, not_with in among.items()
        if (one.node, one.parameter) not in taken
        and one.parameter.lstrip("~") != changed
        and treatment.name not in not_with
    ]
    return _drawn(f"fleet/{mission}", others, BESIDE)


def _drawn(name: str, among: Sequence[Change], count: int) -> tuple[Change, ...]:
    chosen = sorted(among, key=lambda one: _hash(f"{name}{one.node}{one.parameter}"))[:count]
    return tuple(_part_of(name, change) for change in chosen)


def _part_of(name: str, change: Change) -> Change:
    """A value on the way to that of a harmless change: whole numbers stay whole."""
    share = _SHARES[_number(f"{name}/share{change.node}{change.parameter}") % len(_SHARES)]
    old, new = change.old, change.new
    value = float(f"{old + share * (new - old):.4g}")
    if old.is_integer() and new.is_integer():
        value = float(round(value))
    return Change(change.parameter, change.node, old, new if value == old else value)


def _seed(example: Example, number: int) -> int:
    """Of the world: another in each mission, and none of the study's."""
    return 1000 + _number(f"fleet/{example.name}/seed") % 1000 * 1000 + number


def _number(text: str) -> int:
    return int(_hash(text)[:8], 16)


def _hash(text: str) -> str:
    return sha256(text.encode()).hexdigest()
