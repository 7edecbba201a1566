"""Several nodes in one process on rclcpp: each has its reports, flops, names and parameters."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path

import pytest
from click.testing import CliRunner

from patience import PATIENCE_S, wait_for
from pytpc.api.live_reports import Reports
from pytpc.cli.main import main
from pytpc.diagnosis.full_names import with_full_names
from pytpc.diagnosis.results.live import Seen
from pytpc.ingest.decoders import ROS2
from pytpc.ingest.reading import read
from pytpc.recording.mission import Recording
from pytpc.ros.ros2.marking import encode_string
from pytpc.ros.source import Source
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import base_key, resolved
from pytpc.static.static_info import collect
from ros2_dialogue import Peer, events
from ros2_graph import needs_backend, ros2_env
from ros2_rclcpp import ROS, compile_on_rclcpp, needs_rclcpp, rclcpp_env, ros_python

HERE = Path(__file__).parent
CONTAINER = "/cell/holder"
FRONT, REAR, FILTERED = "/cell/front", "/cell/rear", "/cell/filtered"
COMPONENTS = "cell::Gauge", "cell::Filtered", "cell::Pump"

pytestmark = [needs_rclcpp, needs_backend]


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A package of components as ament installs it, beside its static information."""
    folder = tmp_path_factory.mktemp("cell")
    compile_on_rclcpp(HERE / "cell.cpp", folder / "libcell.so", "-shared", "-lclass_loader")
    index = folder / "share/ament_index/resource_index/rclcpp_components/cell"
    index.parent.mkdir(parents=True)
    index.write_text("".join(f"{kind};libcell.so\n" for kind in COMPONENTS))
    return folder


