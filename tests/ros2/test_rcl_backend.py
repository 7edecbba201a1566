"""C++ nodes on rcl alone report to a real graph of ROS 2, where a node of rclpy hears them."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from patience import PATIENCE_S, wait_for
from pytpc.base.paths import prefix
from pytpc.ingest.reading import read
from ros2_dialogue import Dialogue, Peer, compared, events
from ros2_graph import PYTHON, compile_on_rcl, needs_backend, needs_wheels, ros2_env, wheels_env

HERE = Path(__file__).parent
GUARD = "/robot1/guard"
SETTINGS = f"{GUARD}/_tpc"

pytestmark = [needs_wheels, needs_backend]


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compile_on_rcl(HERE / "reporter.cpp", tmp_path_factory.mktemp("rcl") / "reporter")


Start = Callable[..., Dialogue]


@pytest.fixture
def start(program: Path, domain: dict[str, str], tmp_path: Path) -> Iterator[Start]:
    """Start a node: more words of its command line, then settings (``sink="file"``)."""
    started: list[Dialogue] = []

    def run(
        *words: str,
        libraries: str = "",
        chosen_domain: str = "",
        other: Path | None = None,
        **settings: str,
    ) -> Dialogue:
        changed = {f"TPC_{name.upper()}": value for name, value in settings.items()}
        more = {"TPC_FOLDER": str(tmp_path / "reports"), **wheels_env(), **changed}
        if libraries:
            more["LD_LIBRARY_PATH"] = libraries
        if chosen_domain:
            more |= {"REPORTER_DOMAIN": chosen_domain, "ROS_DOMAIN_ID": "0"}
        node = Dialogue(
            [str(other or program), "guard", "/robot1", *words],
            ros2_env(domain, **more),
            tmp_path / f"node-{len(started)}.err",
        )
        started.append(node)
        return node

    yield run
    for node in started:
        node.process.kill()
        node.process.communicate()


@pytest.fixture
def peer(domain: dict[str, str], tmp_path: Path) -> Iterator[Peer]:
    one = Peer([str(PYTHON), str(HERE / "peer.py")], ros2_env(domain), tmp_path / "peer.err")
    yield one
    one.process.kill()
    one.process.communicate()


def test_every_report_of_five_thousand_a_second_arrives_in_order(peer: Peer, start: Start) -> None:
    node = start(policy="every")
    node.say("report 10000 200")
    # Those from before the listener was found are among them.
    assert peer.values(10000) == list(map(float, range(10000)))
    assert node.finish() == 0
    heads = [batch.split("\n")[0] for batch in peer.ask("heard", 10000)["batches"]]
    counted = [list(map(int, re.findall(r"(?:seq|count|dropped):(\d+)", head))) for head in heads]
    assert sum(count for _seq, count, _dropped in counted) == 10000
    assert [seq for seq, *_ in counted] == [
        sum(count for _, count, _ in counted[:place]) for place in range(len(counted))
    ]
    assert all(dropped == 0 for *_, dropped in counted)
    assert all(head.endswith(f",node:{GUARD}") for head in heads)
    assert node.errors() == ""


def test_light_is_the_default(peer: Peer, start: Start) -> None:
    node = start()
    node.say("report 4 0")
    # The first evaluation and three flops.
    assert peer.values(4) == [0, 1, 2, 3]
    assert peer.ask("get", SETTINGS, "sink", "policy", "period", "site_cap") == [
        "auto",
        "light",
        1.0,
        10,
    ]
    assert node.finish() == 0


def test_rosout_has_a_message_for_each_report(peer: Peer, start: Start) -> None:
    node = start(sink="rosout")
    node.say("report 300 1000")
    logs = [log for log in peer.ask("heard", 300)["logs"] if log[3].startswith("threshold_inf")]
    assert node.finish() == 0
    assert [compared(text) for *_, text in logs] == list(map(float, range(300)))
    assert {logger for _, _, logger, _ in logs} == {"robot1.guard"}


def test_settings_are_parameters_of_a_hidden_node(peer: Peer, start: Start) -> None:
    node = start(sink="off")
    node.say("report 5 0")
    assert peer.ask("list", SETTINGS) == [
        "sink",
        "policy",
        "period",
        "site_cap",
        "process_cap",
        "status",
    ]
    assert SETTINGS in peer.ask("nodes", SETTINGS)
    assert peer.ask("types", SETTINGS, "sink", "period", "site_cap", "no") == [4, 3, 2, 0]
    described = [["status", 4, True], ["sink", 4, False]]
    assert peer.ask("describe", SETTINGS, "status", "sink") == described
    assert peer.ask("get", SETTINGS, "no") == []
    assert peer.ask("get", SETTINGS, "status") == ["sink=off policy=every sites=0 dropped=0"]

    assert peer.ask("set", SETTINGS, sink="topic") == [[True, ""]]
    node.say("report 3 0")
    assert peer.values(3) == [0, 1, 2]
    # YAML reads off as false.
    assert peer.ask("set", SETTINGS, sink=False) == [[True, ""]]
    node.say("report 3 0")
    assert peer.ask("set", SETTINGS, sink="topic", period=1, site_cap=7) == [[True, ""]] * 3
    assert peer.ask("get", SETTINGS, "period", "site_cap") == [1.0, 7]
    node.say("report 2 0")
    assert peer.values(5) == [0, 1, 2, 0, 1]
    assert node.finish() == 0


def test_what_cannot_be_set_is_refused_with_the_reason(peer: Peer, start: Start) -> None:
    node = start(sink="off")
    node.say("report 1 0")
    assert peer.ask("set", SETTINGS, sink="file", policy="al", period="no", status="x", no=1) == [
        [True, ""],
        [False, "policy: it must be one of every, edges, light"],
        [False, "period: it must be a number of seconds from 0.001 to 3600"],
        [False, "status: it is read-only"],
        [False, "no: there is no such setting"],
    ]
    refused = [False, "site_cap: it must be a whole number"]
    assert peer.ask("set_all", SETTINGS, sink="topic", site_cap=-1) == refused
    assert peer.ask("get", SETTINGS, "sink") == ["file"]
    assert peer.ask("set_all", SETTINGS, sink="topic", site_cap=3) == [True, ""]
    assert peer.ask("get", SETTINGS, "sink", "site_cap") == ["topic", 3]
    assert node.finish() == 0


def test_the_command_line_replaces_the_environment(
    peer: Peer, start: Start, tmp_path: Path
) -> None:
    file = tmp_path / "settings.yaml"
    file.write_text(
        "/**/_tpc: {ros__parameters: {sink: off, policy: edges, site_cap: x}}\n"
        "/robot1/guard/_tpc: {ros__parameters: {period: 0.5}}\n"
        "/robot1/other/_tpc: {ros__parameters: {period: 0.7}}\n"
        "/**: {ros__parameters: {process_cap: 3}}\n"
    )
    # A rule can name a node without its namespace alone; `process_cap` is for the program.
    rules = ("-p", "_tpc:process_cap:=8", "-p", "process_cap:=4", "-p", "guard:site_cap:=5")
    node = start("--ros-args", "--params-file", str(file), *rules)
    node.say("report 1 0")
    wanted = ["off", "edges", 0.5, 0, 8]
    names = ("sink", "policy", "period", "site_cap", "process_cap")
    assert peer.ask("get", SETTINGS, *names) == wanted
    assert node.errors() == (
        f"tpc: the parameter {SETTINGS}/site_cap is ignored: site_cap: it must be a whole number\n"
    )
    assert node.finish() == 0


def test_a_batch_has_simulated_time_and_the_names_of_parameters(peer: Peer, start: Start) -> None:
    node = start(sink="topic")
    node.say("report 1 0")
    node.say("simulated 12500000000")
    node.say("read limits.speed")
    node.say("report 2 0")
    lines = [line for batch in peer.ask("heard", 3)["batches"] for line in batch.split("\n")[1:]]
    # The first one came before the node had said which time it has.
    assert [line.split(",")[0] for line in lines[:3]] == ["0.0000000", "12.5000000", "12.5000000"]
    name = f"threshold_name:00000002-0000-5000-8000-000000000000,{GUARD}/limits.speed"
    assert node.finish() == 0
    batches = peer.ask("heard", 3)["batches"]
    assert sum(batch.count(name) for batch in batches) >= 1


def test_the_first_node_names_the_process(peer: Peer, start: Start) -> None:
    node = start("--ros-args", "-r", "__node:=keeper", sink="topic")
    node.say("node second")
    node.say("report 1 0")
    (batch,) = peer.ask("heard", 1)["batches"]
    assert batch.split("\n")[0].endswith(",node:/robot1/keeper")
    assert node.finish() == 0


@pytest.fixture(scope="module", params=["lazy", "now"])
def late(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A program that loads the log library after rcl, its calls bound at the start or not."""
    words = "-DLATE", f"-Wl,-z,{request.param},-z,relro"
    output = tmp_path_factory.mktemp("late") / "reporter"
    return compile_on_rcl(HERE / "reporter.cpp", output, *words, with_log=False)


