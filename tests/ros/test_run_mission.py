"""`pytpc run WS LAUNCH` on a real graph: suspects, keys, verdict and page in one terminal."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
from pathlib import Path

import pytest
from recorded_robot import environment, make_workspace, processes_of, shell, wait_until

from pytpc.ingest.reading import read
from pytpc.ros.mission_run import read_status
from screens import Screen
from terminals import Terminal, pytpc

if shutil.which("roslaunch") is None:
    pytest.skip("ROS is not installed", allow_module_level=True)


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    return make_workspace(tmp_path / "ws")


def run(folder: Path, *words: str) -> Terminal:
    return shell("run", "ws", "robot_base", "robot.launch", *words, "-o", "out", folder=folder)


def reports(folder: Path) -> int:
    status = read_status(folder / "out/ros/recorder.json")
    return 0 if status is None else status.reports


def ended(folder: Path) -> str:
    out = folder / "out"
    assert processes_of(out) == []
    assert (out / "report.html").read_text().rstrip().endswith("</html>")
    return str(json.loads((out / "run.json").read_text())["ended"])


# The limit of -0.2 has it command for too long. Two marks, of which one is taken back, and another.
def test_from_the_start_to_the_verdict_with_keys(robot: Path, tmp_path: Path):
    with Screen(run(tmp_path, "limit:=-0.2"), 120, 30) as screen:
        screen.wait_for("watching on http://127.0.0.1", "~limit", timeout_s=60)
        wait_until(lambda: reports(tmp_path) > 2, screen.terminal)
        screen.terminal.press("12u1")
        screen.wait_for("marked: type I")
        screen.terminal.press("q")
        assert screen.terminal.wait(90) == 0
        said = screen.terminal.text
    assert "2 marks: out/marks.csv" in said
    assert "(interrupted): out/mission.bag" in said
    assert "and 2 marks in " in said
    assert "All 2 marks together" in said
    assert json.loads((tmp_path / "out/run.json").read_text())["marks"] == 2
    assert "out/report.html" in said
    assert "next: " in said
    assert ended(tmp_path) == "interrupted"
    assert [mark.type for mark in read(tmp_path / "out").marks] == ["I", "I"]


# The good run of 4 s has other seconds, too.
def test_beside_a_good_run_the_screen_says_what_rank_says(robot: Path, tmp_path: Path):
    good = pytpc("run", "-o", "monday", "ws", "robot_base", "robot.launch", "seconds:=4.0")
    env = {**os.environ, **environment(tmp_path / "runtime")}
    subprocess.run(good, cwd=tmp_path, env=env, stdin=subprocess.DEVNULL, timeout=900, check=True)
    with Screen(run(tmp_path, "limit:=-0.2", "--reference", "monday"), 120, 30) as screen:
        screen.wait_for("watching on http://127.0.0.1", timeout_s=60)
        screen.wait_for("differs from the good run monday:", "~limit 0.5 -> -0.2")
        wait_until(lambda: reports(tmp_path) > 2, screen.terminal)
        screen.wait_for("  1 ~limit")
        screen.terminal.press("1")
        screen.wait_for("The one mark: 1 of type I: ")
        screen.terminal.press("q")
        assert screen.terminal.wait(90) == 0
        said = screen.terminal.text
    assert "differ from the good run monday; the code is the same" in said
    assert ended(tmp_path) == "interrupted"


def test_the_screen_ends_with_the_mission(robot: Path, tmp_path: Path):
    with Screen(run(tmp_path, "seconds:=6.0"), 120, 30) as screen:
        screen.wait_for("watching on http://127.0.0.1", timeout_s=60)
        screen.terminal.press("2")
        assert screen.terminal.wait(90) == 0
        assert "1 mark: out/marks.csv" in screen.terminal.text
    assert ended(tmp_path) == "ended"


def test_a_closed_terminal_still_leaves_the_page(robot: Path, tmp_path: Path):
    terminal = run(tmp_path)
    with terminal:
        wait_until(lambda: reports(tmp_path) > 0, terminal)
        os.close(terminal.child)
        os.close(terminal.master)
        assert terminal.process.wait(90) == 0
    assert ended(tmp_path) == "interrupted"


def test_a_signal_ends_it_within_a_note(robot: Path, tmp_path: Path):
    with Screen(run(tmp_path), 120, 30) as screen:
        screen.wait_for("watching on http://127.0.0.1", timeout_s=60)
        wait_until(lambda: reports(tmp_path) > 2, screen.terminal)
        screen.terminal.press("1nlaut")
        screen.wait_for("note: laut_")
        screen.terminal.process.send_signal(signal.SIGTERM)
        assert screen.terminal.wait(90) == 0
    assert ended(tmp_path) == "interrupted"
    assert [mark.note for mark in read(tmp_path / "out").marks] == ["laut"]


def test_a_mark_that_was_taken_back_is_none(robot: Path, tmp_path: Path):
    with Screen(run(tmp_path, "limit:=-0.2"), 120, 30) as screen:
        screen.wait_for("watching on http://127.0.0.1", "~limit", timeout_s=60)
        wait_until(lambda: reports(tmp_path) > 2, screen.terminal)
        screen.terminal.press("1u")
        screen.wait_for("taken back: type I")
        screen.terminal.press("q")
        assert screen.terminal.wait(90) == 0
        said = screen.terminal.text
    assert "nothing was marked, so nothing is to blame" in said
    assert (tmp_path / "out/report.html").is_file()


def test_without_a_terminal_it_records_and_reports(robot: Path, tmp_path: Path):
    done = subprocess.run(
        pytpc("run", "-o", "out", "ws", "robot_base", "robot.launch", "seconds:=3.0"),
        cwd=tmp_path,
        env={**os.environ, **environment(tmp_path / "runtime")},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=900,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "(ended): out/mission.bag" in done.stdout
    assert "nothing was marked" in done.stderr
    assert ended(tmp_path) == "ended"


def test_ctrl_c_while_it_starts(robot: Path, tmp_path: Path):
    with run(tmp_path) as terminal:
        wait_until((tmp_path / "out/ros/out/rosmaster.log").exists, terminal)
        terminal.press("\x03")
        assert terminal.wait(60) == 1
        assert "no reports arrived" in terminal.text
    assert (tmp_path / "out/run.json").is_file()