@pytest.fixture(scope="module")
def two_gauges(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("gauges")
    return compile_on_rclcpp(HERE / "cell.cpp", folder / "gauges", "-DMAIN")


Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def start(domain: dict[str, str], tmp_path: Path) -> Iterator[Start]:
    """Start a program with words of its command line and settings (``sink="file"``)."""
    started: list[subprocess.Popen[str]] = []

    def run(program: Path, *words: str, ament: Path | None = None, **settings: str):
        env = {**rclcpp_env(), "TPC_FOLDER": str(tmp_path / "m"), "TPC_POLICY": "every"}
        env |= {f"TPC_{name.upper()}": value for name, value in settings.items()}
        if ament is not None:
            env["AMENT_PREFIX_PATH"] += f":{ament}"
        with (tmp_path / "said").open("w") as said:
            process = subprocess.Popen(
                [str(program), *words],
                env=ros2_env(domain, **env),
                stdout=subprocess.DEVNULL,
                stderr=said,
                text=True,
            )
        started.append(process)
        return process

    yield run
    for process in started:
        process.kill()
        process.wait(timeout=PATIENCE_S)


@pytest.fixture
def peer(domain: dict[str, str], tmp_path: Path) -> Iterator[Peer]:
    words = [str(ros_python()), str(HERE / "peer.py")]
    one = Peer(words, ros2_env(domain, **rclcpp_env()), tmp_path / "peer.err")
    yield one
    one.process.kill()
    one.process.communicate()


def hold(
    start: Start, cell: Path, kind: str = "_mt", *more: str, **settings: str
) -> subprocess.Popen[str]:
    """A container, remapped as launch does it."""
    assert ROS is not None
    container = ROS / f"lib/rclcpp_components/component_container{kind}"
    words = ["--ros-args", "-r", "__node:=holder", "-r", "__ns:=/cell"]
    return start(container, *words, *more, ament=cell, **settings)


def load(peer: Peer, kind: str, name: str, **values: float) -> int:
    number, wrong = peer.ask("load", CONTAINER, f"cell::{kind}", name, "/cell", **values)
    assert wrong == ""
    return int(number)


def load_all(peer: Peer) -> None:
    load(peer, "Gauge", "front")
    load(peer, "Gauge", "rear", **{"limits.low": 7.5})
    load(peer, "Filtered", "filtered")
    load(peer, "Pump", "pump", listeners=3)


def compared(recording: Recording, static: Path) -> dict[tuple[str, str], list[float]]:
    """The compared values, by node and full name of the parameter."""
    events = recording.events
    found: dict[tuple[str, str], list[float]] = {}
    sources = {
        one.key: one.source
        for one in with_full_names(collect(static), recording, {}).comparisons.values()
    }
    for key, node, cmp in zip(events.key, events.node, events.cmp, strict=True):
        name = resolved(sources[events.keys[key]] or "", events.nodes[node])
        if not name.endswith("/listeners"):
            found.setdefault((events.nodes[node], name), []).append(float(cmp))
    return {pair: sorted(values) for pair, values in found.items()}


# The pump sends 0 to 9.
PRESSURES = [float(each) for each in range(10)]
WANTED = {
    (FRONT, f"{FRONT}/limits.low"): PRESSURES,
    (REAR, f"{REAR}/limits.low"): PRESSURES,
    (FILTERED, f"{FILTERED}/by.high"): PRESSURES,
    (FILTERED, f"{FILTERED}/by.least"): PRESSURES,
}


def wait_for_reports(folder: Path, static: Path, count: int) -> None:
    """Wait until so many of the pressures are in the files of reports."""
    pressures = [one.key for one in collect(static).comparisons.values() if is_pressure(one)]

    def has_all() -> bool:
        if not list(folder.glob("*.tpc")):
            return False
        events = read(folder).events
        keys = [base_key(events.keys[code]) for code in events.key]
        return sum(key in pressures for key in keys) >= count

    wait_for(has_all)


def is_pressure(comparison: Comparison) -> bool:
    """Not the pump's: it counts its listeners, as often as it takes."""
    return comparison.source is not None and not comparison.source.endswith("listeners")


def end(process: subprocess.Popen[str]) -> None:
    process.terminate()
    process.wait(timeout=PATIENCE_S)


@pytest.mark.parametrize("kind", ["", "_mt", "_isolated"])
def test_components_are_told_apart(
    cell: Path, peer: Peer, start: Start, tmp_path: Path, kind: str
) -> None:
    container = hold(start, cell, kind, sink="file")
    load_all(peer)
    wait_for_reports(tmp_path / "m", cell / "static", 40)
    # The container is one process: it has one place for its settings.
    assert peer.ask("get", f"{CONTAINER}/_tpc", "sink") == ["file"]
    end(container)
    recording = read(tmp_path / "m")
    assert compared(recording, cell / "static") == WANTED
    events = recording.events
    # Above 4.5 from 5 on, and above 7.5 from 8 on.
    thresholds = {
        (events.nodes[node], thresh, result)
        for node, thresh, result, cmp in zip(
            events.node, events.thresh, events.result, events.cmp, strict=True
        )
        if cmp in {5.0, 8.0} and events.nodes[node] in {FRONT, REAR}
    }
    assert thresholds == {
        (FRONT, 4.5, True), (REAR, 7.5, False), (REAR, 7.5, True),
    }  # fmt: skip
    words = ["rank", str(tmp_path / "m"), "--static", str(cell / "static"), "--json"]
    at = str((recording.end_ns - recording.start_ns) / 1e9 + 1)
    result = CliRunner().invoke(main, [*words, "--at", at, "--score", "thesis"])
    assert result.exit_code == 0, result.output
    (ranking,) = json.loads(result.output)
    ranked = {one["parameter"] for one in ranking["suspects"]}
    assert {name for _, name in WANTED} <= ranked


# As docs/reference/runtime.md says: settings apply to the whole process, and a component has none.
def test_the_settings_of_a_container_are_those_of_its_components(
    cell: Path, peer: Peer, start: Start, tmp_path: Path
) -> None:
    container = hold(start, cell, sink="off")
    load(peer, "Gauge", "front")
    load(peer, "Gauge", "rear")
    # The hidden node comes with the first comparison.
    load(peer, "Pump", "first", listeners=2)
    settings = f"{CONTAINER}/_tpc"
    hidden = [one for one in peer.ask("nodes", settings) if one.endswith("/_tpc")]
    assert hidden == [settings]
    assert peer.ask("set", settings, sink="file") == [[True, ""]]
    load(peer, "Pump", "pump", listeners=2)
    wait_for_reports(tmp_path / "m", cell / "static", 20)
    end(container)
    found = compared(read(tmp_path / "m"), cell / "static")
    assert found == {(node, f"{node}/limits.low"): PRESSURES for node in (FRONT, REAR)}


@pytest.mark.parametrize("sink", ["topic", "rosout", "auto"])
def test_a_listener_hears_the_nodes(cell: Path, peer: Peer, start: Start, sink: str) -> None:
    hold(start, cell, sink=sink)
    load_all(peer)
    heard = peer.ask("heard", 40)
    nodes = {}
    if sink == "rosout":
        for _, _, logger, text in heard["logs"]:
            if text.startswith("threshold_information:"):
                nodes.setdefault(text.split(":")[1].split(",")[0], set()).add(logger)
        assert {frozenset(found) for found in nodes.values()} >= {
            frozenset({name.replace("/", ".")[1:]}) for name in (FRONT, REAR, FILTERED)
        }
        return
    reports = Reports(ROS2)
    source = Source("/threshold_information", "", "std_msgs/msg/String", "", "")
    for batch in heard["batches"]:
        for item in reports.read(source, encode_string(batch), 0.0):
            if isinstance(item, Seen):
                nodes.setdefault(item.key, set()).add(item.node)
    assert reports.malformed == 0
    # Each from the first report on; two comparisons are those of the filter.
    assert sorted(map(sorted, nodes.values())) == [
        [FILTERED], [FILTERED], [FRONT], ["/cell/pump"], [REAR],
    ]  # fmt: skip


CLOCK = """\
import rclpy, time
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
rclpy.init()
node = Node("clock")
publisher = node.create_publisher(Clock, "/clock", 1)
for tick in range(1000000):
    message = Clock()
    message.clock.sec, message.clock.nanosec = 1000 + tick // 100, tick % 100 * 10**7
    publisher.publish(message)
    time.sleep(0.01)
"""


# Simulated time begins at 1000 s, and no test takes a day. Until the first message on /clock, the
# time of a component is 0, and that of a container is not known to be simulated.
@pytest.mark.parametrize("way", ["component file", "component topic", "container file"])
def test_reports_of_a_container_have_simulated_time(
    cell: Path, peer: Peer, start: Start, tmp_path: Path, way: str
) -> None:
    whose, sink = way.split()
    clock = tmp_path / "clock.py"
    clock.write_text(CLOCK)
    start(ros_python(), str(clock))
    more = ("-p", "use_sim_time:=true") if whose == "container" else ()
    values = {"use_sim_time": True} if whose == "component" else {}
    hold(start, cell, "", *more, sink=sink)
    load(peer, "Gauge", "front", **values)

    def has_time(turn: int) -> bool:
        """Whether the pressures of one more pump have it; those before may stand after them."""
        load(peer, "Pump", f"pump{turn}", listeners=1, **values)
        if sink == "file":
            wait_for_reports(tmp_path / "m", cell / "static", 10 * turn)
            found = [time_ns / 1e9 for time_ns in read(tmp_path / "m").events.time_ns]
        else:
            heard = peer.ask("heard", 11 * turn)["batches"]
            found = [float(line.split(",")[0]) for batch in heard for line in events(batch)]
        return sum(1000 <= time < 1000 + 86400 for time in found) >= 10

    turns = count(1)
    wait_for(lambda: has_time(next(turns)))


def test_a_component_that_is_loaded_again_is_another_one(
    cell: Path, peer: Peer, start: Start, tmp_path: Path
) -> None:
    container = hold(start, cell, sink="file")
    for turn, name in enumerate(("front", "rear"), 1):
        number = load(peer, "Gauge", name)
        pump = load(peer, "Pump", f"pump{turn}", listeners=1)
        wait_for_reports(tmp_path / "m", cell / "static", 10 * turn)
        # What is made next may get the same memory.
        for one in (pump, number):
            assert peer.ask("unload", CONTAINER, one)
    end(container)
    found = compared(read(tmp_path / "m"), cell / "static")
    assert found == {pair: WANTED[pair] for pair in WANTED if pair[0] in {FRONT, REAR}}


def test_two_nodes_of_a_program_are_told_apart(
    two_gauges: Path, peer: Peer, start: Start, tmp_path: Path
) -> None:
    gauges = start(two_gauges, "--ros-args", "-r", "__ns:=/cell", sink="file")
    static = two_gauges.parent / "static"
    left, right = "/cell/left", "/cell/right"
    wait_for_reports(tmp_path / "m", static, 20)
    # The first one names the process.
    assert peer.ask("get", f"{left}/_tpc", "sink") == ["file"]
    end(gauges)
    found = compared(read(tmp_path / "m"), static)
    assert found == {(node, f"{node}/limits.low"): PRESSURES for node in (left, right)}
