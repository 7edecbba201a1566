"""``pytpc apply --live`` and attached recording, on a real graph.

One roscore for the file. ``/tuned`` is a node with dynamic_reconfigure (the package's own server,
with a description as its generator writes one), ``/plain`` one that reads its parameter once.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from pytpc.base.errors import MissingToolError
from pytpc.cli.main import main
from pytpc.ros.mission_run import RecordOptions
from pytpc.ros.ros1.graph import RosGraph
from pytpc.ros.ros1.live_values import Robot
from pytpc.ros.ros1.record_mission import record_graph
from pytpc.values.origins import read_origins

# What dynamic_reconfigure's generator makes of four lines gen.add(...).
NODE = """
import sys, types
import rospy
from dynamic_reconfigure.server import Server

def parameter(name, kind, low, high, default):
    return {"name": name, "type": kind, "level": 1, "description": "", "edit_method": "",
            "min": low, "max": high, "default": default, "ctype": kind, "cconsttype": kind,
            "srcline": 1, "srcfile": "x.cfg"}

rows = [
    parameter("limit", "double", 0.0, 1.0, 0.5), parameter("count", "int", 0, 10, 3),
    parameter("enabled", "bool", False, True, True), parameter("frame", "str", "", "", "map"),
]
config = types.ModuleType("config")
config.config_description = {
    "name": "Default", "type": "", "state": True, "cstate": "true", "id": 0, "parent": 0,
    "parameters": rows, "groups": [], "parentname": "", "class": "", "upper": "", "lower": "",
    "field": "", "parentclass": "",
}
config.defaults = {row["name"]: row["default"] for row in rows}
config.min = {row["name"]: row["min"] for row in rows}
config.max = {row["name"]: row["max"] for row in rows}
config.level = {row["name"]: row["level"] for row in rows}
config.type = {row["name"]: row["type"] for row in rows}

rospy.init_node("tuned")

def changed(now, level):
    rospy.set_param("/seen", {name: now[name] for name in ("limit", "count", "enabled", "frame")})
    return now

