"""Writes a mission of the made-up fleet as ``pytpc record`` with the sink ``file`` would.

The reports are made of whole columns: a mission of a million takes a good part of a second.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from pytpc.base.atomic import write_atomic
from pytpc.base.paths import MERGED_FILE
from pytpc.recording.graph_file import GRAPH_FILE, write_graph
from pytpc.recording.marks import write_marks
from pytpc.recording.mission import REPORTS_FOLDER, RUN_FILE
from pytpc.static.wiring import GraphTopic
from pytpc.values.origins import ORIGINS_FILE, PARAMS_FILE, Origin, OriginKind, write_origins
from pytpc_evaluation.fleet.processes import KNOTS_HZ, Floats
from pytpc_evaluation.fleet.robot_build import Build, Site
from pytpc_evaluation.fleet.robot_model import (
    DECISIONS,
    GAINS,
    LOOPS,
    SOURCES,
    Kind,
)
from pytpc_evaluation.fleet.world import FlownMission, MissionPlan, World, parameter_of
from pytpc_evaluation.report_file import (
    Records,
    header,
    in_order,
    name,
    reports,
    site,
    sync,
    system_chunks,
    thread_chunks,
)

_SECOND = 10**9
_BOOTED_S = 300
_APART_NS = 2_000
_NOISE = 0.004
_LAUNCH = f"{SOURCES}/launch/robot.launch"
# Where a value is set, by who has set it: the kind of its origin, and the file.
_PLACES: dict[str, tuple[OriginKind, str]] = {
    "config": ("yaml", f"{SOURCES}/config/robot.yaml"),
    "robot": ("yaml", f"{SOURCES}/config/robots/{{robot}}.yaml"),
    "release": ("yaml", f"{SOURCES}/config/release.yaml"),
    "runtime": ("runtime", ""),
}
NODES = tuple(dict.fromkeys(loop.node for loop in LOOPS))


@dataclass(frozen=True)
class MissionWriter:
    """Writes missions of a world; `write` may be called from several processes."""

    world: World

    @cached_property
    def _builds(self) -> dict[bool, tuple[Build, bytes]]:
        """Both builds, each with its file."""
        builds = {older: Build(older) for older in (False, True)}
        return {
            older: (build, json.dumps(build.static_info().to_json(), indent=1).encode() + b"\n")
            for older, build in builds.items()
        }

    def write(self, number: int, out: Path, place: Path) -> dict[str, Any]:
        """Write a mission into a new folder; ``run.json`` last, as a recorder does.

        Args:
            number: of the mission, from 0.
            out: the folder of all missions.
            place: the mission's folder below it; is made, and must not be there.

        Returns:
            What is true of it, for truth.json.
        """
        plan = self.world.plan(number)
        flown = self.world.fly(plan)
        folder = out / place
        build, static = self._builds[plan.older]
        (folder / REPORTS_FOLDER).mkdir(parents=True)
        (folder / MERGED_FILE).write_bytes(static)
        made = [self._write_node(flown, build, node, folder / REPORTS_FOLDER) for node in NODES]
        self._write_values(plan, folder)
        self._write_graph(plan, folder / GRAPH_FILE)
        if flown.marks:
            write_marks(flown.marks, folder / "marks.csv")
        self._write_run(flown, sum(made), static, folder)
        return self._truth(flown, place, sum(made))

    # --- reports

    def _write_node(self, flown: FlownMission, build: Build, node: str, folder: Path) -> int:
        """Write the file of a node; how many reports it has."""
        plan = flown.plan
        steady = (_BOOTED_S + 60 * NODES.index(node)) * _SECOND
        began = plan.start_ns - steady
        sites: list[Site] = []
        threads: list[Records] = []
        for number, loop in enumerate(LOOPS):
            if loop.node == node:
                own = build.sites(number)
                rng = np.random.default_rng([self.world.settings.seed, 4, plan.number, number])
                made = _loop_reports(flown, loop.rate, own, rng)
                made["site"] += len(sites) + 1
                made["steady"] += steady
                threads.append(made)
                sites += own
        reads = build.reads(node)
        seconds = int(self.world.settings.seconds) + 2
        system = [
            *(site(number, one.key) for number, one in enumerate(sites, start=1)),
            *(name(key, self.world.full_name(plan, parameter_of(number))) for number, key in reads),
            *(sync(steady + s * _SECOND, began + steady + s * _SECOND) for s in range(seconds)),
        ]
        pid = 1000 + 10 * plan.number % 30_000 + NODES.index(node)
        head = header(
            self.world.full_name(plan, f"/{node}"),
            host=self.world.robot_name(plan.robot),
            program=f"/opt/ws/install/lib/fleet_robot/{node}",
            pid=pid,
            steady_ns=steady,
            real_ns=plan.start_ns,
        )
        chunks = [thread_chunks(n, one) for n, one in enumerate(threads, start=1)]
        path = folder / f"{node}-{pid}-{plan.start_ns // _SECOND}.tpc"
        with path.open("wb") as stream:
            stream.write(head)
            stream.write(system_chunks(system))
            stream.writelines(chunk.data for chunk in in_order(chunks))
        written = (plan.true_ns + round(self.world.settings.seconds * _SECOND)) // _SECOND
        os.utime(path, (written, written))
        return sum(one.size for one in threads)

    # --- everything else

    def _write_values(self, plan: MissionPlan, folder: Path) -> None:
        world = self.world
        found: dict[str, Origin] = {}
        lines = {parameter: line for line, parameter in enumerate(sorted(plan.values), start=4)}
        for parameter, given in plan.values.items():
            full = world.full_name(plan, parameter)
            kind, file = _PLACES[given.by]
            path = Path(file.format(robot=world.robot_name(plan.robot))) if file else None
            key = parameter.rpartition("/")[2]
            shown = str(given.value).lower() if given.value is True else f"{given.value:g}"
            found[full] = Origin(
                name=full,
                kind=kind,
                value=given.value,
                path=path,
                lineno=lines[parameter] if file else None,
                text=f"{key}: {shown}" if file else "",
                note="" if file else "set by a program, not by the launch file",
                keys=tuple(parameter.strip("/").split("/")) if file else (),
            )
        values: dict[str, object] = {full: origin.value for full, origin in found.items()}
        for node, gains in GAINS.items():
            for key, value in gains.items():
                values[world.full_name(plan, f"/{node}/{key}")] = value
        text = yaml.safe_dump(_nested(values), default_flow_style=False)
        (folder / PARAMS_FILE).write_text(text, encoding="utf-8")
        document: dict[str, object] = {
            "launch": _LAUNCH,
            "args": {},
            "env": {},
            "reason": "",
            "files": {},
        }
        write_origins({**document, "nodes": []}, found, folder / ORIGINS_FILE)

    def _write_graph(self, plan: MissionPlan, path: Path) -> None:
        """Each loop publishes what another node hears."""
        every = [self.world.full_name(plan, f"/{node}") for node in NODES]
        topics = {
            self.world.full_name(plan, f"/{loop.topic}"): GraphTopic(
                loop.message,
                frozenset({every[NODES.index(loop.node)]}),
                frozenset({every[(NODES.index(loop.node) + 1) % len(every)]}),
            )
            for loop in LOOPS
        }
        write_graph(topics, path)

    def _write_run(self, flown: FlownMission, made: int, static: bytes, folder: Path) -> None:
        seconds = self.world.settings.seconds
        document = {
            "schema": 1,
            "launch": _LAUNCH,
            "args": {},
            "until": None,
            "static": {
                "path": "/opt/ws/.tpc/static.json",
                "sha256": hashlib.sha256(static).hexdigest(),
                "guessed": False,
            },
            "bag": "mission.bag",
            "params": PARAMS_FILE,
            "ended": "done",
            "sim_s": seconds,
            "wall_s": seconds,
            "reports": 0,
            "messages": {},
            "lost": {},
            "missed_before": {},
            "done_ns": flown.plan.start_ns + round(seconds * _SECOND),
            "dropped": [],
            "broken": {},
            "files": len(NODES),
            "reports_in_files": made,
            "summaries_in_files": 0,
            "is_reporting": False,
            "marks": len(flown.marks),
        }
        write_atomic(folder / RUN_FILE, json.dumps(document, indent=1).encode() + b"\n")

    # --- the truth

    def _truth(self, flown: FlownMission, place: Path, made: int) -> dict[str, Any]:
        """What is true of a mission."""
        plan = flown.plan
        wrong = plan.wrong
        return {
            "name": plan.name,
            "folder": place.as_posix(),
            "robot": self.world.robot_name(plan.robot),
            "day": plan.day,
            "start_ns": plan.start_ns,
            "older_build": plan.older,
            "reports": made,
            "wrong": None
            if wrong is None
            else {
                "parameter": parameter_of(wrong.decision),
                "node": self.world.full_name(
                    plan, f"/{LOOPS[DECISIONS[wrong.decision].loop].node}"
                ),
                "keys": keys_of(self._builds[plan.older][0], wrong.decision),
                "type": wrong.type,
                "value": wrong.value,
                "right": self.world.right_value(plan.robot, wrong.decision),
            },
            "errors": [{"begin_s": begin, "end_s": end} for begin, end in flown.errors],
            "marks": [
                {"time_ns": mark.time_ns, "error": cause}
                for mark, cause in zip(flown.marks, flown.causes, strict=True)
            ],
            "decoy": plan.decoy,
        }


def keys_of(build: Build, decision: int) -> list[str]:
    """The keys of a decision's comparisons."""
    found = build.sites(DECISIONS[decision].loop)
    return [one.key for one in found if one.compared.decision == decision]


