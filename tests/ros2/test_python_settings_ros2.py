"""The settings of a running node of rclpy: parameters of its hidden node, and entries of files."""

from __future__ import annotations

import json

from patience import wait_for
from pytpc.ingest.reading import read
from ros2_graph import run_python
from ros2_reporting import Program, ended

SET = """\
import json, rclpy, sys
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.node import Node
rclpy.init()
node = Node("setter")

def call(kind, name, request):
    client = node.create_client(kind, "/robot1/tuned/_tpc/" + name)
    assert client.wait_for_service(600.0)
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=600.0)
    return future.result()

FIELDS = {1: "bool_value", 2: "integer_value", 3: "double_value", 4: "string_value"}

def value(found):
    return getattr(found, FIELDS[found.type])

def change(name, **given):
    parameter = Parameter(name=name, value=ParameterValue(**given))
    request = SetParameters.Request(parameters=[parameter])
    (result,) = call(SetParameters, "set_parameters", request).results
    return [result.successful, result.reason]

def get(*names):
    answer = call(GetParameters, "get_parameters", GetParameters.Request(names=list(names)))
    return [value(one) for one in answer.values]

NAMES = ("sink", "policy", "period", "site_cap", "process_cap")
answers = [get(*NAMES)]
answers.append(change("sink", type=4, string_value="nowhere"))
answers.append(change("period", type=3, double_value=1e9))
answers.append(change("site_cap", type=4, string_value="many"))
answers.append(change("status", type=4, string_value="fine"))
answers.append(change("sink", type=1, bool_value=False))
answers.append(get("sink"))
answers.append(change("period", type=2, integer_value=2))
answers.append(change("sink", type=4, string_value="file"))
answers.append(get(*NAMES))
answers.append(get("status"))
print(json.dumps(answers))
"""


def test_settings_change_while_it_runs(domain, tmp_path):
    text = """
rclpy.init()
node = Node("tuned", namespace="/robot1")
def step():
    high(7.0)
    return os.path.exists(sys.argv[1])
until(step)
rclpy.shutdown()
"""
    program, setter = Program(tmp_path, domain, text), tmp_path / "setter.py"
    setter.write_text(SET)
    params, stop = tmp_path / "params.yaml", tmp_path / "stop"
    # The entries of all nodes are for the program's own parameters.
    params.write_text(
        "/**: {ros__parameters: {sink: 7, period: 50.0}}\n"
        "/robot1/tuned: {ros__parameters: {policy: 3}}\n"
        "/**/_tpc: {ros__parameters: {sink: topic, period: 5.0}}\n"
        "/robot1/tuned/_tpc: {ros__parameters: {period: 3.0, site_cap: 9}}\n"
    )
    words = ["--ros-args", "--params-file", str(params)]
    # A rule can name a node without its namespace alone; `policy` is for the program.
    words += ["-p", "_tpc:site_cap:=8", "-p", "policy:=4", "-p", "tuned:period:=4.0"]
    process = program.start(str(stop), *words, TPC_SINK="off")
    try:
        said = run_python(setter, domain)
        # The eight reports of this second may be used up: the next one has its own.
        wait_for(lambda: len(read(program.reports).events) > 0)
    finally:
        stop.touch()
        done = ended(process)
    assert done.returncode == 0
    # The sink was `topic` at first, and nobody listened.
    (line,) = done.stderr.splitlines()
    assert line.endswith("were not sent on /threshold_information: nobody listened")
    assert said.returncode == 0, said.stderr
    answers = json.loads(said.stdout)
    assert answers[0] == ["topic", "every", 3.0, 8, 0]
    assert answers[1] == [False, "sink: it must be one of auto, rosout, topic, file, off"]
    assert answers[2] == [False, "period: it must be a number of seconds from 0.001 to 3600"]
    assert answers[3] == [False, "site_cap: it must be a whole number"]
    assert answers[4][0] is False
    # `off`, as YAML reads it.
    assert answers[5:7] == [[True, ""], ["off"]]
    assert answers[7:9] == [[True, ""], [True, ""]]
    assert answers[9] == ["file", "every", 2.0, 8, 0]
    assert answers[10][0].startswith("sink=file policy=every site_cap=8 sites=1 ")
    assert set(read(program.reports).events.cmp.tolist()) == {7.0}
