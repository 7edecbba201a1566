"""The home of the reader of a page: a robot, built once, its recordings, and a ROS graph.

Everything has the names that the pages use. All pages have the same home, one after the other: its
path is in what the build wrote. `prepare` makes it new for each.
"""

from __future__ import annotations

import json
import re
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import pyarrow.compute as pc
import pyarrow.parquet as pq

from docs_commands import Command
from pytpc.base.paths import project_root
from terminals import Terminal

ROOT = project_root()
PATIENCE_S = 180.0
RIGHT, WRONG = "min_coverage_limit: 0.035", "min_coverage_limit: 0.058"
# A later version of the robot: of its comparisons one is changed, one gone and one new.
EDITS = {
    "coverage > min_coverage_limit": "coverage >= min_coverage_limit",
    '"~min_coverage_limit", 0.035': '"~min_coverage_limit", 0.05',
    "if height > max_height": 'if len(faces) > rospy.get_param("~max_faces")',
    "height = 1.6": "faces = []; height = 1.6",
}
TREE = """cmake_minimum_required(VERSION 3.10)
project(tool CXX)
add_executable(tool src/tool.cpp)
"""
# Words that stand for a name of the reader's.
NAMES = {
    r"\bMISSION\b": "mission",
    r"\bWS\b": "ws",
    r"\bWORKSPACE\b": "uav.json",
    r"DIR\.\.\. -o FOLDER\b": "tree -o survey",
    "<this repository>": str(ROOT),
    r"\b192\.168\.1\.20:": "127.0.0.1:",
    "<prefix>": str(ROOT / "build/install"),
}


class Long(NamedTuple):
    """A command that runs until Ctrl-C: ``ready`` is in what it says once others can go on.

    Ctrl-C is pressed when the block ends, or at once if the command needs no other (``alone``).
    ``status`` is the one that it ends with then.
    """

    ready: str
    alone: bool = False
    status: int = 0


class Keys(NamedTuple):
    """A command that takes keys: what is awaited on its screen, and what is pressed then."""

    presses: tuple[tuple[str, str], ...]


MARK_AND_END = Keys((("~max_speed", "2"), ("marked: type II", "q")))
# The first that matches a command decides; a command that none matches ends by itself.
HOW: dict[str, Long | Keys] = {
    r"roscore": Long("started core service"),
    r"roslaunch": Long(r"process\[mission-\d+\]: started"),
    r"rosbag record": Long("Subscribing to"),
    r"pytpc live": Long(r"http://\S+/\?token=", alone=True),
    r"pytpc stream (?!MISSION|mission)": Long("streaming from", alone=True),
    "rerun": Long("Listening for gRPC", status=130),
    r"pytpc record ws mission": Long(r"[1-9]\d* marks?", alone=True),
    r"pytpc record (?!-)": Long(r"[1-9]\d* reports,", alone=True),
    r"pytpc record": Long("press Ctrl-C to stop"),
    r"pytpc run --static": Long("flying", alone=True),
    r"pytpc mark ": Keys((("q quit", "2"), ("marked: type II", "q"))),
    r"pytpc run": MARK_AND_END,
    r"pytpc watch(?!.*--once)": MARK_AND_END,
    r"pytpc fix(?!.*--(undo|command|json|yes))": Keys((("Try it:", "y\r"),)),
}
# A block that asks a graph, and starts none, is read while the robot runs.
ASKS_A_GRAPH = (
    r"rosbag record|rosparam|rostopic|pytpc (sink|relay|watch(?!.*--once)|apply --live|live|stream)"
)
BESIDE = "beside"
ASKS_A_RECORDING = r"pytpc (watch|live|stream)"
STARTS_A_GRAPH = r"roscore|roslaunch|ros2 launch"
# Commands that find what they are told to fail on: their status is 1.
BREAKS_A_RULE = r"pytpc (lint|compare) .*--fail-on"
HELP = """\
A command of the docs does not do what its page says. Mend the page; or, if the page is right, give
the command what it needs in tests/docs_world.py (a file in `World.prepare`, a line in `HOW` if it
runs until Ctrl-C or takes keys), or list it with the reason in tests/docs/not_run.toml."""
BEGIN = r"(?:^|[;&|]\s*)(?:\w+=\S+ )*"


