"""Flights of a study: what is flown again, what is tried once more, and what a kill leaves."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner
from mission_samples import comparison, static_info
from study_flights import FakeFlier, made, robot

from pytpc.cli.main import main
from pytpc.ros.mission_run import Progress
from pytpc.workspace.colcon import BuildError
from pytpc_evaluation.commands import study_commands
from pytpc_evaluation.commands.study_progress import StudyProgress, result_line
from pytpc_evaluation.study import flying
from pytpc_evaluation.study.dataset import StudyFile, load_causes, load_done, save_done
from pytpc_evaluation.study.plan import Flight, flights_of
from pytpc_evaluation.study.resume import alone_in, end_leftovers
from pytpc_evaluation.study.run import Result, Runner
from pytpc_evaluation.study.system import BuiltSystem


@pytest.fixture
def example(tmp_path, monkeypatch):
    return robot(tmp_path, monkeypatch, "type1_b", "type2_b", "fault_x")


def missions(example) -> list[Flight]:
    return flights_of(example)


# --- one after the other


def flown(flier: FakeFlier, flights: list[Flight], jobs: int = 1) -> dict[str, Result]:
    runner = Runner(lambda _: flier, jobs=jobs)
    kept, rest = runner.kept(flights)
    return {one.flight.label: one for one in [*kept, *runner.run(rest)]}


@pytest.mark.parametrize("jobs", [1, 3])
def test_each_flight_is_flown_once_and_kept_the_next_time(example, tmp_path, jobs):
    flights = missions(example)
    first, again = FakeFlier(tmp_path / "out"), FakeFlier(tmp_path / "out")
    results = flown(first, flights, jobs)
    assert sorted(first.flown) == sorted(one.label for one in flights) == sorted(results)
    assert not any(one.kept or one.error for one in results.values())
    results = flown(again, flights, jobs)
    assert again.flown == []
    assert all(one.kept and one.done == made() for one in results.values())


def test_what_was_flown_with_other_inputs_is_flown_again(example, tmp_path):
    flights = missions(example)
    flown(FakeFlier(tmp_path), flights)
    other = FakeFlier(tmp_path, digest="2")
    assert not any(one.kept for one in flown(other, flights).values())
    assert len(other.flown) == len(flights)


def test_a_run_that_stops_in_the_middle_loses_the_flight_under_way_alone(example, tmp_path):
    flights = missions(example)

    class Power(FakeFlier):
        def fly(self, flight, on_progress=None):
            if len(self.flown) == 2:
                raise KeyboardInterrupt
            return super().fly(flight, on_progress)

    with pytest.raises(KeyboardInterrupt):
        flown(Power(tmp_path), flights)
    rest = FakeFlier(tmp_path)
    flown(rest, flights)
    assert rest.flown == [one.label for one in flights[2:]]


def test_a_flight_that_fails_is_tried_once_more(example, tmp_path):
    flights = missions(example)
    once, twice = flights[1].label, flights[2].label
    flier = FakeFlier(tmp_path, {once: 1, twice: 2})
    results = flown(flier, flights)
    assert flier.flown.count(once) == flier.flown.count(twice) == 2
    assert results[once].done == made()
    assert "pump died" in results[once].retried
    assert "at the second try, the first one failed: " in result_line(results[once])
    # What fails twice is said in a line, and the others go on.
    assert results[twice].done is None
    assert "FAILED" in result_line(results[twice])
    assert "\n" not in result_line(results[twice])
    assert sum(one.done is not None for one in results.values()) == len(flights) - 1


def test_who_leaves_a_run_ends_the_flights_under_way(example, tmp_path):
    ended = []

    class Slow(FakeFlier):
        def fly(self, flight, on_progress=None):
            try:
                while True:
                    time.sleep(0.01)
                    on_progress(Progress(1.0, 0.1, 0, 0))
            finally:
                ended.append(flight.label)

    class Quick(FakeFlier):
        pass

    flights = missions(example)[:3]
    slow, quick = Slow(tmp_path), Quick(tmp_path)
    runner = Runner(lambda one: quick if one is flights[0] else slow, jobs=2)
    for result in runner.run(flights):
        assert result.flight is flights[0]
        break
    # Of the two that had not been begun or were under way none goes on.
    assert set(ended) <= {flights[1].label, flights[2].label}
    assert quick.flown == [flights[0].label]


# --- study.json


def test_study_json_tells_of_all_missions_what_they_are_and_how_far(example, tmp_path):
    flights = missions(example)
    done, failed = flights[1], flights[2]
    save_done(made(remarks=("it leaks",)), done.folder(tmp_path))
    file = StudyFile(tmp_path, {"python": "3.11"}, {failed.label: "pump died"})
    file.save([example])
    document = json.loads((tmp_path / "study.json").read_text())
    assert document["seeds"] == [1, 2]
    assert document["systems"] == [{"name": "robot", "title": "Robot", "rate": 12.0}]
    by_folder = {one["folder"]: one for one in document["missions"]}
    assert list(by_folder) == [one.label for one in flights]
    assert {name: one["state"] for name, one in by_folder.items()} == {
        **dict.fromkeys(by_folder, "planned"),
        done.label: "done",
        failed.label: "failed",
    }
    assert by_folder[done.label]["remarks"] == ["it leaks"]
    assert by_folder[failed.label]["error"] == "pump died"
    treated = by_folder["missions/robot/type1_b/seed-2"]
    assert (treated["parameter"], treated["old"], treated["new"]) == ("~b", 2.0, 0.5)
    # What failed before and was not flown since has still failed.
    assert StudyFile.of(tmp_path, {}).errors == {failed.label: "pump died"}


@pytest.mark.parametrize("text", ["", "[]", '{"schema": 1}', '{"schema": 2, "flight": "1"}'])
def test_a_broken_done_json_is_none(tmp_path, text):
    (tmp_path / "done.json").write_text(text)
    assert load_done(tmp_path) is None


def test_done_json_is_read_as_it_was_written(tmp_path):
    save_done(made(remarks=("a", "b")), tmp_path)
    assert load_done(tmp_path) == made(remarks=("a", "b"))


@pytest.mark.parametrize(
    ("document", "what"),
    [
        ({"causes": []}, "a list is expected"),
        ([{"kind": "III", "start": 1, "end": 1, "reason": "x"}], "kind 'III'"),
        ([{"kind": "I", "start": 1, "end": 1}], "reason"),
        ([{"kind": "I", "start": "early", "end": 1, "reason": "x"}], "early"),
    ],
)
def test_wrong_causes_are_an_error(tmp_path, document, what):
    path = tmp_path / "causes.json"
    path.write_text(json.dumps(document))
    with pytest.raises(Exception, match=what) as caught:
        load_causes(path)
    assert str(caught.value).startswith(f"{path}: not the causes of a mission")


# --- one run at a time, and what a killed one leaves


def test_two_runs_do_not_share_a_folder(tmp_path):
    with alone_in(tmp_path):
        code = (
            "import sys; from pathlib import Path\n"
            "from pytpc_evaluation.study.resume import alone_in\n"
            "from pytpc.base.errors import TpcError\n"
            "try:\n    with alone_in(Path(sys.argv[1])): print('in')\n"
            "except TpcError as error: print(error)\n"
        )
        ran = subprocess.run(
            [sys.executable, "-c", code, tmp_path], capture_output=True, text=True, check=True
        )
        assert ran.stdout == f"{tmp_path}: another run is at work in this folder\n"


def test_what_a_killed_run_left_is_ended_and_nothing_else(tmp_path):
    def sleeper(home: Path) -> subprocess.Popen[bytes]:
        env = {**os.environ, "ROS_HOME": str(home)}
        return subprocess.Popen(["sleep", "600"], env=env, start_new_session=True)

    mine = sleeper(tmp_path / "study" / "missions" / "robot" / "ros" / "home")
    other = sleeper(tmp_path / "study-2" / "missions" / "robot" / "ros" / "home")
    try:
        # The environment is the child's own only when the program runs.
        until = time.monotonic() + 20.0
        while time.monotonic() < until and not end_leftovers(tmp_path / "study"):
            time.sleep(0.05)
        assert mine.wait(10.0) == -signal.SIGTERM
        assert other.poll() is None
    finally:
        for process in (mine, other):
            process.kill()
            process.wait()


# --- the command


@pytest.fixture
def fleet(example, tmp_path, monkeypatch) -> FakeFlier:
    """The command flies the little robot, and only seems to."""
    for module in (flying, study_commands):
        monkeypatch.setattr(module, "EXAMPLES", (example,))
    save = StudyFile.save
    monkeypatch.setattr(StudyFile, "save", lambda self: save(self, (example,)))
    static = static_info(comparison(1, "~a"))
    system = BuiltSystem(example, static, {}, {}, "build")
    monkeypatch.setattr(flying, "prepare", lambda *_: (system, True))
    found = FakeFlier(tmp_path / "out")
    monkeypatch.setattr(flying, "Flier", lambda *_: found)
    return found


def run(*words: str):
    return CliRunner().invoke(main, ["study", *words])


def test_run_flies_all_and_says_so(fleet):
    result = run("run", "--out", str(fleet.out))
    assert result.exit_code == 0
    said = "13 missions: 13 flown, 0 of an earlier run, 0 failed; 0 did not go as demanded"
    assert result.stdout.splitlines() == [f"{said}: {fleet.out}"]
    assert "reference/robot: 60 s simulated in 0 s, 100 reports, 0 errors seen" in result.stderr
    result = run("run", "--out", str(fleet.out), "--json")
    assert {one["kept"] for one in json.loads(result.stdout)} == {True}


def test_run_ends_with_status_1_where_a_mission_failed(fleet):
    label = "missions/robot/clean/seed-1"
    fleet.failures[label] = 2
    result = run("run", "--out", str(fleet.out))
    assert result.exit_code == 1
    assert "12 flown, 0 of an earlier run, 1 failed" in result.stdout
    assert result.stderr.splitlines()[-1].startswith("pytpc: error: 1 mission failed, the first: ")
    assert json.loads((fleet.out / "study.json").read_text())["missions"][5]["state"] == "failed"
    # The next run tries it again, and forgets.
    assert run("run", "--out", str(fleet.out)).exit_code == 0
    assert StudyFile.of(fleet.out, {}).errors == {}


def test_run_shows_what_went_against_the_demand(fleet):
    save = fleet.fly
    remarks = ("no error was seen, and one of type I is demanded",)

    def fly_badly(flight, on_progress=None):
        done = replace(save(flight, on_progress), remarks=remarks)
        save_done(done, flight.folder(fleet.out))
        return done

    fleet.fly = fly_badly
    result = run("run", "--out", str(fleet.out), "--treatment", "type1_b", "--seed", "2")
    assert result.exit_code == 0
    assert "missions/robot/type1_b/seed-2" in result.stdout
    assert remarks[0] in result.stdout
    assert "2 did not go as demanded" in result.stdout


def test_a_broken_treatment_is_one_line_before_anything_is_flown(fleet, example):
    path = example.folder / "treatments" / "type1_b" / "treatment.json"
    path.write_text("{")
    result = run("run", "--out", str(fleet.out))
    assert (result.exit_code, fleet.flown) == (1, [])
    assert result.stderr.startswith(f"pytpc: error: {path}:1: not JSON")


def test_a_build_that_fails_shows_the_end_of_what_it_said(fleet, monkeypatch):
    def fails(*_: object) -> None:
        raise BuildError("does not build", Path("ws"), "robot", ["node.cpp:3: no such thing"])

    monkeypatch.setattr(flying, "prepare", fails)
    result = run("run", "--out", str(fleet.out))
    assert result.exit_code == 1
    assert result.stderr.splitlines() == [
        "node.cpp:3: no such thing",
        "pytpc: error: ws: does not build",
    ]


def test_halves_are_listed(fleet):
    result = run("halves", "--json")
    rows = json.loads(result.stdout)
    assert len(rows) == 8
    assert rows[0] == {
        "system": "robot",
        "treatment": "clean",
        "type": "clean",
        "seed": 1,
        "half": "tuning",
    }
    assert "held-back" in run("halves").stdout


def test_progress_without_a_terminal_is_a_line_now_and_then(example, capsys, monkeypatch):
    monkeypatch.setattr("pytpc_evaluation.commands.study_progress._SILENT_S", 0.0)
    with StudyProgress("study") as progress:
        progress.building(example, " [ 50%] Building\n")
        progress.starts(1)
        progress.flying(missions(example)[-1], Progress(3.0, 1.0, 0, 0))
        progress.ended(Result(missions(example)[-1], made(), kept=True))
    assert capsys.readouterr().err.splitlines() == [
        "building robot: [ 50%] Building",
        "robot/type2_b/seed-2: 3 s simulated",
    ]
