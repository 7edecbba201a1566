"""Nodes that died, from the output of roslaunch."""

from __future__ import annotations

from pathlib import Path

from pytpc.ros.mission_run import DiedNode
from pytpc.ros.ros1.node_output import NodeOutput

BEGIN = """\x1b]2;/ws/robot.launch\x07
NODES
    robot (robot_base/robot.py)
\x1b[1mstarted roslaunch server http://127.0.0.1:1/\x1b[0m
\x1b[1mprocess[robot-1]: started with pid [11]\x1b[0m
\x1b[1mprocess[x/camera-2]: started with pid [12]\x1b[0m
[INFO] looking
one
two
three
Traceback (most recent call last):
  File "camera.py", line 7, in <module>
RuntimeError: no camera
"""
DIED = """\x1b[31m[x/camera-2] process has died [pid 12, exit code 1, cmd /ws/camera.py].
log file: /out/x-camera-2*.log\x1b[0m
"""
REQUIRED = """\x1b[31m====REQUIRED process [robot-1] has died!
process has died [pid 11, exit code -11, cmd /ws/robot].
log file: /out/robot-1*.log
Initiating shutdown!
====\x1b[0m
[robot-1] killing on exit
"""
SAID = (
    "two",
    "three",
    "Traceback (most recent call last):",
    '  File "camera.py", line 7, in <module>',
    "RuntimeError: no camera",
)


def test_nodes_that_died_and_what_was_printed_last(tmp_path: Path) -> None:
    log = tmp_path / "roslaunch.log"
    output = NodeOutput(log)
    assert output.died() == []
    log.write_text(BEGIN)
    assert output.died() == []
    with log.open("a") as stream:
        # It is written in parts.
        stream.write(DIED[:40])
        stream.flush()
        assert output.died() == []
        stream.write(DIED[40:])
    camera = DiedNode("x/camera-2", 1, SAID, log)
    assert output.died() == [camera]
    assert output.died() == []
    with log.open("a") as stream:
        stream.write(REQUIRED)
    (robot,) = output.died()
    assert (robot.name, robot.status) == ("robot-1", -11)
    assert robot.words == "the node robot-1 died (signal 11)"
    assert camera.words == "the node x/camera-2 died (exit status 1)"


def test_a_line_without_an_end_is_bounded(tmp_path: Path) -> None:
    log = tmp_path / "roslaunch.log"
    output = NodeOutput(log)
    with log.open("w") as stream:
        stream.write("process[robot-1]: started with pid [11]\n")
        for _ in range(4):
            stream.write("x" * (1 << 20))
        stream.write("\n" + DIED)
    found: list[DiedNode] = []
    while not found:
        found = output.died()
    assert found[0].said == ("x" * 300,)
