"""Which process is that of a node, and where its values came from then."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from pytpc.ros.ros2.command_lines import CommandLines
from pytpc.ros.ros2.flight import StartedProcess
from pytpc.values.recording import BY_A_NODE, NOT_SEEN, origins_of
from pytpc.values.trace import Trace

GUARD = {"/robot1/guard/limit": 4.5, "/robot1/guard/gain": 1.0}


@pytest.fixture
def lines(tmp_path: Path) -> CommandLines:
    # No process of this machine has this domain.
    (tmp_path / "a.yaml").write_text("/**: {ros__parameters: {limit: 4.5}}\n")
    (tmp_path / "b.yaml").write_text("/**: {ros__parameters: {limit: 9.0}}\n")
    return CommandLines("no domain")


def started(folder: Path, pid: int, *words: str) -> StartedProcess:
    return StartedProcess(pid, ("node", "--ros-args", *words), folder)


def places(lines: CommandLines, values=GUARD, launched=None, *, is_own=False):
    trace = lines.trace(values, launched, is_own=is_own)
    if trace is None:
        return None
    found = origins_of(trace, values, values)
    return {name.rpartition("/")[2]: (one.kind, one.lineno) for name, one in found.items()}


def test_a_process_whose_values_the_node_has_is_its_own(lines, tmp_path):
    lines.look([started(tmp_path, 1, "--params-file", "b.yaml")])
    assert places(lines) is None
    lines.look([started(tmp_path, 2, "--params-file", "a.yaml")])
    assert places(lines) == {"limit": ("yaml", 1), "gain": ("default", None)}


def test_a_name_on_the_command_line_is_enough(lines, tmp_path):
    words = ["--params-file", "b.yaml", "-r", "__node:=guard", "-r", "__ns:=/robot1"]
    lines.look([started(tmp_path, 1, *words)])
    trace = lines.trace(GUARD, None, is_own=False)
    limit = origins_of(trace, GUARD, GUARD)["/robot1/guard/limit"]
    # The node has another value than the file: something has set it.
    assert (limit.kind, limit.note) == ("runtime", f"{tmp_path}/b.yaml:1 set it to 9.0")
    others = {"/robot2/guard/limit": 9.0, "/robot1/arm/limit": 9.0}
    assert places(lines, others) is None


def test_a_value_on_the_command_line_is_said_to_be_there(lines, tmp_path):
    lines.look([started(tmp_path, 1, "--params-file", "b.yaml", "-p", "limit:=4.5")])
    # Its name has a slash, and still it is a parameter of /robot1/guard.
    depth = "/robot1/guard/qos_overrides./scan.publisher.depth"
    values = {**GUARD, depth: 10}
    found = origins_of(lines.trace(values, None, is_own=False), values, values)
    limit = found["/robot1/guard/limit"]
    assert (limit.words(), limit.overridden) == ("args of the node", (f"{tmp_path}/b.yaml:1",))
    assert found[depth].words() == "default in the code"


def test_two_processes_that_may_be_it_must_agree(lines, tmp_path):
    for pid in (1, 2):
        lines.look([started(tmp_path, pid, "--params-file", "a.yaml")])
    assert places(lines) == {"limit": ("yaml", 1), "gain": ("default", None)}
    lines.look([started(tmp_path, 3, "-p", "limit:=4.5")])
    assert places(lines) == {"limit": ("unknown", None), "gain": ("default", None)}


def test_a_file_that_launch_has_written_is_no_place(lines, tmp_path):
    (tmp_path / "launch_params_x1").write_text("/**: {ros__parameters: {limit: 4.5}}\n")
    lines.look([started(tmp_path, 1, "--params-file", "launch_params_x1")])
    trace = lines.trace(GUARD, None, is_own=False)
    limit = origins_of(trace, GUARD, GUARD)["/robot1/guard/limit"]
    assert (limit.kind, limit.path, limit.words()) == ("launch", None, "launch file")
    assert "pytpc record --launch FILE" in limit.note
    assert trace.files == {}


def test_what_the_launch_file_says_counts_more(lines, tmp_path):
    lines.look([started(tmp_path, 1, "--params-file", "a.yaml")])
    launched = Trace(Path("x.launch.py"), {}, {}, [], {}, placed={})
    found = lines.trace(GUARD, launched, is_own=True)
    assert found.launch == Path("x.launch.py")
    assert set(found.files) == {str(tmp_path / "a.yaml")}
    assert found.declaring == {"/robot1/guard"}


def test_a_node_of_another_machine_is_not_said_to_have_its_defaults(lines, tmp_path):
    lines.look([started(tmp_path, 1, "--params-file", "a.yaml")])
    values = {**GUARD, "/far/away": 7}
    trace = lines.trace(values, None, is_own=False)
    far = origins_of(trace, values, values)["/far/away"]
    assert (far.kind, far.note) == ("unknown", NOT_SEEN)
    # What changed while it ran is known all the same.
    far = origins_of(trace, values, {**values, "/far/away": 6})["/far/away"]
    assert (far.kind, far.note) == ("runtime", "it was 6 when the recording began")
    assert BY_A_NODE not in far.note


def test_a_file_that_is_gone_is_told(lines, tmp_path):
    lines.look([started(tmp_path, 1, "--params-file", "gone.yaml")])
    (fault,) = lines.faults
    assert "gone.yaml" in fault


def test_running_processes_of_the_domain_are_read(tmp_path):
    (tmp_path / "a.yaml").write_text("/**: {ros__parameters: {limit: 4.5}}\n")
    code = "print('up', flush=True); input()"
    words = ["--ros-args", "--params-file", "a.yaml"]
    env = {**os.environ, "ROS_DOMAIN_ID": "231"}
    with subprocess.Popen(
        [sys.executable, "-c", code, *words],
        cwd=tmp_path,
        env=env,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as process:
        assert process.stdout.readline() == b"up\n"
        here, elsewhere = CommandLines("231"), CommandLines("230")
        here.look()
        elsewhere.look()
        process.communicate(b"\n")
    assert places(here) == {"limit": ("yaml", 1), "gain": ("default", None)}
    assert places(elsewhere) is None
