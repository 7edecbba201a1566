"""`pytpc mark` in a real terminal, on a bag that is already recorded."""

from __future__ import annotations

import os
import signal
import subprocess
import termios
from pathlib import Path

import pytest
from mission_samples import BagFile, line, ns

from pytpc.recording.marks import Mark, marks_beside, read_marks, write_marks
from terminals import Terminal, pytpc

START = 100.0


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    """A mission of a minute, from 100 to 160 s."""
    path = tmp_path / "mission.bag"
    with BagFile(path) as writer:
        for seconds in (START, START + 60):
            writer.log(seconds, "/node", line(0, 0, 1, 2))
    return path


# The clock stands at the beginning until it is told to go: Right is 5 s. Marks at 105 s (wrong),
# 110 s (type I) and 110 s + 1 ns (type II, which is taken back); the first is made last.
def test_marks_are_beside_the_bag_at_every_key(bag: Path, tmp_path: Path):
    beside = marks_beside(bag)
    with Terminal(pytpc("mark", str(bag), "--observer", "ana"), tmp_path) as terminal:
        terminal.wait_for("0:00.0 of 1:00.0, stopped")
        terminal.press("\x1b[C\x1b[C1")
        terminal.wait_for("marked: type I")
        assert read_marks(beside) == (Mark(ns(110), "I", "ana"),)
        terminal.press("2")
        terminal.wait_for("marked: type II")
        terminal.press("u")
        terminal.wait_for("taken back: type II")
        terminal.press("\x1b[D3n")
        terminal.wait_for("note: _")
        terminal.press('1 dröhnt, "laut"x\x7f\r')
        terminal.wait_for("noted")
        terminal.press("q")
        assert terminal.wait() == 0
        assert termios.tcgetattr(terminal.child) == terminal.before
        assert "2 marks:" in terminal.text
    assert read_marks(beside) == (
        Mark(ns(105), None, "ana", '1 dröhnt, "laut"'),
        Mark(ns(110), "I", "ana"),
    )


def test_the_clock_goes_and_stops_at_the_end(bag: Path, tmp_path: Path):
    with Terminal(pytpc("mark", str(bag)), tmp_path) as terminal:
        terminal.wait_for("stopped")
        terminal.press("\x1b[A\x1b[D.. ++++")
        terminal.wait_for("going, speed 16")
        terminal.wait_for("1:00.0 of 1:00.0")
        terminal.press("1q")
        assert terminal.wait() == 0
    assert read_marks(marks_beside(bag)) == (Mark(ns(160), "I"),)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_it_cleanly(bag: Path, tmp_path: Path, number: signal.Signals):
    with Terminal(pytpc("mark", str(bag)), tmp_path) as terminal:
        terminal.wait_for("stopped")
        terminal.press("2")
        terminal.wait_for("marked")
        assert terminal.end(number) == 128 + number
        assert termios.tcgetattr(terminal.child) == terminal.before
        assert "\x1b[?25h" in terminal.output.decode()
    assert read_marks(marks_beside(bag)) == (Mark(ns(100), "II"),)


# The terminal is gone, as when an SSH connection breaks: the kernel says so by SIGHUP.
def test_a_terminal_that_is_gone(bag: Path, tmp_path: Path):
    with Terminal(pytpc("mark", str(bag)), tmp_path) as terminal:
        terminal.wait_for("stopped")
        terminal.press("2")
        terminal.wait_for("marked")
        os.close(terminal.child)
        os.close(terminal.master)
        assert terminal.process.wait(10) != 0
    assert read_marks(marks_beside(bag)) == (Mark(ns(100), "II"),)