LOAD = f"load {prefix()}/lib/libtpc_log.so.0"


# As in a container: its own node is there, and follows /clock, before it loads a component.
def test_a_program_that_had_rcl_before_has_its_names_and_time(
    peer: Peer, start: Start, late: Path
) -> None:
    words = ("--ros-args", "-r", "__node:=guard", "-r", "__ns:=/robot1")
    node = start(*words, other=late, sink="topic")
    node.say("follow")
    node.say(LOAD)
    node.say("simulated 12500000000")
    node.say("report 2 0")
    node.say("node second")
    node.say("made /second 2000 100")
    node.say("of 2000 2")
    node.say("read_on of.node")
    assert peer.ask("get", SETTINGS, "sink") == ["topic"]
    lines = [line for batch in peer.ask("heard", 4)["batches"] for line in batch.split("\n")[1:]]
    assert {line.split(",")[0] for line in lines if ",threshold_" not in line} == {"12.5000000"}
    node.say("simulated 13500000000")
    # What waits is sent at once, as the program is shut down.
    node.say("report 1 0")
    node.say("shutdown")
    batches = peer.ask("heard", 5)["batches"]
    assert {batch.split("\n")[0].split(",node:")[1] for batch in batches} == {GUARD}
    assert events(batches[-1])[-1].startswith("13.5000000,")
    told = "".join(batches)
    assert "threshold_name:00000001-0000-5000-8000-000000000000,node:/second" in told
    # The rule for the first node's name is one for all nodes.
    assert f"threshold_name:00000002-0000-5000-8000-000000000000,{GUARD}/of.node" in told
    assert node.finish() == 0
    assert node.errors() == ""


