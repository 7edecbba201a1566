"""Where a launch file sets values: it is read with roslaunch's own loader, and line by line."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner
from launch_samples import environment, make_package, needs_roslaunch

from pytpc.base.errors import InputError, MissingToolError
from pytpc.cli.main import main
from pytpc.values.recording import origins_of, try_trace
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
    assert "roslaunch computes it" in target.origins["/computed"].note
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


HARD = """<?xml version="1.0"?>
<!-- a comment
     of two lines -->
<launch>
  <arg name="gain" default="2.5"/>
  <arg name="on" default="true"/>
  <group ns="a" if="$(arg on)">
    <group ns="b">
      <rosparam file="$(dirname)/sub.yaml" subst_value="true" ns="c"/>
      <param name="skipped" value="1" unless="$(arg on)"/>
      <param name="kept" value="1"/>
    </group>
  </group>
  <node pkg="p" type="t" name="n" ns="deep" clear_params="true">
    <rosparam file="$(dirname)/own.yaml"/>
    <param name="pose" type="yaml" value="{x: 1.5, y: [1, 2]}"/>
    <param name="both" value="3"/>
  </node>
  <include file="$(dirname)/low.launch" pass_all_args="true"/>
  <include file="$(dirname)/low.launch" ns="again">
    <arg name="gain" value="7"/>
  </include>
  <rosparam>{flow: {one: 1,
             two: 2}}</rosparam>
  <rosparam command="load" param="list">
    - 1
    - 2
  </rosparam>
</launch>
"""
LOW = """<launch>
  <arg name="gain" default="9"/>
  <param name="low"
         value="$(arg gain)"/>
</launch>
"""
SUB = "# comment\nk: $(arg gain)\nsome/deep: 4\n/rooted: 5\n"
OWN = "both: 1\nlimit: &l 0.5\ncopy: *l\nboth: 2\n"
# What is set, in which file and line: counted in the texts above.
HARD_PLACES = {
    "/a/b/c/k": (2.5, "sub.yaml", 2),
    "/a/b/c/some/deep": (4, "sub.yaml", 3),
    "/rooted": (5, "sub.yaml", 4),
    "/a/b/kept": (1, "hard.launch", 11),
    "/deep/n/limit": (0.5, "own.yaml", 2),
    # An alias: the value is written where the anchor is.
    "/deep/n/copy": (0.5, "own.yaml", 2),
    "/deep/n/both": (3, "hard.launch", 17),
    "/deep/n/pose/x": (1.5, "hard.launch", 16),
    "/deep/n/pose/y": ([1, 2], "hard.launch", 16),
    # All arguments are handed on, so that it is the default of line 5 of the file above.
    "/low": (2.5, "hard.launch", 5),
    "/again/low": (7, "hard.launch", 21),
    "/flow/one": (1, "hard.launch", 23),
    "/flow/two": (2, "hard.launch", 24),
    "/list": ([1, 2], "hard.launch", 26),
}


@needs_roslaunch
def test_hard_cases(tmp_path):
    texts = {"hard.launch": HARD, "low.launch": LOW, "sub.yaml": SUB, "own.yaml": OWN}
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    origins = read_target(tmp_path / "hard.launch", {}, environment(tmp_path)).origins
    found = {
        name: (one.value, one.path.name if one.path is not None else "", one.lineno)
        for name, one in origins.items()
    }
    assert found == HARD_PLACES
    assert "subst_value" in origins["/a/b/c/k"].note
    assert origins["/deep/n/both"].overridden == (f"{tmp_path}/own.yaml:4",)
    assert origins["/again/low"].via == (
        f"{tmp_path}/hard.launch:20",
        f"{tmp_path}/low.launch:3",
    )
    said = subprocess.run(
        ["roslaunch", "--dump-params", str(tmp_path / "hard.launch")],
        env=environment(tmp_path), capture_output=True, text=True, check=True, timeout=60,
    )  # fmt: skip
    wanted = yaml.load(said.stdout, yaml.SafeLoader)
    pose = wanted.pop("/deep/n/pose")
    wanted.update({f"/deep/n/pose/{key}": value for key, value in pose.items()})
    assert {name: value[0] for name, value in found.items()} == {
        name: value for name, value in wanted.items() if name not in ("/rosdistro", "/rosversion")
    }


@needs_roslaunch
@pytest.mark.parametrize("command", ["apply", "origin"])
def test_a_package_of_a_workspace_that_is_not_sourced(tmp_path, monkeypatch, command):
    for name in ("ROS_PACKAGE_PATH", "CMAKE_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)
    launch = tmp_path / "ws/src/robot/robot.launch"
    launch.parent.mkdir(parents=True)
    launch.write_text("<launch><include file='$(find my_camera)/camera.launch'/></launch>")
    words = [str(launch), "/x", *(["1"] if command == "apply" else [])]

    def said():
        result = CliRunner().invoke(main, [command, *words])
        assert result.exit_code == 1
        return result.stderr

    what = (
        "it needs the package my_camera, which no sourced workspace has; give the built workspace"
    )
    assert said() == f"pytpc: error: {launch}: {what} that has it: --workspace WORKSPACE\n"
    (tmp_path / "ws/.tpc").mkdir()
    assert said().endswith(f"that has it: --workspace {tmp_path}/ws\n")


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
