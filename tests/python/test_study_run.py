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

from pytpc import demo_examples
from pytpc.cli import study_commands
from pytpc.cli.main import main
from pytpc.cli.study_progress import StudyProgress, result_line
from pytpc.errors import RunError
from pytpc.ingest.recording import Recording, load_recording
from pytpc.marks import Mark
from pytpc.mission import MissionRun, Progress
from pytpc.study import digest, fly, flying, people
from pytpc.study.changes import Candidate
from pytpc.study.dataset import Cause, StudyFile, load_causes, load_done, save_done
from pytpc.study.fly import Flier, remarks_of
from pytpc.study.plan import Flight, flights_of
from pytpc.study.resume import alone_in, end_leftovers
from pytpc.study.run import Result, Runner
from pytpc.study.system import System

AMONG = (Candidate("/pump", "a", 1.0), Candidate("/pump", "c", 0.004))


@pytest.fixture
def example(tmp_path, monkeypatch):
    return robot(tmp_path, monkeypatch, "type1_b", "type2_b", "fault_x")


def missions(example) -> list[Flight]:
    return flights_of(example, AMONG)


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


# --- how a mission went against what its treatment demands

LEAKS, STANDS = Cause("I", 20.0, 20.0, "it leaks"), Cause("II", 12.5, 40.0, "it stands there")


@pytest.mark.parametrize(
    ("name", "causes", "reached", "expected"),
    [
        ("clean", [], True, []),
        ("clean", [], False, ["the vial was not filled"]),
        ("clean", [LEAKS], True, ["an error was seen where there is none: it leaks (20.0 s)"]),
        ("type1_b", [LEAKS], True, []),
        ("type1_b", [], True, ["no error was seen, and one of type I is demanded"]),
        # The first one in time counts, wherever it stands.
        (
            "type1_b",
            [LEAKS, STANDS],
            False,
            ["the first error that was seen is of type II, not I: it stands there (12.5 s)"],
        ),
        ("type2_b", [LEAKS, STANDS], False, []),
        ("type2_b", [STANDS], True, ["the vial was filled"]),
        ("fault_x", [STANDS, LEAKS], True, []),
    ],
)
def test_what_goes_against_the_demand_is_said(example, name, causes, reached, expected):
    flight = Flight("mission", example, example.treatment(name), 1, "tuning")
    assert remarks_of(flight, causes, reached=reached) == tuple(expected)
    assert remarks_of(replace(flight, kind="suggested"), causes, reached=reached) == ()


# --- the flight itself, on no graph


@pytest.fixture
def flier(example, tmp_path, monkeypatch) -> Flier:
    """Its missions fly in no time; its observer sees a leak, and one person marks it."""
    calls: list[dict[str, str]] = []

    def run_mission(env, launch, args, folder, timeout_s, **_):
        assert env["TPC_SINK"] == "file"
        calls.append(dict(args))
        (folder / "mission.bag").write_bytes(b"#ROSBAG")
        (folder / "tpc").mkdir()
        ended = "timeout" if example_ends["late"] else "done"
        params = folder / "params.yaml"
        params.write_text("pump: {b: 0.5}\n")
        messages = {"/truth/full": 1}
        return MissionRun(folder / "mission.bag", params, ended, 60.0, 5.0, 0, messages, {}, {})

    def mark(example, env, folder, seed):
        seen.append(seed)
        causes = [{"kind": "I", "start": 20.0, "end": 20.0, "reason": "it leaks"}]
        (folder / "causes.json").write_text(json.dumps(causes))
        (folder / "marks.parquet").write_bytes(b"")

    seen: list[int] = []
    example_ends = {"late": False}
    events = load_recording(demo_examples.SHARED_PACKAGE.parent / "recorded_mission").events
    monkeypatch.setattr(fly, "run_mission", run_mission)
    monkeypatch.setattr(fly, "see", lambda *words: (words[-1] / "sights.parquet").write_bytes(b""))
    monkeypatch.setattr(fly, "mark", mark)
    monkeypatch.setattr(fly, "read_marked", lambda _: (Mark(22 * 10**9, "I", "user1"),))
    monkeypatch.setattr(fly, "read", lambda folder: Recording("seed-1", events, (), 0, 60 * 10**9))
    static = static_info(comparison(1, "~a"), comparison(2, "~b"))
    system = System(example, static, {"TPC_SINK": "file"}, {}, "build 1")
    found = Flier(system, tmp_path / "out", 12.0, "people 1")
    object.__setattr__(found, "calls", calls)
    object.__setattr__(found, "seen", seen)
    object.__setattr__(found, "ends", example_ends)
    return found


