"""One flight of the study: what it leaves, when it is made again, and what is said of it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from mission_samples import comparison, static_info
from study_flights import robot

from pytpc.base.errors import RunError
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording, load_recording
from pytpc.ros.mission_run import MissionRun
from pytpc_evaluation.demo import demo_examples
from pytpc_evaluation.study import digest, fly, people
from pytpc_evaluation.study.dataset import Cause, load_done
from pytpc_evaluation.study.fly import Flier, remarks_of
from pytpc_evaluation.study.plan import Flight, flights_of
from pytpc_evaluation.study.system import BuiltSystem


@pytest.fixture
def example(tmp_path, monkeypatch):
    return robot(tmp_path, monkeypatch, "type1_b", "type2_b", "fault_x")


def missions(example) -> list[Flight]:
    return flights_of(example)


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


class Rig:
    """Stands for the graph and for the observer: a mission in no time, a leak, and one mark."""

    def __init__(self) -> None:
        self.calls: list[dict[str, str]] = []
        self.seen: list[int] = []
        self.ended = "done"
        self.done_ns = 30 * 10**9

    def run_mission(self, env, options, **_):
        assert env["TPC_SINK"] == "file"
        self.calls.append(dict(options.args))
        folder = options.out_dir
        bag, params = folder / "mission.bag", folder / "params.yaml"
        bag.write_bytes(b"#ROSBAG")
        params.write_text("pump: {b: 0.5}\n")
        for name in ("tpc", "ros"):
            (folder / name).mkdir()
        return MissionRun(
            bag, params, self.ended, 60.0, 5.0, 0, {"/truth/full": 1}, {}, {}, self.done_ns
        )

    def see(self, example, env, bag, folder):
        assert bag.read_bytes() == b"#ROSBAG"
        pq.write_table(pa.table({"time": [1.0, 44.9, 45.0, 45.1]}), folder / "sights.parquet")

    def mark(self, example, env, folder, seed):
        self.seen.append(seed)
        causes = [{"kind": "I", "start": 20.0, "end": 20.0, "reason": "it leaks"}]
        (folder / "causes.json").write_text(json.dumps(causes))
        (folder / "marks.parquet").write_bytes(b"")


@pytest.fixture
def rig(monkeypatch) -> Rig:
    found = Rig()
    for name in ("run_mission", "see", "mark"):
        monkeypatch.setattr(fly, name, getattr(found, name))
    events = load_recording(demo_examples.SHARED_PACKAGE.parent / "recorded_mission").events
    monkeypatch.setattr(fly, "read_marked", lambda _: (Mark(22 * 10**9, "I", "user1"),))
    monkeypatch.setattr(fly, "read", lambda _: Recording("seed-1", events, (), 0, 60 * 10**9))
    return found


@pytest.fixture
def flier(example, tmp_path, rig) -> Flier:
    static = static_info(comparison(1, "~a"), comparison(2, "~b"))
    system = BuiltSystem(example, static, {"TPC_SINK": "file"}, {}, "build 1")
    return Flier(system, tmp_path / "out", 12.0, "people 1")


def treated(example, seed: int = 1) -> Flight:
    (found,) = [
        one
        for one in missions(example)
        if one.treatment.name == "type1_b" and one.seed == seed and one.kind == "mission"
    ]
    return found


def test_a_mission_leaves_what_its_readers_need_and_no_more(flier, rig, example):
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
    # How long a graph goes on after the mission's end and 15 s hangs on the machine.
    assert load_recording(folder).end_ns == 45 * 10**9
    assert load_recording(folder).events.time_ns.max() <= 45 * 10**9
    assert pq.read_table(folder / "sights.parquet")["time"].to_pylist() == [1.0, 44.9, 45.0]
    assert done.sim_s == 45.0
    assert (done.causes, done.marks, done.reached, done.remarks) == (1, 1, True, ())
    (args,) = rig.calls
    assert args == {
        "rate": "12",
        "seed": "1",
        "treatment": str(example.folder / "treatments/type1_b/params.yaml"),
        "overlay2": str(folder / "decoys.yaml"),
        "observer": "false",
    }
    assert flier.kept(flight) == done


def test_a_reference_has_no_second_file_of_parameters(flier, rig, example):
    flier.fly(missions(example)[0])
    assert "overlay2" not in rig.calls[0]


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


def test_other_people_look_at_the_same_flight(flier, rig, example):
    flight = treated(example)
    flier.fly(flight)
    others = replace(flier, people="people 2")
    assert others.kept(flight) is None
    done = others.fly(flight)
    assert len(rig.calls) == 1
    assert rig.seen == [flight.people] * 2
    assert others.kept(flight) == done


@pytest.mark.parametrize("name", ["events.parquet", "causes.json", "sights.parquet"])
def test_a_mission_that_lost_a_file_is_flown_again(flier, rig, example, name):
    flight = treated(example)
    flier.fly(flight)
    (flight.folder(flier.out) / name).unlink()
    assert flier.kept(flight) is None
    flier.fly(flight)
    assert flier.kept(flight) is not None
    # What people make of a flight is made again from what they saw.
    assert len(rig.calls) == (1 if name == "causes.json" else 2)


def test_a_file_of_causes_that_is_broken_is_made_anew_and_stops_no_run(flier, rig, example):
    flight = treated(example)
    flier.fly(flight)
    path = flight.folder(flier.out) / "causes.json"
    path.write_text("[{")
    assert flier.kept(flight) is None
    flier.fly(flight)
    assert flier.kept(flight) is not None
    assert len(rig.calls) == 1


def test_a_mission_that_does_not_end_is_not_done(flier, rig, example):
    flight = treated(example)
    flier.fly(flight)
    rig.ended = "timeout"
    with pytest.raises(RunError, match=r"seed-1: the mission was not over after 5 s"):
        replace(flier, rate=24.0).fly(flight)
    # Nor is what was there before.
    assert load_done(flight.folder(flier.out)) is None


def test_the_eyes_are_where_the_digest_looks_for_them():
    for file in digest.EYES:
        assert file.is_file()


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


def test_an_observer_that_a_signal_ends_is_an_error(example, tmp_path):
    script = example.observer
    script.parent.mkdir()
    script.write_text("import os, signal\nos.kill(os.getpid(), signal.SIGTERM)\n")
    with pytest.raises(RunError, match=r"observer\.py: ended with status -15: it says nothing"):
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


def test_the_marks_have_the_type_that_was_right_whatever_was_said(tmp_path):
    path = tmp_path / "marks.parquet"
    columns = {
        "time_ns": [9, 5],
        "observer": ["user1", "user2"],
        "cause": [0, 0],
        "right": ["II", "I"],
        "said": ["I", "II"],
    }
    pq.write_table(pa.table(columns), path)
    assert people.read_marked(path) == (Mark(5, "I", "user2"), Mark(9, "II", "user1"))