@pytest.mark.parametrize("line", ["node second", "read_in /second limit 2000 8"])
def test_a_program_that_had_rcl_before_is_named_after_the_first_known_node(
    start: Start, late: Path, tmp_path: Path, line: str
) -> None:
    node = start(other=late, sink="file")
    node.say(LOAD)
    node.say(line)
    node.say("report 2 700000")
    node.say("report 2 0")
    assert node.finish() == 0
    assert read(tmp_path / "reports").events.nodes == (SECOND,)


SECOND = "/second"


def nodes_of(folder: Path) -> dict[str, set[str]]:
    """The nodes of each key, without the key's first 36 characters."""
    return {key[36:]: set(nodes) for key, nodes in read(folder).nodes_of.items()}


# Two nodes of 100 bytes, an object within the second one, and one of a plugin that reads on the
# second node. Of an object that neither is nor reads anything, only the process is known.
def test_each_object_is_of_its_node(start: Start, tmp_path: Path) -> None:
    node = start(sink="file")
    node.say("node second")
    # At first nothing is known of the plugin.
    node.say("of 5000 1")
    for line in (f"made {GUARD} 1000 100", f"made {SECOND} 2000 100", "of 1000 2", "of 2000 2"):
        node.say(line)
    node.say("of 2050 2")
    node.say(f"read_in {SECOND} by.limit 5000 8")
    node.say("of 9000 2")
    node.say("read_on of.node")
    assert node.finish() == 0
    assert nodes_of(tmp_path / "reports") == {
        "": {SECOND}, "#2": {GUARD}, "#3": {SECOND}, "#4": {SECOND}, "#5": {GUARD},
    }  # fmt: skip
    names = {one.name for one in read(tmp_path / "reports").names if one.name}
    assert names == {f"{SECOND}/by.limit", f"{SECOND}/of.node"}


