"""The folder of a mission: what a recording writes, replaces, keeps and refuses."""

from __future__ import annotations

import json
import threading

import pytest
from click.testing import CliRunner
from mission_samples import mission_run

from pytpc.base.errors import RunError
from pytpc.cli.main import main
from pytpc.ros.mission_run import (
    RecordOptions,
    clear_earlier,
    save_run,
)
from pytpc.ros.ros1 import param_dump
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.param_dump import dump_params
from pytpc.ros.ros1.record_mission import record_graph


@pytest.mark.parametrize("ending", ["exit 1", "exec sleep 600"])
def test_half_of_the_values_is_not_left_in_the_folder(tmp_path, monkeypatch, ending):
    monkeypatch.setattr(param_dump, "_HURRIED_S", 1.0)
    program = tmp_path / "bin/rosparam"
    program.parent.mkdir()
    program.write_text(f"#!/bin/sh\necho half > $2\n{ending}\n")
    program.chmod(0o755)
    env = {"PATH": f"{program.parent}:/usr/bin:/bin"}
    with pytest.raises(RunError, match="rosparam dump"):
        dump_params(env, tmp_path / "params.yaml", lambda: True)
    assert list(tmp_path.iterdir()) == [program.parent]


def test_run_json_says_how_it_went(tmp_path):
    run = mission_run(tmp_path)
    save_run(run, RecordOptions(tmp_path, tmp_path / "a.launch", {"seed": "1"}))
    document = json.loads((tmp_path / "run.json").read_text())
    assert document["args"] == {"seed": "1"}
    assert document["bag"] == "mission.bag"
    assert (document["ended"], document["reports"]) == ("done", 10)
    assert document["messages"]["/mark_action"] == 2


# What is left of it would be ranked as if it were of the next mission. Marks of a bag that stays,
# stay with it; those of the second mission do not replace those of the first.
def test_an_earlier_mission_is_cleared_and_its_marks_are_kept(tmp_path):
    folder = tmp_path / "today"
    (folder / "tpc").mkdir(parents=True)
    text = "time_ns,type,observer,note\n1,I\n"
    marks = ["mission.bag", "today", "tpc/uav-1-1.tpc"]
    stay = ["notes.md", "grades.csv", "other.bag", "other.bag.marks.csv"]
    names = ["mission.bag", "run.json", "events.parquet", "marks.json", "tpc/uav-1-1.tpc", *stay]
    for turn in range(2):
        (folder / "tpc").mkdir(exist_ok=True)
        for name in names:
            (folder / name).write_text(f"{turn}")
        for path in ["marks.csv", "ana.csv", *(f"{name}.marks.csv" for name in marks[::2])]:
            (folder / path).write_text(f"{text}{turn}\n")
        (tmp_path / "today.marks.csv").write_text(f"{text}{turn}\n")
        kept = clear_earlier(folder)
        ending = ".old.2" if turn else ".old"
        inside = ["ana.csv", "marks.csv", "mission.bag.marks.csv", "uav-1-1.tpc.marks.csv"]
        assert {str(path.relative_to(tmp_path)) for path in kept} == {
            f"today.marks.csv{ending}",
            *(f"today/{name}{ending}" for name in inside),
        }
        assert {path.read_text() for path in kept} == {f"{text}{turn}\n"}
    left = {path.name for path in folder.iterdir() if ".old" not in path.name}
    assert left == set(stay)
    assert len(list(folder.glob("*.old*"))) == 8
    assert clear_earlier(tmp_path / "new") == []


class _NoRecorder:
    """Stands for a recorder that reached the master, and then was interrupted."""

    def __init__(self, *_: object, **__: object) -> None:
        pass

    def tell_marks(self, _: object) -> None:
        pass

    def step(self) -> None:
        raise RunError("interrupted")

    leave = step


# The bag of the earlier recording is gone, its marks are not; the master was reached.
def test_kept_marks_are_said(tmp_path, monkeypatch):
    monkeypatch.setattr("pytpc.ros.ros1.record_mission.GraphRecorder", _NoRecorder)
    monkeypatch.setattr(Master, "call", lambda *_: 1)
    path = tmp_path / "marks.csv"
    for ending in ("old", "old.2"):
        path.write_text("time_ns,type,observer,note\n1,I\n")
        result = CliRunner().invoke(main, ["record", "-o", str(tmp_path)])
        assert f"marks of the earlier recording are kept: {path}.{ending}\n" in result.output
    path.write_text("time_ns,type,observer,note\n1,I\n")
    (tmp_path / "monday.bag").write_text("has marks of its own")
    assert "are kept" not in CliRunner().invoke(main, ["record", "-o", str(tmp_path)]).output
    assert path.exists()


def test_marks_stay_if_nothing_is_recorded(tmp_path):
    path = tmp_path / "marks.csv"
    path.write_text("time_ns,type,observer,note\n1,I\n")
    env = {"ROS_MASTER_URI": "http://[::1]:1"}
    with pytest.raises(RunError):
        record_graph(RecordOptions(tmp_path), threading.Event(), env)
    assert path.exists()


def test_a_converted_mission_is_not_recorded_over(tmp_path):
    for name in ("events.parquet", "marks.json"):
        (tmp_path / name).write_text("the only one")
    with pytest.raises(RunError, match="another folder"):
        record_graph(RecordOptions(tmp_path), threading.Event(), {})


@pytest.mark.parametrize("name", ["mission.bag", "mission.bag.active"])
def test_a_recording_of_a_robot_is_not_replaced(tmp_path, name):
    (tmp_path / name).write_text("the only one")
    with pytest.raises(RunError, match="another folder"):
        record_graph(
            RecordOptions(tmp_path),
            stop=threading.Event(),
            env={"ROS_MASTER_URI": "http://[::1]:1"},
        )
    assert (tmp_path / name).read_text() == "the only one"
