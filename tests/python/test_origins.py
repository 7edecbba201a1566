"""Where values come from: what is recorded with a mission, and what is made of it."""

from __future__ import annotations

import json
import threading
from pathlib import Path
from typing import ClassVar

import pytest
from click.testing import CliRunner
from launch_samples import environment, make_package, needs_roslaunch

from pytpc.base.errors import InputError
from pytpc.cli.main import main
from pytpc.ros.mission_run import RecordOptions
from pytpc.ros.ros1 import record_mission, recorder
from pytpc.ros.ros1.master import Master
from pytpc.values import recording
from pytpc.values.origins import (
    ORIGINS_FILE,
    START_FILE,
    Origin,
    from_json,
    origin_for,
    read_origins,
    resolved,
    to_json,
)
from pytpc.values.recording import BY_A_NODE, origins_of, read_parameters, save_origins, try_trace
from pytpc.values.trace import trace_launch

# --- what a node did


@needs_roslaunch
def test_set_at_runtime(tmp_path):
    launch = tmp_path / "run.launch"
    launch.write_text(
        "<launch>\n"
        '  <param name="kept" value="1"/>\n'
        '  <param name="changed" value="2"/>\n'
        '  <param name="gone" value="3"/>\n'
        '  <param name="pose" type="yaml" value="{x: 1.0, y: 2.0}"/>\n'
        "</launch>\n"
    )
    trace = trace_launch(environment(tmp_path), launch, {})
    at_end = {"/kept": 1, "/changed": 2.0, "/new": 5, "/rosversion": "1.15", "/pose/x": 1.0,
              "/pose/y": 2.5}  # fmt: skip
    origins = origins_of(trace, at_end)
    assert (origins["/kept"].kind, origins["/kept"].lineno) == ("launch", 2)
    # 2 became 2.0: the type is part of the value.
    assert (origins["/changed"].kind, origins["/changed"].value) == ("runtime", 2.0)
    assert origins["/changed"].note == f"{launch}:3 set it to 2"
    assert origins["/gone"].note == f"{launch}:4 set it, and it was deleted at runtime"
    assert (origins["/new"].kind, origins["/new"].note) == ("runtime", BY_A_NODE)
    assert origins["/pose/x"].lineno == 5
    assert origins["/pose/y"].note == f"{launch}:5 set it to 2.0"
    # What roslaunch and the master keep for themselves is nobody's parameter.
    assert "/rosversion" not in origins


def test_without_a_launch_file():
    # At the start 1, at the end 2: it was set meanwhile. Of what stayed nothing is known.
    origins = origins_of(None, {"/a": 2, "/b": 3}, {"/a": 1, "/b": 3})
    assert (origins["/a"].kind, origins["/b"].kind) == ("runtime", "unknown")
    assert origins["/b"].words() == "unknown"


# --- the file


@needs_roslaunch
def test_recorded_and_read(tmp_path):
    launch = make_package(tmp_path)
    env = environment(tmp_path)
    trace, reason = try_trace(env, launch, {})
    assert reason == ""
    mission = tmp_path / "mission"
    mission.mkdir()
    text = "mission: {limit: 0.058, 'odd:name': .inf}\nleft:\n  arm: {limit: 0.3}\n"
    (mission / "params.yaml").write_text(text)
    (mission / START_FILE).write_text(text)
    save_origins(mission, mission / "params.yaml", trace, reason, env)
    origins = read_origins(mission)
    assert origins["/mission/limit"].words() == f"{tmp_path}/robot/config/extra.yaml:2"
    assert origins["/mission/odd:name"].value == float("inf")
    assert origins["/left/arm/limit"].kind == "runtime"
    assert read_origins(mission / "mission.bag") == origins
    document = json.loads((mission / ORIGINS_FILE).read_text())
    assert document["launch"] == str(launch)
    assert document["nodes"][0]["name"] == "/left/arm"
    # sha256 of each launch and YAML file that was read: two of each.
    assert len(document["files"]) == 4
    assert document["env"]["ROS_PACKAGE_PATH"] == str(tmp_path)


def test_a_dump_that_cannot_be_read_costs_no_mission(tmp_path):
    (tmp_path / "params.yaml").write_text("a: [\n")
    save_origins(tmp_path, tmp_path / "params.yaml", None, "", {})
    assert read_origins(tmp_path) == {}
    assert "not YAML in line 2" in json.loads((tmp_path / ORIGINS_FILE).read_text())["reason"]


