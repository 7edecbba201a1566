"""``apply`` and ``origin``: typing mistakes, values out of range, and lines that set several."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner
from launch_samples import environment, needs_roslaunch
from mission_samples import link_unit

from pytpc.cli.main import main
from pytpc.static.link_unit import ParameterRead
from pytpc.static.static_info import StaticInfo
from pytpc.values.recording import save_origins, try_trace

COSTMAP = "obstacles:\n  radius: 0.5\n  enabled: true\n"
LAUNCH = """<launch>
  <node pkg="robot" type="move" name="move">
    <rosparam file="$(find robot)/costmap.yaml" ns="global"/>
    <rosparam file="$(find robot)/costmap.yaml" ns="local"/>
  </node>
</launch>
"""
CFG = """from dynamic_reconfigure.parameter_generator_catkin import *
gen = ParameterGenerator()
gen.add("radius", double_t, 0, "how far", 0.5, 0.1, 2.0)
gen.add("mode", int_t, 0, "how", 0, edit_method=gen.enum(
    [gen.const("slow", int_t, 0, ""), gen.const("fast", int_t, 5, "")], ""))
exit(gen.generate("robot", "robot", "Robot"))
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    folder = tmp_path / "robot"
    folder.mkdir()
    (folder / "package.xml").write_text("<package><name>robot</name></package>\n")
    (folder / "robot.launch").write_text(LAUNCH)
    (folder / "costmap.yaml").write_text(COSTMAP)
    return folder


@pytest.fixture
def mission(package: Path, tmp_path: Path) -> Path:
    """The folder of a mission, with the static information of a node that reads three names."""
    folder = tmp_path / "mission"
    folder.mkdir()
    one = "{obstacles: {radius: 0.5, enabled: true}}"
    (folder / "params.yaml").write_text(f"move: {{global: {one}, local: {one}}}\n")
    env = environment(tmp_path)
    trace, reason = try_trace(env, package / "robot.launch", {})
    save_origins(folder, folder / "params.yaml", trace, reason, env)
    save_static(folder / "static.json", package, "<dynamic>/radius", "~speed", "~mode")
    return folder


def save_static(path: Path, package: Path, *names: str) -> None:
    reads = [
        ParameterRead(
            name=name,
            api="ros::NodeHandle::param",
            type="double",
            file="src/move.cpp",
            lineno=number,
            column=1,
            function="main",
            default=None,
        )
        for number, name in enumerate(names, start=1)
    ]
    StaticInfo.of([link_unit([], reads, str(package))]).save(path)


@needs_roslaunch
def test_every_parameter_that_the_line_sets_is_named(apply, mission: Path, package: Path):
    both = "/move/global/obstacles/radius, /move/local/obstacles/radius"
    done = apply(mission, "/move/global/obstacles/radius", "0.4")
    assert f"{package}/costmap.yaml:2: {both} 0.5 -> 0.4\n" in done.stdout
    answer = json.loads(
        apply(package / "robot.launch", "local/obstacles/radius", "0.3", "--json").output
    )
    # The one that was asked for is the first.
    assert answer["file"]["parameter"] == "/move/local/obstacles/radius"
    assert answer["file"]["parameters"] == both.split(", ")[::-1]


@needs_roslaunch
@pytest.mark.parametrize(
    ("value", "fits"), [("0.1", True), ("2", True), ("0.09", False), ("-1", False)]
)
def test_a_value_out_of_the_declared_range(
    apply, mission: Path, package: Path, value: str, fits: bool
):
    (package / "cfg").mkdir()
    (package / "cfg/Robot.cfg").write_text(CFG)
    words = (mission, "/move/global/obstacles/radius", value)
    done = apply(*words, status=0 if fits else 1)
    if fits:
        return
    assert done.stderr == (
        f"pytpc: error: {package}/costmap.yaml:2: {value} is outside of what"
        f" {package}/cfg/Robot.cfg:3 declares for radius: 0.1 to 2; --force writes it all"
        " the same\n"
    )
    assert (package / "costmap.yaml").read_text() == COSTMAP
    apply(*words, "--force")
    assert f"radius: {value}" in (package / "costmap.yaml").read_text()


@needs_roslaunch
def test_a_value_that_is_none_of_the_choices(apply, mission: Path, package: Path):
    (package / "Robot.cfg").write_text(CFG)
    refused = apply(mission, "/move/mode", "3", "--add", status=1).stderr
    assert "declares for mode: 0 (slow), 5 (fast); --force" in refused
    apply(mission, "/move/mode", "5", "--add", "--dry-run")


# Another package's field of that name says nothing about a node that does not read it.
def test_declarations_of_other_packages_do_not_count(apply, mission: Path, tmp_path: Path):
    other = tmp_path / "other"
    other.mkdir()
    (other / "package.xml").write_text("<package/>")
    (other / "Other.cfg").write_text(CFG)
    yaml = other / "x.yaml"
    yaml.write_text("radius: 1.0\n")
    # Here nobody knows who reads it: the package of the file counts.
    assert "outside" in apply(yaml, "radius", "9", status=1).stderr
    save_static(tmp_path / "static.json", tmp_path / "robot", "~radius")
    apply(yaml, "radius", "9")
    assert mission.is_dir()


@needs_roslaunch
@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("raduis", "raduis is not set anywhere; did you mean /move/global/obstacles/radius"),
        ("/move/global/obstacles/raduis", "did you mean /move/global/obstacles/radius"),
        # A node reads it, and nothing sets it.
        ("/move/sped", "/move/sped is not set anywhere; did you mean ~speed?"),
    ],
)
def test_a_typing_mistake_is_not_added(apply, mission: Path, package: Path, name: str, said: str):
    for also in ((), ("--add",)):
        refused = apply(mission, name, "1", *also, status=1)
        assert said in refused.stderr
        assert "--add" not in refused.stderr
    assert said in CliRunner().invoke(main, ["origin", str(mission), name]).stderr
    assert (package / "robot.launch").read_text() == LAUNCH


@needs_roslaunch
def test_what_a_node_reads_can_be_added(apply, mission: Path, package: Path):
    assert "--add puts it" in apply(mission, "/move/speed", "1", status=1).stderr
    apply(mission, "/move/speed", "1", "--add")
    assert '<param name="speed"' in (package / "robot.launch").read_text()
    # With --force, what nobody reads, too.
    apply(mission, "/move/sped", "1", "--add", "--force")
    assert '<param name="sped"' in (package / "robot.launch").read_text()


def test_a_typing_mistake_in_a_yaml_file(apply, params: Path):
    refused = apply(params, "limi", "1", status=1)
    assert refused.stderr == (
        f"pytpc: error: {params}: limi is not in the file; did you mean mission/limit?\n"
    )
