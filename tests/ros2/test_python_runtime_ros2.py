"""Nodes of rclpy on a real graph: what they report is received or read."""

from __future__ import annotations

import json
import signal
import subprocess
from collections.abc import Iterator

import pytest

from patience import wait_for
from pytpc.ingest.reading import read
from ros2_graph import PYTHON, ros2_env
from ros2_reporting import KEY, Listener, Program, ended


@pytest.fixture(scope="module")
def listener(
    domain: dict[str, str], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Listener]:
    found = Listener(domain, tmp_path_factory.mktemp("listener"))
    yield found
    found.end()


# 15,000 reports at 5,000 a second.
def test_every_report_arrives_in_order(domain, tmp_path, listener):
    text = """
rclpy.init()
node = Node("fast", namespace="/robot1")
for number in range(15000):
    high(float(number))
    if number % 50 == 49:
        time.sleep(0.01)
node.destroy_node()
rclpy.shutdown()
"""
    done = Program(tmp_path, domain, text).run(TPC_SINK="topic", TPC_POLICY="every")
    assert (done.returncode, done.stderr) == (0, "")
    wait_for(lambda: len(listener.values("/robot1/fast")) >= 15000)
    assert listener.values("/robot1/fast") == [float(number) for number in range(15000)]
    batches = listener.batches("/robot1/fast")
    assert {batch.head["dropped"] for batch in batches} == {"0"}
    first = 0
    for batch in batches:
        assert int(batch.head["seq"]) == first
        first += len(batch.lines)
    times = [float(line.split(",")[0]) for batch in batches for line in batch.lines]
    assert times == sorted(times)


def test_rosout(domain, tmp_path, listener):
    text = """
rclpy.init()
node = Node("talker", namespace="/robot1")
for number in range(100):
    high(float(number))
rclpy.shutdown()
"""
    done = Program(tmp_path, domain, text).run(TPC_SINK="rosout")
    assert (done.returncode, done.stderr) == (0, "")
    wait_for(lambda: len(listener.logs("robot1.talker")) >= 100)
    logs = listener.logs("robot1.talker")
    assert [message for message, _, _ in logs] == [
        f"threshold_information:{KEY},{number > 6.5},cmp:{number},thresh:6.5,res:{number > 6.5}"
        for number in range(100)
    ]
    # INFO of rcl_interfaces/msg/Log.
    assert {level for _, _, level in logs} == {20}
    times = [int(at) for _, at, _ in logs]
    assert times == sorted(times)


# 2,000 evaluations, two outcomes in turn every 100: 0 to 9 are the flops. The program ends when it
# was heard: what is not heard goes to a file.
def test_the_default_sends_flops_and_summaries(domain, tmp_path, listener):
    text = """
rclpy.init()
node = Node("usual")
for number in range(2000):
    high(float(number // 100 % 2 * 10))
    time.sleep(0.001)
sys.stdin.read()
"""
    process = Program(tmp_path, domain, text).start()

    def counted() -> int:
        lines = [line for batch in listener.batches("/usual") for line in batch.lines]
        return sum(int(line.split(",")[4]) for line in lines if line.startswith("~"))

    wait_for(lambda: counted() > 0)
    done = ended(process)
    assert (done.returncode, done.stderr) == (0, "")
    wait_for(lambda: counted() >= 2000)
    assert counted() == 2000
    # The first evaluation, and 19 flops, of which at most 10 in a second are told.
    assert 10 <= len(listener.values("/usual")) <= 20


def test_names_with_remapping(domain, tmp_path, listener):
    text = """
rclpy.init()
node = Node("guard")
high(7.0)
print(node.get_fully_qualified_name())
others = lambda: [space for name, space in node.get_node_names_and_namespaces() if name == "_tpc"]
until(others)
print(others())
"""
    program = Program(tmp_path, domain, text)
    words = ("--ros-args", "-r", "__node:=scout", "-r", "__ns:=/robot2/arm")
    done = program.run(*words, TPC_SINK="topic")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "/robot2/arm/scout\n['/robot2/arm/scout']\n"
    wait_for(lambda: listener.values("/robot2/arm/scout") == [7.0])
    assert program.run(*words, TPC_SINK="file").returncode == 0
    (file,) = program.reports.glob("*.tpc")
    assert file.name.startswith("robot2_arm_scout-")
    assert read([file]).events.nodes == ("/robot2/arm/scout",)


