"""The answers about a fleet, as plain data: suspects, drifts, outliers, and what turned where."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from pytpc.base.wording import many, percent
from pytpc.diagnosis.results.suspects import SURE

WHOLE_FLEET = ""
"""The robot of what is said of all robots together."""


class FleetPlace(NamedTuple):
    """A comparison of the fleet.

    ``node`` and ``parameter`` are without the robots' own namespaces, ``place`` is ``file:line``,
    ``key`` that of the newest build.
    """

    parameter: str
    node: str
    place: str
    key: str


@dataclass(frozen=True, slots=True)
class ValueInMissions:
    """A value of a parameter, and how many bad and good missions had it; with ``robots``, sorted.

    ``fresh`` counts the bad missions whose robot flew no good mission with it.
    """

    text: str
    number: float | None
    bad: int
    good: int
    fresh: int
    robots: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FleetEvidence:
    """What speaks for a parameter, in log odds; the sum is its score.

    ``diagnoses`` of the bad missions, its ``values``, and the ``behaviour`` of its comparisons, as
    they count; ``prior`` is what is known before. "None of them" has the score 0, or what the
    diagnoses say of it.
    """

    prior: float
    diagnoses: float
    values: float
    behaviour: float


@dataclass(frozen=True, slots=True)
class FleetSuspect:
    """A parameter, and how likely it is what makes missions of the fleet go wrong.

    Attributes:
        position: from 1; ``tied`` ones share it.
        probability: with those of the others and of none of them 1.
        evidence: where the probability comes from.
        importance: of its predicates, with missions as runs; 0 where they say nothing.
        importance_position: its position by that, None where it is 0.
        differs: the share of bad missions whose value no good mission has; None where the value is
            known in no bad mission.
        mean_position: the mean of its positions by another ranking of each bad mission, if given.
        values: the commonest values in bad missions first, then those of good ones only.
        more_values: how many further values are not listed.
        margin_bad: the median over bad missions of the median margin of ``shows``; ``margin_good``
            over good ones; None without one.
        unit: of the margins.
        shows: the comparison that behaves most otherwise in bad missions; None of what is not
            compared.
        robots: those with a bad mission with a value that none of their good ones has.
        reason: in words.
    """

    position: int
    tied: bool
    parameter: str
    probability: float
    evidence: FleetEvidence
    importance: float
    importance_position: int | None
    differs: float | None
    mean_position: float | None
    values: tuple[ValueInMissions, ...]
    more_values: int
    margin_bad: float | None
    margin_good: float | None
    unit: str
    shows: FleetPlace | None
    robots: tuple[str, ...]
    reason: str


@dataclass(frozen=True, slots=True)
class FleetCause:
    """A parameter that makes some missions go wrong; others may have another cause.

    ``probability`` is that by all good missions and by the bad ones that no other cause explains.
    It explains so many ``bad`` missions, of these ``robots``: those with a value with which the
    robot mostly went wrong, and which no likelier cause explains.
    """

    parameter: str
    probability: float
    bad: int
    robots: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FleetRanking:
    """Which parameter makes missions go wrong: the suspects, the likeliest first.

    The suspects are judged as if there was one cause; ``none`` is the probability that it is none
    of them. ``bad`` and ``good`` count the missions, of so many ``robots``; ``diagnosed`` are the
    bad ones with a diagnosis of their own. ``notes`` say what keeps the answer from being surer.
    ``causes`` are the parameters that can be blamed, however many there are.
    """

    suspects: tuple[FleetSuspect, ...]
    none: float
    bad: int
    good: int
    robots: int
    diagnosed: int
    notes: tuple[str, ...]
    causes: tuple[FleetCause, ...] = ()

    @property
    def accused(self) -> str | None:
        """The parameter that is likely enough to be blamed, and compared; None without one.

        Of several causes it is the first one.
        """
        if self.causes:
            return self.causes[0].parameter
        first = next(iter(self.suspects), None)
        sure = first is not None and first.probability >= SURE and first.shows is not None
        return first.parameter if first is not None and sure else None

    @property
    def is_mixed(self) -> bool:
        """Whether there are several causes, or one that is no sure suspect of all bad missions."""
        if len(self.causes) != 1:
            return bool(self.causes)
        first = self.suspects[0]
        return first.parameter != self.causes[0].parameter or first.probability < SURE

    @property
    def text(self) -> str:
        """The judgement in one line."""
        if not self.suspects:
            return "no parameter is compared, and none was recorded"
        first = self.suspects[0]
        sure, none = percent(first.probability), percent(self.none)
        if self.is_mixed:
            blamed = [
                f"{one.parameter}, {percent(one.probability)}, for {one.bad:,}"
                for one in self.causes
            ]
            of = f"of {many(self.bad, 'bad mission')}"
            return f"blame {'; '.join([f'{blamed[0]} {of}', *blamed[1:]])}"
        if self.accused is not None:
            return f"blame {first.parameter}: {sure}; none of the parameters: {none}"
        if self.none > first.probability:
            return (
                f"not sure: most likely none of the parameters ({none}), then"
                f" {first.parameter} ({sure})"
            )
        return f"not sure: {first.parameter} is likeliest ({sure}); none of the parameters: {none}"


class DayMargin(NamedTuple):
    """A day, ``YYYY-MM-DD``, and the median of its margins."""

    day: str
    margin: float


@dataclass(frozen=True, slots=True)
class FleetDrift:
    """A margin that rises or falls from day to day.

    Attributes:
        robot: ``WHOLE_FLEET`` for all robots together.
        where: the comparison.
        measure: ``least`` or ``median``, of the margins of each mission.
        since: the first day with the present setting, ``threshold`` (None where it has several).
        until: the last day that was seen.
        days: how many days there are missions of.
        now: the margin on the last day, on the line; ``per_day`` is its slope, in ``unit``.
        chance: how likely chance is to order days so.
        is_clear: whether it is hardly by chance, however many series were tested.
        turns_on: the day on which the margin will be 0, ``YYYY-MM-DD``; None if it rises, or that
            is too far off to say.
        earliest, latest: the interval of that day; None is an open end.
        turned: how often it has turned since.
        margins: of the days that have one, sorted. Of all robots together they are the medians over
            the robots, each moved to their common level.
    """

    robot: str
    where: FleetPlace
    measure: Literal["least", "median"]
    since: str
    until: str
    days: int
    threshold: float | None
    now: float
    per_day: float
    unit: str
    chance: float
    is_clear: bool
    turns_on: str | None
    earliest: str | None
    latest: str | None
    turned: int
    margins: tuple[DayMargin, ...] = ()


@dataclass(frozen=True, slots=True)
class FleetDrifts:
    """All margins that drift, by the day on which they will turn; the others behind.

    ``tested`` counts the series of days; with a chance of ``chance`` each, some of the drifts are
    by chance. ``short`` counts those of fewer than ``fewest`` days, of which nothing is said.
    """

    drifts: tuple[FleetDrift, ...]
    tested: int
    short: int
    fewest: int
    chance: float

    @property
    def by_chance(self) -> float:
        """How many drifts there would be if nothing drifted."""
        return self.tested * self.chance


@dataclass(frozen=True, slots=True)
class OtherSetting:
    """A robot has another value of a parameter than its sisters.

    ``value`` is that of most of its missions. ``usual`` is that of most sisters, of which ``share``
    have it; ``score`` is how many median absolute deviations it is off theirs, None where all have
    one value, or it is no number.
    """

    robot: str
    parameter: str
    value: str
    usual: str
    sisters: int
    share: float
    score: float | None


@dataclass(frozen=True, slots=True)
class OtherDecision:
    """A comparison behaves otherwise on a robot than on its sisters.

    ``measure`` is what differs: ``own`` is its median over the robot's missions, ``usual`` that of
    the sisters' medians. ``score`` is how many of their median absolute deviations it is off;
    ``chance`` how likely chance ranks its missions so, times the number of tests.
    ``is_set_otherwise`` says that the robot has a value of the parameter, too, that fewer than half
    of its sisters have.
    """

    robot: str
    where: FleetPlace
    measure: str
    own: float
    usual: float
    sisters: int
    score: float
    chance: float
    is_set_otherwise: bool


class RobotCounts(NamedTuple):
    """How many decisions and settings of a robot differ from its sisters."""

    robot: str
    decisions: int
    settings: int


@dataclass(frozen=True, slots=True)
class FleetOutliers:
    """Which robots differ from their sisters: decisions by chance, settings that matter first.

    ``settings`` and ``decisions`` are separate: a robot may be set otherwise on purpose. ``counts``
    has one entry for each robot, the most decisions first. ``tested``
    counts the tests of decisions. ``notes`` say what could not be judged.
    """

    settings: tuple[OtherSetting, ...]
    decisions: tuple[OtherDecision, ...]
    counts: tuple[RobotCounts, ...]
    tested: int
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FoundMission:
    """A mission whose digest fits to a query; ``where`` are the comparisons that fit.

    ``turns`` counts those of all of them; ``least`` is the least margin, None without one.
    """

    mission: str
    robot: str
    day: str
    start_ns: int
    is_bad: bool
    where: tuple[FleetPlace, ...]
    turns: int
    least: float | None

    @property
    def text(self) -> str:
        """The mission in one line."""
        return f"{self.robot} {self.day} {self.mission}: {many(self.turns, 'turn')}"


@dataclass(frozen=True, slots=True)
class FoundTurn:
    """A turn of a comparison in a mission.

    ``value`` was compared with ``threshold`` at ``time_ns``, when the ``result`` became true or
    false. ``margin`` is the smaller of those before and after it; None where there is none.
    """

    time_ns: int
    key: str
    node: str
    parameter: str
    place: str
    result: bool
    value: float
    threshold: float
    margin: float | None
