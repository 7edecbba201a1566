"""What is asked of flown fleets: ten bad missions and fifty good ones, and which parameter it is.

Whether a mission went right is what its owner says: one with a wrong parameter went wrong if an
error was seen and marked, and a clean one went right if none was seen, whatever false alarms there
were. All others are left out. In questions of the shape ``by-marks`` nobody says so: a mission with
a mark counts as bad, also if that was a false alarm.
"""

from __future__ import annotations

import random
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

Shape = Literal["mixed", "one-robot", "by-marks"]
SHAPES: tuple[Shape, ...] = get_args(Shape)
"""Bad missions of all three robots, or of one; the good ones are of all three. ``by-marks`` ones
have the missions of ``mixed`` ones."""
ASKED: tuple[Shape, ...] = ("mixed", "one-robot")
"""Those that are asked if nothing is said."""
BAD = 10
GOOD = 50
MARKED = 0.8
"""Nothing is asked of a treatment with a smaller share of the wanted bad missions."""
DRAWS = 3


@dataclass(frozen=True, slots=True)
class FleetQuestion:
    """A question with a known answer.

    ``bad`` and ``good`` are folders of missions, sorted; ``parameter`` and ``node`` are what is
    wrong in all of the bad ones. ``draw`` counts the drawn questions of a treatment and shape.
    """

    system: str
    treatment: str
    type: str
    half: str
    parameter: str
    node: str
    shape: Shape
    draw: int
    bad: tuple[str, ...]
    good: tuple[str, ...]


def questions(
    rows: Iterable[Mapping[str, Any]],
    draws: int = DRAWS,
    shapes: Sequence[Shape] = ASKED,
    bad_count: int = BAD,
    good_count: int = GOOD,
) -> Iterator[FleetQuestion]:
    """The questions that flown missions allow, by system, treatment and shape.

    Args:
        rows: of ``flights.json``.
        draws: how many questions there are of each treatment and shape, each with other missions.
        shapes: which.
        bad_count: how many bad missions a question has; with less than 80 % of them there is none.
        good_count: how many good ones; with fewer there is none.
    """
    good, bad = by_verdict(rows)
    for (system, treatment), marked in sorted(bad.items()):
        if len(good.get(system, ())) < good_count:
            continue
        for shape in shapes:
            among = _of_one_robot(marked) if shape == "one-robot" else marked
            if len(among) < MARKED * bad_count:
                continue
            for draw in range(draws):
                drawn = "one-robot" if shape == "one-robot" else "mixed"
                dice = random.Random(f"fleet {system} {treatment} {drawn} {draw}")
                yield FleetQuestion(
                    system=system,
                    treatment=treatment,
                    type=marked[0]["type"],
                    half=marked[0]["half"],
                    parameter=marked[0]["parameter"],
                    node=marked[0]["node"] or "",
                    shape=shape,
                    draw=draw,
                    bad=by_turns(among, bad_count, dice),
                    good=by_turns(good[system], good_count, dice),
                )


def by_verdict(
    rows: Iterable[Mapping[str, Any]],
) -> tuple[dict[str, list[Mapping[str, Any]]], dict[tuple[str, str], list[Mapping[str, Any]]]]:
    """The flown missions that went right, by system, and those that went wrong and were marked.

    The latter are by system and treatment.
    """
    good: defaultdict[str, list[Mapping[str, Any]]] = defaultdict(list)
    bad: defaultdict[tuple[str, str], list[Mapping[str, Any]]] = defaultdict(list)
    for row in rows:
        if row["state"] != "done":
            continue
        if row["parameter"] is None:
            if not row["errors"]:
                good[row["system"]].append(row)
        elif row["errors"] and row["marks"]:
            bad[row["system"], row["treatment"]].append(row)
    return good, bad


def by_turns(rows: Iterable[Mapping[str, Any]], count: int, dice: random.Random) -> tuple[str, ...]:
    """Draw at most so many missions, of each robot as many as of the others if there are.

    Returns:
        Their folders, sorted.
    """
    robots: defaultdict[str, list[str]] = defaultdict(list)
    for row in rows:
        robots[row["robot"]].append(row["folder"])
    drawn = []
    for robot in sorted(robots):
        folders = sorted(robots[robot])
        dice.shuffle(folders)
        # What decides between robots whose turn it is, is drawn too.
        drawn += [(turn, dice.random(), folder) for turn, folder in enumerate(folders)]
    return tuple(sorted(folder for _, _, folder in sorted(drawn)[:count]))


def _of_one_robot(marked: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Those of the robot with the most."""
    robots = [row["robot"] for row in marked]
    most = max(sorted(set(robots)), key=robots.count)
    return [row for row in marked if row["robot"] == most]
