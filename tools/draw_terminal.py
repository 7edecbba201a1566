"""Draw the README's film of a terminal from a real session.

``draw_terminal.py [--folder FOLDER]`` builds the image capture robot of examples/ and flies it,
once as it should be and then with one wrong value in its YAML. It types into a shell what a user
would: run, mark, apply, run again. Nothing of the output is edited; waiting is shortened, as
``Session.pace`` says. FOLDER is in the picture, and keeps the workspace, so that a second drawing
need not build it. The robot's noise has a fixed seed, but its nodes run side by side: two drawings
differ a little.
"""

from __future__ import annotations

import argparse
import fcntl
import os
import pty
import re
import select
import shutil
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import pyte
from terminal_film import Film, Screen, lines_of

ROOT = Path(__file__).resolve().parents[1]
PICTURE = ROOT / "docs/images/run.svg"
COLUMNS, LINES = 100, 25
PROMPT = "$ "
TITLE = "TPC finds the wrong parameter of a robot, in a terminal"
DESCRIPTION = (
    "pytpc run flies a simulated UAV that should take a picture of a person. It hovers in front of"
    " the person and takes none. The screen shows the suspects; the key 2 marks that the"
    " robot should be doing something. After the mission, min_coverage_limit is blamed and a value"
    " is suggested. pytpc apply writes it into the robot's YAML file. In the next run the UAV takes"
    " its picture and lands."
)
LAUNCH = """<launch>
  <!-- What the scripted observer says is not recorded: it is pressed as a key. -->
  <remap from="/mark_action" to="/observer/action"/>
  <remap from="/mark_no_action" to="/observer/no_action"/>
  <include file="$(find image_capture)/launch/image_capture.launch">
    <arg name="rate" value="3"/>
    <arg name="overlay2" value="$(dirname)/robot.yaml"/>
  </include>
</launch>
"""
YAML = """flight_controller:
  cruise_speed: 1.0
  max_height: 4.0

mission:
  takeoff_height: 1.6
  search_yaw_rate: 0.35
  min_coverage_limit: 0.035
  standoff_distance: 2.2
"""
# From where the UAV hovers, a face covers 0.051 of the picture.
GOOD = "out/yesterday"
UNTIL = "--until /mission/done"
WRONG = YAML.replace("0.035", "0.058")
SAID = re.compile(r"^\[rosout\].*: mark_(action|no_action) at ", re.MULTILINE)
NEXT = re.compile(r"^next: (pytpc apply .*)", re.MULTILINE)