# A container unloads a component, and the next one gets its memory: also in the thread's tables.
@pytest.mark.parametrize("policy", ["every", "edges", "light"])
def test_another_node_in_the_same_memory_reports_apart(
    start: Start, tmp_path: Path, policy: str
) -> None:
    node = start(sink="file", policy=policy)
    for name in ("/old", "/old", "/new"):
        node.say(f"made {name} 1000 100")
        node.say(f"read_in {name} limit 1000 100")
        node.say("of 1000 3")
        node.say("of 1050 3")
    assert node.finish() == 0
    assert nodes_of(tmp_path / "reports") == {
        "": {"/old"}, "#2": {"/old"}, "#3": {"/new"}, "#4": {"/new"},
    }  # fmt: skip


def test_a_listener_hears_the_nodes_with_the_first_reports(peer: Peer, start: Start) -> None:
    node = start(sink="topic")
    node.say(f"made {GUARD} 1000 100")
    node.say(f"made {SECOND} 2000 100")
    node.say("of 1000 2")
    node.say("of 2000 3")
    (batch,) = peer.ask("heard", 5)["batches"]
    assert batch.count("#2,node:/second") == 1
    assert ",node:" not in batch.replace("#2,node:/second", "").split("\n", 1)[1]
    assert peer.ask("set", SETTINGS, sink="rosout") == [[True, ""]]
    node.say("of 1000 2")
    node.say("of 2000 3")
    logs = [log for log in peer.ask("heard", 10)["logs"] if log[3].startswith("threshold_inf")]
    assert sorted(logger for _, _, logger, _ in logs) == ["robot1.guard"] * 2 + ["second"] * 3
    assert node.finish() == 0


def test_reports_go_to_the_graph_that_the_program_has_chosen(
    peer: Peer, start: Start, domain: dict[str, str]
) -> None:
    node = start(chosen_domain=domain["ROS_DOMAIN_ID"], sink="topic")
    node.say("report 2 0")
    assert peer.values(2) == [0, 1]
    assert node.finish() == 0


def test_a_child_of_a_node_writes_to_a_file_alone(peer: Peer, start: Start, tmp_path: Path) -> None:
    node = start(sink="topic")
    node.say("report 2 0")
    assert peer.values(2) == [0, 1]
    node.say("fork 5")
    node.say("report 2 0")
    assert peer.values(4) == [0, 1, 0, 1]
    assert "was forked from a node" in node.errors()
    assert peer.ask("set", SETTINGS, sink="file") == [[True, ""]]
    node.say("fork 5")
    assert node.finish() == 0
    files = list((tmp_path / "reports").iterdir())
    assert sum(len(read(file).events.cmp) for file in files) == 5