CELL = """
rclpy.init()
class Guard(Node):
    def __init__(self, name):
        super().__init__(name, namespace="/cell")
    def hear(self, value):
        return high(value)
class Filter:
    def __init__(self, node):
        self._node = node
    def hear(self, value):
        return (lambda: high(value))()
guards = [Guard("front"), Guard("rear"), Filter(Node("filtered", namespace="/cell"))]
for step in range(30):
    for at, guard in enumerate(guards):
        guard.hear(float(step + 100 * at))
    if step % 10 == 9:
        time.sleep(0.3)
high(1000.0)
rclpy.shutdown()
"""
STEPS = [float(step) for step in range(30)]
OF_CELL = {
    "/cell/front": [*STEPS, 1000.0],
    "/cell/rear": [100 + step for step in STEPS],
    "/cell/filtered": [200 + step for step in STEPS],
}


# Two nodes of one class, and a helper of a third one. What is of no node is the process's.
@pytest.mark.parametrize("policy", ["every", "edges"])
def test_each_node_of_a_program_has_its_reports(domain, tmp_path, policy):
    program = Program(tmp_path, domain, CELL)
    done = program.run(TPC_SINK="file", TPC_POLICY=policy)
    assert (done.returncode, done.stderr) == (0, "")
    recording = read(program.reports)
    nodes = {f"{KEY}": {"/cell/front"}, f"{KEY}#2": {"/cell/rear"}, f"{KEY}#3": {"/cell/filtered"}}
    assert recording.nodes_of == nodes
    events = recording.events
    found = {
        node: events.cmp[events.node == events.nodes.index(node)].tolist() for node in events.nodes
    }
    if policy == "every":
        assert found == OF_CELL
    else:
        # Only the front one changes: once. Each reports its first outcome.
        assert {node: len(values) for node, values in found.items()} == {
            "/cell/front": 2, "/cell/rear": 1, "/cell/filtered": 1,
        }  # fmt: skip


def test_a_listener_hears_which_node_of_a_program_it_is(domain, tmp_path, listener):
    program = Program(tmp_path, domain, CELL)
    done = program.run(TPC_SINK="topic", TPC_POLICY="every")
    assert (done.returncode, done.stderr) == (0, "")
    wait_for(lambda: len(listener.values("/cell/front")) >= 31)
    lines = [line for batch in listener.batches("/cell/front") for line in batch.lines]
    told = {line.split(",", 1)[1] for line in lines if "threshold_name" in line}
    assert told == {
        f"threshold_name:{KEY}#2,node:/cell/rear", f"threshold_name:{KEY}#3,node:/cell/filtered",
    }  # fmt: skip
    done = program.run(TPC_SINK="rosout")
    assert (done.returncode, done.stderr) == (0, "")
    for node, values in OF_CELL.items():
        logger = node[1:].replace("/", ".")

        def heard(logger: str = logger) -> list[float]:
            texts = [text for text, _, _ in listener.logs(logger) if "_information" in text]
            return [float(text.split("cmp:")[1].split(",")[0]) for text in texts]

        wait_for(lambda heard=heard, values=values: len(heard()) >= len(values))
        assert heard() == values


# The node is made after the first report, and the process is named after the first of two.
def test_two_nodes_in_an_executor_and_reports_before_them(domain, tmp_path):
    text = """
from rclpy.executors import MultiThreadedExecutor
high(1.0)
rclpy.init()
nodes = [Node("first"), Node("second", namespace="/other")]
executor = MultiThreadedExecutor(num_threads=3)
counts = [0, 0]
def tick(at):
    counts[at] += 1
    high(7.0)
timers = []
for at, node in enumerate(nodes):
    executor.add_node(node)
    timers.append(node.create_timer(0.01, lambda at=at: tick(at)))
until(lambda: executor.spin_once(timeout_sec=1.0) or min(counts) >= 20)
for timer in timers:
    timer.cancel()
time.sleep(0.2)
executor.shutdown()
rclpy.shutdown()
print(sum(counts), *[thread.name for thread in threading.enumerate() if "Pool" not in thread.name])
"""
    program = Program(tmp_path, domain, text)
    done = program.run(TPC_SINK="file")
    assert (done.returncode, done.stderr) == (0, "")
    count, threads = done.stdout.split()
    events = read(program.reports).events
    assert events.cmp.tolist() == [1.0] + [7.0] * int(count)
    # Before the second node all reports are the process's; rclpy knows whose timer it calls.
    by_node = {name: int((events.node == at).sum()) for at, name in enumerate(events.nodes)}
    assert by_node.keys() == {"/first", "/other/second"}
    assert by_node["/first"] >= 21
    assert by_node["/other/second"] >= 20
    # The thread beside the nodes is none of the program's.
    assert threads == "MainThread"