class Session:
    """A shell in a terminal of its own, and the film of it; a context manager.

    ``pace`` seconds of the session are one of the film, in which no wait is longer than ``most_s``
    and no frame shorter than ``least_s``.
    """

    def __init__(self, folder: Path, env: Mapping[str, str]) -> None:
        """Start the shell in a folder."""
        self.film, self.now_s = Film(), 0.0
        self._screen = Screen(COLUMNS, LINES)
        self._stream = pyte.ByteStream(self._screen)
        self._master, child = pty.openpty()
        fcntl.ioctl(child, termios.TIOCSWINSZ, struct.pack("HHHH", LINES, COLUMNS, 0, 0))
        self._shell = subprocess.Popen(
            ["setsid", "--ctty", "bash", "--norc", "--noprofile", "-i"],
            cwd=folder,
            env=env,
            stdin=child,
            stdout=child,
            stderr=child,
        )
        os.close(child)
        self._seen_s = time.monotonic()
        self.pace()

    def __enter__(self) -> Session:
        """Wait for the prompt."""
        self.wait_for_prompt(20.0)
        self.film, self.now_s = Film(), 0.0
        self.film.show(0.0, lines_of(self._screen))
        return self

    def __exit__(self, *_: object) -> None:
        """End the shell, and with its terminal what runs in it."""
        os.close(self._master)
        with suppress(subprocess.TimeoutExpired):
            self._shell.wait(20)
        self._shell.kill()
        self._shell.wait()

    @property
    def text(self) -> str:
        """What the screen shows."""
        return "\n".join(self._screen.display)

    def pace(self, pace: float = 1.0, least_s: float = 0.04, most_s: float = 1.0) -> None:
        """Choose how the time of the film runs from here on."""
        self._pace, self._least_s, self._most_s = pace, least_s, most_s

    def hold(self, seconds: float) -> None:
        """Leave the screen in the film for a while."""
        self.now_s += seconds

    def type(self, line: str) -> None:
        """Type a line as a person does."""
        self.pace()
        self.hold(0.4)
        for character in line:
            self.press(character)
            self._read(0.035)
        self.hold(0.4)
        self.press("\r")

    def press(self, keys: str) -> None:
        """Send keys."""
        os.write(self._master, keys.encode())

    def wait_for(self, *wanted: str, timeout_s: float = 120.0) -> None:
        """Until one of ``wanted`` is on the screen."""
        until = time.monotonic() + timeout_s
        while not any(one in self.text for one in wanted):
            self._read(0.1, until)

    def wait_for_prompt(self, timeout_s: float = 180.0) -> None:
        """Until the shell asks for the next command."""
        until = time.monotonic() + timeout_s
        while not self.at_prompt():
            self._read(0.1, until)

    def at_prompt(self) -> bool:
        """Whether the shell waits for a command, of which nothing is typed."""
        line = self._screen.display[self._screen.cursor.y]
        return line.rstrip() == PROMPT.rstrip() and self._screen.cursor.x == len(PROMPT)

    def wait(self, seconds: float) -> None:
        """Let time pass in the session."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            self._read(0.1)

    def _read(self, patience_s: float, until: float | None = None) -> None:
        if until is not None and time.monotonic() > until:
            sys.exit(f"draw-terminal: the session does not go on:\n{self.text}")
        if not select.select([self._master], [], [], patience_s)[0]:
            return
        try:
            self._stream.feed(os.read(self._master, 65536))
        except OSError:
            sys.exit(f"draw-terminal: the shell has ended:\n{self.text}")
        now = time.monotonic()
        self.now_s += min(self._most_s, (now - self._seen_s) / self._pace)
        self._seen_s = now
        self.film.show(self.now_s, lines_of(self._screen), self._least_s)


def robot(folder: Path) -> None:
    """Build a workspace, and write the launch file and the parameters of a robot beside it."""
    for package in ("image_capture", "simulated_world"):
        link = folder / "ws/src" / package
        link.parent.mkdir(parents=True, exist_ok=True)
        link.unlink(missing_ok=True)
        link.symlink_to(ROOT / "examples" / package)
    subprocess.run([sys.executable, "-m", "pytpc", "build", folder / "ws"], check=True)
    (folder / "robot.launch").write_text(LAUNCH, encoding="utf-8")
    (folder / "robot.yaml").write_text(YAML, encoding="utf-8")
    # Earlier recordings, and the changes that `apply` could take back.
    for name in ("out", ".local"):
        shutil.rmtree(folder / name, ignore_errors=True)


def play(session: Session, folder: Path) -> None:
    """Do what a user does after a good run."""
    session.type("# Yesterday the UAV took a picture of the person. Now it hovers, and takes none.")
    session.wait_for_prompt()
    fly(session, folder, "out/today", 8.0)
    session.hold(6.0)
    suggested = NEXT.search(session.text)
    if suggested is None:
        sys.exit(f"draw-terminal: no value is suggested:\n{session.text}")
    session.type(suggested[1].rstrip())
    session.pace(4.0)
    session.wait_for_prompt()
    session.hold(3.0)
    fly(session, folder, "out/again", 12.0)
    session.type("cat out/again/ros/log/latest/uav_simulator-*.log")
    session.wait_for_prompt()
    session.hold(4.0)


def fly(session: Session, folder: Path, output: str, pace: float) -> None:
    """Run a mission, and press a key whenever the scripted observer sees an error."""
    session.type(f"pytpc run ws robot.launch -o {output} {UNTIL} --reference {GOOD}")
    session.pace(pace, 0.35)
    session.wait_for("Type II:")
    logs, marks = folder / output / "ros/log", 0
    while not session.at_prompt():
        session.wait(0.2)
        said = [each[1] for each in SAID.finditer(read(logs, "observer-*.log"))]
        for word in said[marks:]:
            session.press("2" if word == "no_action" else "1")
        marks = len(said)


def read(logs: Path, pattern: str) -> str:
    """What a node logged so far; "latest" is not read, since roslaunch replaces it as it starts."""
    return "".join(path.read_text(encoding="utf-8") for path in logs.glob(f"*-*/{pattern}"))


def main() -> None:
    """Build, play and draw."""
    parser = argparse.ArgumentParser(description="Draw docs/images/run.svg from a real session.")
    parser.add_argument("--folder", type=Path, default=Path("/tmp/uav"))
    parser.add_argument("--picture", type=Path, default=PICTURE)
    given = parser.parse_args()
    folder = given.folder.resolve()
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if folder.stat().st_uid != os.getuid():
        sys.exit(f"draw-terminal: {folder} belongs to somebody else; give another one: --folder")
    robot(folder)
    env = {
        **os.environ,
        "HOME": str(folder),
        "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
        "PS1": PROMPT,
        "TERM": "xterm-256color",
        "LANG": "C.UTF-8",
    }
    for name in ("COLUMNS", "LINES", "ROS_MASTER_URI", "PROMPT_COMMAND", "TPC_POLICY"):
        env.pop(name, None)
    words = ["run", "ws", "robot.launch", "-o", GOOD, *UNTIL.split(), "--no-keys"]
    subprocess.run([sys.executable, "-m", "pytpc", *words], cwd=folder, env=env, check=True)
    (folder / "robot.yaml").write_text(WRONG, encoding="utf-8")
    with Session(folder, env) as session:
        play(session, folder)
        picture = session.film.draw(TITLE, DESCRIPTION, session.now_s)
    given.picture.write_text(picture, encoding="utf-8")
    print(f"{given.picture}: {session.now_s:.0f} s, {len(picture) / 1000:.0f} kB")


if __name__ == "__main__":
    main()
