"""Processes of a graph: how they end, and the lines of their output that tell why."""

from __future__ import annotations

import os

import pytest

from pytpc.base.errors import RunError
from pytpc.ros.ros1.graph import GraphProcess, RosGraph


# As roslaunch 1.16 prints it.
def test_the_tail_has_the_place_in_a_broken_yaml_file(tmp_path):
    log_file = tmp_path / "x.log"
    log_file.write_text(
        "\x1b[31mRLException: error loading <rosparam> tag: \n"
        "\tfile /ws/task.yaml contains invalid YAML:\n"
        "mapping values are not allowed here\n"
        '  in "<unicode string>", line 7, column 16:\n'
        "      cooldown: 3.0: x\n"
        "                   ^\n"
        'XML is <rosparam file="$(find x)/task.yaml" command="load"/>\x1b[0m\n'
        "\x1b[31mThe traceback for the exception was written to the log file\x1b[0m\n"
    )
    process = GraphProcess("x", None, log_file, 1.0)  # type: ignore[arg-type]
    assert process.tail() == [
        "RLException: error loading <rosparam> tag: file /ws/task.yaml contains invalid YAML:"
        ' mapping values are not allowed here in "<unicode string>", line 7, column 16:'
        " cooldown: 3.0: x"
    ]


# A detail that reads like an error, as that of a tab does, is told once, and pushes out nothing.
def test_the_details_of_an_error_are_told_once(tmp_path):
    log_file = tmp_path / "x.log"
    log_file.write_text(
        "ERROR: first\n"
        "ERROR: second\n"
        "RLException: /ws/task.yaml contains invalid YAML:\n"
        "found character that cannot start any token\n"
        "  error_limit: 3\n"
        "XML is <rosparam/>\n"
    )
    process = GraphProcess("x", None, log_file, 1.0)  # type: ignore[arg-type]
    assert process.tail() == [
        "ERROR: first",
        "ERROR: second",
        "RLException: /ws/task.yaml contains invalid YAML: found character that cannot start any"
        " token error_limit: 3",
    ]


def test_tail_of_a_process_prefers_what_tells_of_an_error(tmp_path):
    log_file = tmp_path / "x.log"
    lines = ["started", "\x1b[31mRLException: no such file\x1b[0m", "", "====", "done", "bye"]
    log_file.write_text("\n".join(lines))
    process = GraphProcess("x", None, log_file, 1.0)  # type: ignore[arg-type]
    assert process.tail() == ["RLException: no such file"]
    log_file.write_text("one\ntwo\nthree\n\x1b]2;x.launch http://127.0.0.1:1\x07four\n")
    assert process.tail(2) == ["three", "four"]
    assert GraphProcess("x", None, tmp_path / "none", 1.0).tail() == []  # type: ignore[arg-type]


# roslaunch ends with status 0 when a required node is done: the mission is over, and no error.
def test_what_may_end_by_itself(tmp_path):
    graph = RosGraph({"PATH": os.environ["PATH"]}, tmp_path)
    (tmp_path / "out").mkdir()
    for status, may_end in ((0, True), (3, True), (0, False)):
        process = graph.start("one", ["sh", "-c", f"exit {status}"], may_end=may_end)
        process.popen.wait()
        is_well = status == 0 and may_end
        assert process.has_ended_well is is_well
        if is_well:
            graph.check()
        else:
            with pytest.raises(RunError, match=f"one ended with status {status}"):
                graph.check()
        graph.stop(process)
    died = "\x1b[31m=====REQUIRED process [a-1] has died!\nprocess has died [pid 5, exit code -11]"
    process = graph.start("three", ["printf", f"{died}\n"], may_end=True)
    process.popen.wait()
    with pytest.raises(RunError, match=r"three ended with status 0: .*exit code -11"):
        graph.check()
    graph.stop(process)
    running = graph.start("two", ["sleep", "60"], may_end=True)
    assert not running.has_ended_well
    graph.check()
    graph.stop(running)