@pytest.mark.parametrize("sink", ["auto", "topic"])
def test_a_child_of_a_node_ends_as_it_would_without_reports(start: Start, sink: str) -> None:
    node = start(sink=sink)
    node.say("report 2 0")
    assert node.say("child 5") == "0\n"
    assert node.finish() == 0


@pytest.mark.parametrize("sink", ["topic", "rosout"])
def test_what_waits_is_sent_when_the_node_ends(peer: Peer, start: Start, sink: str) -> None:
    node = start(sink=sink)
    node.say("report 2 0")
    peer.ask("heard", 2)
    node.say("report 7 0")
    node.say("shutdown")
    peer.ask("heard", 9)
    # It goes on after that: the context of the log library is not the program's.
    node.say("report 600 0")
    assert node.finish() == 0
    heard = peer.ask("heard", 609)
    lines = [line for batch in heard["batches"] for line in events(batch)]
    lines += [text for *_, text in heard["logs"] if text.startswith("threshold_information:")]
    assert [compared(line) for line in lines] == [0, 1, *range(7), *range(600)]
    assert node.errors() == ""


def test_no_report_is_lost_in_a_file_when_the_node_is_killed(start: Start, tmp_path: Path) -> None:
    node = start(sink="file")
    node.say("report 20000 0")
    node.process.kill()
    node.process.wait(timeout=PATIENCE_S)
    (file,) = (tmp_path / "reports").iterdir()
    assert file.name.startswith("robot1_guard-")
    assert list(read(file).events.cmp) == list(map(float, range(20000)))


# The program's node has what it needs, and the hidden node comes after it, with the same enclave.
# Ten evaluations alternate, and then five: `light` and `edges` report each, too. What waits for a
# topic when the hidden node turns out not to work is in the file, with the time that it had.
@pytest.mark.parametrize("policy", ["every", "edges", "light"])
@pytest.mark.parametrize("sink", ["topic", "rosout"])
def test_a_hidden_node_without_keys_leaves_the_node_alone(
    start: Start, tmp_path: Path, sink: str, policy: str
) -> None:
    node = start("--ros-args", "--enclave", "/arm", sink=sink, policy=policy, site_cap="0")
    for name, value in (("ENABLE", "true"), ("STRATEGY", "Enforce"), ("KEYSTORE", tmp_path)):
        node.say(f"env ROS_SECURITY_{name} {value}")
    node.say("report 10 0")
    wait_for(lambda: list((tmp_path / "reports").glob("*.tpc")) != [])
    node.say("report 5 0")
    assert node.finish() == 0
    (why,) = node.errors().splitlines()
    assert why.startswith("tpc: no reports are sent on a topic (")
    assert f"{tmp_path}/enclaves/arm" in why
    (file,) = (tmp_path / "reports").iterdir()
    found = read(file)
    reported = [*range(10), *range(5)]
    assert list(found.events.cmp) == reported
    if policy != "every":
        assert sum(found.summaries.count) == len(reported)
    assert (np.diff(found.events.time_ns) >= 0).all()


@pytest.mark.parametrize("sink", ["auto", "rosout"])
def test_without_its_backend_a_node_writes_a_file_and_says_so(
    start: Start, tmp_path: Path, sink: str
) -> None:
    alone = tmp_path / "lib"
    alone.mkdir()
    shutil.copy(prefix() / "lib/libtpc_log.so.0", alone)
    libraries = f"{alone}:{wheels_env()['LD_LIBRARY_PATH']}"
    node = start(libraries=libraries, sink=sink)
    node.say("report 4 0")
    assert node.finish() == 0
    missing = (
        f"{alone}/libtpc_log_ros2.so: cannot open shared object file: No such file or directory"
    )
    assert node.errors() == (
        f"tpc: no reports are sent on a topic ({missing}); they are written to {tmp_path}/reports\n"
    )
    (file,) = (tmp_path / "reports").iterdir()
    assert file.name.startswith("reporter-")
    assert list(read(file).events.cmp) == [0, 1, 2, 3]