Server(config, changed)
rospy.spin()
"""
PLAIN = "import rospy; rospy.init_node('plain'); rospy.get_param('~gain'); rospy.spin()"
LAUNCH = '<launch>\n  <param name="/plain/gain" value="2"/>\n</launch>\n'


@pytest.fixture(scope="module")
def graph(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RosGraph]:
    folder = tmp_path_factory.mktemp("graph")
    try:
        graph = RosGraph({"PATH": "/usr/bin:/bin", "HOME": str(folder)}, folder).__enter__()
    except MissingToolError:
        pytest.skip("ROS is not installed")
    try:
        graph.call("setParam", "/plain/gain", 2)
        graph.start("tuned", ["/usr/bin/python3", "-c", NODE])
        graph.start("plain", ["/usr/bin/python3", "-c", PLAIN])
        deadline = time.monotonic() + 20
        while not ready(graph):
            graph.check()
            assert time.monotonic() < deadline, "the nodes do not come up"
            time.sleep(0.1)
        yield graph
    finally:
        graph.__exit__(None, None, None)


def ready(graph: RosGraph) -> bool:
    services = json.dumps(graph.call("getSystemState"))
    return "/tuned/set_parameters" in services and '"/plain"' in services


@pytest.fixture
def apply(graph: RosGraph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("ROS_MASTER_URI", graph.uri)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))

    def run(*words: str) -> Result:
        return CliRunner().invoke(main, ["apply", *words])

    return run


def test_a_node_with_dynamic_reconfigure_takes_it_at_once(apply, graph: RosGraph) -> None:
    done = apply("--live", "/tuned/limit", "0.75")
    assert done.exit_code == 0, done.output
    assert f"{graph.uri}: /tuned/limit 0.5 -> 0.75" in done.output
    assert "uses it now (dynamic_reconfigure), without a restart" in done.output
    # The node says what its callback was given.
    assert graph.call("getParam", "/seen/limit") == 0.75
    undone = apply("--undo")
    assert undone.exit_code == 0, undone.output
    assert graph.call("getParam", "/seen/limit") == 0.5
    assert graph.call("getParam", "/tuned/limit") == 0.5
    assert json.loads(apply("--list", "--json").output) == []


@pytest.mark.parametrize(
    "case",
    [("count", "7", 3, 7), ("enabled", "false", True, False), ("frame", "odom", "map", "odom")],
)
def test_each_type(apply, graph: RosGraph, case: tuple[str, str, object, object]) -> None:
    name, given, before, taken = case
    assert apply("--live", f"/tuned/{name}", given).exit_code == 0
    assert graph.call("getParam", f"/seen/{name}") == taken
    assert apply("--undo").exit_code == 0
    assert graph.call("getParam", f"/seen/{name}") == before


def test_what_the_node_makes_of_it_is_said(apply, graph: RosGraph) -> None:
    answer = json.loads(apply("--live", "/tuned/limit", "5", "--json").output)["live"]
    # Its description says 0 to 1.
    assert (answer["new"], answer["holds"]) == (5.0, 1.0)
    assert answer["note"] == "the node limited it to 1.0 (dynamic_reconfigure)"
    assert apply("--undo", "--force").exit_code == 0
    assert graph.call("getParam", "/seen/limit") == 0.5


def test_a_node_without_it_has_to_ask_again(apply, graph: RosGraph) -> None:
    done = apply("--live", "/plain/gain", "3")
    assert done.exit_code == 0, done.output
    assert "/plain does not offer it by dynamic_reconfigure" in done.output
    assert graph.call("getParam", "/plain/gain") == 3
    # Somebody else sets it meanwhile: that is not overwritten.
    graph.call("setParam", "/plain/gain", 4)
    refused = apply("--undo")
    assert refused.exit_code == 1
    assert "/plain/gain is 4 now: something else has set it" in refused.output
    assert graph.call("getParam", "/plain/gain") == 4
    assert apply("--undo", "--force").exit_code == 0
    assert graph.call("getParam", "/plain/gain") == 2


def test_what_nobody_has_set(apply, graph: RosGraph) -> None:
    refused = apply("--live", "/plain/other", "3.5")
    assert refused.exit_code == 1
    assert "/plain/other is not on the parameter server" in refused.output
    assert apply("--live", "/plain/other", "3.5", "--force").exit_code == 0
    assert graph.call("getParam", "/plain/other") == 3.5
    assert apply("--undo").exit_code == 0
    assert graph.call("hasParam", "/plain/other") is False


def test_the_type_is_kept_and_a_dry_run_sets_nothing(apply, graph: RosGraph) -> None:
    refused = apply("--live", "/tuned/count", "2.5")
    assert refused.exit_code == 1
    assert "/tuned/count: the parameter is a whole number" in refused.output
    dry = apply("--live", "/tuned/limit", "0.25", "--dry-run")
    assert "not set: --dry-run" in dry.output
    assert "the node would take it at once" in dry.output
    assert graph.call("getParam", "/seen/limit") == 0.5
    assert json.loads(apply("--list", "--json").output) == []


def test_beside_what_the_node_sets(apply, graph: RosGraph) -> None:
    """A parameter below the node that is none of its dynamic_reconfigure."""
    graph.call("setParam", "/tuned/extra", 1.5)
    done = apply("--live", "/tuned/extra", "2.5")
    assert done.exit_code == 0, done.output
    assert "/tuned does not offer it by dynamic_reconfigure" in done.output
    assert graph.call("getParam", "/tuned/extra") == 2.5
    assert apply("--undo").exit_code == 0
    assert graph.call("getParam", "/tuned/extra") == 1.5


def test_an_end_of_the_name(apply, graph: RosGraph) -> None:
    # /seen/limit and /tuned/limit; only /plain has a gain.
    refused = apply("--live", "limit", "0.25")
    assert refused.exit_code == 1
    assert "/seen/limit, /tuned/limit" in refused.output
    assert "/plain/gain 2 -> 5" in apply("--live", "gain", "5").output
    assert apply("--undo").exit_code == 0


def test_the_node_ends_before_the_undo(apply, graph: RosGraph) -> None:
    node = graph.start("gone", ["/usr/bin/python3", "-c", NODE, "__name:=gone"])
    deadline = time.monotonic() + 20
    while "/gone/set_parameters" not in json.dumps(graph.call("getSystemState")):
        assert time.monotonic() < deadline, "the node does not come up"
        time.sleep(0.1)
    assert (
        "uses it now (dynamic_reconfigure), without a restart"
        in apply("--live", "/gone/limit", "0.75").output
    )
    graph.stop(node)
    # What the next node will read is set back all the same.
    undone = apply("--undo")
    assert undone.exit_code == 0, undone.output
    assert graph.call("getParam", "/gone/limit") == 0.5


def test_no_master(apply, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:9")
    done = apply("--live", "/plain/gain", "3")
    assert done.exit_code == 1
    assert "the ROS master at http://127.0.0.1:9 does not answer" in done.output


@pytest.mark.parametrize("known", [True, False])
def test_a_graph_that_runs_already(graph: RosGraph, tmp_path: Path, known: bool) -> None:
    """Attached, the launch file is known if somebody names it; values are dumped all the same."""
    launch = tmp_path / "plain.launch"
    launch.write_text(LAUNCH)
    stop = threading.Event()
    threading.Timer(1.0, stop.set).start()
    env = {**graph.env, "PATH": "/usr/bin:/bin"}
    given = launch if known else None
    record_graph(RecordOptions(tmp_path / "out", given), stop=stop, env=env)
    origins = read_origins(tmp_path / "out")
    gain = origins["/plain/gain"]
    assert gain.value == 2
    if known:
        assert (gain.kind, gain.path, gain.lineno) == ("launch", launch, 2)
        assert origins["/tuned/limit"].kind == "runtime"
    else:
        assert (gain.kind, gain.path) == ("unknown", None)
    assert Robot(graph.uri).value("/plain/gain") == 2
