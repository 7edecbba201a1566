"""A robot in Python that needs no build: a workspace as `pytpc build` leaves it, and its folder."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from pytpc.api.building import analyse
from pytpc.python_analysis.rules_file import load_rules
from pytpc.static.sources import with_source_digests
from terminals import Terminal, pytpc

ROOT = Path(__file__).parents[2]
MANIFEST = """<package format="2"><name>{name}</name><version>0.0.1</version>
<description>A robot.</description><maintainer email="a@example.com">a</maintainer>
<license>Apache-2.0</license></package>
"""
# It goes up and down once a second, and says so when it is above its limit.
NODE = """#!/usr/bin/env python3
import math

import rospy
from std_msgs.msg import Bool, Float64

rospy.init_node("robot")
limit = rospy.get_param("~limit", 0.5)
floor = rospy.get_param("~floor", -0.9)
seconds = rospy.get_param("~seconds", 600.0)
command = rospy.Publisher("~command", Float64, queue_size=1)
begun = rospy.get_time()
while not rospy.is_shutdown() and rospy.get_time() - begun < seconds:
    height = math.sin(6.28 * (rospy.get_time() - begun))
    if height > limit:
        command.publish(1.0)
    elif height < floor:
        command.publish(-1.0)
    rospy.sleep(0.05)
"""
LAUNCH = """<launch>
  <arg name="limit" default="0.5"/>
  <arg name="seconds" default="600.0"/>
  <node pkg="robot_base" type="robot.py" name="robot" required="true">
    <param name="limit" value="$(arg limit)"/>
    <param name="seconds" value="$(arg seconds)"/>
  </node>
</launch>
"""


def make_package(share: Path, name: str, files: Mapping[str, str]) -> None:
    """A package as ROS finds it below a folder of ROS_PACKAGE_PATH."""
    for place, text in {"package.xml": MANIFEST.format(name=name), **files}.items():
        path = share / name / place
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755)


def make_workspace(folder: Path) -> Path:
    """A workspace with the robot, analysed."""
    share = folder / "src"
    files = {"scripts/robot.py": NODE, "launch/robot.launch": LAUNCH}
    make_package(share, "robot_base", files)
    install = folder / ".tpc/install"
    install.mkdir(parents=True)
    (install / "setup.bash").write_text(f"export ROS_PACKAGE_PATH={share}:/usr/share\n")
    static = analyse([share / "robot_base"], load_rules("default", None))
    with_source_digests(static).save(folder / ".tpc/static.json")
    return folder


def environment(runtime: Path) -> dict[str, str]:
    """That of a shell in which nothing was sourced; its recordings are announced in ``runtime``."""
    runtime.mkdir(mode=0o700, exist_ok=True)
    return {"PYTHONPATH": str(ROOT), "XDG_RUNTIME_DIR": str(runtime)}


def shell(*words: str, folder: Path, **env: str) -> Terminal:
    """A terminal in which pytpc runs."""
    given = {**environment(folder / "runtime"), "ROS_MASTER_URI": "", **env}
    return Terminal(pytpc(*words), folder, env=given, columns=120, lines=30)


def wait_until(what: Callable[[], object], terminal: Terminal, patience_s: float = 60.0) -> None:
    """Until something is true while a program runs."""
    until = time.monotonic() + patience_s
    while not what():
        assert time.monotonic() < until, terminal.text[-2000:]
        assert terminal.process.poll() is None, terminal.text[-2000:]
        terminal._read(0.02)


def processes_of(folder: Path) -> list[int]:
    """The processes whose ROS home is below a folder."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            words = (entry / "environ").read_bytes()
        except OSError:
            continue
        if f"ROS_HOME={folder}".encode() in words and int(entry.name) != os.getpid():
            found.append(int(entry.name))
    return found