def test_no_origins(tmp_path):
    assert read_origins(tmp_path) == {}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "not JSON"),
        ('{"schema": 7}', "not a file of origins of version 1"),
        ("[]", "not a file of origins of version 1"),
        ('{"schema": 1}', "not a file of origins"),
        ('{"schema": 1, "parameters": {"/a": {"kind": "odd", "value": 1}}}', "kind 'odd'"),
        ('{"schema": 1, "parameters": {"/a": {"kind": "yaml"}}}', "value"),
        ('{"schema": 1, "parameters": {"/a": 3}}', "not a file of origins"),
    ],
)
def test_a_broken_file(tmp_path, text, said):
    (tmp_path / ORIGINS_FILE).write_text(text)
    with pytest.raises(InputError, match=said):
        read_origins(tmp_path)


def test_values_in_json():
    value = [1.5, float("-inf"), {"a": float("inf")}, "x", True, None]
    assert json.dumps(to_json(value), allow_nan=False)
    assert from_json(to_json(value)) == value
    assert str(from_json(to_json(float("nan")))) == "nan"


def test_a_dump_of_the_server(tmp_path):
    # As `rosparam dump` writes it: PyYAML's quotes, block lists, binary data.
    dump = tmp_path / "params.yaml"
    dump.write_text("a: {b: '5', c: 1.0e-07, d: true}\nlist:\n- 1\n- x\nraw: !!binary |\n  aGk=\n")
    assert read_parameters(dump) == {
        "/a/b": "5", "/a/c": 1e-07, "/a/d": True, "/list": [1, "x"], "/raw": "aGk=\n",
    }  # fmt: skip


# --- from the source's name to the parameter


ORIGINS = {
    name: Origin(name, "yaml", 1, Path("p.yaml"), 2, "")
    for name in ("/ns/mission/limit", "/ns/limit", "/limit", "/a/only", "/b/twice", "/c/twice")
}


@pytest.mark.parametrize(
    ("source", "node", "name"),
    [
        ("~limit", "/ns/mission", "/ns/mission/limit"),
        ("limit", "/ns/mission", "/ns/limit"),
        ("/limit", "/ns/mission", "/limit"),
        # A forked child is called like its parent, with its number.
        ("~limit", "/ns/mission (4711)", "/ns/mission/limit"),
        # The namespace is only known as the node runs.
        ("<dynamic>/limit", "/ns/mission", "/ns/mission/limit"),
        # Whose report it is is not known (console text): there is one of this name.
        ("~only", "console", "/a/only"),
    ],
)
def test_the_origin_of_a_name_in_the_source(source, node, name):
    found = origin_for(ORIGINS, source, node, 0.5)
    assert found is not None
    assert (found.name, found.kind) == (name, "yaml")


def test_a_default_in_the_code():
    found = origin_for(ORIGINS, "~other", "/ns/mission", 0.5)
    assert found == Origin("/ns/mission/other", "default", 0.5, None, None, "")
    assert found.words() == "default in the code"
    unknown = origin_for(ORIGINS, "~other", "/ns/mission", None)
    assert unknown is not None
    assert unknown.note == "the default is not known"


def test_nothing_is_known():
    assert origin_for({}, "~limit", "/ns/mission", 0.5) is None
    assert origin_for(ORIGINS, "<dynamic>", "/ns/mission", 0.5) is None
    assert origin_for(ORIGINS, "~twice", "", 0.5) is None


def test_names_of_ros():
    assert resolved("~a/b", "/n") == "/n/a/b"
    assert resolved("a", "/n") == "/a"
    assert resolved("/a", "/x/n") == "/a"


# --- the command


@needs_roslaunch
def test_the_command(tmp_path, monkeypatch):
    launch = make_package(tmp_path)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    done = CliRunner().invoke(main, ["origin", str(launch), "mission/limit"])
    assert done.exit_code == 0, done.output
    assert done.output.splitlines() == [
        f"/mission/limit = 0.058: {tmp_path}/robot/config/extra.yaml:2",
        "    limit: 0.058",
        f"    through {launch}:8",
        f"    overrides {tmp_path}/robot/config/params.yaml:3",
    ]
    answer = json.loads(
        CliRunner().invoke(main, ["origin", str(launch), "rate:=8", "--json"]).output
    )
    assert answer["/left/gain"]["kind"] == "argument"
    assert answer["/left/gain"]["value"] == 8.0
    table = CliRunner().invoke(main, ["origin", str(launch)])
    assert "/right/width" in table.output
    several = CliRunner().invoke(main, ["origin", str(launch), "limit"])
    assert several.exit_code == 1
    assert "several parameters end with limit: /left/arm/limit, /mission/limit" in several.output