CLOCK = """\
import rclpy, time
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
rclpy.init()
node = Node("clock")
publisher = node.create_publisher(Clock, "/clock", 1)
for tick in range(100000):
    message = Clock()
    message.clock.sec, message.clock.nanosec = 1000 + tick // 100, tick % 100 * 10**7
    publisher.publish(message)
    time.sleep(0.01)
"""


@pytest.mark.parametrize("sink", ["file", "topic"])
def test_simulated_time(domain, tmp_path, listener, sink):
    text = """
rclpy.init()
node = Node("dreamer_" + sys.argv[1])
start = lambda: node.get_clock().now().nanoseconds
until(lambda: rclpy.spin_once(node, timeout_sec=0.1) or start() > 0)
for number in range(50):
    before = start()
    until(lambda: rclpy.spin_once(node, timeout_sec=0.1) or start() > before)
    print(start())
    high(float(number))
"""
    clock = tmp_path / "clock.py"
    clock.write_text(CLOCK)
    program = Program(tmp_path, domain, text)
    publisher = subprocess.Popen([PYTHON, clock], env=ros2_env(domain))
    try:
        done = program.run(sink, "--ros-args", "-p", "use_sim_time:=true", TPC_SINK=sink)
    finally:
        publisher.kill()
        publisher.wait()
    assert (done.returncode, done.stderr) == (0, "")
    expected = [int(word) for word in done.stdout.split()]
    assert len(expected) == 50
    if sink == "file":
        assert read(program.reports).events.time_ns.tolist() == expected
        return
    node = "/dreamer_topic"
    wait_for(lambda: len(listener.values(node)) >= 50)
    lines = [line for batch in listener.batches(node) for line in batch.lines]
    assert [round(float(line.split(",")[0]) * 1e9, -2) for line in lines] == expected


ENDS = {
    "nothing": "",
    "shutdown": "node.destroy_node(); rclpy.shutdown()",
    "exit": "sys.exit(3)",
    "error": "raise ValueError('wrong')",
    "interrupt": "node.create_timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT))\ntry:\n"
    "    rclpy.spin(node)\nexcept KeyboardInterrupt:\n    pass\n"
    "for number in range(100, 110):\n    high(float(number))",
    "terminate": "node.create_timer(0.1, lambda: os.kill(os.getpid(), signal.SIGTERM))\ntry:\n"
    # In a tenth of all runs rclpy's own spin fails at this signal, without TPC, too.
    "    rclpy.spin(node)\n"
    "except (rclpy.executors.ExternalShutdownException, RuntimeError):\n    pass\n"
    "sys.exit(5)",
    "again": "node.destroy_node()\nrclpy.shutdown()\nrclpy.init()\nnode = Node('later')\n"
    "for number in range(100, 110):\n    high(float(number))\nrclpy.shutdown()",
    "thread": "spin = threading.Thread(target=rclpy.spin, args=(node,))\nspin.start()\n"
    "time.sleep(0.2)\nrclpy.shutdown()\nspin.join()",
}


STATUS = {"exit": 3, "error": 1, "terminate": 5}


@pytest.mark.parametrize(
    ("end", "sink"),
    [
        *((end, "topic") for end in ENDS),
        ("nothing", "file"),
        ("interrupt", "file"),
        ("again", "file"),
    ],
)
def test_the_end_of_a_node(domain, tmp_path, listener, end, sink):
    text = f"""
rclpy.init()
node = Node("end_{end}")
for number in range(100):
    high(float(number))
{ENDS[end]}
"""
    program = Program(tmp_path, domain, text)
    done = program.run(TPC_SINK=sink)
    assert done.returncode == STATUS.get(end, 0)
    if end == "error":
        assert done.stderr.startswith("Traceback")
        assert done.stderr.endswith("\nValueError: wrong\n")
    else:
        assert done.stderr == ""
    count = 110 if end in ("interrupt", "again") else 100
    expected = [float(number) for number in range(count)]
    if sink == "file":
        events = read(program.reports).events
        assert events.cmp.tolist() == expected
        assert events.nodes == (f"/end_{end}",)
        return
    wait_for(lambda: len(listener.values(f"/end_{end}")) >= count)
    assert listener.values(f"/end_{end}") == expected


