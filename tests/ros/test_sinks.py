"""The sinks that speak ROS on a real graph: what is made is received, or is accounted for.

The nodes are tests/ros/sinks: `reporter` says on its standard output how many reports it made.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from click.testing import CliRunner

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import log_library, prefix, project_root
from pytpc.cli.main import main
from pytpc.ingest.reading import read
from pytpc.ingest.ros1 import decode_log, decode_string
from pytpc.ros.ros1.graph import GraphProcess, RosGraph
from pytpc.ros.ros1.instrumented_nodes import InstrumentedNodes
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.subscriber import RawSubscriber

SOURCES = Path(__file__).parent / "sinks"
TOPIC = "/threshold_information"
BEFORE, AFTER, CHILD, PARENT, THREAD = 1, 2, 3, 4, 100
FIRST_LINE = re.compile(r"#seq:(\d+),count:(\d+),dropped:(\d+),pid:(\d+),steady:\d+\.\d{9}")

try:
    log_library()
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)


def key(number: int) -> str:
    return f"{number:08d}-0000-4000-8000-000000000000"


@pytest.fixture(scope="module")
def nodes(tmp_path_factory) -> Path:
    """The folder of the nodes, built."""
    folder = tmp_path_factory.mktemp("sinks")
    options = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_COMPILER=clang++-19"]
    options.append(f"-DTPC_PREFIX={prefix()}")
    for command in (
        ["cmake", "-S", str(SOURCES), "-B", str(folder), *options],
        ["cmake", "--build", str(folder)],
    ):
        done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=900)
        assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture
def graph(tmp_path) -> Iterator[RosGraph]:
    with RosGraph(dict(os.environ), tmp_path / "graph") as graph:
        yield graph


@dataclass
class Reader:
    """All that came on the topic, taken apart as docs/reference/formats.md says."""

    reports: Counter[str] = field(default_factory=Counter)
    values: dict[str, list[float]] = field(default_factory=dict)
    times: list[float] = field(default_factory=list)
    others: list[str] = field(default_factory=list)
    messages: int = 0
    before: int = 0
    expected: int | None = None
    missing: int = 0
    dropped: int = 0
    pids: set[int] = field(default_factory=set)

    def take(self, text: str) -> None:
        first, *lines = text.split("\n")
        seq, count, self.dropped, pid = map(int, FIRST_LINE.fullmatch(first).groups())
        self.messages += 1
        self.pids.add(pid)
        if self.expected is None:
            self.before = self.expected = seq
        self.missing += seq - self.expected
        self.expected = seq + count
        reports = [line for line in lines if ",threshold_" not in line]
        self.others += [line for line in lines if ",threshold_" in line]
        assert len(reports) == count
        for line in reports:
            stamp, name, _result, cmp, thresh, _res = line.split(",")
            assert re.fullmatch(r"\d+\.\d{7}", stamp) and thresh == "thresh:0.5"
            self.times.append(float(stamp))
            self.reports[name] += 1
            self.values.setdefault(name, []).append(float(cmp.removeprefix("cmp:")))


@contextlib.contextmanager
def subscribed(graph: RosGraph, topic: str = TOPIC) -> Iterator[RawSubscriber]:
    subscriber = RawSubscriber(Master(graph.uri, "/reader"), "127.0.0.1", [topic])
    try:
        yield subscriber
    finally:
        subscriber.close()


def until(
    holds: Callable[[], bool], subscriber: RawSubscriber | None = None, take=None, limit_s=15.0
) -> None:
    """Wait, and take in what comes meanwhile."""
    end = time.monotonic() + limit_s
    while not holds():
        assert time.monotonic() < end, "it does not come"
        if subscriber is None:
            time.sleep(0.02)
        else:
            for _, data in subscriber.poll(0.05):
                take(decode_string(data).decode())


def read_on(subscriber: RawSubscriber, take, seconds: float = 0.3) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for _, data in subscriber.poll(0.05):
            take(decode_string(data).decode())


def start(graph: RosGraph, nodes: Path, *options: str, **env: str) -> GraphProcess:
    """The reporter; after its reports it stays a moment, so that a node's end is no part of a test.

    What is made in the last moment before ros::shutdown may not be sent any more.
    """
    command = [str(nodes / "reporter"), *options, "--stay=0.2"]
    return graph.start("reporter", command, env={"TPC_SINK": "topic", **env})


def ended(process: GraphProcess) -> bool:
    return process.popen.poll() is not None


def made(process: GraphProcess) -> dict[str, int]:
    """What the reporter says that it made."""
    said = process.log.read_text()
    assert process.popen.wait(10) == 0, said
    found = re.search(r"made before=(\d+) running=(\d+) after=(\d+)", said)
    return dict(zip(("before", "running", "after"), map(int, found.groups()), strict=True))


def test_topic_has_every_report_in_order_whoever_made_it(graph, nodes):
    # 16 threads, 200 reports before ros::init: all come; 10 after ros::shutdown: said, not sent.
    reader = Reader()
    with subscribed(graph) as subscriber:
        began = time.time()
        process = start(graph, nodes, "--before=200", "--after=10", "--threads=16", "--rate=8000")
        until(lambda: ended(process), subscriber, reader.take)
        read_on(subscriber, reader.take)
    count = made(process)
    assert count == {"before": 200, "running": 8000, "after": 10}
    assert reader.reports == {key(BEFORE): 200} | {key(THREAD + i): 500 for i in range(16)}
    for values in reader.values.values():
        assert values == [float(i) for i in range(len(values))]
    assert reader.before == reader.missing == reader.dropped == 0
    assert reader.pids == {process.popen.pid}
    assert all(began - 1 < stamp < time.time() + 1 for stamp in reader.times)
    # 8,200 lines of about 85 bytes are ten messages of 64 KiB, and one each 0.2 s at most.
    assert 10 < reader.messages < 20
    assert "tpc: 10 evaluations were not sent on /threshold_information" in process.log.read_text()


def test_what_nobody_listens_to_is_kept_up_to_a_bound_and_the_rest_is_counted(graph, nodes):
    # 100,000 reports before ros::init; the newest 65,536, less up to a block of 4,096, are kept.
    process = start(graph, nodes, "--before=100000", "--rate=100", "--seconds=60", "--flops=1")
    time.sleep(1.0)
    reader = Reader()
    with subscribed(graph) as subscriber:
        until(lambda: reader.reports[key(THREAD)] > 50, subscriber, reader.take)
    graph.stop(process)
    kept = reader.reports[key(BEFORE)]
    assert 61_000 <= kept <= 65_536
    assert reader.dropped == 100_000 - kept and reader.missing == 0
    assert reader.values[key(BEFORE)] == [float(i) for i in range(100_000 - kept, 100_000)]
    # Each of the dropped ones is a flop, but for the first.
    (line,) = reader.others
    assert line.split(",", 1)[1] == (
        f"threshold_dropped:{key(BEFORE)},count:{100_000 - kept},flops:{100_000 - kept - 1}"
        ",why:stopped"
    )


def test_slow_killed_and_new_subscribers_do_not_hold_a_node_up(graph, nodes):
    script = (
        "import sys\nfrom pytpc.ros.ros1.master import Master\n"
        "from pytpc.ros.ros1.subscriber import RawSubscriber\n"
        "s = RawSubscriber(Master(*sys.argv[1:]), '127.0.0.1', ['/threshold_information'])\n"
        "while True:\n"
        "    for _ in s.poll(1.0): pass\n"
    )
    path = {"PYTHONPATH": str(project_root())}
    argv = [sys.executable, "-c", script, graph.uri]
    slow, killed = (graph.start(n, [*argv, f"/{n}"], env=path) for n in ("slow", "killed"))
    reader = Reader()
    with subscribed(graph) as subscriber:
        process = start(graph, nodes, "--rate=5000", "--seconds=3")
        until(lambda: reader.messages > 5, subscriber, reader.take)
        slow.popen.send_signal(signal.SIGSTOP)
        killed.popen.kill()
        until(lambda: ended(process), subscriber, reader.take)
        read_on(subscriber, reader.take)
        slow.popen.send_signal(signal.SIGCONT)
    # The reader that is neither slow nor killed has everything, whoever was connected first.
    assert made(process)["running"] == reader.reports[key(THREAD)] == 15_000
    assert reader.before == reader.missing == 0


def test_loss_towards_a_stopped_subscriber_is_seen_in_the_numbers(graph, nodes):
    # roscpp keeps 512 messages of about 50 KB for it, which are full after some 5 s of 5 MB each;
    # the kernel has some MiB more.
    reader = Reader()
    with subscribed(graph) as subscriber:
        process = start(graph, nodes, "--rate=60000", "--seconds=8", "--stay=60")
        until(lambda: reader.messages > 0, subscriber, reader.take)
        time.sleep(8.5)
        # What was kept for it is tens of megabytes, which take a busy machine a while.
        until(lambda: accounted(reader) >= 480_000, subscriber, reader.take, limit_s=45.0)
        graph.stop(process)
    assert made(process)["running"] == 480_000
    assert reader.missing > 10_000
    assert accounted(reader) == 480_000


def accounted(reader: Reader) -> int:
    """The reports of the thread that came, that are known to be missing, and that were dropped."""
    return reader.reports[key(THREAD)] + reader.missing + reader.dropped


def test_what_a_node_cannot_send_at_its_end_is_said(graph, nodes):
    # 100,000 a second: what is made after the last turn before ros::shutdown is not sent.
    reader = Reader()
    with subscribed(graph) as subscriber:
        process = start(graph, nodes, "--rate=100000", "--stay=0", "--after=3")
        until(lambda: ended(process), subscriber, reader.take)
        read_on(subscriber, reader.take)
    total = sum(made(process).values())
    unsent = int(re.search(r"tpc: (\d+) evaluations were not sent", process.log.read_text())[1])
    assert unsent >= 3
    assert total - 10_000 < reader.reports.total() + reader.dropped + unsent <= total


@pytest.mark.parametrize("sink", ["topic", "rosout"])
def test_forked_child_ends_and_its_reports_are_said_to_be_missing(graph, nodes, sink):
    reader = Reader()
    with subscribed(graph) as subscriber:
        process = start(graph, nodes, "--fork=100", "--rate=100", TPC_SINK=sink)
        until(lambda: ended(process), subscriber, reader.take)
        read_on(subscriber, reader.take)
    assert made(process)["running"] == 100
    if sink == "topic":
        assert reader.reports == {key(THREAD): 100, key(PARENT): 1}
    said = process.log.read_text()
    assert "child ended with 0" in said
    assert said.count("was forked from a node: its reports do not reach") == 1


def test_forked_child_goes_on_with_what_its_parent_was_set_to(graph, nodes, tmp_path):
    graph.call("setParam", "/tpc/sink", "file")
    folder = str(tmp_path / "log")
    options = ("--fork=100", "--fork-wait=1.5")
    process = start(graph, nodes, *options, TPC_SINK="off", TPC_FOLDER=folder)
    until(lambda: ended(process))
    assert made(process)["running"] == 100
    said = process.log.read_text()
    assert "child ended with 0" in said and "forked from a node" not in said
    assert len(list((tmp_path / "log").glob("*.tpc"))) == 2


def rosout(graph: RosGraph, texts: list[str], process: GraphProcess, subscriber) -> None:
    def take_all() -> None:
        for _, data in subscriber.poll(0.05):
            log = decode_log(data)
            if log.node == b"/reporter" and log.msg.startswith(b"threshold_"):
                texts.append(log.msg.decode())

    while not ended(process):
        take_all()
    end = time.monotonic() + 0.3
    while time.monotonic() < end:
        take_all()


def test_rosout_has_the_thesis_lines(graph, nodes):
    texts: list[str] = []
    with subscribed(graph, "/rosout") as subscriber:
        process = start(graph, nodes, "--rate=1000", "--after=7", "--flops=1", TPC_SINK="rosout")
        rosout(graph, texts, process, subscriber)
    assert made(process)["running"] == 1000
    # The first ones may be made before the node is connected, and the last ones may still be in
    # roscpp's queue when it shuts down.
    assert len(texts) > 500
    for line in texts:
        number = int(re.search(r"cmp:(\d+)", line)[1])
        odd = number % 2
        assert line == (
            f"threshold_information:{key(THREAD)},{odd},cmp:{number},thresh:0.5,res:{odd}"
        )
    said = process.log.read_text()
    assert "tpc: 7 evaluations were not sent on /rosout" in said
    assert "threshold_information" not in said, "nothing on the console"


# The handler of a node may shut it down while its thread is inside a report, and then waits for
# roscpp's threads. Under the sink `rosout`, a report inside roscpp's console crashed a quarter of
# such nodes.
@pytest.mark.parametrize(
    ("sink", "policy"),
    [("rosout", "every"), ("topic", "every"), ("auto", "light"), ("file", "edges")],
)
def test_a_handler_that_shuts_the_node_down_may_interrupt_a_report(
    graph, nodes, tmp_path, sink, policy
):
    env = {"TPC_SINK": sink, "TPC_POLICY": policy, "TPC_FOLDER": str(tmp_path / "files")}
    with subscribed(graph, TOPIC if sink == "topic" else "/rosout") as subscriber:
        for turn in range(8):
            process = graph.start(f"turn{turn}", [str(nodes / "interrupted")], env=env)
            until(lambda: "ready" in process.log.read_text())  # noqa: B023
            end = time.monotonic() + 0.05 + 0.06 * turn
            while time.monotonic() < end:
                subscriber.poll(0.02)
            process.popen.send_signal(signal.SIGINT)
            assert process.popen.wait(30) == 0, process.log.read_text()


@pytest.fixture
def pytpc(graph, monkeypatch) -> Callable[..., tuple[int, str]]:
    monkeypatch.setenv("ROS_MASTER_URI", graph.uri)

    def run(*arguments: str) -> tuple[int, str]:
        result = CliRunner().invoke(main, [*arguments])
        return result.exit_code, result.output

    return run


def status_of(pytpc, *arguments: str) -> dict:
    code, output = pytpc("sink", "--json", *arguments)
    assert code == 0, output
    (found,) = json.loads(output)
    return found


def advertised(graph: RosGraph, node: str = "/reporter") -> bool:
    services = [name for name, _ in graph.call("getSystemState")[2]]
    return f"{node}/tpc/reload" in services


def test_sinks_are_changed_while_the_node_runs(graph, nodes, pytpc, tmp_path):
    folder = tmp_path / "a folder"
    reader = Reader()
    with subscribed(graph) as subscriber:
        env = {"TPC_FOLDER": str(folder)}
        process = start(graph, nodes, "--rate=1000", "--seconds=60", **env)
        until(lambda: advertised(graph))
        until(lambda: reader.messages > 3, subscriber, reader.take)
        assert status_of(pytpc)["values"]["sink"] == "topic"
        found = status_of(pytpc, "reporter", "--sink", "file")
        assert found["values"]["file"].startswith(str(folder))
        read_on(subscriber, reader.take)
        at_file = reader.messages
        read_on(subscriber, reader.take)
        assert reader.messages == at_file
        (file,) = folder.glob("*.tpc")
        assert status_of(pytpc, "--sink", "topic")["values"]["sink"] == "file", "/tpc is weaker"
        assert status_of(pytpc, "/reporter", "--clear")["values"]["sink"] == "topic"
        until(lambda: reader.messages > at_file + 3, subscriber, reader.take)
        assert status_of(pytpc, "--sink", "off")["values"]["sink"] == "off"
        found = status_of(pytpc, "--sink", "rosout", "--policy", "edges", "--period", "0.5")
        assert (found["values"]["sink"], found["values"]["policy"]) == ("rosout", "edges")
        assert float(found["values"]["period"]) == 0.5
        assert not ended(process)
        # All that was made while the topic was chosen came: what waited was sent at each change.
        assert reader.missing == 0
    assert file.stat().st_size > 4096
    assert graph.stop(process) == 0


def test_many_changes_under_load_lose_nothing_of_the_topic(graph, nodes, tmp_path):
    control = InstrumentedNodes(graph.uri)
    reader = Reader()
    sinks = ("file", "topic", "off", "topic", "rosout", "topic")
    with subscribed(graph) as subscriber:
        options = ("--threads=16", "--rate=16000", "--seconds=60")
        process = start(graph, nodes, *options, TPC_FOLDER=str(tmp_path))
        until(lambda: advertised(graph))
        for turn in range(30):
            control.set("/reporter", {"sink": sinks[turn % 6]})
            policy = "edges" if turn % 4 == 0 else "every"
            control.set("/reporter", {"policy": policy})
            status = control.reload("/reporter")
            assert status.success and status.values["sink"] == sinks[turn % 6], status
            read_on(subscriber, reader.take, 0.05)
        read_on(subscriber, reader.take)
        assert not ended(process)
        assert graph.stop(process) == 0
    assert reader.missing == 0 and reader.messages > 10
    for values in reader.values.values():
        assert values == sorted(set(values))


def test_parameters_hold_from_the_start_and_wrong_ones_get_a_warning(graph, nodes, pytpc):
    # `off` in YAML is false: what rosparam makes of it.
    graph.call("setParam", "/tpc/sink", False)
    graph.call("setParam", "/reporter/tpc", {"period": "often", "perod": 1, "site_cap": [1]})
    process = start(graph, nodes, "--rate=100", "--seconds=60")
    until(lambda: advertised(graph))
    code, output = pytpc("sink", "--json")
    assert code == 1
    (found,) = json.loads(output[: output.rindex("]") + 1])
    assert found["values"]["sink"] == "off" and not found["success"]
    said = process.log.read_text()
    for name in ("/reporter/tpc/period is ignored", "/reporter/tpc/site_cap is ignored"):
        assert f"tpc: the parameter {name}" in said
    assert "tpc: there is no setting perod (/reporter/tpc/perod)" in said
    graph.call("setParam", "/tpc", 3)
    graph.call("deleteParam", "/reporter/tpc")
    code, output = pytpc("sink", "/reporter")
    assert code == 1 and "/tpc is not a namespace of parameters and is ignored" in output
    code, output = pytpc("sink", "/other")
    assert code == 1 and output.strip().endswith(
        "/other is not a running instrumented node; there are /reporter"
    )
    assert graph.stop(process) == 0
    code, output = pytpc("sink")
    assert code == 1 and "no instrumented node is running" in output


# Whoever reaches the master can set parameters: a node that runs as root must not write where
# they say.
def test_parameters_do_not_decide_where_files_go(graph, nodes, pytpc, tmp_path):
    graph.call("setParam", "/tpc", {"folder": str(tmp_path / "theirs"), "sink": "file"})
    graph.call("setParam", "/reporter/tpc", {"file_limit": 0, "file_reserve": 0})
    ours = tmp_path / "ours"
    process = start(graph, nodes, "--rate=100", "--seconds=60", TPC_FOLDER=str(ours))
    until(lambda: advertised(graph))
    for _ in range(3):
        code, output = pytpc("sink")
        assert code == 1 and "only the environment of the node sets it (TPC_FOLDER)" in output
    assert graph.stop(process) == 0
    assert not (tmp_path / "theirs").exists() and len(list(ours.glob("*.tpc"))) == 1
    said = process.log.read_text()
    for name in ("/tpc/folder", "/reporter/tpc/file_limit", "/reporter/tpc/file_reserve"):
        assert said.count(f"tpc: the parameter {name} is ignored: only the environment") == 1


def test_two_nodelets_share_one_sink_and_one_service(graph, nodes, pytpc):
    reader = Reader()
    with subscribed(graph) as subscriber:
        process = graph.start("manager", [str(nodes / "manager")], env={"TPC_SINK": "topic"})
        until(lambda: advertised(graph, "/manager"))
        wanted = (key(1), key(2))
        until(lambda: min(reader.reports[k] for k in wanted) > 20, subscriber, reader.take)
        assert status_of(pytpc)["node"] == "/manager"
        assert len(reader.pids) == 1 and reader.missing == 0
        assert status_of(pytpc, "--sink", "off")["values"]["sink"] == "off"
    assert graph.stop(process) == 0


# A handle completes a name with its own namespace, the node with its name. What roscpp refuses
# is no name. Each comes once to a file, and again and again to those who may listen later.
@pytest.mark.parametrize("sink", ["file", "topic", "rosout"])
def test_names_of_parameters_are_those_of_roscpp(graph, nodes, tmp_path, sink):
    expected = [f"{key(1)},/first/limit", f"{key(1)},/manager/shared"]
    expected += [f"{key(2)},/manager/shared", f"{key(2)},/second/limit"]
    env = {"TPC_SINK": sink, "TPC_FOLDER": str(tmp_path)}
    with subscribed(graph, "/rosout" if sink == "rosout" else TOPIC) as subscriber:
        texts: list[str] = []

        def names() -> list[str]:
            found = [re.findall("threshold_name:(.*)", text) for text in texts]
            return sorted(name for some in found for name in some)

        process = graph.start("manager", [str(nodes / "manager")], env=env)
        if sink == "file":
            until(lambda: any(tmp_path.glob("*.tpc")))
            until(lambda: len(read(next(tmp_path.glob("*.tpc"))).names) == len(expected))
        else:
            decode = decode_log if sink == "rosout" else decode_string
            end = time.monotonic() + 20
            while len(set(names())) < len(expected):
                assert time.monotonic() < end, texts
                for _, data in subscriber.poll(0.1):
                    got = decode(data)
                    texts.append((got if isinstance(got, bytes) else got.msg).decode())
        process.popen.send_signal(signal.SIGINT)
        process.popen.wait(10)
    if sink == "file":
        recording = read(next(tmp_path.glob("*.tpc")))
        assert [f"{one.key},{one.name}" for one in recording.names] == expected
        assert {one.node for one in recording.names} == {"/manager"}
    else:
        assert sorted(set(names())) == expected


def master_of(graph: RosGraph) -> int:
    return int(graph.call("getPid"))


def test_node_lives_on_when_the_master_is_killed_started_again_or_hangs(graph, nodes, pytpc):
    reader = Reader()
    with subscribed(graph) as subscriber:
        process = start(graph, nodes, "--rate=1000", "--seconds=4", "--flops=1")
        until(lambda: advertised(graph))
        until(lambda: reader.messages > 5, subscriber, reader.take)
        master = master_of(graph)
        os.kill(master, signal.SIGSTOP)
        read_on(subscriber, reader.take, 0.5)
        os.kill(master, signal.SIGCONT)
        os.kill(master, signal.SIGKILL)
        code, output = pytpc("sink")
        assert code == 1 and "is roscore running, and is ROS_MASTER_URI right?" in output
        port = graph.uri.rsplit(":", 1)[1]
        graph.start("master2", ["rosmaster", "--core", "-p", port])
        until(lambda: ended(process), subscriber, reader.take)
        read_on(subscriber, reader.take)
    # What is connected stays connected.
    assert made(process)["running"] == reader.reports[key(THREAD)] == 4000


def test_clock_that_jumps_back_is_written_as_it_is(tmp_path, nodes):
    script = (
        "import rospy, sys\nfrom rosgraph_msgs.msg import Clock\n"
        "rospy.init_node('clock', disable_rosout=True)\n"
        "p = rospy.Publisher('/clock', Clock, queue_size=1, latch=True)\n"
        "import time\n"
        "for start in (500.0, 100.0):\n"
        "    for i in range(100):\n"
        "        p.publish(rospy.Time.from_sec(start + i / 100))\n"
        "        time.sleep(0.01)\n"
    )
    reader = Reader()
    with RosGraph(dict(os.environ), tmp_path / "graph", use_sim_time=True) as graph:
        with subscribed(graph) as subscriber:
            process = start(graph, nodes, "--before=5", "--rate=500", "--seconds=4")
            until(lambda: reader.messages > 3, subscriber, reader.take)
            graph.start("clock", ["/usr/bin/python3", "-c", script])
            until(lambda: ended(process), subscriber, reader.take)
            read_on(subscriber, reader.take)
        assert made(process)["running"] == 2000
    assert reader.reports[key(BEFORE)] == 5 and reader.missing == 0
    # Before ros::init and before the first /clock the time is not known: 0.
    assert set(reader.times[:50]) == {0.0}
    known = [t for t in reader.times if t]
    assert known == sorted(known, key=lambda t: t < 200) and max(known) > 500
    assert min(known) >= 100.0 and known[-1] == pytest.approx(100.99, abs=0.02)


def relay(graph: RosGraph) -> GraphProcess:
    """The relay, started by a launch file as docs/how-to/record.md says."""
    launch = graph.folder / "relay.launch"
    launch.write_text(
        "<launch><node pkg='rosout' type='rosout' name='passer' output='screen'"
        f" launch-prefix='{sys.executable} -m pytpc relay'/></launch>"
    )
    path = ":".join(part for part in (str(project_root()), os.environ.get("PYTHONPATH")) if part)
    process = graph.start("roslaunch", ["roslaunch", str(launch)], env={"PYTHONPATH": path})
    until(lambda: "passing on" in process.log.read_text())
    return process


def test_relay_passes_on_and_a_bag_of_both_topics_has_each_report_once(graph, nodes, tmp_path):
    passer = relay(graph)
    bag, status = tmp_path / "both.bag", tmp_path / "status.json"
    command = [sys.executable, "-m", "pytpc.ros.ros1.recorder"]
    command += ["--bag", str(bag), "--status", str(status), "--parent", str(os.getpid())]
    path = {"PYTHONPATH": str(project_root())}
    recorder = graph.start("recorder", [*command, "/rosout", TOPIC], env=path, patience_s=15.0)
    until(lambda: status.exists() and json.loads(status.read_text())["ready"])
    process = start(graph, nodes, "--rate=2000", "--wait=1", "--stay=1", TPC_SINK="rosout")
    until(lambda: ended(process))
    time.sleep(0.5)
    assert graph.stop(recorder) == 0, recorder.log.read_text()
    graph.stop(passer)
    assert "2,000 reports passed on\n" in passer.log.read_text()
    assert json.loads(status.read_text())["messages"][TOPIC] == 2000
    recording = read(bag)
    assert len(recording.events) == made(process)["running"] == 2000
    assert recording.events.cmp.tolist() == [float(i) for i in range(2000)]
    assert recording.malformed == 0 and recording.lost == {}
    assert "2,000 reports on /threshold_information with keys" in " ".join(recording.notes)


def test_relay_registers_again_with_a_master_that_was_started_again(graph, nodes):
    passer = relay(graph)
    os.kill(master_of(graph), signal.SIGKILL)
    until(lambda: "waiting for the master" in passer.log.read_text())
    graph.start("master2", ["rosmaster", "--core", "-p", graph.uri.rsplit(":", 1)[1]])
    until(lambda: "registered with it" in passer.log.read_text())
    lines: list[str] = []
    with subscribed(graph) as subscriber:
        process = start(graph, nodes, "--rate=100", "--stay=1", TPC_SINK="rosout")
        until(lambda: ended(process), subscriber, lines.append)
    assert len(lines) > 50
    last = re.escape(f",{key(THREAD)},0,cmp:99,thresh:0.5,res:0")
    assert re.fullmatch(rf"\d{{10}}\.\d{{7}}{last}", lines[-1])
