"""The tables that drive the analysis: those that come with TPC, and the user's own."""

import json
from pathlib import Path

import pytest

from pytpc.base.checked_json import check_rules, parse_json
from pytpc.base.errors import InputError

TABLES = Path(__file__).parents[2] / "passes/rules"
# What the thesis looks at: the reads by param() with a variable, and three statements.
THESIS = {
    "ros::NodeHandle::param",
    "ros::Publisher::publish",
    "ros::ServiceClient::call",
    "ros::service::call",
}
# docs/reference/analysis.md, row by row; what is not of ROS 1 is in the other table.
READS = {
    "ros1": {
        "ros::NodeHandle::param",
        "ros::NodeHandle::getParam",
        "ros::NodeHandle::getParamCached",
        "ros::param::get",
        "ros::param::param",
        "ros::param::getCached",
    },
    "ros2": {
        f"{node}::{method}"
        for node in ("rclcpp::Node", "rclcpp_lifecycle::LifecycleNode")
        for method in ("declare_parameter", "get_parameter", "get_parameter_or")
    },
}
EXPOSING = {
    "ros1": {
        "actionlib::SimpleActionClient::sendGoal",
        "actionlib::ServerGoalHandle::setSucceeded",
        "actionlib::SimpleActionServer::publishFeedback",
        "tf::TransformBroadcaster::sendTransform",
        "tf2_ros::StaticTransformBroadcaster::sendTransform",
        "image_transport::Publisher::publish",
        "realtime_tools::RealtimePublisher::unlockAndPublish",
    },
    "ros2": {
        "rclcpp::Publisher::publish",
        "rclcpp_lifecycle::LifecyclePublisher::publish",
        "rclcpp::Client::async_send_request",
        "rclcpp_action::Client::async_send_goal",
        "rclcpp_action::ServerGoalHandle::succeed",
    },
}


def functions(table: str, section: str) -> set[str]:
    return {row["function"] for row in json.loads((TABLES / f"{table}.json").read_text())[section]}


@pytest.mark.parametrize("table", ["ros1", "ros2"])
def test_a_table_that_comes_with_tpc_keeps_to_the_schema(table: str) -> None:
    check_rules(TABLES / f"{table}.json")


@pytest.mark.parametrize("table", ["ros1", "ros2"])
def test_the_tables_hold_what_is_specified(table: str) -> None:
    assert READS[table] <= functions(table, "reads")
    assert EXPOSING[table] <= functions(table, "exposing")


def test_the_thesis_has_a_profile_of_its_own() -> None:
    table = json.loads((TABLES / "ros1.json").read_text())
    rows = [*table["reads"], *table["exposing"]]
    named = [row["function"] for row in rows if "thesis" in row["profiles"]]
    assert sorted(named) == sorted(THESIS)


def test_the_example_in_the_documentation_is_right(tmp_path: Path) -> None:
    text = (TABLES.parents[1] / "docs/reference/analysis.md").read_text().split("```json\n")[1]
    path = tmp_path / "own.json"
    path.write_text(text.split("```")[0])
    check_rules(path)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ('{"reads": [', ":1: not JSON"),
        ("[]", ": /: "),
        ('{"reeds": []}', ": /: "),
        ('{"reads": {}}', ": /reads: "),
        ('{"exposing": [{}]}', ": /exposing/0: "),
        ('{"exposing": [{"function": 7}]}', ": /exposing/0/function: "),
        ('{"exposing": [{"function": "f", "topic": -1}]}', ": /exposing/0/topic: "),
        ('{"reads": [{"function": "f", "name": 0}]}', ": /reads/0: "),
        ('{"reads": [{"function": "f", "name": 0, "value": "x"}]}', ": /reads/0/value: "),
        (
            '{"reads": [{"function": "f", "name": 0, "value": 1, "resolve": "x"}]}',
            ": /reads/0/resolve: ",
        ),
        ('{"exposing": [{"function": "f", "slot": 3}]}', ": /exposing/0: "),
        (
            '{"held": [{"function": "f", "relation": "<", "nanoseconds": 12}]}',
            ": /held/0/nanoseconds: ",
        ),
        (
            '{"reads": [{"function": "f", "name": 0, "value": "return", "many": "map"}]}',
            ": /reads/0/value: ",
        ),
        (
            '{"reads": [{"function": "f", "name": 0, "value": 1, "many": "list"}]}',
            ": /reads/0/value: ",
        ),
        ('{"handles": [{"function": "f", "parts": [{}], "to": "this"}]}', ": /handles/0/parts/0: "),
        ('{"opaque": [""]}', ": /opaque/0: "),
        ('{"schema": 2}', ": /schema: "),
    ],
)
def test_a_fault_is_named_with_its_place(tmp_path: Path, text: str, place: str) -> None:
    path = tmp_path / "own.json"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        check_rules(path)
    assert str(caught.value).startswith(f"{path}{place}")
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"own\.json: cannot be read"):
        check_rules(tmp_path / "own.json")


def test_every_row_of_a_schema_is_used() -> None:
    """A section that no table has would be one that nobody tests."""
    schema = parse_json(Path(__file__).parents[2] / "pytpc/base/schema/rules.schema.json")
    assert isinstance(schema, dict)
    tables = [json.loads((TABLES / f"{table}.json").read_text()) for table in ("ros1", "ros2")]
    used = {key for table in tables for key in table}
    assert set(schema["properties"]) == used