# rclpy has a thread that shuts all contexts down after a signal: sooner or later than the end.
SHUT = "until(lambda: not node.context.ok())"
WHEN_SHUT = {
    # The sink has looked, and has found nobody yet.
    "before": "from rclpy.publisher import Publisher\n"
    "from pytpc.python_runtime.ros2_link import Link\n"
    "found = Publisher.get_subscription_count, Link.known_subscribers\n"
    "Publisher.get_subscription_count = lambda self: 0\n"
    "Link.known_subscribers = lambda self, topic: 0\n"
    "time.sleep(1.0)\n"
    "Publisher.get_subscription_count, Link.known_subscribers = found\n"
    f"interrupt()\n{SHUT}",
    "while it sends": "from pytpc.python_runtime.ros2_sinks import TopicSink\n"
    "finish = TopicSink.finish\n"
    "def interrupted(self):\n"
    f"    TopicSink.finish = finish\n    interrupt()\n    {SHUT}\n    finish(self)\n"
    "TopicSink.finish = interrupted",
}


@pytest.mark.parametrize("when", WHEN_SHUT)
def test_a_signal_near_the_end_loses_no_report(domain, tmp_path, listener, when):
    name = f"end_{when.replace(' ', '_')}"
    text = f"""
rclpy.init()
node = Node("{name}")
def interrupt():
    try:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(10.0)
    except KeyboardInterrupt:
        pass
for number in range(100):
    high(float(number))
{WHEN_SHUT[when]}
"""
    done = Program(tmp_path, domain, text).run(TPC_SINK="topic")
    assert (done.returncode, done.stderr) == (0, "")
    wait_for(lambda: len(listener.values(f"/{name}")) >= 100)
    assert listener.values(f"/{name}") == [float(number) for number in range(100)]


def test_a_node_that_is_killed_leaves_its_file(domain, tmp_path):
    text = """
rclpy.init()
node = Node("killed")
for number in range(1000):
    high(float(number))
os.kill(os.getpid(), signal.SIGKILL)
"""
    program = Program(tmp_path, domain, text)
    assert program.run(TPC_SINK="file").returncode == -signal.SIGKILL
    events = read(program.reports).events
    assert events.cmp.tolist() == [float(number) for number in range(1000)]
    assert events.nodes == ("/killed",)


def test_the_node_itself_stays_as_it_is(domain, tmp_path):
    text = """
import json
rclpy.init()
node = Node("same", namespace="/robot1")
node.declare_parameter("limit", 1.0)
high(7.0)
if len(sys.argv) > 1:
    until(lambda: ("_tpc", "/robot1/same") in node.get_node_names_and_namespaces())
print(json.dumps([
    sorted(node.list_parameters([], 0).names),
    node.get_publisher_names_and_types_by_node("same", "/robot1"),
    node.get_subscriber_names_and_types_by_node("same", "/robot1"),
    node.get_service_names_and_types_by_node("same", "/robot1"),
    node.get_client_names_and_types_by_node("same", "/robot1"),
]))
"""
    program = Program(tmp_path, domain, text)
    plain, hooked = program.run(plain=True), program.run("with", TPC_SINK="topic")
    assert (plain.returncode, plain.stderr, hooked.returncode) == (0, "", 0)
    assert json.loads(plain.stdout)[0] == [
        "limit",
        "start_type_description_service",
        "use_sim_time",
    ]
    assert hooked.stdout == plain.stdout


def test_where_the_graph_cannot_be_used_a_file_is_written(domain, tmp_path):
    text = """
from rclpy.context import Context
high(1.0)
rclpy.init()
def init(self, *args, **options):
    raise RuntimeError("no more participants")
Context.init = init
node = Node("alone")
high(7.0)
folder = os.environ["TPC_FOLDER"]
until(lambda: os.path.exists(folder) and len(os.listdir(folder)))
time.sleep(0.2)
high(6.0)
"""
    program = Program(tmp_path, domain, text)
    for sink in ("topic", "rosout", "auto"):
        done = program.run(TPC_SINK=sink, TPC_FOLDER=f"{program.reports}/{sink}")
        assert done.returncode == 0
        assert done.stderr == (
            "tpc: ROS 2 cannot be used, so reports are written to files in"
            f" {program.reports}/{sink}: no more participants\n"
        )
        events = read(program.reports / sink).events
        assert (events.cmp.tolist(), events.nodes) == ([1.0, 7.0, 6.0], ("/alone",))


