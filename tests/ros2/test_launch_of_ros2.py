"""Where the values in launch files of ROS 2 came from, by launch itself, and `pytpc apply` there.

launch and launch_ros are on no registry. These tests run where the interpreter of ROS 2 can import
them, or where TPC_TEST_LAUNCH names an install space that has them (and composition_interfaces).
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest
from launch_files import PYTHON as LAUNCH_PY
from launch_files import XML, write_launch_files

from patience import PATIENCE_S
from pytpc.base.errors import InputError
from pytpc.values.target import Target, chosen, plan_origin, read_target
from ros2_graph import PYTHON, ros2_env


@pytest.fixture(scope="module")
def env() -> dict[str, str]:
    folder = os.environ.get("TPC_TEST_LAUNCH")
    more = {} if folder is None else {"PYTHONPATH": folder, "AMENT_PREFIX_PATH": folder}
    env = {**ros2_env({}), **more, "PATH": f"{PYTHON.parent}:{os.defpath}"}
    ran = subprocess.run(
        [PYTHON, "-c", "import launch_ros.actions, launch_xml, launch_yaml"],
        env=env,
        capture_output=True,
        text=True,
        check=False,
    )
    if ran.returncode:
        pytest.skip(f"no launch_ros: {ran.stderr.strip().splitlines()[-1]}")
    return env


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_launch_files(tmp_path)
    return tmp_path


def places(target: Target, folder: Path) -> dict[str, tuple[object, str, str]]:
    """Value, kind and place of all parameters."""
    return {
        name: (one.value, one.kind, one.words().removeprefix(f"{folder}/"))
        for name, one in target.origins.items()
    }


def line(text: str, part: str) -> int:
    """The number of the only line that has a text."""
    (number,) = [n for n, one in enumerate(text.splitlines(), 1) if part in one]
    return number


def test_python_and_what_it_includes(folder: Path, env: dict[str, str]) -> None:
    target = read_target(folder / "robot.launch.py", {}, {**env, "TMPDIR": str(folder)})
    parts = ("default_value=", "shared", '"gain"', "common = ", '"x"', '"y"', '"rate"', '"fps"')
    py = {part: f"robot.launch.py:{line(LAUNCH_PY, part)}" for part in parts}
    shared = (7, "launch", py["shared"])
    common = py["common = "]
    assert places(target, folder) == {
        "/raw/k": (1000.0, "launch", f"robot.launch.py:{line(LAUNCH_PY, 'ExecuteProcess(cmd')}"),
        "/raw/rate": (10, "yaml", "params.yaml:3"),
        "/raw/speed_limit": (4.0, "yaml", "params.yaml:4"),
        "/robot1/arm/inner/limits.min": (0.5, "launch", f"inner.launch.xml:{line(XML, '0.5')}"),
        # SetParameter makes `/**` the first entry, so that the node's own one counts.
        "/robot1/arm/inner/rate": (9, "launch", py['"rate"']),
        "/robot1/arm/inner/shared": shared,
        "/robot1/arm/inner/speed_limit": (4.0, "yaml", "params.yaml:4"),
        "/robot1/box/shared": shared,
        "/robot1/cam/fps": (30, "launch", py['"fps"']),
        "/robot1/cam/rate": (10, "yaml", "params.yaml:3"),
        "/robot1/cam/shared": shared,
        "/robot1/cam/speed_limit": (4.0, "yaml", "params.yaml:4"),
        "/robot1/deep/life/shared": shared,
        "/robot1/deep/life/y": ([1.0, 2.0], "launch", py['"y"']),
        "/robot1/guard/gain": (0.25, "launch", py['"gain"']),
        "/robot1/guard/limits.min": (0.058, "yaml", "params.yaml:8"),
        "/robot1/guard/nested.a": (1, "launch", common),
        "/robot1/guard/nested.b": (2.5, "launch", common),
        "/robot1/guard/rate": (10, "yaml", "params.yaml:3"),
        "/robot1/guard/shared": shared,
        "/robot1/guard/speed_limit": (4.5, "launch", py["default_value="]),
        "/robot1/guard/word": ("fast", "launch", common),
        "/robot1/nameless/shared": shared,
        "/robot1/nameless/x": (1, "launch", py['"x"']),
    }
    limit = target.origins["/robot1/guard/speed_limit"]
    assert (limit.argument, limit.overridden) == ("limit", (f"{folder}/params.yaml:4",))
    rate = target.origins["/robot1/guard/rate"]
    assert rate.note == "/** sets it for 3 nodes"
    # What launch has written for the nodes is gone again.
    assert [path.name for path in folder.iterdir() if "launch_" in path.name] == []


def test_an_argument_of_the_command_line(folder: Path, env: dict[str, str]) -> None:
    origin = read_target(folder / "robot.launch.py", {"limit": "3"}, env).origins[
        "/robot1/guard/speed_limit"
    ]
    assert (origin.value, origin.kind, origin.argument) == (3, "argument", "limit")
    with pytest.raises(InputError, match="limit:=3 on the command line of ros2 launch"):
        plan_origin(origin, "4")


def test_yaml(folder: Path, env: dict[str, str]) -> None:
    assert places(read_target(folder / "yaml.launch.yaml", {}, env), folder) == {
        "/robot1/guard/shared": (7, "launch", "yaml.launch.yaml:7"),
        "/robot1/guard/speed_limit": (4.5, "launch", "yaml.launch.yaml:4"),
        "/robot1/guard/gain": (0.25, "launch", "yaml.launch.yaml:17"),
        "/robot1/guard/deep.er": (3.0, "launch", "yaml.launch.yaml:21"),
        "/robot1/guard/limits.min": (0.058, "yaml", "params.yaml:8"),
        "/robot1/guard/rate": (10, "yaml", "params.yaml:3"),
    }


@pytest.mark.parametrize(
    "case",
    [
        ("robot.launch.py", "gain", "2", ('"gain": 0.25', '"gain": 2.0')),
        ("robot.launch.py", "/robot1/guard/speed_limit", "3", ('"4.5"', '"3.0"')),
        ("robot.launch.py", "nested.b", "3", ('"b": 2.5', '"b": 3.0')),
        ("robot.launch.py", "word", "slow", ('"fast"', '"slow"')),
        ("robot.launch.py", "life/y", "[1, 3]", ("[1.0, 2.0]", "[1.0, 3.0]")),
        ("robot.launch.py", "fps", "25", ('"fps": 30', '"fps": 25')),
        ("robot.launch.py", "/robot1/arm/inner/rate", "5", ('"rate": "9"', '"rate": "5"')),
        ("robot.launch.py", "/robot1/arm/inner/limits.min", "1", ('"0.5"', '"1.0"')),
        ("robot.launch.py", "/raw/rate", "11", ("rate: 10", "rate: 11")),
        ("yaml.launch.yaml", "gain", "2", ("value: 0.25", "value: 2.0")),
        ("yaml.launch.yaml", "/robot1/guard/speed_limit", "2", ('"4.5"', '"2.0"')),
        ("yaml.launch.yaml", "deep.er", "2", ("value: 3.0", "value: 2.0")),
        ("yaml.launch.yaml", "limits.min", "1e-3", ("0.058", "0.001")),
    ],
)
def test_apply(
    folder: Path, env: dict[str, str], case: tuple[str, str, str, tuple[str, str]]
) -> None:
    launch, parameter, given, (before, after) = case
    target = read_target(folder / launch, {}, env)
    change = plan_origin(chosen(target, parameter), given, files=target.files)
    text = change.before.decode()
    assert text.count(before) == 1
    assert change.after.decode() == text.replace(before, after)


@pytest.mark.parametrize(
    ("parameter", "given", "why"),
    [
        ("fps", "4.5", "is a whole number and '4.5' is not"),
        ("/raw/k", "3", "change it by hand"),
    ],
)
def test_refused(folder: Path, env: dict[str, str], parameter: str, given: str, why: str) -> None:
    target = read_target(folder / "robot.launch.py", {}, env)
    origin = chosen(target, parameter)
    with pytest.raises(InputError, match=why) as refused:
        plan_origin(origin, given, files=target.files)
    assert (refused.value.path, refused.value.line) == (str(origin.path), origin.lineno)


def test_bad_files_are_one_line_with_the_place(folder: Path, env: dict[str, str]) -> None:
    (folder / "params.yaml").write_text("/**:\n  ros__parameters:\n    a: [1, x]\n")
    with pytest.raises(InputError, match="types int and string") as refused:
        read_target(folder / "yaml.launch.yaml", {}, env)
    assert (refused.value.path, refused.value.line) == (str(folder / "params.yaml"), 3)
    (folder / "robot.launch.py").write_text("raise RuntimeError('no\\nway')\n")
    with pytest.raises(InputError, match=r"launch cannot read it: .*no way"):
        read_target(folder / "robot.launch.py", {}, env)


REAL = """\
import os
from launch import LaunchDescription, LaunchService
from launch.actions import DeclareLaunchArgument, GroupAction, SetLaunchConfiguration
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node, PushRosNamespace, SetParameter, SetParametersFromFile
from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue

