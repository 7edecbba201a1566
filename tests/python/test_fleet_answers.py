"""What ``pytpc fleet`` answers about a made-up fleet of which everything is known."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner, Result
from fleet_samples import Flight, digest

from pytpc.api.dask_engine import Engine, engine
from pytpc.api.fleet_asking import newest_build, rank
from pytpc.api.fleet_judging import spread
from pytpc.api.fleet_missions import FleetMission, missions, once_each
from pytpc.base.errors import InputError
from pytpc.cli.main import main
from pytpc.fleet.data_set import Fleet, Place
from pytpc.fleet.tables import COMPARISONS, MISSIONS
from pytpc_evaluation.fleet.generating import generate
from pytpc_evaluation.fleet.world import WorldSettings

pytestmark = pytest.mark.filterwarnings("ignore")
WORLD = WorldSettings(robots=4, missions=32, days=5, reports=60_000)


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, dict[str, Any]]:
    """A data set of 32 missions of four robots, one of an older build; and the truth."""
    out = tmp_path_factory.mktemp("world")
    truth = generate(WORLD, out / "recorded")
    call("add", out / "fleet", out / "recorded")
    return str(out / "fleet"), truth


def run(*words: object) -> Result:
    return CliRunner().invoke(main, ["fleet", *map(str, words)])


def call(*words: object) -> str:
    """Standard output of a command that must do well."""
    done = run(*words)
    assert done.exit_code == 0, done.output
    return done.stdout


def answer(*words: object) -> Any:
    return json.loads(call(*words, "--json"))


def bare(name: str) -> str:
    return name.rpartition("/")[2].lstrip("~")


def test_the_wrong_parameters_are_first(world):
    fleet, truth = world
    found = answer("rank", fleet)
    wrong = {bare(one["parameter"]) for one in truth["culprits"]}
    assert bare(found["suspects"][0]["parameter"]) in wrong
    assert found["suspects"][0]["mean_position"] >= 1
    assert found["bad"] == sum(one["wrong"] is not None for one in truth["missions"]) or (
        found["bad"] <= sum(bool(one["marks"]) for one in truth["missions"])
    )


def test_one_wrong_parameter_alone(world):
    fleet, truth = world
    culprit = truth["culprits"][0]
    named = {
        one["name"]: one["wrong"] and bare(one["wrong"]["parameter"]) for one in truth["missions"]
    }
    with engine(workers=2) as own:
        known = missions(Fleet(fleet), own).found
    others = [one for one in known if named[one.name] not in (None, bare(culprit["parameter"]))]
    for one in others:
        call("drop", fleet, one.place.mission, "--yes")
    found = answer("rank", fleet)
    assert bare(found["suspects"][0]["parameter"]) == bare(culprit["parameter"])


def test_threads_and_processes_say_the_same(world):
    fleet, _ = world
    answers = []
    for cluster in (None, "local"):
        with engine(cluster, 2) as own:
            answers.append(rank(Fleet(fleet), own))
    assert answers[0] == answers[1]


class Deadly(Engine):
    """Threads as a cluster whose workers die at the first item that can be done without."""

    def map(self, task, items, on_progress=None, lost=None):
        if lost is None or not items:
            return super().map(task, items, on_progress)
        return [lost(items[0]), *super().map(task, items[1:], on_progress)]


def test_a_bad_mission_that_does_not_fit_into_memory(world):
    fleet, _ = world
    with engine(workers=2) as own:
        whole = rank(Fleet(fleet), own)
    found = rank(Fleet(fleet), Deadly(2))
    (lost,) = found.unread
    assert lost.why.startswith("worker processes died while they read it")
    assert found.answer.bad == whole.answer.bad
    assert found.answer.suspects[0].parameter == whole.answer.suspects[0].parameter


@pytest.mark.parametrize("question", ["rank", "drift", "outliers", "find"])
def test_tables_pages_and_parquet(world, question: str, tmp_path: Path):
    fleet, truth = world
    parameter = [bare(truth["culprits"][0]["parameter"])] if question == "find" else []
    words = [question, fleet, *parameter]
    assert call(*words).strip()
    table, page = tmp_path / "t.parquet", tmp_path / "p.html"
    assert call(*words, "--parquet", table, "--page", page) == ""
    assert pq.read_table(table).num_columns > 3
    assert page.read_text(encoding="utf-8").lstrip().lower().startswith("<!doctype html>")


def test_the_robot_that_differs(world):
    fleet, truth = world
    found = answer("outliers", fleet)
    settings = {(one["robot"], bare(one["parameter"])) for one in found["settings"]}
    own = truth["outlier"]
    assert {(own["robot"], bare(one["parameter"])) for one in own["parameters"]} <= settings


# The unit of the margins is that of the parameter.
def test_turns_are_found_within_a_margin(world):
    fleet, truth = world
    parameter = bare(truth["culprits"][0]["parameter"])
    every = answer("find", fleet, parameter)
    near = answer("find", fleet, parameter, "--margin", "1e-3")
    assert len(every) > 0
    assert sum(len(one["turned"]) for one in near) < sum(len(one["turned"]) for one in every)
    assert all(turn["margin"] <= 1e-3 for one in near for turn in one["turned"])
    done = run("find", fleet, "no_such_parameter")
    assert done.exit_code == 1
    assert "no_such_parameter" in done.stderr


def test_good_missions_are_learned(world, tmp_path: Path):
    fleet, _ = world
    assert call("learn", fleet, "-o", tmp_path / "good", "--most", "4").startswith("learned 4 good")
    bad = next(one for one in answer("list", fleet, "--verdict", "bad") if one["marks"])
    call("show", fleet, bad["mission"], "-o", tmp_path / "bad")
    words = ["rank", str(tmp_path / "bad"), "--reference", str(tmp_path / "good"), "--json"]
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 0, done.output


def test_without_a_bad_mission(world):
    fleet, _ = world
    done = run("rank", fleet, "--since", "2999-01-01")
    assert (done.exit_code, "no missions" in done.stderr) == (1, True)
    done = run("rank", fleet, "--since", "yesterday")
    assert (done.exit_code, "give it as 2026-11-30" in done.stderr) == (2, True)
    with pytest.raises(InputError, match="no missions"):
        newest_build(())


def stored(fleet: Fleet, number: int, verdict: str, *, is_silent: bool = False) -> None:
    """A mission without reports; p0 is 0.9 in bad ones. A silent one compared nothing."""
    flight = Flight(f"m{number}", day=1 + number, verdict=verdict)
    row = digest(flight, thresh=0.9 if verdict == "bad" else 0.5)
    of_mission = {field.name: row.get(field.name, 0) for field in MISSIONS}
    words = dict.fromkeys(("name", "source", "stamp", "build", "keep", "tpc"), "")
    of_mission |= {**words, "seconds": 60.0, "notes": [], "files": []}
    row |= {field.name: 0 for field in COMPARISONS if field.name not in row}
    rows = [] if is_silent else [row]
    fleet.write(
        Place(flight.robot, row["day"], flight.mission),
        {
            "missions": pa.Table.from_pylist([of_mission], schema=MISSIONS),
            "comparisons": pa.Table.from_pylist(rows, schema=COMPARISONS),
        },
    )


def test_missions_that_do_not_count_are_said(tmp_path: Path):
    fleet = Fleet(str(tmp_path))
    fleet.begin()
    stored(fleet, 0, "bad", is_silent=True)
    stored(fleet, 1, "good")
    with engine(workers=1) as own:
        with pytest.raises(InputError, match="1 mission without a comparison, not counted"):
            rank(fleet, own)
        stored(fleet, 2, "bad")
        found = rank(fleet, own).answer
    assert (found.bad, found.good) == (1, 1)
    assert found.notes == (
        "1 mission without a comparison, not counted (1 bad)",
        "no bad mission has marks, so that none has a diagnosis: say when it went wrong",
    )


def flown(robot: str, number: int) -> FleetMission:
    place = Place(robot, "2026-11-30", f"m{number:03}")
    return FleetMission(place, "m", "", "b", "bad", "edges", "1", number, number, 1, 1, 1, 1.0, ())


def test_a_mission_on_two_days_counts_once():
    one, other = flown("a", 1), flown("b", 1)
    again = replace(one, place=one.place._replace(day="2026-12-02"))
    found, told = once_each((again, other, one))
    assert found == (other, one)
    assert [(place, why) for place, why in told] == [
        (again.place, "is there on 2026-11-30, too, and counts only then: drop one of both")
    ]


# Of robots with 1, 9 and 90 missions, nine are 1, 4 and 4, from the middle of equal parts.
def test_missions_are_spread_over_robots_and_time():
    every = [
        flown(robot, n)
        for robot, count in zip("abc", (1, 9, 90), strict=True)
        for n in range(count)
    ]
    chosen = [(one.place.robot, one.start_ns) for one in spread(every, 9)]
    assert chosen == [
        ("a", 0), ("b", 1), ("b", 3), ("b", 5), ("b", 7), ("c", 11), ("c", 33), ("c", 56), ("c", 78)
    ]  # fmt: skip
    assert len(spread(every, 1000)) == 100