# The program's node has what it needs, and the hidden node comes after it.
def test_a_hidden_node_without_keys_leaves_the_node_alone(domain, tmp_path):
    text = """
rclpy.init()
node = Node("secured")
os.environ.update(ROS_SECURITY_ENABLE="true", ROS_SECURITY_STRATEGY="Enforce")
os.environ["ROS_SECURITY_KEYSTORE"] = "/none"
for number in range(10):
    high(float(number))
folder = os.environ["TPC_FOLDER"]
until(lambda: os.path.exists(folder) and len(os.listdir(folder)))
time.sleep(0.2)
high(10.0)
print(node.get_name())
"""
    program = Program(tmp_path, domain, text)
    done = program.run(TPC_SINK="topic")
    assert (done.returncode, done.stdout) == (0, "secured\n")
    (warning,) = done.stderr.splitlines()
    assert warning.startswith("tpc: ROS 2 cannot be used, so reports are written to files in ")
    assert "directory '/none/enclaves' does not exist" in warning
    events = read(program.reports).events
    assert events.cmp.tolist() == [float(number) for number in range(11)]


def test_a_signal_while_the_hidden_node_is_made(domain, tmp_path, listener):
    text = """
from pytpc.python_runtime import ros2_link
make = ros2_link._hidden_node
def interrupted(node, context, ask):
    ros2_link._hidden_node = make
    context.shutdown()
    return make(node, context, ask)
ros2_link._hidden_node = interrupted
rclpy.init()
node = Node("hasty")
high(7.0)
until(lambda: "_tpc" in [name for name, _ in node.get_node_names_and_namespaces()])
"""
    done = Program(tmp_path, domain, text).run(TPC_SINK="topic")
    assert (done.returncode, done.stderr) == (0, "")
    wait_for(lambda: listener.values("/hasty") == [7.0])


def test_a_program_without_a_node(domain, tmp_path):
    text = "high(1.0)\nhigh(7.0)\n"
    program = Program(tmp_path, domain, text)
    done = program.run()
    assert (done.returncode, done.stderr) == (0, "")
    done = program.run(TPC_SINK="topic")
    assert done.returncode == 0
    assert "2 evaluations were not sent on /threshold_information" in done.stderr
    assert program.run(TPC_SINK="file").returncode == 0
    assert read(program.reports).events.cmp.tolist() == [1.0, 7.0]


def test_a_child_of_a_node(domain, tmp_path, listener):
    text = """
rclpy.init()
node = Node("parent")
for number in range(10):
    high(float(number))
child = os.fork()
if child == 0:
    high(100.0)
    sys.stdout.flush()
    # Otherwise the participant of rclpy ends the child.
    os._exit(4)
status = os.waitpid(child, 0)[1]
high(10.0)
print(os.waitstatus_to_exitcode(status))
"""
    program = Program(tmp_path, domain, text)
    done = program.run(TPC_SINK="topic")
    assert (done.returncode, done.stdout) == (0, "4\n")
    assert done.stderr.count("was forked from a node: its reports do not reach /threshold") == 1
    wait_for(lambda: len(listener.values("/parent")) >= 11)
    assert listener.values("/parent") == [float(number) for number in range(11)]
    done = program.run(TPC_SINK="file")
    assert (done.returncode, done.stdout, done.stderr) == (0, "4\n", "")
    events = read(program.reports).events
    assert sorted(events.cmp.tolist()) == [*map(float, range(11)), 100.0]
    # Of two processes with one name, the later one is told apart by its number.
    first, second = sorted(events.nodes)
    assert first == "/parent"
    assert second.startswith("/parent (")


def test_ctrl_c_of_a_spinning_node(domain, tmp_path, listener):
    text = """
rclpy.init()
node = Node("spinning")
count = 0
def tick():
    global count
    high(float(count))
    count += 1
node.create_timer(0.002, tick)
print("up", flush=True)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
node.destroy_node()
print(count)
"""
    process = Program(tmp_path, domain, text).start(TPC_SINK="topic")
    wait_for(lambda: len(listener.values("/spinning")) > 100)
    process.send_signal(signal.SIGINT)
    done = ended(process)
    assert (done.returncode, done.stderr) == (0, "")
    count = int(done.stdout.split()[1])
    wait_for(lambda: len(listener.values("/spinning")) >= count)
    assert listener.values("/spinning") == [float(number) for number in range(count)]