class World:
    """The home below ``folder``; a built robot is kept beside it."""

    def __init__(self, folder: Path) -> None:
        self.home, self._kept = folder / "home", folder / "kept"
        runtime = folder / "run"
        runtime.mkdir(mode=0o700)
        programs = folder / "bin"
        programs.mkdir()
        port = _free_port()
        _script(programs / "pytpc", f'exec {sys.executable} -m pytpc "$@"')
        # The port of everybody's master may be taken on this machine.
        _script(programs / "roscore", f"exec /usr/bin/roscore -p {port}")
        self.env = {
            "HOME": str(self.home),
            "PATH": f"{programs}:{Path(sys.executable).parent}:/usr/bin:/bin",
            "PYTHONPATH": f"{ROOT}:{ROOT}/evaluation",
            "XDG_RUNTIME_DIR": str(runtime),
            "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
            "ROS_IP": "127.0.0.1",
            "BROWSER": "true",
            "LANG": "C.UTF-8",
            "NO_COLOR": "1",
            "TERM": "xterm",
        }

    def build(self) -> None:
        """Build the robot, and record it with its right value and with a wrong one."""
        shutil.copytree(ROOT / "tests/docs/my_robot", self.home / "ws/src/my_robot")
        self._said("pytpc build ws")
        self._said("pytpc record ws sim.launch -o yesterday")
        _replace(self.home / "ws/src/my_robot/config/params.yaml", RIGHT, WRONG)
        for name in ("mission", "again"):
            self._said(f"pytpc record ws sim.launch -o {name}")
        marks = self._said(f"pytpc marks {ROOT}/examples/recorded_mission --csv")
        (self.home / "marks.csv").write_text(marks)
        self.home.rename(self._kept)

    def _said(self, text: str) -> str:
        done = subprocess.run(
            ["bash", "-c", text],
            cwd=self.home,
            env=self.env,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=600,
            check=False,
        )
        assert done.returncode == 0, f"{text}\n{done.stdout}{done.stderr}"
        return done.stdout

    def prepare(self, commands: Sequence[Command]) -> None:
        """Make the home new, with what a reader of these commands has."""
        shutil.rmtree(self.home, ignore_errors=True)
        shutil.copytree(self._kept, self.home, symlinks=True)
        home, robot = self.home, self.home / "ws/src/my_robot"
        for name in ("examples", "build"):
            (home / name).symlink_to(ROOT / name)
        shutil.copytree(robot / "config", home / "config")
        shutil.copy(robot / "launch/robot.launch", home)
        node = (robot / "scripts/mission.py").read_text()
        # rospy does not survive a Ctrl-C while it asks for a parameter.
        started = 'print("flying", flush=True)\nrospy.Timer('
        (home / "node.py").write_text(node.replace("rospy.Timer(", started))
        shutil.copy(ROOT / "tests/docs/params.yaml", home)
        shutil.copy(ROOT / "examples/recorded_mission/static.json", home / "uav.json")
        shutil.copy(home / "mission/mission.bag", home / "my.bag")
        (home / ".ros/tpc").mkdir(parents=True)
        (home / "tree/src").mkdir(parents=True)
        (home / "tree/CMakeLists.txt").write_text(TREE)
        (home / "tree/src/tool.cpp").write_text("int main() { return 0; }\n")
        (home / ".config/fish/completions").mkdir(parents=True)
        text = "\n".join(command.text for command in commands)
        self._prepare_sources(text)
        # On this page the robot is mended: its own files must have set the values.
        if "pytpc fix today" in text:
            shutil.copytree(home / "mission", home / "today", symlinks=True)
        else:
            for name in ("yesterday", "monday", "tuesday", "wednesday"):
                shutil.rmtree(home / name, ignore_errors=True)
                recorded(home / name)
            for name in ("today", "tomorrow", "missions/first", "missions/second"):
                recorded(home / name, home / "marks.csv")
        if "pytpc fleet add" in text:
            for robot in ("robot6", "robot7", "robot8"):
                recorded(home / "missions" / robot / "monday")
        if "pytpc rank monday tuesday" in text:
            for name in ("monday", "tuesday"):
                shutil.copy(home / "marks.csv", home / name)
        for name in ("monday", "tuesday"):
            shutil.copytree(self._kept / "yesterday", home / "out" / name, symlinks=True)
        if not re.search(r"record\b.* -[oO] out/today", text):
            recorded(home / "out/today", home / "marks.csv")

    def _prepare_sources(self, text: str) -> None:
        """Give the robot the faults and edits of which the pages with these commands speak."""
        home, robot = self.home, self.home / "ws/src/my_robot"
        if "unit.bc" in text:
            self._said("clang-19 -c -emit-llvm -xc /dev/null -o unit.bc")
        if "pytpc lint" in text:
            _replace(robot / "config/params.yaml", WRONG, f"{WRONG}\n  max_coverage_limit: 0.05")
            _replace(robot / "config/params.yaml", "max_height", "max_hight")
        if "pytpc compare base.json" in text:
            shutil.copy(home / "ws/.tpc/static.json", home / "base.json")
            for old, new in EDITS.items():
                _replace(robot / "scripts/mission.py", old, new)
            self._said("pytpc build ws")


