"""`pytpc mark` in a real terminal, on a bag that is already recorded."""

from __future__ import annotations

import os
import signal
import subprocess
import termios
from pathlib import Path

import pytest
from mission_samples import BagFile, line, ns

from pytpc.ingest.reading import read
from pytpc.recording.graph_file import GRAPH_FILE, write_graph
from pytpc.recording.marks import Mark, marks_beside, read_marks, write_marks
from pytpc.static.wiring import GraphTopic
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


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_note_that_a_signal_interrupts_is_kept(bag: Path, tmp_path: Path, number: signal.Signals):
    with Terminal(pytpc("mark", str(bag)), tmp_path) as terminal:
        terminal.wait_for("stopped")
        terminal.press("2n")
        terminal.wait_for("note: _")
        terminal.press("laut")
        terminal.wait_for("note: laut_")
        assert terminal.end(number) == 128 + number
    assert read_marks(marks_beside(bag)) == (Mark(ns(100), "II", "", "laut"),)


@pytest.fixture
def graph(bag: Path) -> None:
    """What the robot of the mission publishes, as `record` leaves it beside the bag."""
    topics = {
        name: GraphTopic(kind, frozenset({"/driver"}), frozenset({"/base"}))
        for name, kind in {"/cmd_vel": "geometry_msgs/Twist", "/odom": "nav_msgs/Odometry"}.items()
    }
    write_graph(topics, bag.with_name(GRAPH_FILE))


@pytest.mark.usefixtures("graph")
def test_the_place_of_a_mark_is_chosen_from_the_recorded_graph(bag: Path, tmp_path: Path):
    with Terminal(pytpc("mark", str(bag)), tmp_path) as terminal:
        terminal.wait_for("w where")
        terminal.press("2w")
        terminal.wait_for("1 /cmd_vel (geometry_msgs/Twist)")
        terminal.press("1q\r")
        terminal.wait_for("not a ROS name: 1q")
        terminal.press("\x7f\r")
        terminal.wait_for("wrong at /cmd_vel")
        assert read_marks(marks_beside(bag)) == (Mark(ns(100), "II", "", "@/cmd_vel"),)
        terminal.press("q")
        assert terminal.wait() == 0


@pytest.mark.usefixtures("graph")
def test_a_place_is_chosen_where_the_cursor_cannot_move(bag: Path, tmp_path: Path):
    with Terminal(pytpc("mark", str(bag)), tmp_path, env={"TERM": "dumb"}) as terminal:
        terminal.wait_for("w where")
        terminal.press("1w")
        asked = "where (number, name or part; Enter ends it):"
        terminal.wait_for(f"   3 /base (node)\r\n   4 /driver (node)\r\n{asked}")
        terminal.press("odo")
        terminal.press("\r")
        terminal.wait_for("wrong at /odom")
        # Typing has shown the list no second time.
        assert "/cmd_vel" not in terminal.text
        assert "\x1b" not in terminal.output.decode()
        terminal.press("q")
        assert terminal.wait() == 0
    assert read_marks(marks_beside(bag)) == (Mark(ns(100), "I", "", "@/odom"),)


def test_a_broken_graph_leaves_typing(bag: Path, tmp_path: Path):
    bag.with_name(GRAPH_FILE).write_text("[]")
    with Terminal(pytpc("mark", str(bag)), tmp_path, columns=400) as terminal:
        terminal.wait_for("not the graph of a mission")
        terminal.press("1w")
        terminal.wait_for("no place is known: type a name")
        terminal.press("base_link\rq")
        assert terminal.wait() == 0
    assert read_marks(marks_beside(bag)) == (Mark(ns(100), "I", "", "@base_link"),)


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


def test_a_session_without_a_mark_leaves_no_file(bag: Path, tmp_path: Path):
    with Terminal(pytpc("mark", str(bag)), tmp_path) as terminal:
        terminal.wait_for("0 marks")
        terminal.press("q")
        terminal.wait_for("nothing was marked")
        assert terminal.wait() == 0
    assert not marks_beside(bag).exists()


# The file for new marks is not there: the mark is in one that an older version wrote.
def test_a_mark_in_another_file_of_the_recording_is_counted(bag: Path, tmp_path: Path):
    folder = tmp_path / "mission"
    folder.mkdir()
    bag.rename(folder / "mission.bag")
    (folder / "run.json").write_text("{}")
    older = folder.with_name("mission.marks.csv")
    write_marks((Mark(ns(101), "II", "", ""),), older)
    with Terminal(pytpc("mark", str(folder)), tmp_path) as terminal:
        terminal.wait_for("1 mark")
        terminal.press("q")
        terminal.wait_for("1 mark:")
        assert terminal.wait() == 0
        assert "nothing was marked" not in terminal.text


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


# Each in a terminal of their own, and each names the mission in another way.
def test_two_observers_of_a_folder_and_of_the_bag_in_it(bag: Path, tmp_path: Path):
    (tmp_path / "run.json").write_text("{}")
    with (
        Terminal(pytpc("mark", ".", "--observer", "marks0"), tmp_path) as one,
        Terminal(pytpc("mark", str(bag), "--observer", "marks1"), tmp_path) as two,
    ):
        for terminal in (one, two):
            terminal.wait_for("stopped")
        one.press("12uq")
        two.press("\x1b[C2q")
        for terminal in (one, two):
            assert terminal.wait() == 0
        assert "1 mark: marks.csv" in one.text
    found = (Mark(ns(100), "I", "marks0"), Mark(ns(105), "II", "marks1"))
    assert read_marks(tmp_path / "marks.csv") == found
    assert read(bag).marks == read(tmp_path).marks == found


def test_a_file_of_ones_own_is_told_how_to_be_read(bag: Path, tmp_path: Path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    with Terminal(pytpc("mark", str(bag), "-o", "elsewhere/m"), tmp_path, columns=400) as terminal:
        terminal.wait_for("stopped")
        terminal.press("1q")
        assert terminal.wait() == 0
        assert f"pytpc rank {bag} --marks elsewhere/m" in terminal.text
    assert read(bag).marks == ()


def test_a_person_is_told_that_a_copy_has_marks_of_its_own(bag: Path, tmp_path: Path) -> None:
    def said(*words: str) -> str:
        with Terminal(pytpc(*words), tmp_path, columns=200) as terminal:
            assert terminal.wait() == 0
            return terminal.text

    copied = said("convert", str(bag), "-o", "copy")
    assert f"copy has marks of its own from now on: what is marked in {bag} later" in copied
    added = "a copy that `pytpc convert` made before does not have this mark"
    assert added in said("marks", str(bag), "--add", "1", "I")
    assert added not in said("marks", "copy", "--add", "1", "I")
    assert "of its own" not in said("convert", "copy", "-o", "copy")
