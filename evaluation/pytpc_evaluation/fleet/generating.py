"""Writes the missions of a made-up fleet below a folder, and what is true of them."""

from __future__ import annotations

import json
import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc_evaluation.fleet.mission_files import MissionWriter
from pytpc_evaluation.fleet.robot_model import DECISIONS
from pytpc_evaluation.fleet.world import Drift, World, WorldSettings, WrongValue, parameter_of

TRUTH_FILE = "truth.json"
"""Beside the missions; no command of ``pytpc`` reads it."""
Advance = Callable[[int, int], None]


def mission_folder(world: World, number: int) -> Path:
    """Where a mission is below the folder of all: ``ROBOT/NAME``."""
    plan = world.plan(number)
    return Path(world.robot_name(plan.robot)) / plan.name


def generate(
    settings: WorldSettings,
    out: Path,
    numbers: Sequence[int] | None = None,
    *,
    jobs: int = 1,
    on_progress: Advance | None = None,
) -> dict[str, Any]:
    """Write missions and ``truth.json``.

    Args:
        settings: of the world.
        out: is made; may hold other missions of the same world.
        numbers: which missions; all of them if not given.
        jobs: how many processes write.
        on_progress: called with (missions written, missions in all).

    Returns:
        What ``truth.json`` has.

    Raises:
        InputError: one of the missions is there already, or missions of another world.
    """
    world = World(settings)
    before = _earlier(truth_of(world), out / TRUTH_FILE)
    wanted = range(settings.missions) if numbers is None else numbers
    for number in wanted:
        folder = out / mission_folder(world, number)
        if folder.exists():
            raise InputError("is there already; remove it, or give another folder", folder)
    missions = []
    for mission in _written(settings, out, wanted, jobs):
        missions.append(mission)
        if on_progress is not None:
            on_progress(len(missions), len(wanted))
    missions = sorted([*before, *missions], key=lambda one: one["folder"])
    truth = {**truth_of(world), "missions": missions}
    write_atomic(out / TRUTH_FILE, json.dumps(truth, indent=1).encode() + b"\n")
    return truth


def _earlier(truth: dict[str, Any], path: Path) -> list[dict[str, Any]]:
    """The missions that were written before.

    Raises:
        InputError: they are of another world.
    """
    if not path.exists():
        return []
    document = parse_json(path)
    if not isinstance(document, dict) or {**truth, "missions": []} != {**document, "missions": []}:
        raise InputError("is of another fleet; give another folder", path)
    return list(document["missions"])


def _written(
    settings: WorldSettings, out: Path, wanted: Sequence[int], jobs: int
) -> Iterator[dict[str, Any]]:
    if jobs == 1:
        writer = MissionWriter(World(settings))
        for number in wanted:
            yield _write(writer, out, number)
        return
    # Threads of the caller would be copied half by a fork.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, context) as pool:
        yield from pool.map(partial(_write_alone, settings, out), wanted)


def _write_alone(settings: WorldSettings, out: Path, number: int) -> dict[str, Any]:
    return _write(MissionWriter(World(settings)), out, number)


def _write(writer: MissionWriter, out: Path, number: int) -> dict[str, Any]:
    return writer.write(number, out, mission_folder(writer.world, number))


def truth_of(world: World) -> dict[str, Any]:
    """What is true of the fleet as a whole. Margins are in the unit of their parameter."""
    settings = world.settings
    return {
        "schema": 1,
        "settings": {**asdict(settings), "seconds": settings.seconds},
        "culprits": [_culprit(world, one) for one in world.culprits],
        "drifts": [_drift(world, one) for one in world.drifts],
        "outlier": {
            "robot": world.robot_name(world.outlier),
            "parameters": [
                {
                    "parameter": parameter_of(number),
                    "value": world.right_value(world.outlier, number),
                    "usual": DECISIONS[number].value_at(DECISIONS[number].level),
                }
                for number in world.far
            ],
            "sees_elsewhere": parameter_of(world.elsewhere),
        },
        "clock_off": world.robot_name(world.clock_off),
        "older_build": world.robot_name(world.older),
        "own_values": {
            world.robot_name(robot): dict(sorted(values.items()))
            for robot, values in enumerate(world.own_values)
        },
    }


def _culprit(world: World, one: WrongValue) -> dict[str, Any]:
    return {
        "parameter": parameter_of(one.decision),
        "type": one.type,
        "value": one.value,
        "robots": [world.robot_name(robot) for robot in one.robots],
    }


def _drift(world: World, one: Drift) -> dict[str, Any]:
    decision = DECISIONS[one.decision]
    return {
        "parameter": parameter_of(one.decision),
        "margin_per_day": -one.steps * decision.spread / decision.scale,
        "robots": [world.robot_name(robot) for robot in one.robots],
    }