def test_two_observers_at_once_and_again(bag: Path, tmp_path: Path):
    with (
        Terminal(pytpc("mark", str(bag), "--observer", "ana"), tmp_path) as one,
        Terminal(pytpc("mark", str(bag), "--observer", "ben"), tmp_path) as two,
    ):
        one.wait_for("stopped")
        two.wait_for("stopped")
        for terminal in (one, two):
            terminal.press("1")
            terminal.wait_for("marked")
        one.press("u")
        one.wait_for("taken back")
        for terminal in (one, two):
            terminal.press("q")
            assert terminal.wait() == 0
    assert read_marks(marks_beside(bag)) == (Mark(ns(100), "I", "ben"),)
    # Who comes again finds the own marks of before.
    with Terminal(pytpc("mark", str(bag), "--observer", "ben"), tmp_path) as terminal:
        terminal.wait_for("1 mark:")
        terminal.press("uq")
        assert terminal.wait() == 0
    assert read_marks(marks_beside(bag)) == ()


def test_a_narrow_terminal_without_colours(bag: Path, tmp_path: Path):
    with Terminal(
        pytpc("mark", str(bag)), tmp_path, env={"TERM": "vt100", "NO_COLOR": "1"}, columns=20
    ) as terminal:
        terminal.wait_for("q quit")
        terminal.press("1")
        terminal.wait_for("0:00.0  I")
        terminal.press("q")
        assert terminal.wait() == 0


def test_a_terminal_that_cannot_move_its_cursor(bag: Path, tmp_path: Path):
    with Terminal(pytpc("mark", str(bag)), tmp_path, env={"TERM": "dumb"}) as terminal:
        terminal.wait_for("q quit")
        for _ in range(2):
            terminal.press("1")
            terminal.wait_for("marked: type I")
        assert "\x1b" not in terminal.output.decode()
        terminal.press("\x04")
        assert terminal.wait() == 0
    assert len(read_marks(marks_beside(bag))) == 2


def test_without_a_terminal_it_says_so(bag: Path, tmp_path: Path):
    done = subprocess.run(
        pytpc("mark", str(bag)),
        stdin=subprocess.DEVNULL,
        check=False,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == (
        "pytpc: error: standard input is not a terminal, so no keys can be read"
    )


def test_a_file_that_is_none_of_marks_is_not_overwritten(bag: Path, tmp_path: Path):
    marks_beside(bag).write_text("my notes\n")
    with Terminal(pytpc("mark", str(bag)), tmp_path) as terminal:
        assert terminal.wait() == 1
        assert "mission.bag.marks.csv:1: the first line is not time_ns,type" in terminal.text
    assert marks_beside(bag).read_text() == "my notes\n"


# As root every folder can be written; one that is gone cannot.
def test_a_mark_that_cannot_be_saved_is_kept(bag: Path, tmp_path: Path):
    folder = tmp_path / "usb"
    folder.mkdir()
    with Terminal(pytpc("mark", str(bag), "-o", "usb/marks.csv"), tmp_path) as terminal:
        terminal.wait_for("stopped")
        folder.rmdir()
        terminal.press("1")
        terminal.wait_for("NOT SAVED")
        folder.mkdir()
        terminal.wait_for("saved now")
        folder_marks = read_marks(folder / "marks.csv")
        assert folder_marks == (Mark(ns(100), "I"),)
        (folder / "marks.csv").unlink()
        folder.rmdir()
        terminal.press("2q")
        assert terminal.wait() == 1
        assert "NOT SAVED" in terminal.text


def test_a_namespace_that_ros_has_not(tmp_path: Path):
    done = subprocess.run(
        pytpc("mark", "--observer", "no good"),
        check=False,
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    assert done.returncode == 2
    assert "'no good' is not a ROS namespace" in done.stderr


def test_marks_of_others_stay_in_the_file(bag: Path, tmp_path: Path):
    others = (Mark(ns(101), "II", "cleo", "hm"),)
    write_marks(others, marks_beside(bag))
    with Terminal(pytpc("mark", str(bag)), tmp_path) as terminal:
        terminal.wait_for("0 marks")
        terminal.press("u")
        terminal.wait_for("no mark yet")
        terminal.press("3q")
        assert terminal.wait() == 0
    assert read_marks(marks_beside(bag)) == (Mark(ns(100), None), *others)