def test_the_launch_file_of_a_graph_that_runs(tmp_path):
    out = ["-o", str(tmp_path / "out"), "--launch", str(tmp_path / "none.launch")]
    done = CliRunner().invoke(main, ["record", *out])
    assert done.exit_code == 1
    assert f"{tmp_path}/none.launch: no such launch file" in done.output
    twice = CliRunner().invoke(main, ["record", "ws", "a.launch", *out])
    assert twice.exit_code == 2
    assert "--launch is only for a running graph" in twice.output


def test_a_mission_that_was_recorded_without(tmp_path):
    done = CliRunner().invoke(main, ["origin", str(tmp_path)])
    assert done.exit_code == 1
    assert f"no {ORIGINS_FILE}" in done.output


@needs_roslaunch
def test_tags_out_of_an_entity_cost_no_mission(tmp_path):
    launch = tmp_path / "entity.launch"
    launch.write_text(
        "<!DOCTYPE launch [<!ENTITY n \"<param name='lim' value='1'/>\">]>\n"
        "<launch>&n;<rosparam>a: 1</rosparam></launch>\n"
    )
    env = environment(tmp_path)
    trace, reason = try_trace(env, launch, {})
    assert reason == ""
    (tmp_path / "params.yaml").write_text("lim: 1\na: 1\n")
    save_origins(tmp_path, tmp_path / "params.yaml", trace, reason, env)
    origins = read_origins(tmp_path)
    assert (origins["/a"].kind, origins["/a"].value) == ("launch", 1)


def test_what_nobody_thought_of_costs_no_mission(tmp_path, monkeypatch):
    def broken(*_args: object, **_options: object) -> None:
        raise AssertionError("odd")

    monkeypatch.setattr(recording, "trace_any_launch", broken)
    trace, reason = try_trace({}, tmp_path / "a.launch", {})
    assert trace is None
    assert "odd" in reason
    monkeypatch.setattr(recording, "origins_of", broken)
    (tmp_path / "params.yaml").write_text("a: 1\n")
    save_origins(tmp_path, tmp_path / "params.yaml", None, "", {})
    assert "odd" in json.loads((tmp_path / ORIGINS_FILE).read_text())["reason"]


def test_a_roslaunch_that_is_none_costs_no_mission(tmp_path):
    program = tmp_path / "roslaunch"
    program.write_bytes(b"")
    program.chmod(0o755)
    launch = tmp_path / "a.launch"
    launch.write_text("<launch/>")
    trace, reason = try_trace({"PATH": str(tmp_path)}, launch, {})
    assert trace is not None or reason


def test_recording_goes_on_while_the_launch_file_is_read(tmp_path, monkeypatch):
    polled, stop = threading.Event(), threading.Event()

    class Subscriber:
        broken: ClassVar[dict[str, int]] = {}
        received = 0

        def __init__(self, *_: object) -> None:
            pass

        def poll(self, _seconds: float) -> list[object]:
            polled.set()
            return []

        def connections(self) -> set[tuple[str, str]]:
            return set()

        def close(self) -> None:
            pass

    class Nothing:
        def __init__(self, *_: object) -> None:
            pass

        def look(self) -> None:
            pass

    def slow(*_: object) -> tuple[None, str]:
        read_meanwhile = polled.wait(5.0)
        stop.set()
        return None, "read meanwhile" if read_meanwhile else "recorded nothing meanwhile"

    def dump(_env: object, path: Path, *_: object) -> None:
        path.write_text("a: 1\n")

    monkeypatch.setattr(recorder, "RawSubscriber", Subscriber)
    monkeypatch.setattr(recorder, "Discovery", Nothing)
    monkeypatch.setattr(Master, "has_sim_time", lambda _: False)
    monkeypatch.setattr(record_mission, "try_trace", slow)
    monkeypatch.setattr(record_mission, "try_dump", dump)
    env = {"ROS_MASTER_URI": "http://localhost:1"}
    launch = tmp_path / "a.launch"
    options = RecordOptions(tmp_path / "out", launch, timeout_s=8.0)
    record_mission.record_graph(options, stop=stop, env=env)
    document = json.loads((tmp_path / "out" / ORIGINS_FILE).read_text())
    assert document["reason"] == "read meanwhile"
