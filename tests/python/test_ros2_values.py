"""Values of parameters over time, from /parameter_events in a bag by `ros2 bag record`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from mission_samples import ns
from ros2_bags import STORE, Ros2Bag, ros2_time

from pytpc.api.live_reports import Reports
from pytpc.api.missions import convert
from pytpc.api.record import RecordOptions, is_of_ros2
from pytpc.base.errors import InputError, TpcError
from pytpc.diagnosis.results.live import Seen
from pytpc.ingest.decoders import ROS2
from pytpc.ingest.parameter_events import TOPIC, TYPE, ParameterEvent, decode_parameter_event
from pytpc.ingest.reading import read
from pytpc.ingest.ros2 import node_of_logger
from pytpc.recording.mission import ReadName
from pytpc.recording.parameter_values import ParameterValues, SetValue
from pytpc.ros.graphs import values_at
from pytpc.ros.ros2.address import Ros2Address, is_ros2
from pytpc.ros.ros2.graph_recording import write_params
from pytpc.ros.ros2.marking import encode_string
from pytpc.ros.source import Source
from pytpc.ros.which import asked_ros, sign_of_ros2
from pytpc.values.recording import read_parameters

SPEED = "/robot1/guard/limits.speed"
KINDS: dict[type, tuple[int, str]] = {
    bool: (1, "bool_value"),
    int: (2, "integer_value"),
    float: (3, "double_value"),
    str: (4, "string_value"),
}


def value_of(value: Any) -> Any:
    empty = {
        "type": 0,
        "bool_value": False,
        "integer_value": 0,
        "double_value": 0.0,
        "string_value": "",
        "byte_array_value": [],
        "bool_array_value": [],
        "integer_array_value": [],
        "double_array_value": [],
        "string_array_value": [],
    }
    if isinstance(value, list):
        number, field = KINDS[type(value[0])]
        empty |= {"type": number + 5, field.replace("_value", "_array_value"): value}
    elif value is not None:
        number, field = KINDS[type(value)]
        empty |= {"type": number, field: value}
    numpy = __import__("numpy")
    for field, of in (("integer", "i8"), ("double", "f8"), ("bool", "?"), ("byte", "u1")):
        empty[f"{field}_array_value"] = numpy.array(empty[f"{field}_array_value"], of)
    return STORE.types["rcl_interfaces/msg/ParameterValue"](**empty)


def event(seconds: float, new: dict[str, Any], changed: dict[str, Any], deleted: list[str]) -> Any:
    kind = STORE.types["rcl_interfaces/msg/Parameter"]

    def parameters(found: dict[str, Any]) -> list[Any]:
        return [kind(name=name, value=value_of(value)) for name, value in found.items()]

    return STORE.types[TYPE](
        stamp=ros2_time(seconds),
        node="/robot1/guard",
        new_parameters=parameters(new),
        changed_parameters=parameters(changed),
        deleted_parameters=parameters(dict.fromkeys(deleted)),
    )


def test_an_event_has_values_of_all_types() -> None:
    values = {
        "a": True,
        "b": -3,
        "c": 0.5,
        "d": "text",
        "e": [1, 2],
        "f": [0.5],
        "g": ["x", ""],
        "h": [True, False],
    }
    raw = bytes(STORE.serialize_cdr(event(5, values, {}, ["gone"]), TYPE))
    found = decode_parameter_event(raw)
    assert found.stamp_ns == ns(5)
    assert found.node == "/robot1/guard"
    assert found.values == {**values, "gone": None}
    for size in range(4, len(raw) - 8, 7):
        with pytest.raises(ValueError, match="ends too early"):
            decode_parameter_event(raw[:size])


@pytest.mark.parametrize("kind", ["mcap", "db3"])
def test_a_bag_of_ros2_knows_the_value_at_a_time(tmp_path: Path, kind: str) -> None:
    with Ros2Bag(tmp_path / "bag", kind) as bag:
        bag.text(1, "/threshold_information", "")
        bag._write(TOPIC, TYPE, 2, event(2, {"limits.speed": 6.5}, {}, []))
        bag._write(TOPIC, TYPE, 7, event(7, {}, {"limits.speed": 4.0}, []))
        bag._write(TOPIC, TYPE, 9, event(9, {}, {}, ["limits.speed"]))
    recording = read(bag.file)
    values = ParameterValues(recording.values)
    # What holds before the first that is known is taken to be that.
    at = {1: 6.5, 6.9: 6.5, 7: 4.0, 8.9: 4.0, 9: None}
    assert {time: values.at(SPEED, ns(time)) for time in at} == at
    assert values.last() == {}
    assert f"{SPEED} was set from 6.5 to 4.0 at 6.0 s" in recording.notes
    convert([bag.file], tmp_path / "copy")
    assert read(tmp_path / "copy").values == recording.values


def test_values_that_are_set_again_are_no_changes() -> None:
    values = ParameterValues(
        [SetValue(5, "/a/x", 1), SetValue(9, "/a/x", 1), SetValue(7, "/a/x", 1)]
    )
    assert list(values.changes()) == []
    assert values.kept() == (SetValue(5, "/a/x", 1),)
    # A whole number is not the double.
    values = ParameterValues([SetValue(5, "/a/x", 1), SetValue(9, "/a/x", 1.0)])
    assert [one.new for one in values.changes()] == [1.0]


def test_a_parameters_file_has_the_names_that_it_was_written_from(tmp_path: Path) -> None:
    nodes = {"/plain": {"a": [1, 2], "on": True, "qos_overrides./clock.depth": 7}}
    write_params(tmp_path / "params.yaml", nodes)
    assert read_parameters(tmp_path / "params.yaml") == {
        "/plain/a": [1, 2],
        "/plain/on": True,
        "/plain/qos_overrides./clock.depth": 7,
    }


def test_a_logger_is_of_a_node() -> None:
    assert node_of_logger(b"robot1.guard") == b"/robot1/guard"
    assert node_of_logger(b"/uav") == b"/uav"


def test_the_address_of_a_graph_is_that_of_its_variables() -> None:
    env = {"ROS_DOMAIN_ID": "7", "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "HOME": "/h"}
    text = str(Ros2Address.of_env(env))
    assert text == "ros2://7?ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST"
    assert is_ros2(text)
    assert not is_ros2("http://localhost:11311")
    back = Ros2Address.parse(text).env({"ROS_DOMAIN_ID": "1", "RMW_IMPLEMENTATION": "x", "A": "b"})
    assert back == {"A": "b", "ROS_DOMAIN_ID": "7", "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    assert str(Ros2Address.of_env({})) == "ros2://0"
    assert str(Ros2Address.of_env({"ROS_DOMAIN_ID": "0232"})) == "ros2://232"
    for wrong in ("-1", "233", "x", "1e1", "\u0663", "9" * 5000, "0000000009999"):
        with pytest.raises(InputError, match="give a number from 0 to 232"):
            Ros2Address.of_env({"ROS_DOMAIN_ID": wrong})


def test_which_ros_a_shell_is_for() -> None:
    assert sign_of_ros2({"ROS_VERSION": "2"}) == "ROS_VERSION=2"
    assert sign_of_ros2({"AMENT_PREFIX_PATH": "/opt/ros/jazzy"})
    # ROS 1 was sourced last.
    assert sign_of_ros2({"AMENT_PREFIX_PATH": "/opt/ros/jazzy", "ROS_VERSION": "1"}) == ""
    assert sign_of_ros2({"ROS_DISTRO": "noetic", "ROS_VERSION": "1"}) == ""
    assert asked_ros({"TPC_ROS": "2"}) == 2
    assert asked_ros({}) is None
    with pytest.raises(InputError, match="give 1 or 2"):
        asked_ros({"TPC_ROS": "three"})


def test_without_a_python_with_rclpy_it_is_said_what_to_type(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("TPC_ROS2_PYTHON", "/usr/bin/python3")
    with pytest.raises(TpcError, match=r"no Python with rclpy is found.*setup\.sh"):
        values_at("ros2://7")


@pytest.mark.parametrize(
    ("asked", "launch", "packages", "expected"),
    [
        ("", "robot.launch.py", {}, True),
        ("1", "robot.launch.py", {}, False),
        ("", "guard", {"guard": "ament_python", "arm": "catkin"}, True),
        ("", "guard", {"guard": "catkin", "arm": "ament_cmake"}, False),
        # Nobody has this package; the workspace has one ROS alone.
        ("", "sentry", {"guard": "ament_python"}, True),
        ("", "sentry", {"guard": "catkin"}, False),
    ],
)
def test_the_ros_of_a_mission(tmp_path, monkeypatch, asked, launch, packages, expected):  # noqa: PLR0917
    monkeypatch.setenv("TPC_ROS", asked)
    for name, kind in packages.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "package.xml").write_text(
            f"<package format='3'><name>{name}</name><version>0.1.0</version>"
            "<description>d</description><maintainer email='a@b.org'>a</maintainer>"
            f"<license>x</license><export><build_type>{kind}</build_type></export></package>"
        )
    options = RecordOptions(tmp_path / "out", launch=Path(launch), package=launch)
    assert is_of_ros2(tmp_path, options) == expected


def test_the_parameters_of_hidden_nodes_of_tpc_are_no_values_of_the_robot() -> None:
    nodes = ("/robot1/guard", "/robot1/guard/_tpc", "/_tpc_agent_7")
    assert [ParameterEvent(0, one, {}).is_of_tpc for one in nodes] == [False, True, True]


def test_live_reports_of_ros2_are_of_the_node_that_the_batch_names() -> None:
    key = "00000001-0000-5000-8000-000000000000"
    batch = (
        "#seq:{},count:1,dropped:0,pid:7,steady:1.0,node:/robot1/guard\n"
        f"5.5,{key},1,cmp:2,thresh:1,res:1\n5.5,threshold_name:{key},/robot1/guard/limits.speed"
    )
    source = Source("/threshold_information", "", "std_msgs/msg/String", "", "")
    reports = Reports(ROS2)
    items = reports.read(source, encode_string(batch.format(0)), 0.0)
    assert items == [
        Seen(5_500_000_000, key, "/robot1/guard", True, 2.0, 1.0, True),
        ReadName(key, "/robot1/guard", "/robot1/guard/limits.speed"),
    ]
    # After number 0 comes 3.
    reports.read(source, encode_string(batch.format(3)), 0.0)
    assert (reports.lost, reports.malformed) == (2, 0)
