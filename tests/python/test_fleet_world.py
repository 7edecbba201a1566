"""The made-up fleet is the same each time, and what its truth.json says is so."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

from pytpc.cli.rank_commands import rank_command
from pytpc.diagnosis.full_names import with_full_names
from pytpc.ingest.reading import read
from pytpc.recording.mission import Recording
from pytpc.static.other_builds import keys_in
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import read_origins
from pytpc_evaluation.commands.study_commands import study_group
from pytpc_evaluation.fleet.generating import generate, mission_folder
from pytpc_evaluation.fleet.robot_build import Build
from pytpc_evaluation.fleet.robot_model import DECISIONS
from pytpc_evaluation.fleet.world import World, WorldSettings, parameter_of
from pytpc_evaluation.report_file import (
    header,
    name,
    reports,
    site,
    sync,
    system_chunks,
    thread_chunks,
)

SMALL = WorldSettings(robots=3, missions=12, days=4, reports=60_000)
SECOND = 10**9
READ = "6f1c0f4e-7a1b-5c3d-8e2f-000000000009"


def files_of(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@pytest.fixture(scope="module")
def fleet(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict]:
    out = tmp_path_factory.mktemp("fleet")
    return out, generate(SMALL, out)


# --- the writer of binary files


def test_a_written_file_reads_back(tmp_path):
    # 2,047 reports are one more than a chunk has. Thread 1 reports each 2 ns from 1,000 on, thread
    # 2 once, at 1,001; the real clock is 5 s ahead of the steady one.
    one, two = reports(2047, np.arange(2047) % 2 == 1), reports(1, True)
    one["site"], one["thresh"], one["cmp"] = 1, 0.5, np.arange(2047)
    one["steady"] = 1000 + 2 * np.arange(2047)
    two["site"], two["thresh"], two["cmp"], two["steady"] = 2, -1.0, 7.25, 1001
    path = tmp_path / "node-1-1.tpc"
    system = [site(1, "k" * 36), site(2, "short"), name(READ, "/r/n/limit"), sync(0, 5 * SECOND)]
    with path.open("wb") as stream:
        stream.write(header("/r/n", real_ns=5 * SECOND))
        stream.write(system_chunks(system))
        stream.write(thread_chunks(1, one).tobytes() + thread_chunks(2, two).tobytes())
    found = read(path)
    events = found.events
    assert len(events) == 2048 and found.malformed == 0 and not found.lost
    assert events.time_ns[:3].tolist() == [5 * SECOND + 1000, 5 * SECOND + 1001, 5 * SECOND + 1002]
    assert events.cmp[:3].tolist() == [0, 7.25, 1] and events.cmp[-1] == 2046
    assert events.res[:3].tolist() == [False, True, True]
    assert [events.keys[code] for code in events.key[:2].tolist()] == ["k" * 36, "short"]
    assert [(said.key, said.node, said.name) for said in found.names] == [
        (READ, "/r/n", "/r/n/limit")
    ]


def test_records_of_the_system_do_not_lie_in_two_chunks(tmp_path):
    # A key of 100 characters takes 1 + 3 records; 511 of them fill 2,044 of 2,046.
    keys = [f"{number:0100d}" for number in range(600)]
    path = tmp_path / "node-1-1.tpc"
    one = reports(600, False)
    one["site"] = 1 + np.arange(600)
    one["steady"], one["cmp"], one["thresh"] = np.arange(600), 0.0, 1.0
    raw = system_chunks(site(number, key) for number, key in enumerate(keys, start=1))
    assert len(raw) == 2 * 65536
    path.write_bytes(header("/n", real_ns=SECOND) + raw + thread_chunks(1, one).tobytes())
    found = read(path)
    assert [found.events.keys[code] for code in found.events.key.tolist()] == keys
    assert found.malformed == 0 and not found.lost


# --- the fleet


def test_the_same_settings_write_the_same_bytes(fleet, tmp_path):
    """Also one mission alone, and by other processes."""
    out, truth = fleet
    generate(SMALL, tmp_path, [5])
    generate(SMALL, tmp_path, [2], jobs=2)
    world = World(SMALL)
    for number in (5, 2):
        folder = mission_folder(world, number)
        assert files_of(tmp_path / folder) == files_of(out / folder)
    written = json.loads((tmp_path / "truth.json").read_text())
    folders = sorted(str(mission_folder(world, number)) for number in (2, 5))
    assert [one["folder"] for one in written["missions"]] == folders
    assert all(one in truth["missions"] for one in written["missions"])


def test_another_seed_makes_another_fleet(fleet, tmp_path):
    _, truth = fleet
    other = generate(WorldSettings(2, 3, 4, 12, 60_000), tmp_path, [0])
    assert other["culprits"] != truth["culprits"]


def outcomes(recording: Recording, keys: list[str], limit: float, below: bool) -> tuple:
    """When the first of these comparisons was evaluated, what came out, and what should have."""
    events = recording.events
    rows = events.key == events.keys.index(keys[0])
    should = events.cmp[rows] < limit if below else events.cmp[rows] > limit
    return events.time_ns[rows] - recording.start_ns, events.res[rows], should


def test_a_wrong_value_turns_its_comparison_otherwise_in_the_errors(fleet):
    out, truth = fleet
    seen = 0
    for one in truth["missions"]:
        wrong = one["wrong"]
        if wrong is None:
            assert one["errors"] == []
            continue
        number = next(n for n, _ in enumerate(DECISIONS) if parameter_of(n) == wrong["parameter"])
        decision = DECISIONS[number]
        recording = read(out / one["folder"])
        limit = wrong["right"] * decision.scale
        at, res, should = outcomes(recording, wrong["keys"], limit, decision.relation == "<")
        inside = np.zeros(at.size, np.bool_)
        for error in one["errors"]:
            span = (at >= 1e9 * error["begin_s"]) & (at <= 1e9 * error["end_s"])
            # Noise of 0.004 steps is added where values cross a threshold.
            assert (res != should)[span].mean() > 0.9
            # Type I: it did what it should not.
            assert (res[span & (res != should)] == (wrong["type"] == "I")).all()
            inside |= (at >= 1e9 * error["begin_s"] - 1e8) & (at <= 1e9 * error["end_s"] + 1e8)
        # What is wrong for less than 0.4 s is no error that anybody sees.
        assert one["errors"] and (res == should)[~inside].mean() > 0.9
        seen += 1
    assert seen >= 3


def test_marks_are_near_their_errors(fleet):
    _, truth = fleet
    causes = []
    for one in truth["missions"]:
        for mark in one["marks"]:
            causes.append(mark["error"])
            if mark["error"] is not None:
                after = (mark["time_ns"] - one["start_ns"]) / 1e9
                after -= one["errors"][mark["error"]]["begin_s"]
                end = truth["settings"]["seconds"] - one["errors"][mark["error"]]["begin_s"]
                assert 0.5 <= after <= 3.0 or after == pytest.approx(end - 0.01, abs=1e-6)
    assert any(cause is not None for cause in causes)


def test_a_mission_has_the_names_and_values_of_its_robot(fleet):
    out, truth = fleet
    one = next(one for one in truth["missions"] if one["wrong"] is not None)
    folder, robot, wrong = out / one["folder"], one["robot"], one["wrong"]
    values = yaml.safe_load((folder / "params.yaml").read_text())[robot]
    *above, last = wrong["parameter"].strip("/").split("/")
    for part in above:
        values = values[part]
    assert values[last] == wrong["value"]
    recording = read(folder)
    static = StaticInfo.load(folder / "static.json")
    named = with_full_names(static, recording, {})
    assert recording.nodes_of[wrong["keys"][0]] == {wrong["node"]}
    limits = {one.source for one in named.comparisons.values() if "max_speed" in (one.source or "")}
    assert limits == {"limits/max_speed"}
    assert set(recording.events.keys) <= set(static.comparisons)
    origin = read_origins(folder)[f"/{robot}{wrong['parameter']}"]
    assert origin.value == wrong["value"] and origin.words().endswith(
        f"release.yaml:{origin.lineno}"
    )


def test_robots_differ_in_their_own_values_alone(fleet):
    """A third of the parameters each, the far ones of the outlier too."""
    _, truth = fleet
    world = World(SMALL)
    parameters = {parameter_of(number) for number, _ in enumerate(DECISIONS)}
    for robot in range(3):
        own = truth["own_values"][world.robot_name(robot)]
        assert 0.15 * len(parameters) < len(own) < 0.6 * len(parameters)
        for number in range(robot, 12, 3):
            plan = world.plan(number)
            for parameter, given in plan.values.items():
                usual = next(
                    one.value_at(one.level) if one.relation != "flag" else True
                    for n, one in enumerate(DECISIONS)
                    if parameter_of(n) == parameter
                )
                if plan.wrong is not None and parameter == parameter_of(plan.wrong.decision):
                    assert given.value == plan.wrong.value
                elif parameter != plan.decoy:
                    assert given.value == own.get(parameter, usual)
    assert world.robot_name(world.outlier) == truth["outlier"]["robot"]
    far = truth["outlier"]["parameters"]
    assert len(far) == 3 and all(one["value"] != one["usual"] for one in far)


def test_a_margin_that_drifts_becomes_smaller_every_day_and_stays_above_zero(fleet):
    _, truth = fleet
    world = World(SMALL)
    drift = truth["drifts"][0]
    number = world.drifts[0].decision
    margins = defaultdict(list)
    for mission in range(12):
        plan = world.plan(mission)
        if plan.decoy == parameter_of(number):
            continue
        flown = world.fly(plan)
        level = DECISIONS[number].level_of(float(plan.values[parameter_of(number)].value))
        z = flown.processes.z[:, number]
        assert (z < level).all()
        margins[plan.robot].append((plan.day, float(np.median(level - z))))
    unit = DECISIONS[number].spread / DECISIONS[number].scale
    for days in margins.values():
        day, margin = np.array(days).T
        slope = np.polyfit(day, margin * unit, 1)[0]
        # 3.2 steps in three days; a mission's median wanders by less than half a step.
        assert slope == pytest.approx(drift["margin_per_day"], rel=0.5)


def test_an_older_build_has_other_keys_that_can_be_told(fleet):
    out, truth = fleet
    older = [one for one in truth["missions"] if one["older_build"]]
    assert {one["robot"] for one in older} == {truth["older_build"]} and len(older) == 1
    there = StaticInfo.load(out / older[0]["folder"] / "static.json")
    here = Build().static_info()
    assert not set(there.comparisons) & set(here.comparisons)
    renamed = keys_in(here, there)
    assert set(renamed) == set(there.comparisons)
    for old, new in renamed.items():
        assert there.comparisons[old].source_code == here.comparisons[new].source_code
    assert set(read(out / older[0]["folder"]).events.keys) <= set(there.comparisons)


def test_the_clock_of_one_robot_is_off(fleet):
    out, truth = fleet
    world = World(SMALL)
    for number in (0, 1, 2):
        plan = world.plan(number)
        recording = read(out / mission_folder(world, number))
        assert recording.start_ns == plan.start_ns
        off_h = (plan.true_ns - plan.start_ns) / 1e9 / 3600
        # 41 days and 3 hours.
        assert off_h == (987 if world.robot_name(plan.robot) == truth["clock_off"] else 0)


def test_many_missions_of_a_day_have_their_own_names_and_times():
    # 167 missions a day and robot, in 14 hours: one each 5 minutes.
    world = World(WorldSettings(missions=10_020))
    plans = [world.plan(number) for number in range(0, 10_020, 6)]
    assert len({plan.name for plan in plans}) == 1670
    assert [plan.day for plan in plans] == [turn // 167 for turn in range(1670)]
    starts = [plan.true_ns for plan in plans]
    assert starts == sorted(starts) and min(np.diff(starts)) > 200 * SECOND
    assert plans[167].name.endswith("-2026-03-03-1") and plans[166].name.endswith("-167")


def test_rank_has_the_wrong_parameter_among_the_first(tmp_path):
    truth = generate(WorldSettings(), tmp_path, [1])
    (one,) = truth["missions"]
    ran = CliRunner().invoke(rank_command, [str(tmp_path / one["folder"]), "--json"])
    assert ran.exit_code == 0, ran.output
    diagnosis = json.loads(ran.stdout)[0]["diagnosis"]
    first = [suspect["parameter"] for suspect in diagnosis["suspects"][:3]]
    assert f"~{one['wrong']['parameter'].rpartition('/')[2]}" in first


# --- the command


def test_the_command_writes_batches_of_one_fleet(tmp_path):
    def run(*words: str):
        options = ["--missions", "4", "--robots", "2", "--reports", "60000", "--jobs", "1"]
        return CliRunner().invoke(study_group, ["fleet-world", str(tmp_path), *options, *words])

    made = run("--count", "1", "--json")
    assert made.exit_code == 0 and len(json.loads(made.stdout)["missions"]) == 1
    made = run("--first", "1")
    assert made.exit_code == 0 and made.stdout.startswith("4 missions of 2 robots, ")
    assert [path.name for path in sorted(tmp_path.glob("r*/*"))] == [
        "r1-2026-03-02-1",
        "r1-2026-03-03-1",
        "r2-2026-03-02-1",
        "r2-2026-03-03-1",
    ]
    again = run("--first", "1")
    assert "is there already" in str(again.exception)
    other = run("--seed", "2")
    assert "is of another fleet" in str(other.exception)
    assert run("--first", "4").exit_code == 2