HERE = os.path.dirname(__file__)
PARAMS = os.path.join(HERE, "params.yaml")


def node(**more):
    return Node(executable=os.environ["TPC_TEST_PYTHON"], arguments=[os.environ["TPC_TEST_NODE"]],
                **more)


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("limit", default_value="4.5"),
        node(name="early", parameters=[{"rate": 1}, PARAMS]),
        SetParameter("shared", 7),
        GroupAction([
            PushRosNamespace("robot1"),
            SetParametersFromFile(PARAMS),
            SetLaunchConfiguration("limit", "5.5"),
            node(name="guard", parameters=[
                {"speed_limit": LaunchConfiguration("limit"), "a": {"b": [1, 2], "c": "1e3"}},
                ParameterFile(PARAMS), Parameter("rate", LaunchConfiguration("limit")),
                {"text": ParameterValue("12", value_type=str)}],
                ros_arguments=["-p", "early:=yes", "-p", "guard:own:=1e3"]),
        ]),
        node(name="late", namespace="/far/away",
             parameters=[{"limit": LaunchConfiguration("limit")}]),
    ])


if __name__ == "__main__":
    service = LaunchService()
    service.include_launch_description(generate_launch_description())
    service.run()
"""


def test_nodes_that_launch_starts_get_the_values_that_are_shown(
    folder: Path, env: dict[str, str], domain: dict[str, str]
) -> None:
    launch = folder / "real.launch.py"
    launch.write_text(REAL)
    env = {
        **env,
        **domain,
        "ROS_LOG_DIR": str(folder / "log"),
        "TPC_TEST_FOLDER": str(folder),
        "TPC_TEST_PYTHON": str(PYTHON),
        "TPC_TEST_NODE": str(Path(__file__).with_name("node_of_launch.py")),
    }
    ran = subprocess.run(
        [PYTHON, launch], env=env, capture_output=True, text=True, timeout=PATIENCE_S, check=False
    )
    given = {
        f"{path.stem.replace('+', '/')}/{name}": value
        for path in folder.glob("+*.json")
        for name, value in json.loads(path.read_text()).items()
    }
    shown = {name: repr(one.value) for name, one in read_target(launch, {}, env).origins.items()}
    assert shown == given, ran.stderr
    assert {name.rpartition("/")[0] for name in given} == {
        "/early",
        "/robot1/guard",
        "/far/away/late",
    }
