"""Where values come from: the launch file is read with roslaunch's own loader."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner
from launch_samples import environment, make_package, needs_roslaunch

from pytpc.cli.main import main
from pytpc.errors import InputError, MissingToolError
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
from pytpc.values.target import Target, read_target
from pytpc.values.trace import name_on_server, roslaunch_python, trace_launch


@pytest.fixture(scope="module")
def sample(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Target]:
    """The folder with the package, and what is known of its launch file with rate:=8."""
    folder = tmp_path_factory.mktemp("sample")
    launch = make_package(folder)
    return folder, read_target(launch, {"rate": "8"}, environment(folder))


# name, kind, value, file, line, source line; places are counted in launch_samples.py.
PLACES = [
    ("/use_sim_time", "launch", True, "launch/main.launch", 5),
    # A YAML file that is loaded; the second one overrides the first.
    ("/mission/limit", "yaml", 0.058, "config/extra.yaml", 2),
    ("/mission/names", "yaml", ["a", "b"], "config/params.yaml", 5),
    ("/top", "yaml", True, "config/params.yaml", 10),
    # A merge: the mass is written where the anchor is, the size is the map's own.
    ("/other/mass", "yaml", 2, "config/params.yaml", 6),
    ("/other/size", "yaml", 4, "config/params.yaml", 9),
    # In a group; from the command line, so that the tag is the place and the kind says it.
    ("/left/gain", "argument", 8.0, "launch/main.launch", 10),
    # In a node: an argument's default is the place where the value stands.
    ("/left/arm/speed", "launch", 1.5, "launch/main.launch", 3),
    ("/left/arm/limit", "launch", 0.25, "launch/main.launch", 13),
    # YAML in the launch file.
    ("/left/arm/torque", "launch", 3.5, "launch/main.launch", 16),
    ("/left/arm/joints/wrist", "launch", 2.0, "launch/main.launch", 17),
    ("/alone", "launch", 5, "launch/main.launch", 26),
    # A private parameter outside of a node goes to the nodes below.
    ("/left/arm/shared", "launch", 7, "launch/main.launch", 6),
    # Through an include: $(arg depth) is $(arg speed) of the file above.
    ("/right/depth", "launch", 1.5, "launch/main.launch", 3),
    ("/right/width", "launch", 9, "launch/inner.launch", 3),
    ("/computed", "launch", 6, "launch/main.launch", 24),
    # The node itself sets what is in its args, when it starts.
    ("/leg/step", "launch", 0.5, "launch/main.launch", 29),
    ("/leg/fast", "launch", True, "launch/main.launch", 29),
    # The last of two holds.
    ("/again", "launch", 2, "launch/main.launch", 28),
]


@needs_roslaunch
@pytest.mark.parametrize("place", PLACES, ids=[place[0] for place in PLACES])
def test_the_place(sample, place):
    folder, target = sample
    name, kind, value, file, lineno = place
    origin = target.origins[name]
    assert (origin.kind, origin.value) == (kind, value)
    assert origin.path == folder / "robot" / file
    assert origin.lineno == lineno
    assert origin.words() == f"{folder}/robot/{file}:{lineno}"


@needs_roslaunch
def test_what_else_is_known(sample):
    folder, target = sample
    main_launch, params = folder / "robot/launch/main.launch", folder / "robot/config/params.yaml"
    limit = target.origins["/mission/limit"]
    assert limit.text == "limit: 0.058"
    assert limit.via == (f"{main_launch}:8",)
    assert limit.overridden == (f"{params}:3",)
    assert limit.keys == ("mission", "limit")
    gain = target.origins["/left/gain"]
    assert gain.argument == "rate"
    assert gain.note == "rate:=8 on roslaunch's command line"
    assert target.origins["/right/depth"].via == (
        f"{main_launch}:21",
        f"{folder}/robot/launch/inner.launch:4",
        f"{main_launch}:22",
    )
    assert "roslaunch works it out" in target.origins["/computed"].note
    # The command of a parameter is not run: `false` would have failed the whole file.
    assert target.origins["/text"].note == "the output of a command: false"
    assert target.origins["/leg/step"].note == "in the args of the node: _step:=0.5"
    assert target.origins["/leg/step"].overridden == (f"{main_launch}:30",)
    assert target.origins["/again"].overridden == (f"{main_launch}:27",)
    # rosparam's own angles: 90 degrees are pi/2.
    assert target.origins["/mission/angle"].value == pytest.approx(1.5707963267948966)
    assert [(node.name, node.lineno) for node in target.nodes] == [
        ("/left/arm", 11),
        ("/leg", 29),
    ]


@needs_roslaunch
def test_roslaunch_says_the_same(tmp_path):
    """The values are those that `roslaunch --dump-params` gives, for the sample and a mission."""
    launch = make_package(tmp_path)
    # roslaunch would run the command, which fails.
    launch.write_text(launch.read_text().replace(' command="false"', ' value="t"'))
    mission = Path(__file__).parents[2] / "examples/image_capture/launch/image_capture.launch"
    env = environment(tmp_path)
    env["ROS_PACKAGE_PATH"] += f":{mission.parents[2]}"
    for file, args in ((launch, {"rate": "8"}), (mission, {"seed": "3", "fault": "true"})):
        given = [f"{name}:={value}" for name, value in args.items()]
        said = subprocess.run(
            ["roslaunch", "--dump-params", str(file), *given],
            env=env, capture_output=True, text=True, check=True, timeout=60,
        )  # fmt: skip
        wanted = yaml.load(said.stdout, yaml.SafeLoader)
        trace = trace_launch(env, file, args)
        found = {
            name: settings[-1]["value"]
            for name, settings in trace.settings.items()
            if name in trace.by_roslaunch
        }
        # In a node's args; roslaunch does not know of it.
        found.pop("/leg/step", None)
        wanted.pop("/leg/step", None)
        for own in ("/rosdistro", "/rosversion"):
            wanted.pop(own, None)
        assert len(found) > 15
        assert found == wanted


@needs_roslaunch
def test_a_launch_file_that_roslaunch_does_not_take(tmp_path):
    broken = tmp_path / "broken.launch"
    broken.write_text("<launch>\n  <param name='x'/>\n</launch>\n")
    with pytest.raises(InputError, match=r"roslaunch cannot read it: .*one and only one of value"):
        trace_launch(environment(tmp_path), broken, {})
    broken.write_text("<launch>\n  <arg name='a'/><param name='x' value='$(arg a)'/></launch>")
    with pytest.raises(InputError, match="requires the 'a' arg"):
        trace_launch(environment(tmp_path), broken, {})
    # A mission does not fail for it: roslaunch itself says so better.
    trace, reason = try_trace(environment(tmp_path), broken, {})
    assert trace is None
    assert "requires the 'a' arg" in reason
    with pytest.raises(InputError, match="no such launch file"):
        trace_launch(environment(tmp_path), tmp_path / "none.launch", {})


def test_no_roslaunch(tmp_path):
    with pytest.raises(MissingToolError, match="apt-get install python3-roslaunch"):
        roslaunch_python({"PATH": str(tmp_path)})


@needs_roslaunch
def test_anonymous_names(tmp_path):
    launch = tmp_path / "anon.launch"
    launch.write_text(
        '<launch>\n  <node pkg="p" type="t" name="$(anon cam)">\n'
        '    <param name="gain" value="3"/>\n  </node>\n</launch>\n'
    )
    trace = trace_launch(environment(tmp_path), launch, {})
    # roslaunch puts host, process and a number behind the name.
    origins = origins_of(trace, {"/cam_host_4711_123/gain": 3, "/camera/gain": 4})
    assert origins["/cam_host_4711_123/gain"].lineno == 3
    assert origins["/camera/gain"].kind == "runtime"
    # Two of them: which one is meant cannot be told.
    both = {"/cam_a_1_2/gain": 3, "/cam_b_1_2/gain": 3}
    (name,) = trace.settings
    assert name_on_server(name, both) == name


@needs_roslaunch
def test_a_file_of_another_encoding_is_named_all_the_same(tmp_path):
    (tmp_path / "own.yaml").write_bytes(b"# caf\xc3\xa9\r\nlimit: 0.5\r\n")
    launch = tmp_path / "own.launch"
    launch.write_bytes(b'\xef\xbb\xbf<launch><rosparam file="$(dirname)/own.yaml"/></launch>')
    origins = read_target(launch, {}, environment(tmp_path)).origins
    assert (origins["/limit"].path, origins["/limit"].lineno) == (tmp_path / "own.yaml", 2)
    assert origins["/limit"].text == "limit: 0.5"


# --- what a node did


def of(kind="launch", value=1, name="/n/x"):
    return Origin(name, kind, value, Path("a.launch"), 3, "")


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
    assert "--launch is for a graph that runs" in twice.output


def test_a_mission_that_was_recorded_without(tmp_path):
    done = CliRunner().invoke(main, ["origin", str(tmp_path)])
    assert done.exit_code == 1
    assert f"no {ORIGINS_FILE}" in done.output