def _loop_reports(
    flown: FlownMission, rate: float, sites: Sequence[Site], rng: np.random.Generator
) -> Records:
    """The reports of a thread: a row of comparisons in each round, some of which are left out.

    Its sites and its times begin at 0.
    """
    count = int(flown.processes.times[-2] * rate)
    numbers = [one.compared.decision for one in sites]
    values = _between(flown, sites, np.arange(count) * np.float64(KNOTS_HZ / rate))
    values += _NOISE * rng.standard_normal(values.shape, np.float32)
    decisions = [DECISIONS[number] for number in numbers]
    values *= np.array([one.sign * one.spread for one in decisions])
    values += np.array([one.centre for one in decisions])
    thresholds = flown.thresholds[numbers]
    res = values > thresholds
    for column, one in enumerate(decisions):
        if one.relation == "<":
            res[:, column] = values[:, column] < thresholds[column]
        elif one.kind is Kind.FLAG:
            values[:, column] = thresholds[column]
            res[:, column] = thresholds[column] != 0
    made = reports(values.shape, res)
    made["cmp"], made["thresh"] = values, thresholds
    made["site"] = np.arange(len(sites))
    period = round(_SECOND / rate)
    made["steady"] = np.arange(count)[:, None] * period + np.arange(len(sites)) * _APART_NS
    nested = [n for n, one in enumerate(sites) if one.compared.place and one.decision.nested]
    if not nested:
        return made.reshape(-1)
    evaluated = np.ones(res.shape, np.bool_)
    for column in nested:
        evaluated[:, column] = res[:, column - 1]
    return made[evaluated]


def _between(flown: FlownMission, sites: Sequence[Site], at: Floats) -> Floats:
    """float64[n, sites]: the values in steps at times in knots, linear between these."""
    columns = [
        (flown.processes.second if one.compared.place else flown.processes.z)[
            :, one.compared.decision
        ]
        for one in sites
    ]
    knots = np.stack(columns, axis=1)
    before = at.astype(np.int64)
    share = (at - before)[:, None]
    found: Floats = knots[before]
    found += share * np.diff(knots, axis=0)[before]
    return found


def _nested(values: dict[str, object]) -> dict[str, Any]:
    """Full names as the maps of a dump of the parameter server."""
    found: dict[str, Any] = {}
    for full, value in values.items():
        *above, last = full.strip("/").split("/")
        place = found
        for part in above:
            place = place.setdefault(part, {})
        place[last] = value
    return found