def recorded(folder: Path, marks: Path | None = None) -> None:
    """Write the mission of the examples, as one of two minutes: with marks, or as a good run."""
    shutil.copytree(ROOT / "examples/recorded_mission", folder)
    about = json.loads((folder / "marks.json").read_text())
    (folder / "marks.json").write_text(json.dumps({**about, "end_ns": 120 * 10**9, "marks": []}))
    with (folder / "params.yaml").open("a") as stream:
        stream.write(f"planner:\n  robot_radius: {0.42 if marks else 0.17}\n")
    if marks:
        shutil.copy(marks, folder)
        return
    (folder / "treatment.json").unlink()
    _replace(folder / "params.yaml", WRONG, RIGHT)
    table = pq.read_table(folder / "events.parquet")
    at = table.schema.get_field_index("thresh")
    right = pc.if_else(pc.equal(table["thresh"], 0.058), 0.035, table["thresh"])
    pq.write_table(table.set_column(at, table.schema.field(at), right), folder / "events.parquet")


class Reader:
    """Types the commands of a page in their order, each in a terminal; a context manager."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._before = "true"
        self._running: list[tuple[str, Terminal, int]] = []
        self._said: list[str] = []

    def __enter__(self) -> Reader:
        return self

    def __exit__(self, *_: object) -> None:
        # A program that is killed leaves what it started; one that is interrupted ends it.
        while self._running:
            with self._running.pop()[1] as terminal, suppress(AssertionError, OSError):
                terminal.press("\x03")
                terminal.wait(PATIENCE_S)

    def read(self, block: Sequence[Command]) -> None:
        """Type the commands of a block, and compare what the page shows below them."""
        self._said = []
        texts = [spelt(command.text) for command in block]
        # Each section begins anew: `record` refuses a folder that has a recording.
        for again in re.findall(
            r"(?:pytpc (?:record|keep)\b.* -o|rosbag record -O) (out/\w+)", "\n".join(texts)
        ):
            shutil.rmtree(self._world.home / again, ignore_errors=True)
        starts = any(re.search(BEGIN + STARTS_A_GRAPH, text) for text in texts)
        if not starts and any(re.search(BEGIN + ASKS_A_GRAPH, text) for text in texts):
            self._start('eval "$(pytpc env --setup ws)"; roslaunch my_robot robot.launch')
            if any(re.search(BEGIN + ASKS_A_RECORDING, text) for text in texts):
                self._start(f"pytpc record -o {BESIDE} --static ws")
            if any("--rerun" in text for text in texts):
                self._start("rerun --serve-grpc --bind 127.0.0.1")
        for command, text in zip(block, texts, strict=True):
            try:
                self._type(text)
            except AssertionError as error:
                raise AssertionError(f"{command.place}: {error}\n{HELP}") from None
        while self._running:
            self._interrupt()
        shutil.rmtree(self._world.home / BESIDE, ignore_errors=True)
        check_output(block[0].output, "\n".join(self._said))

    def _type(self, text: str) -> None:
        how = next((HOW[each] for each in HOW if re.search(BEGIN + each, text)), None)
        if isinstance(how, Long):
            self._start(text)
            if how.alone:
                self._interrupt()
            return
        with self._terminal(text) as terminal:
            for wanted, keys in how.presses if how else ():
                await_text(terminal, wanted)
                terminal.press(keys)
            self._end(text, terminal, int(re.search(BREAKS_A_RULE, text) is not None))
        if re.match(r"(eval|source|\.|export|cd) [^;&|]*$", text):
            self._before += f"; {text}"

    def _start(self, text: str) -> None:
        how = next(HOW[each] for each in HOW if re.search(BEGIN + each, text))
        assert isinstance(how, Long)
        terminal = self._terminal(text)
        self._running.append((text, terminal, how.status))
        await_text(terminal, how.ready)

    def _interrupt(self) -> None:
        text, terminal, status = self._running.pop()
        with terminal:
            terminal.press("\x03")
            self._end(text, terminal, status)

    def _end(self, text: str, terminal: Terminal, wanted: int) -> None:
        status = terminal.wait(PATIENCE_S)
        assert status == wanted, f"{text}: status {status}\n{said(terminal)}"
        # A line of progress, which only a slow machine shows, ends with a \r.
        self._said += re.sub(r"\r+\n?", "\n", terminal.text).splitlines()

    def _terminal(self, text: str) -> Terminal:
        words = ["env", "-i", *(f"{name}={value}" for name, value in self._world.env.items())]
        command = f"{self._before} && {text}"
        return Terminal([*words, "bash", "-c", command], self._world.home, columns=200, lines=50)


def read_page(world: World, found: Sequence[Command]) -> None:
    """Type the commands of a page, in a new home, and compare what the page shows."""
    world.prepare(found)
    with Reader(world) as reader:
        for _, block in groupby(found, key=lambda command: command.block):
            reader.read(list(block))


def spelt(text: str) -> str:
    """A command with a name of the reader's for each word that stands for one."""
    for word, name in NAMES.items():
        text = re.sub(word, name, text)
    return text