def treated(example, seed: int = 1) -> Flight:
    (found,) = [
        one
        for one in missions(example)
        if one.treatment.name == "type1_b" and one.seed == seed and one.kind == "mission"
    ]
    return found


def test_a_mission_leaves_what_its_readers_need_and_no_more(flier, example):
    flight = treated(example)
    done = flier.fly(flight)
    folder = flight.folder(flier.out)
    assert sorted(path.name for path in folder.iterdir()) == [
        "causes.json",
        "changes.json",
        "decoys.yaml",
        "done.json",
        "events.parquet",
        "marks.json",
        "marks.parquet",
        "params.yaml",
        "sights.parquet",
        "treatment.json",
    ]
    assert load_recording(folder).marks == (Mark(22 * 10**9, "I", "user1"),)
    assert (done.causes, done.marks, done.reached, done.remarks) == (1, 1, True, ())
    (args,) = flier.calls
    assert args == {
        "rate": "12",
        "seed": "1",
        "treatment": str(example.folder / "treatments/type1_b/params.yaml"),
        "overlay2": str(folder / "decoys.yaml"),
        "observer": "false",
    }
    assert flier.kept(flight) == done


def test_a_reference_has_no_second_file_of_parameters(flier, example):
    flier.fly(missions(example)[0])
    assert "overlay2" not in flier.calls[0]


def test_inputs_that_are_others_make_another_digest(flier, example):
    flight = treated(example)
    before = flier.digests(flight)
    people_alone = replace(flier, people="people 2").digests(flight)
    assert people_alone[0] == before[0]
    assert people_alone[1] != before[1]
    overlay = flight.treatment.overlay
    others = [
        replace(flier, rate=24.0).digests(flight),
        replace(flier, system=replace(flier.system, digest="build 2")).digests(flight),
        flier.digests(treated(example, seed=2)),
        flier.digests(replace(flight, changes=())),
        flier.digests(replace(flight, treatment=replace(flight.treatment, launch={"fault": "x"}))),
    ]
    overlay.write_text("pump: {b: 0.6}\n")
    others.append(flier.digests(flight))
    assert len({before[0], *(one[0] for one in others)}) == 7


def test_what_a_treatment_says_of_itself_may_change(flier, example):
    flight = treated(example)
    flier.fly(flight)
    path = flight.treatment.overlay.with_name("treatment.json")
    path.write_text(json.dumps({**json.loads(path.read_text()), "effect": "It drips."}))
    again = replace(flight, treatment=example.treatment("type1_b"))
    assert flier.kept(again) is not None
    copy = json.loads((flight.folder(flier.out) / "treatment.json").read_text())
    assert copy["effect"] == "It drips."


def test_other_people_look_at_the_same_flight(flier, example):
    flight = treated(example)
    flier.fly(flight)
    others = replace(flier, people="people 2")
    assert others.kept(flight) is None
    done = others.fly(flight)
    assert len(flier.calls) == 1
    assert flier.seen == [flight.people] * 2
    assert others.kept(flight) == done


@pytest.mark.parametrize("name", ["events.parquet", "causes.json", "sights.parquet"])
def test_a_mission_that_lost_a_file_is_flown_again(flier, example, name):
    flight = treated(example)
    flier.fly(flight)
    (flight.folder(flier.out) / name).unlink()
    assert flier.kept(flight) is None
    flier.fly(flight)
    assert flier.kept(flight) is not None
    # What people make of a flight is made again from what they saw.
    assert len(flier.calls) == (1 if name == "causes.json" else 2)


