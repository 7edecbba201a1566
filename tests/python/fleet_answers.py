"""Hand-made answers about a fleet."""

from __future__ import annotations

from pytpc.diagnosis.results.fleet import (
    WHOLE_FLEET,
    FleetDrift,
    FleetDrifts,
    FleetEvidence,
    FleetOutliers,
    FleetPlace,
    FleetRanking,
    FleetSuspect,
    FoundMission,
    FoundTurn,
    OtherDecision,
    OtherSetting,
    RobotCounts,
    ValueInMissions,
)

START_NS = 1_700_000_000_000_000_000


def place(parameter: str = "~safe_distance", lineno: int = 12) -> FleetPlace:
    return FleetPlace(
        parameter=parameter,
        node="/guard",
        place=f"src/guard.cpp:{lineno}",
        key=f"key-{parameter}",
    )


def value(text: str, bad: int, good: int, robots: tuple[str, ...]) -> ValueInMissions:
    number = float(text) if text.replace(".", "").isdigit() else None
    return ValueInMissions(text, number, bad, good, bad if not good else 0, robots)


def suspect(position: int, parameter: str, probability: float, **fields: object) -> FleetSuspect:
    made: dict[str, object] = {
        "tied": False,
        "evidence": FleetEvidence(-2.0, 0.5, 3.0, 1.0),
        "importance": 0.4,
        "importance_position": position,
        "differs": 0.75,
        "mean_position": 1.5,
        "values": (value("0.3", 3, 0, ("r1", "r2")), value("0.8", 1, 9, ("r1", "r2", "r3"))),
        "more_values": 0,
        "margin_bad": 0.02,
        "margin_good": 0.4,
        "unit": "parameter",
        "shows": place(parameter),
        "robots": ("r1", "r2"),
        "reason": "3 of 4 bad missions have a value that no good mission of the robot has: 0.3",
        **fields,
    }
    return FleetSuspect(position=position, parameter=parameter, probability=probability, **made)  # type: ignore[arg-type]


def uncompared(position: int, parameter: str) -> FleetSuspect:
    """What no comparison reports, with nothing that is known besides."""
    return suspect(
        position,
        parameter,
        0.01,
        importance=0.0,
        importance_position=None,
        differs=None,
        mean_position=None,
        margin_bad=None,
        margin_good=None,
        unit="",
        shows=None,
        robots=(),
        values=(),
        reason="no comparison reports it",
    )


def ranking(*suspects: FleetSuspect, notes: tuple[str, ...] = ()) -> FleetRanking:
    none = 1 - sum(one.probability for one in suspects)
    return FleetRanking(suspects, none, 4, 10, 3, 2, notes)


def drift(parameter: str = "~safe_distance", robot: str = "r1", **fields: object) -> FleetDrift:
    made: dict[str, object] = {
        "measure": "least",
        "since": "2026-11-01",
        "until": "2026-11-10",
        "days": 10,
        "threshold": 0.8,
        "now": 0.2,
        "per_day": -0.02,
        "unit": "parameter",
        "chance": 0.0004,
        "is_clear": True,
        "turns_on": "2026-11-20",
        "earliest": "2026-11-16",
        "latest": "2026-11-27",
        "turned": 0,
        **fields,
    }
    return FleetDrift(robot=robot, where=place(parameter), **made)  # type: ignore[arg-type]


def drifts(*found: FleetDrift) -> FleetDrifts:
    return FleetDrifts(found, tested=40, short=3, fewest=5, chance=0.001)


def rising(robot: str = WHOLE_FLEET) -> FleetDrift:
    return drift(
        "~battery", robot, per_day=0.5, turns_on=None, earliest=None, latest=None, threshold=None
    )


def setting(robot: str = "r3", parameter: str = "~gain") -> OtherSetting:
    return OtherSetting(robot, parameter, "2.5", "1", 9, 1.0, None)


def decision(robot: str = "r3", parameter: str = "~safe_distance") -> OtherDecision:
    return OtherDecision(
        robot, place(parameter), "turns a minute", 4.0, 0.5, 9, 8.25, 0.0001, False
    )


def outliers(
    settings: tuple[OtherSetting, ...] = (),
    decisions: tuple[OtherDecision, ...] = (),
    notes: tuple[str, ...] = (),
) -> FleetOutliers:
    robots = sorted({one.robot for one in (*settings, *decisions)} | {"r1", "r2", "r3"})
    counts = tuple(
        RobotCounts(
            robot,
            sum(one.robot == robot for one in decisions),
            sum(one.robot == robot for one in settings),
        )
        for robot in robots
    )
    return FleetOutliers(settings, decisions, counts, 120, notes)


def mission(robot: str = "r1", name: str = "flight-1a2b", *, is_bad: bool = True) -> FoundMission:
    return FoundMission(name, robot, "2026-11-03", START_NS, is_bad, (place(),), 2, 0.05)


def turn(seconds: float = 1.5, *, result: bool = True) -> FoundTurn:
    time_ns = START_NS + round(seconds * 1e9)
    where = place()
    return FoundTurn(
        time_ns, where.key, where.node, where.parameter, where.place, result, 0.75, 0.8, 0.05
    )