def await_text(terminal: Terminal, pattern: str) -> None:
    """Until the program has said what matches."""
    until = time.monotonic() + PATIENCE_S
    while not re.search(pattern, terminal.text):
        assert terminal.process.poll() is None, f"it ended:\n{said(terminal)}"
        assert time.monotonic() < until, f"no {pattern!r} in:\n{said(terminal)}"
        terminal.read()


def said(terminal: Terminal) -> str:
    """The last lines that are neither empty nor those of a spinner."""
    lines = [line.rstrip() for line in terminal.text.replace("\r", "\n").splitlines()]
    return "\n".join([line for line in lines if line and not "⠀" < line[0] < "⣿"][-60:])


def check_output(shown: Sequence[str], output: str) -> None:
    """Compare how lines begin: the first that the page shows, and most of the others."""
    shown = [line for line in shown if line.strip("., ")]
    strange = [line for line in shown if not re.search(beginning(line), output, re.MULTILINE)]
    if strange and (strange[0] == shown[0] or 2 * len(strange) > len(shown)):
        raise AssertionError(f"no line begins like {strange} of the page in:\n{output}")


def beginning(line: str) -> str:
    """What a line begins with that looks like this one: three words, with any numbers."""
    words = [
        r"\S+" if re.search(r"\d|\.\.", word) else re.escape(word) for word in line.split()[:3]
    ]
    return r"^\s*" + r"\s+".join(words)


def _free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


def _script(path: Path, line: str) -> None:
    path.write_text(f"#!/bin/sh\n{line}\n")
    path.chmod(0o755)


def _replace(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