def test_a_mission_that_does_not_end_is_not_done(flier, example):
    flight = treated(example)
    flier.fly(flight)
    flier.ends["late"] = True
    with pytest.raises(RunError, match=r"seed-1: the mission was not over after 5 s"):
        replace(flier, rate=24.0).fly(flight)
    # Nor is what was there before.
    assert load_done(flight.folder(flier.out)) is None


def test_the_sources_digest_knows_what_the_robot_is_built_from(example):
    before = digest.sources_digest(example)
    for name in ("README.md", "study.json", "treatments/clean/params.yaml", "demo.py"):
        (example.folder / name).write_text("other")
        assert digest.sources_digest(example) == before
    (example.folder / "src" / "node.cpp").write_text("int main() { return 1; }\n")
    assert digest.sources_digest(example) != before


# --- the observer's own program


def test_an_observer_that_fails_says_why_in_a_line(example, tmp_path):
    script = example.observer
    script.parent.mkdir()
    script.write_text("import sys\nsys.exit('first\\nno such\\nbag')\n")
    with pytest.raises(RunError, match=r"observer\.py: ended with status 1: bag"):
        people.see(example, {}, Path("mission.bag"), tmp_path)


def test_the_observer_sees_the_shared_package_before_all_others(example, tmp_path):
    script = example.observer
    script.parent.mkdir()
    script.write_text(
        "import os, sys, pathlib, simulated_world\n"
        "words = [os.environ['PYTHONPATH'], *sys.argv[1:]]\n"
        f"pathlib.Path({str(tmp_path / 'said')!r}).write_text('\\n'.join(words))\n"
    )
    people.mark(example, {"PYTHONPATH": "/a:/b"}, Path("/m"), 7)
    path, *words = (tmp_path / "said").read_text().splitlines()
    assert path == f"{demo_examples.SHARED_PACKAGE}/src:/a:/b"
    assert words == [
        *("--sights", "/m/sights.parquet", "--seed", "7", "--users", "4"),
        *("--causes", "/m/causes.json", "--marks", "/m/marks.parquet"),
    ]


# --- one run at a time, and what a killed one leaves


def test_two_runs_do_not_share_a_folder(tmp_path):
    with alone_in(tmp_path):
        code = (
            "import sys; from pathlib import Path; from pytpc.study.resume import alone_in\n"
            "from pytpc.errors import TpcError\n"
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
    system = System(example, static, {}, {}, "build")
    monkeypatch.setattr(flying, "prepare", lambda *_: (system, True))
    found = FakeFlier(tmp_path / "out")
    monkeypatch.setattr(flying, "Flier", lambda *_: found)
    return found


def run(*words: str):
    return CliRunner().invoke(main, ["study", *words])


def test_run_flies_all_and_says_so(fleet):
    result = run("run", "--out", str(fleet.out))
    assert result.exit_code == 0
    assert result.stdout.splitlines() == [
        f"9 missions: 9 flown, 0 of an earlier run, 0 failed; 0 did not go as demanded: {fleet.out}"
    ]
    assert "reference/robot: 60 s simulated in 0 s, 100 reports, 0 errors seen" in result.stderr
    result = run("run", "--out", str(fleet.out), "--json")
    assert {one["kept"] for one in json.loads(result.stdout)} == {True}


def test_run_ends_with_status_1_where_a_mission_failed(fleet):
    label = "missions/robot/clean/seed-1"
    fleet.failures[label] = 2
    result = run("run", "--out", str(fleet.out))
    assert result.exit_code == 1
    assert "8 flown, 0 of an earlier run, 1 failed" in result.stdout
    assert result.stderr.splitlines()[-1].startswith("pytpc: error: 1 mission failed, the first: ")
    assert json.loads((fleet.out / "study.json").read_text())["missions"][1]["state"] == "failed"
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
    monkeypatch.setattr("pytpc.cli.study_progress._SILENT_S", 0.0)
    with StudyProgress("study") as progress:
        progress.building(example, " [ 50%] Building\n")
        progress.starts(1)
        progress.flying(treated(example), Progress(3.0, 1.0, 0, 0))
        progress.ended(Result(treated(example), made(), kept=True))
    assert capsys.readouterr().err.splitlines() == [
        "building robot: [ 50%] Building",
        "robot/type1_b/seed-1: 3 s simulated",
    ]
