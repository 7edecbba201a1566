"""Paths of messages over nodes: from static information, launch files and recorded graphs."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from mission_samples import comparison, events, key, link_unit

from pytpc.api.wired_robot import wiring_of_mission
from pytpc.base.errors import InputError
from pytpc.cli.main import main
from pytpc.recording.graph_file import GRAPH_FILE, read_graph, read_recorded_graph, write_graph
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Comparison, Received
from pytpc.static.message_paths import MOST_NODES, MessagePaths, leaves, path_text, routes
from pytpc.static.static_info import StaticInfo
from pytpc.static.wiring import UNKNOWN, GraphTopic, RunningNode, Wiring

BOOL, TWIST = "std_msgs/Bool", "geometry_msgs/Twist"


def hears(topic: str | None, kind: str | None = BOOL, by: Any = "value") -> Received:
    return Received(topic, kind, by, "src/node.cpp", 20)


def sends(number: int, source: str, topic: str | None, kind: str | None, *heard: Received) -> Any:
    return comparison(number, source, topic=topic, message=kind, received=heard or None)


def robot(**units: list[Comparison]) -> StaticInfo:
    """A link unit of this name for each node."""
    return StaticInfo.of(replace(link_unit(found), link_unit=name) for name, found in units.items())


# camera decides /done; driver hears it in two comparisons and decides /cmd_vel; brake hears that.
# The sampler hears another topic, and a topic of the same name with another type.
def sample() -> StaticInfo:
    return robot(
        camera=[sends(1, "~min_coverage", "done", BOOL)],
        driver=[
            sends(2, "~retry", "cmd_vel", TWIST, hears("/done")),
            sends(3, "~speed", "cmd_vel", TWIST, hears("/done", by="control")),
        ],
        brake=[sends(4, "~hold", None, None, hears("cmd_vel", None))],
        sampler=[
            sends(5, "~depth", None, None, hears("/other")),
            sends(6, "~rate", None, None, hears("/done", "std_msgs/Int32")),
        ],
    )


def texts(static: StaticInfo, wiring: Wiring, number: int = 1) -> list[str]:
    return [path_text(static, path) for path in MessagePaths(static, wiring).from_key(key(number))]


def test_a_path_leads_over_topics_of_one_name_and_type() -> None:
    retry = "~min_coverage (camera) -> /done -> driver: src/node.cpp:12 ~retry"
    speed = "~min_coverage (camera) -> /done -> driver: src/node.cpp:13 ~speed"

    assert texts(sample(), UNKNOWN) == [
        f"{retry} -> /cmd_vel",
        f"{speed} -> /cmd_vel",
        f"{retry} -> /cmd_vel -> brake: src/node.cpp:14 ~hold",
    ]
    # The comparisons of a node are alike.
    firsts = routes(MessagePaths(sample(), UNKNOWN).from_key(key(1)))
    assert [path_text(sample(), path, others) for path, others in firsts] == [
        f"{retry} (and 1 more) -> /cmd_vel",
        f"{retry} -> /cmd_vel -> brake: src/node.cpp:14 ~hold",
    ]
    # What begins another path is part of it.
    paths = MessagePaths(sample(), UNKNOWN).from_key(key(1))
    assert [len(path.links) for path in leaves(paths)] == [1, 2]


def test_what_is_not_connected_has_no_path() -> None:
    assert texts(sample(), UNKNOWN, 4) == []
    assert texts(sample(), UNKNOWN, 5) == []
    assert texts(robot(camera=[comparison(1, "a", topic="makePlan -> result")]), UNKNOWN) == []


def test_cycles_end_and_paths_are_bounded() -> None:
    # a and b hear each other.
    both = robot(
        a=[sends(1, "x", "/ab", BOOL, hears("/ba"))],
        b=[sends(2, "y", "/ba", BOOL, hears("/ab"))],
    )
    assert texts(both, UNKNOWN) == ["x (a) -> /ab -> b: src/node.cpp:12 y -> /ba"]

    # n0 to n9, each hears the one before.
    row = {f"n{n}": [sends(n, f"p{n}", f"/t{n}", BOOL, hears(f"/t{n - 1}"))] for n in range(10)}
    longest = MessagePaths(robot(**row), UNKNOWN).from_key(key(0))[-1]
    assert longest.end.node == f"/n{MOST_NODES - 1}"


def test_launch_files_give_nodes_their_names_and_topics() -> None:
    nodes = (
        RunningNode("/left/camera", "robot/camera", (("done", "/left/ready"),)),
        RunningNode("/left/driver", "robot/driver", (("/done", "ready"),)),
        RunningNode("/right/driver", "robot/driver"),
    )

    assert texts(sample(), Wiring(nodes)) == [
        "~min_coverage (left/camera) -> /left/ready -> left/driver: src/node.cpp:12 ~retry"
        " -> /left/cmd_vel",
        "~min_coverage (left/camera) -> /left/ready -> left/driver: src/node.cpp:13 ~speed"
        " -> /left/cmd_vel",
    ]


def test_a_process_is_a_node_of_its_program() -> None:
    loaded = replace(sends(2, "y", None, BOOL, hears("/ab")), processes=("robot/host@field",))
    static = robot(a=[sends(1, "x", "/ab", BOOL)], library=[loaded])
    nodes = (RunningNode("/a", "robot/a"), RunningNode("/h", "robot/host"))

    assert texts(static, Wiring(nodes)) == ["x (a) -> /ab -> h: src/node.cpp:12 y"]


def test_a_script_is_a_node_of_its_file() -> None:
    script = replace(link_unit([sends(1, "x", "/ab", BOOL)]), link_unit="a", script="nodes/a.py")
    other = replace(link_unit([sends(2, "y", None, BOOL, hears("/ab"))]), link_unit="b")
    nodes = (RunningNode("/n", "robot/a.py"), RunningNode("/m", "robot/b"))
    found = MessagePaths(StaticInfo.of([script, other]), Wiring(nodes)).from_key(key(1))

    assert [(path.start.node, path.end.node) for path in found] == [("/n", "/m")]


def test_private_names_are_those_of_the_node() -> None:
    static = robot(a=[sends(1, "x", "~out", BOOL)], b=[sends(2, "y", None, None, hears("/a/out"))])
    assert texts(static, UNKNOWN) == ["x (a) -> /a/out -> b: src/node.cpp:12 y"]


def test_a_recorded_graph_says_who_speaks_to_whom() -> None:
    evaluated = {key(1): frozenset({"/camera"}), key(2): frozenset({"/driver"})}

    def graph(**subscribers: str) -> Wiring:
        topics = {
            "/ready": GraphTopic(BOOL, frozenset({"/camera"}), frozenset({subscribers["ready"]})),
            "/out": GraphTopic(TWIST, frozenset({"/driver"}), frozenset({"/brake"})),
        }
        return Wiring((), evaluated, topics)

    # Nobody knows that /done is renamed; but camera has only one topic of this type to driver.
    assert texts(sample(), graph(ready="/driver")) == [
        "~min_coverage (camera) -> /ready -> driver: src/node.cpp:12 ~retry -> /cmd_vel"
    ]
    assert texts(sample(), graph(ready="/brake")) == []


def test_a_name_of_the_graph_is_not_another_topic() -> None:
    evaluated = {key(1): frozenset({"/camera"}), key(2): frozenset({"/driver"})}
    ends = frozenset({"/camera"}), frozenset({"/driver"})
    topics = {"/done": GraphTopic(BOOL, ends[0], frozenset()), "/b": GraphTopic(BOOL, *ends)}

    assert texts(sample(), Wiring((), evaluated, topics)) == []
    topics["/done"] = GraphTopic(BOOL, *ends)
    assert texts(sample(), Wiring((), evaluated, topics)) == [
        "~min_coverage (camera) -> /done -> driver: src/node.cpp:12 ~retry -> /cmd_vel"
    ]


def test_the_graph_of_a_mission_is_kept(tmp_path: Path) -> None:
    topics = {"/a": GraphTopic(BOOL, frozenset({"/x", "/y"}), frozenset()), "/b": GraphTopic(
        None, frozenset(), frozenset({"/x"}))}  # fmt: skip
    services = {"/go": frozenset({"/x", "/y"})}
    write_graph(topics, tmp_path / GRAPH_FILE, services)

    assert read_graph(tmp_path) == topics
    assert read_graph(tmp_path / "none") == {}
    assert read_recorded_graph(tmp_path) == (topics, services)
    wiring = wiring_of_mission(Recording("m", events([]), (), 0, 1), tmp_path)
    assert (wiring.topics, wiring.services) == (topics, services)


def test_a_graph_of_an_earlier_version_has_no_services(tmp_path: Path) -> None:
    (tmp_path / GRAPH_FILE).write_text('{"schema": 1, "topics": {}}')
    assert read_recorded_graph(tmp_path) == ({}, {})


@pytest.mark.parametrize(
    "text",
    [
        "[]",
        '{"schema": 2}',
        '{"schema": 1, "topics": {"/a": 1}}',
        '{"schema": 1, "topics": {}, "services": {"/a": "/b"}}',
    ],
)
def test_a_broken_graph_is_an_error(tmp_path: Path, text: str) -> None:
    (tmp_path / GRAPH_FILE).write_text(text)
    with pytest.raises(InputError, match="not the graph of a mission"):
        read_graph(tmp_path)


def test_explain_says_where_the_outcome_goes_on(tmp_path: Path) -> None:
    sample().save(tmp_path / "static.json")
    said = CliRunner().invoke(main, ["explain", str(tmp_path / "static.json"), "min_coverage"])

    assert said.exit_code == 0, said.output
    listed = " ".join(said.output.partition("goes on to")[2].split())
    assert listed.startswith(
        "~min_coverage (camera) -> /done -> driver: src/node.cpp:12 ~retry (and 1 more) -> /cmd_vel"
        " ~min_coverage (camera) -> /done"
    )

    asked = ["explain", str(tmp_path / "static.json"), "min_coverage", "--json"]
    (found,) = json.loads(CliRunner().invoke(main, asked).output)["comparisons"]
    assert found["goes_on"][0] == {
        "start": {
            "node": "/camera", "key": key(1), "parameter": "~min_coverage",
            "file": "src/node.cpp", "lineno": 11,
        },
        "links": [{
            "topic": "/done", "type": BOOL, "by": "value", "node": "/driver", "key": key(2),
            "parameter": "~retry", "file": "src/node.cpp", "lineno": 12,
        }],
        "topic": "/cmd_vel",
    }  # fmt: skip


def test_explain_is_silent_where_nothing_is_linked(tmp_path: Path) -> None:
    robot(camera=[comparison(1, "x")]).save(tmp_path / "static.json")
    said = CliRunner().invoke(main, ["explain", str(tmp_path / "static.json"), "x"])
    assert said.exit_code == 0
    assert "goes on" not in said.output


def test_old_files_have_no_messages(tmp_path: Path) -> None:
    static = robot(camera=[comparison(1, "x")])
    (found,) = static.to_json()["units"][0]["comparisons"]
    assert "received" not in found
    assert "message" not in found
    sample().save(tmp_path / "static.json")
    assert StaticInfo.load(tmp_path / "static.json").comparisons == sample().comparisons
