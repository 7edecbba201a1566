"""The places of a graph that an observer chooses from, and how one is chosen."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import pytest

from pytpc.recording.graph_file import GRAPH_FILE, write_graph
from pytpc.recording.graph_places import Naming, Place, places_of, recorded_places
from pytpc.static.wiring import Connections, GraphTopic

TWIST, BOOL = "geometry_msgs/Twist", "std_msgs/Bool"


def topic(kind: str | None, by: str, *to: str) -> GraphTopic:
    return GraphTopic(kind, frozenset({by} if by else ()), frozenset(to))


def graph(topics: dict[str, GraphTopic], services: Iterable[tuple[str, str]] = ()) -> Connections:
    return Connections(topics, {name: frozenset({node}) for name, node in services})


def names(found: Connections) -> list[str]:
    return [str(place) for place in places_of(found)]


# driver listens to the plan and moves the base; nobody listens to its state.
def test_topics_that_somebody_hears_come_first_then_services_and_nodes() -> None:
    found = graph(
        {
            "/a_state": topic(BOOL, "/driver"),
            "/plan": topic(None, "/planner", "/driver"),
            "/cmd_vel": topic(TWIST, "/driver", "/base"),
            "/goal": topic(BOOL, "", "/planner"),
        },
        [("/stop", "/driver")],
    )
    assert names(found) == [
        "/cmd_vel (geometry_msgs/Twist)",
        "/plan (topic)",
        "/a_state (std_msgs/Bool)",
        "/stop (service)",
        "/base (node)",
        "/driver (node)",
        "/planner (node)",
    ]


def test_what_ros_and_tpc_have_themselves_is_no_place() -> None:
    own = [
        *("/rosout", "/rosout_agg", "/clock", "/parameter_events", "/threshold_information"),
        *("/mark_action", "/ana/mark_note", "/mark_undo"),
    ]
    found = graph(
        {
            **{name: topic(BOOL, "/a", "/b") for name in own},
            "/tf": topic("tf2_msgs/TFMessage", "/a", "/b"),
            "/a/updates": topic("dynamic_reconfigure/Config", "/a", "/b"),
            "/by_rviz": topic(BOOL, "/rviz_1", "/a"),
            "/logged": topic(BOOL, "/a", "/record_1732871", "/tpc_recorder_7"),
        },
        [("/a/get_loggers", "/a"), ("/a/set_parameters", "/a"), ("/record_1/x", "/record_1")],
    )
    assert names(found) == [
        "/tf (tf2_msgs/TFMessage)",
        "/logged (std_msgs/Bool)",
        "/a (node)",
        "/b (node)",
    ]


def test_an_action_is_one_place() -> None:
    parts = ("cancel", "feedback", "goal", "result", "status")
    ros1 = {
        f"/move_base/{part}": topic(f"move_base_msgs/MoveBaseAction{part.title()}", "/mb")
        for part in parts
    }
    assert names(graph(ros1)) == [
        "/move_base (action move_base_msgs/MoveBase)",
        "/mb (node)",
    ]
    # A goal alone is a topic.
    assert names(graph({"/x/goal": topic(BOOL, "/a")})) == ["/x/goal (std_msgs/Bool)", "/a (node)"]


def test_what_ros2_hides_is_no_place_and_its_actions_are_one_each() -> None:
    ros2 = graph(
        {
            "/turn/_action/feedback": topic("x/action/Turn_FeedbackMessage", "/a"),
            "/turn/_action/status": topic("action_msgs/msg/GoalStatusArray", "/a"),
            "/a/_tpc/notes": topic("std_msgs/msg/String", "/a/_tpc"),
        },
        [("/turn/_action/send_goal", "/a"), ("/a/_tpc/get", "/a/_tpc"), ("/go", "/a")],
    )
    assert names(ros2) == ["/turn (action)", "/go (service)", "/a (node)"]


def test_a_name_stands_once() -> None:
    found = graph({"/arm": topic(BOOL, "/arm", "/x")}, [("/arm", "/arm")])
    assert names(found) == ["/arm (std_msgs/Bool)", "/x (node)"]


def test_names_that_ros_has_not_are_no_places() -> None:
    bad = ["/a b", "/\x1b[2J", "", "/" + "a" * 10_000, "/ä", "/a//b"]
    assert places_of(graph({name: topic(BOOL, "", "") for name in bad})) == ()
    assert names(graph({name: topic(BOOL, "/a") for name in bad})) == ["/a (node)"]


def test_a_graph_of_any_size_has_a_bounded_number_of_places() -> None:
    many = {f"/t{number}": topic("x" * 10_000, "/a") for number in range(3000)}
    found = places_of(graph(many))
    assert len(found) == 1000
    assert max(len(place.about) for place in found) == 80


def test_a_recording_has_the_places_of_its_graph(tmp_path: Path) -> None:
    assert recorded_places(tmp_path) == ()
    write_graph(
        {"/out": topic(TWIST, "/a", "/b")}, tmp_path / GRAPH_FILE, {"/go": frozenset({"/a"})}
    )
    assert [str(place) for place in recorded_places(tmp_path)] == [
        "/out (geometry_msgs/Twist)",
        "/go (service)",
        "/a (node)",
        "/b (node)",
    ]


KNOWN = tuple(Place(name, "x") for name in ("/arm/cmd", "/cmd_vel", "/cmd", "/odom"))


def chosen(typed: str, places: tuple[Place, ...] = KNOWN) -> str:
    return Naming(places, typed).chosen()


@pytest.mark.parametrize(
    ("typed", "place"),
    [
        ("2", "/cmd_vel"),
        # The whole name comes before the beginning of another, and that before a part.
        ("cmd", "/cmd"),
        ("/CMD_", "/cmd_vel"),
        ("arm", "/arm/cmd"),
        ("dom", "/odom"),
        ("base_link", "base_link"),
        ("~state", "~state"),
        ("@cmd", "cmd"),
        ("  ", ""),
    ],
)
def test_a_place_is_chosen_by_number_name_or_part(typed: str, place: str) -> None:
    assert chosen(typed) == place


@pytest.mark.parametrize(
    ("typed", "why"),
    [
        ("0", "no place has this number: 0"),
        ("5", "no place has this number: 5"),
        ("too fast", "not a ROS name: too fast"),
        ("@", "not a ROS name: "),
        ("/a" + "\x1b" * 100, "not a ROS name: /a" + "\N{REPLACEMENT CHARACTER}" * 58 + "..."),
    ],
)
def test_what_is_no_place_is_refused_in_a_line(typed: str, why: str) -> None:
    with pytest.raises(ValueError) as caught:  # noqa: PT011
        chosen(typed)
    assert str(caught.value) == why


def test_without_known_places_a_number_is_no_name() -> None:
    with pytest.raises(ValueError, match="not a ROS name: 1"):
        chosen("1", ())
    assert chosen("/cmd_vel", ()) == "/cmd_vel"


def test_places_keep_their_numbers_when_the_list_gets_shorter() -> None:
    assert Naming(KNOWN, "").lines(9) == [
        "   1 /arm/cmd (x)",
        "   2 /cmd_vel (x)",
        "   3 /cmd (x)",
        "   4 /odom (x)",
    ]
    assert Naming(KNOWN, "cmd").lines(9) == [
        ">  3 /cmd (x)",
        "   2 /cmd_vel (x)",
        "   1 /arm/cmd (x)",
    ]


def test_the_list_has_no_more_lines_than_there_is_room() -> None:
    assert Naming(KNOWN, "").lines(3) == [
        "   1 /arm/cmd (x)",
        "   2 /cmd_vel (x)",
        "     2 more: type a part of the name",
    ]
    # The number that is typed is in sight.
    assert Naming(KNOWN, "4").lines(2)[0] == ">  4 /odom (x)"
    assert Naming(KNOWN, "").lines(0) == []


def test_it_says_that_only_typing_is_left() -> None:
    assert Naming((), "").lines(5) == ["  no place is known: type a name"]
    assert Naming(KNOWN, "xy").lines(5) == ["  no known place fits: Enter takes the name as it is"]


def test_what_is_typed_is_bounded() -> None:
    naming = Naming()
    for _ in range(300):
        naming = naming.type("a")
    assert len(naming.typed) == 255
    assert naming.type("backspace").type("left").typed == "a" * 254
